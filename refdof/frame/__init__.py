"""Frames: pictures made elsewhere, with their depth, for the methods that need no more."""

"""Rays: exact surfaces along the rays of pixels, and their colours."""

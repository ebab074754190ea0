"""Raster stages: rays, layers, and what methods share on the way from triangles to pixels."""

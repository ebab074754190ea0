"""Fetch units: how many texture reads a picture costs, one unit being one read at every pixel.

A method whose reads follow from its parameters and the picture's size has `fetch_units(params, width, height)`, which
counts its loops with the constants that they run with. As in [1], table 1, reads of textures inside filters count, each
bilinear or trilinear one as one; a pixel's own texel outside of a filter and what the driver does by itself do not.

References
----------
.. [1] Lee, Kim, Choi (2009), Real-Time Depth-of-Field Rendering Using Anisotropically Filtered Mipmap Interpolation.
"""

__all__ = ["LARGEST_RADIUS", "MEAN_RADIUS", "level_shares"]

LARGEST_RADIUS = 8.0  # px, [1], table 1: the largest circle of confusion is 16 px wide
MEAN_RADIUS = 4.0  # px, [1], table 1, note


def level_shares(width: int, height: int, count: int) -> list[float]:
    """Texels of mip levels 1 .. `count` per pixel of the picture."""
    sizes = [max(1, width >> k) * max(1, height >> k) for k in range(1, count + 1)]
    return [size / (width * height) for size in sizes]

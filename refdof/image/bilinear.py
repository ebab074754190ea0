"""Bilinear reads: the two texels around a place, the weight of the second, and the blend of four."""

from refdof._jit import inline

__all__ = ["bilinear", "texels_around"]


@inline
def texels_around(place, size):
    """The two texels around `place` [texels from the corner], cut at the border, and the second's weight."""
    centred = min(max(place - type(place)(0.5), type(place)(0)), type(place)(size - 1))
    first = int(centred)
    return first, min(first + 1, size - 1), centred - type(place)(first)


@inline
def bilinear(p, q, r, s, wx, wy):
    """Blend p and q, and r and s below them, by wx, and then those two by wy."""
    a, b = p + (q - p) * wx, r + (s - r) * wx
    return a + (b - a) * wy

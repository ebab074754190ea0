"""Bilinear reads: the two texels around a place, and the weight of the second."""

from refdof._jit import inline

__all__ = ["texels_around"]


@inline
def texels_around(place, size):
    """The two texels around `place` [texels from the corner], cut at the border, and the second's weight."""
    centred = min(max(place - type(place)(0.5), type(place)(0)), type(place)(size - 1))
    first = int(centred)
    return first, min(first + 1, size - 1), centred - type(place)(first)

"""Extreme inputs: numbers at the ends of what float32 and a shader can do. For the level "extreme" of packs."""

import numpy as np

from refdof.oracle.pictures import Picture, random, seen

__all__ = ["INPUTS"]


def sharp(width: int, height: int) -> Picture:
    """Every circle is 0 exactly: the picture stays as it is, and nothing is divided by 0."""
    color, _ = random(3, (height, width, 3), (1,))
    return seen(color, np.full((height, width), 2.0), 50.0, 2.0)


def pinhole(width: int, height: int) -> Picture:
    """A lens of radius 0: all depths, no circles."""
    color, place = random(4, (height, width, 3), (height, width))
    return seen(color, 1.0 + 9.0 * place, 0.0, 2.0)


def huge(width: int, height: int) -> Picture:
    """Circles of up to a million pixels, of both signs, beside sharp ones."""
    color, place = random(5, (height, width, 3), (height, width))
    y, x = np.indices((height, width))
    return seen(color, np.where((x + y) % 4 == 0, 2.0, 1.0 + 9.0 * place), 4e6, 2.0)


def tiny(width: int, height: int) -> Picture:
    """Circles that are denormal numbers, which hardware may take for 0."""
    color, place = random(6, (height, width, 3), (height, width))
    return seen(color, 1.0 + 9.0 * place, 1e-39, 2.0)


def distances(width: int, height: int) -> Picture:
    """Depths from 1e-4 to 1e30, row after row: device depth and 1 / depth at their ends."""
    color, place = random(7, (height, width, 3), (height, width))
    steps = np.array([1e-4, 1e-2, 1.0, 2.0, 1e2, 1e4, 1e8, 1e16, 1e30])
    return seen(color, steps[np.arange(height) % len(steps), None] * (1.0 + 0.5 * place), 20.0, 2.0)


def hair(width: int, height: int) -> Picture:
    """Depths that are apart by the last bit or not at all: who is behind whom may be either where it rounds."""
    color, place = random(8, (height, width, 3), (height, width))
    near, far = np.float32(5.0), np.nextafter(np.float32(5.0), np.float32(6.0))
    depth = np.where(place < 0.5, near, far)
    depth[:, : width // 3] = 2.0
    return seen(color, depth, 40.0, 2.0)


def bright(width: int, height: int) -> Picture:
    """Lights of 1e4 beside black and beside 1e-3: what half floats and running means make of it."""
    y, x = np.indices((height, width))
    light = np.where((x * 5 + y * 11) % 61 == 0, 1e4, np.where((x + y) % 2 == 0, 0.0, 1e-3))
    return seen(light[..., None] * [1.0, 0.5, 0.25], 1.0 + 7.0 * x / width, 60.0, 2.0)


def dim(width: int, height: int) -> Picture:
    """Colours from 1e-45, the least float32, to 1e-30: denormals may be taken for 0, but not for NaN."""
    (place,) = random(9, (height, width, 3))
    y, x = np.indices((height, width))
    scale = np.array([1e-45, 1e-42, 1e-39, 1e-36, 1e-30])[x % 5, None]
    return seen(scale * (1.0 + place), 1.0 + 7.0 * y / height, 50.0, 2.0)


INPUTS = (sharp, pinhole, huge, tiny, distances, hair, bright, dim)

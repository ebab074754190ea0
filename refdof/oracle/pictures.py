"""Pictures: what a case gives a single-image method, and the numbers that they are made of.

Only the five exact operations and stateless bits make them: the same pictures on every processor.
"""

import math
from typing import NamedTuple

import numpy as np

from refdof._check import Float

__all__ = ["FAR", "Picture", "random", "seen"]

FAR = 1e6
"""Depth of the background [scene units]: files hold no infinities, which textures and parsers of ports may not take."""


class Picture(NamedTuple):
    """What a single-image method is given: rows top-down, float32.

    color (H, W, 3) linear RGB; depth (H, W), planar; coc (H, W) signed radius [px], coc_scale (1 / focus - 1 / depth).
    """

    color: Float
    depth: Float
    coc: Float
    coc_scale: float
    focus: float


def seen(color: Float, depth: Float, coc_scale: float, focus: float) -> Picture:
    """A picture through a thin lens; circles are those of the depth as files hold it."""
    color, depth = color.astype(np.float32), depth.astype(np.float32)
    coc = coc_scale * (1.0 / focus - 1.0 / depth.astype(np.float64))
    return Picture(color, depth, coc.astype(np.float32), coc_scale, focus)


def random(seed: int, *shapes: tuple[int, ...]) -> list[Float]:
    """Numbers in 0 .. 1, 53 bits each: the bits of a NumPy `PCG64`, which no version may change."""
    bits = np.random.PCG64(seed)
    return [(bits.random_raw(math.prod(shape)) >> np.uint64(11)).reshape(shape) * 2.0**-53 for shape in shapes]

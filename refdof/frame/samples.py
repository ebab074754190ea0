"""Samples: deep pixels, as surfaces for methods of layers.

A deep pixel holds samples of a depth, a colour times its opacity, and an opacity. Methods know surfaces. Samples are
gathered front to back until together they hide half of what is behind them, or more: that is one surface, at the depth
of the last of them. What is left over behind hides less than half, and is none. The colour of a surface is what the
pixel's ray sees from there on, as that of a transparent surface of a scene: its first sample over the next one, and so
on. An opaque sample with nothing gathered before it is a surface as it is.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index, InputError, as_float, as_image
from refdof._jit import inline, kernel, prange
from refdof.raster.rays.exact_layers import Layers

__all__ = ["Samples", "flat_samples", "surfaces_of_samples"]

_MOST_LAYERS = 1024
_HALF = 0.5


class Samples(NamedTuple):
    """All samples of a picture. start (H + 1 rows of W,) int64: those of pixel p are start[p] .. start[p + 1] - 1;
    color (S, 3) float64, times opacity; depth (S,) float64; opacity (S,) float64.
    """

    start: Index
    color: Float
    depth: Float
    opacity: Float

    @property
    def pixel(self) -> Index:
        """The pixel of each sample: (S,), counted row by row."""
        return np.repeat(np.arange(len(self.start) - 1), np.diff(self.start))


def flat_samples(color: Sequence[np.ndarray], depth: np.ndarray, opacity: np.ndarray | None) -> Samples:
    """Samples of channels (H, W) whose entries are arrays, or None; without an opacity all are opaque.

    Raises
    ------
    InputError
        If channels differ in their numbers of samples, a value is NaN, a colour is infinite or an opacity is not in
        0 .. 1.
    """
    counts = np.array([0 if one is None else len(one) for one in depth.flat], dtype=np.int64)
    flat = [_flat(channel, counts) for channel in (*color, depth)]
    opaque = np.ones(len(flat[0])) if opacity is None else _flat(opacity, counts)
    return Samples(
        np.concatenate([np.zeros(1, np.int64), np.cumsum(counts)]),
        as_image("color", np.stack(flat[:3], axis=-1), (None, 3), dtype=np.float64),
        as_float("depth", flat[3], (None,), dtype=np.float64, finite=False),
        as_float("opacity", opaque, (None,), dtype=np.float64, minimum=0.0, maximum=1.0),
    )


def surfaces_of_samples(samples: Samples, size: tuple[int, int]) -> tuple[Layers, Float]:
    """Surfaces of samples with planar depths, front to back, and the flat picture, of this width and height.

    Normals are zeros, and triangles are numbers of layers. Samples at infinity are seen, but are no surface.

    Raises
    ------
    InputError
        If a pixel has more than 1024 surfaces.
    """
    width, height = size
    counts = np.zeros((height, width), np.int64)
    flat, nothing = np.zeros((height, width, 3), np.float32), np.zeros((0, height, width))
    _gather(*samples, np.zeros((*nothing.shape, 3), np.float32), nothing, counts, flat)
    most = max(1, int(counts.max(initial=0)))
    if most > _MOST_LAYERS:
        raise InputError(f"depth: a pixel has {most} surfaces; allowed are at most {_MOST_LAYERS}")
    shape = (most, height, width)
    color, depth = np.zeros((*shape, 3), np.float32), np.full(shape, np.inf)
    _gather(*samples, color, depth, counts, flat)
    number = np.arange(most, dtype=np.int32)[:, None, None]
    triangle = np.where(number < counts, number, np.int32(-1))
    return Layers(color, depth, np.zeros((*shape, 3), np.float32), triangle), flat


def _flat(channel: np.ndarray, counts: Index) -> np.ndarray:
    given = [0 if one is None else len(one) for one in channel.flat]
    if not np.array_equal(given, counts):
        raise InputError("color: channels of a deep pixel have different numbers of samples; allowed is one number")
    return np.concatenate([np.zeros(0, np.float32), *(one for one in channel.flat if one is not None)])


@kernel
def _gather(start, color, depth, opacity, out_color, out_depth, counts, flat):
    """Write the surfaces of every pixel into out_color (N, H, W, 3) and out_depth (N, H, W), the first N of them, how
    many there are into counts (H, W), and what the pixel sees into flat (H, W, 3).
    """
    height, width = counts.shape
    for y in prange(height):
        for x in range(width):
            first, last = start[y * width + x], start[y * width + x + 1]
            order = _front_to_back(depth, first, last)

            # Back to front: what is seen from each sample on.
            seen = np.zeros((len(order) + 1, 3))
            for k in range(len(order) - 1, -1, -1):
                through = 1.0 - opacity[order[k]]
                for c in range(3):
                    seen[k, c] = color[order[k], c] + through * seen[k + 1, c]
            for c in range(3):
                flat[y, x, c] = seen[0, c]

            # Front to back: a surface wherever half is hidden.
            found, begin, through = 0, 0, 1.0
            for k in range(len(order)):
                if depth[order[k]] == np.inf:
                    break
                through *= 1.0 - opacity[order[k]]
                if through <= _HALF:
                    if found < len(out_depth):
                        for c in range(3):
                            out_color[found, y, x, c] = seen[begin, c]
                        out_depth[found, y, x] = depth[order[k]]
                    found, begin, through = found + 1, k + 1, 1.0
            counts[y, x] = found


@inline
def _front_to_back(depth, first, last):
    """Numbers first .. last - 1 by depth; equally deep ones stay in order."""
    order = np.arange(first, last)
    for k in range(1, len(order)):
        moved, place = order[k], k
        while place > 0 and depth[order[place - 1]] > depth[moved]:
            order[place] = order[place - 1]
            place -= 1
        order[place] = moved
    return order

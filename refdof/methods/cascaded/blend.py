"""Layers of `cascaded`, made where they are blended, and the two orders of blurring and blending.

A buffer is premultiplied RGBA, planar: (4, H, W). `Source` holds the peeled surfaces; no layer is ever stored.
"""

import math
from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from refdof._check import Float
from refdof._jit import borrow, inline, kernel, prange
from refdof.methods.cascaded.layers import Layering
from refdof.methods.cascaded.matting import layer_coordinate, matte, ramp_code

__all__ = ["Blur", "Source", "blend_over", "blur_apart", "cascade", "layer_alone", "normalized", "source_of"]

Blur = Callable[[Float, float, Float], None]


class Source(NamedTuple):
    """Peeled surfaces: coordinate (M, H, W), color (M, H, W, 3), the ramp's number, and which rows hold something of
    which layer: held (H, K) bool.
    """

    coordinate: Float
    color: Float
    ramp: int
    held: np.ndarray

    def blend(self, layer: int, layer_in_front: bool, buffer: Float) -> None:
        """Blend a layer over the buffer, or under it: A over B of Eq. (12), in place."""
        _blend(self.coordinate, self.color, self.ramp, self.held[:, layer].copy(), layer, layer_in_front, buffer)


def source_of(color: Float, depth: Float, layering: Layering, ramp: str, boundary: str) -> Source:
    """Surfaces by their layer coordinates: color (M, H, W, 3), depth (M, H, W), NaN for none."""
    coordinate = layer_coordinate(depth, layering.bounds, boundary, color.dtype.type)
    held = np.zeros((depth.shape[1], len(layering.deviation)), dtype=bool)
    _mark_rows(coordinate, ramp_code(ramp), held)
    return Source(coordinate, color, ramp_code(ramp), held)


def layer_alone(source: Source, layer: int) -> Float:
    """L_k of Eq. (2), by itself: (H, W, 4)."""
    buffer = np.zeros((4, *source.coordinate.shape[1:]), dtype=source.color.dtype)
    source.blend(layer, True, buffer)
    return np.moveaxis(buffer, 0, -1)


def cascade(
    source: Source, order: Iterable[int], layering: Layering, layer_in_front: bool, blur: Blur, buffer: Float,
    scratch: Float,
) -> None:  # fmt: skip
    """Blend layers in `order` into an empty buffer and blur it after each: Eq. (13)."""
    variance, begun = 0.0, False
    for k in order:
        if source.held[:, k].any():
            blur(buffer, math.sqrt(variance), scratch)
            source.blend(k, layer_in_front, buffer)
            variance, begun = 0.0, True
        if begun:
            variance += float(layering.step[k]) ** 2
    blur(buffer, math.sqrt(variance), scratch)


def blur_apart(source: Source, layering: Layering, blur: Blur, buffer: Float, layer: Float, scratch: Float) -> None:
    """Blur every layer by itself, Eq. (11), and blend all of them into an empty buffer, from the back to the front."""
    for k in reversed(range(len(layering.deviation))):
        if source.held[:, k].any():
            layer[:] = 0.0
            source.blend(k, True, layer)
            blur(layer, float(layering.deviation[k]), scratch)
            blend_over(layer, buffer)


@kernel
def blend_over(front, back):
    """Back = front over back, (4, H, W) each."""
    _, height, width = back.shape
    for y in prange(height):
        upper, lower = borrow(front), borrow(back)
        one = back.dtype.type(1)
        for c in range(4):
            for x in range(width):
                lower[c, y, x] = upper[c, y, x] + (one - upper[3, y, x]) * lower[c, y, x]


@kernel
def normalized(buffer, divide):
    """Colours (H, W, 3) of a buffer (4, H, W), divided by alpha or not; 0 where alpha is 0."""
    _, height, width = buffer.shape
    out = np.empty((height, width, 3), dtype=buffer.dtype)
    for y in prange(height):
        for x in range(width):
            alpha = buffer[3, y, x]
            for c in range(3):
                value = buffer[c, y, x]
                out[y, x, c] = value / alpha if divide and alpha > 0 else value
    return out


@kernel
def _mark_rows(coordinate, ramp, held):
    """Mark in held (H, K) the layers in which a surface of the row has weight."""
    count, height, width = coordinate.shape
    layers = held.shape[1]
    for y in prange(height):
        row, one = borrow(held)[y], coordinate.dtype.type(1)
        for m in range(count):
            places = borrow(coordinate)[m, y]
            for x in range(width):
                if places[x] >= 0:
                    core = int(places[x])
                    for k in range(max(core - 1, 0), min(core + 2, layers)):
                        if not row[k] and matte(places[x] - k, one, ramp, m == 0) > 0:
                            row[k] = True


@kernel
def _blend(coordinate, color, ramp, held, layer, layer_in_front, buffer):
    """Blend L_k over buffer (4, H, W), or under it, row by row."""
    height, width = buffer.shape[1:]
    for y in prange(height):
        if held[y]:
            places, colors, target = borrow(coordinate), borrow(color), borrow(buffer)
            one = buffer.dtype.type(1)
            for x in range(width):
                red, green, blue, alpha = _matted(places, colors, ramp, layer, y, x, one)
                if alpha > 0:
                    above = one if layer_in_front else one - target[3, y, x]
                    below = one - alpha if layer_in_front else one
                    target[0, y, x] = above * red + below * target[0, y, x]
                    target[1, y, x] = above * green + below * target[1, y, x]
                    target[2, y, x] = above * blue + below * target[2, y, x]
                    target[3, y, x] = above * alpha + below * target[3, y, x]


@inline
def _matted(coordinate, color, ramp, layer, y, x, one):
    """L_k at a pixel, premultiplied: matted buffers, the nearer over the farther, Eq. (2)."""
    zero = one - one
    red, green, blue, alpha = zero, zero, zero, zero
    scalar = type(one)
    for m in range(len(coordinate)):
        weight = matte(coordinate[m, y, x] - scalar(layer), one, ramp, m == 0)
        if weight > zero:
            share = weight * (one - alpha)
            red += share * color[m, y, x, 0]
            green += share * color[m, y, x, 1]
            blue += share * color[m, y, x, 2]
            alpha += share
    return red, green, blue, alpha

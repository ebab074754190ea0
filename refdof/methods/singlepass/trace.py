"""Trace: every tap of the walk by itself, in NumPy: what the kernel does without keeping it. For stages and bounds."""

from typing import NamedTuple

import numpy as np

from refdof._check import Float
from refdof.methods.singlepass.params import Params
from refdof.methods.singlepass.planar import mix_of_four, pad_planes, window
from refdof.methods.singlepass.walk import (
    NEAREST,
    Walk,
    bands,
    read_color,
    read_guides,
    sizes_of,
    spiral,
    spread,
    texels_of,
)
from refdof.stages import Stage, StageRecorder

__all__ = ["STAGES", "TapOfAll", "cover_of", "limit_of", "record_stages", "tap_of_all"]

COLUMNS = (
    "x", "y", "depth", "red", "green", "blue", "size", "reach", "weight", "sum_red", "sum_green", "sum_blue", "total",
)  # fmt: skip

_FAR = 1e300  # stands for the background in blends of depths

STAGES = (
    Stage("coc", "H W", "px", "signed circle of confusion, a radius", "formula"),
    Stage("size", "H W", "px", "getBlurSize: the circle without its sign, at most the largest blur", "formula"),
    Stage("limit", "H W", "px", "what the sizes of taps from behind are cut at", "formula"),
    Stage("taps", "N 3", "px", "the spiral, y down, as offsets from the pixel", "formula", ("x", "y", "radius")),
    Stage("weight_sum", "H W", "", "sum of all taps' weights m; 0 where no tap reaches the pixel", "filter"),
    Stage("reach *", "H W", "px", "size of that tap after the cut, counted from 1", "formula"),
    Stage("weight *", "H W", "", "weight m of that tap, counted from 1", "formula"),
    Stage("mean *", "H W 3", "", "linear RGB after so many taps, as if the loop ended there", "filter"),
    Stage(
        "probes",
        "P N+1 13",
        "px, linear RGB, unit of depth",
        "the loop at single pixels, row 0 the pixel itself: place from the picture's corner, what was read, size "
        "before and after the cut, weight, and the listing's color and tot",
        "filter",
        COLUMNS,
    ),
)


class TapOfAll(NamedTuple):
    """One tap of all pixels: color (3, H, W); size before and after the cut [px] and weight, (H, W) each."""

    color: Float
    size: Float
    reach: Float
    weight: Float


def record_stages(recorder: StageRecorder, walk: Walk, coc: Float, depth: Float, params: Params) -> None:
    """Record `STAGES`; depth (H, W) is in the caller's unit."""
    count, (height, width) = len(walk.offsets), coc.shape
    recorder.record("coc", lambda: coc)
    recorder.record("size", lambda: sizes_of(coc, params.max_blur_size))
    recorder.record("limit", lambda: limit_of(walk))
    recorder.record("taps", lambda: spiral(params))
    recorder.record("weight_sum", lambda: _weight_sum(walk))
    for k in recorder.steps(count):
        if k > 0:
            tap = tap_of_all(walk, k - 1)
            recorder.record(f"reach {k}", lambda tap=tap: tap.reach)  # type: ignore[misc]
            recorder.record(f"weight {k}", lambda tap=tap: tap.weight)  # type: ignore[misc]
        recorder.record(f"mean {k}", lambda k=k: spread(walk, k))  # type: ignore[misc]
    pixels = recorder.pixels(height, width)
    if pixels:
        recorder.record("probes", lambda: _probes(walk, depth, params, pixels))


def tap_of_all(walk: Walk, k: int) -> TapOfAll:
    """Tap `k`, counted from 0, as the kernel has it to the bit."""
    color = read_color(walk, walk.offsets[k], walk.weights[k])
    order, circle = read_guides(walk, walk.offsets[k], walk.weights[k])
    size = circle if walk.mode == NEAREST else sizes_of(circle, walk.numbers[1])
    here = window(walk.center, walk.margin, 0, 0)[3]
    reach = np.where(order < here, np.minimum(size, limit_of(walk)), size)
    return TapOfAll(color, size, reach, cover_of(reach, walk.inner[k]))


def limit_of(walk: Walk) -> Float:
    """What taps from behind are cut at: (H, W) [px]."""
    return walk.numbers[0] * sizes_of(window(walk.center, walk.margin, 0, 0)[4], walk.numbers[1])


def cover_of(reach: Float, inner: Float) -> Float:
    """smoothstep(radius - 0.5, radius + 0.5, reach)."""
    zero, one, two, three = (reach.dtype.type(value) for value in range(4))
    t = np.minimum(np.maximum(reach - inner, zero), one)
    return t * (t * (three - two * t))


def _weight_sum(walk: Walk) -> Float:
    """Sum of the weights of all taps: (H, W) float64."""
    total = np.zeros(window(walk.planes, walk.margin, 0, 0).shape[1:])
    for rows, band in bands(walk):
        for k in range(len(walk.offsets)):
            total[rows] += tap_of_all(band, k).weight
    return total


def _probes(walk: Walk, depth: Float, params: Params, pixels: tuple[tuple[int, int], ...]) -> Float:
    """The loops at some pixels: (P, N + 1, 13) float64, `COLUMNS`."""
    places = np.zeros((len(walk.offsets) + 1, 2))
    places[1:] = spiral(params)[:, :2]
    places += params.shift_x, params.shift_y
    depth, inverse = depth.astype(np.float64), params.depth_filter == "bilinear"
    with np.errstate(divide="ignore"):
        plane = pad_planes(1.0 / depth if inverse else np.minimum(depth, _FAR), walk.margin, params.border)
    offsets, weights = texels_of(places, params, np.float64)
    side, tables = 2 * walk.margin + 1, []
    for x, y in pixels:
        part = np.s_[:, y : y + side, x : x + side]
        one_pixel = walk._replace(planes=walk.planes[part], center=walk.center[part])
        reads = zip(offsets[:, 2:].tolist(), weights[:, 2:], strict=True)
        read = np.array([mix_of_four(plane[part], walk.margin, i, j, share).item() for (i, j), share in reads])
        with np.errstate(divide="ignore"):
            distance = 1.0 / read if inverse else np.where(read > _FAR * 1e-9, np.inf, read)
        there = places + np.array([x + 0.5, y + 0.5])
        tables.append(np.concatenate([there, distance[:, None], _loop(one_pixel)], axis=1))
    return np.stack(tables)


def _loop(walk: Walk) -> Float:
    """The loop of a walk over a single pixel: (N + 1, 10) float64, `COLUMNS` from red on."""
    center = window(walk.center, walk.margin, 0, 0)[:, 0, 0]
    own = walk.planes.dtype.type
    size, color, total = sizes_of(center[4], walk.numbers[1]), center[:3].copy(), own(1)
    rows = [(*color, size, size, 1.0, *color, total)]
    for k in range(len(walk.offsets)):
        tap = TapOfAll(*(value[..., 0, 0] for value in tap_of_all(walk, k)))
        color += color / total * (own(1) - tap.weight) + tap.color * tap.weight
        total = own(k + 2)
        rows.append((*tap.color, tap.size, tap.reach, tap.weight, *color, total))
    return np.array(rows, dtype=np.float64)

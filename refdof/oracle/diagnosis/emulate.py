"""Emulate: run a model of a port at some pixels, in NumPy: pixels by taps in one array.

1. Lay out the spiral                                     `spiral_of`
2. Read colour where the taps lie                         `_colors`
3. Make depths and circles, and read them, too            `refdof.oracle.diagnosis.guides`
4. Decide how far each tap counts                         `_weights`
5. Take the running mean, whose step is linear in color   `_mean`

The step color += mix(color / total, tap, m) is color = a color + m tap, with a = 1 + (1 - m) / total: so a tap has a
share of m times the product of all a after it, and the loop over taps is one product along an axis.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from operator import attrgetter
from typing import Any

import numpy as np

from refdof._check import Float
from refdof.oracle.diagnosis.color_operations import operate
from refdof.oracle.diagnosis.guides import Guides, guides_of
from refdof.oracle.diagnosis.model import Model
from refdof.oracle.diagnosis.reads import pixels_of, read, spots_of
from refdof.oracle.diagnosis.samples import Samples

__all__ = ["emulator", "spiral_of", "tap_shares"]

_MOST_TAPS = 3000

_SPIRAL = (
    "rad_scale", "angle_step", "angle_start", "radius_start", "bound", "max_taps", "growth", "row_step", "axes",
    "scale", "tap_fault", "tap_stride",
)  # fmt: skip
_COLOR_READS = (
    *_SPIRAL, "flip", "image_shift", "half", "before", "color_filter", "border_color", "shift_color",
    "shift_center_color",
)  # fmt: skip
_GUIDE_READS = (
    *_SPIRAL, "flip", "image_shift", "half", "depth", "radial", "depth_of_circles", "depth_scale_tap",
    "depth_scale_center", "depth_flip", "law", "law_scale", "size_cap", "focus_factor", "focus_add", "depth_filter",
    "border_depth", "shift_depth", "shift_center_depth",
)  # fmt: skip


def emulator(samples: Samples) -> Callable[[Model], Float]:
    """A function that makes of a model what it gives at the samples: (P, 3) float64. It keeps what it read last."""
    colors = lru_cache(maxsize=3)(lambda key: _colors(samples, _model(_COLOR_READS, key)))
    guides = lru_cache(maxsize=6)(lambda key: _guides(samples, _model(_GUIDE_READS, key)))

    def run(model: Model) -> Float:
        model = _scaled(model, samples)
        with np.errstate(all="ignore"):
            taps, center = colors(_key(_COLOR_READS, model))
            seen = guides(_key(_GUIDE_READS, model))
            shares, own = tap_shares(model, spiral_of(model)[:, 2], seen)
            image = own[:, None] * center + np.einsum("pn,pnc->pc", shares.astype(np.float32), taps)
            image = operate(image, model.after)
            left = _left_alone(model, seen)
            return np.where(left[:, None], center, image)

    return run


# What is read depends on few parameters: those are the keys by which it is kept.


def _key(names: tuple[str, ...], model: Model) -> tuple[Any, ...]:
    return tuple(attrgetter(*names)(model))


def _model(names: tuple[str, ...], key: tuple[Any, ...]) -> Model:
    return Model(**dict(zip(names, key, strict=True)))


def _scaled(model: Model, samples: Samples) -> Model:
    """With the pixels that a radius of 1 spans where a port's pixel size is that of another picture."""
    if model.pixel_size is None:
        return model
    width, height = ((samples.width, samples.height)[part] if part in (0, 1) else part for part in model.pixel_size)
    scale = model.scale[0] * samples.width / width, model.scale[1] * samples.height / height
    return replace(model, scale=scale, pixel_size=None)


def spiral_of(model: Model) -> Float:
    """Taps (N, 3): x, y [px], in the direction of rows in files, and radius."""
    return _spiral_of(_key(_SPIRAL, model))


@lru_cache(maxsize=64)
def _spiral_of(key: tuple[Any, ...]) -> Float:
    model = _model(_SPIRAL, key)
    radii = _radii_of(model.radius_start, model.bound, min(model.max_taps, _MOST_TAPS), model.rad_scale, model.growth)
    angles = model.angle_start + model.angle_step * np.arange(len(radii))
    waves = {"c": np.cos(angles), "s": np.sin(angles)}
    along, across = waves[model.axes[-1]], waves[model.axes[-2]]
    across = -across if model.axes[0] == "-" else across
    taps = np.stack([across * radii * model.scale[0], model.row_step * along * radii * model.scale[1], radii], axis=-1)
    taps = taps[:: model.tap_stride]
    if model.tap_fault is not None:
        index, times = model.tap_fault
        taps = np.repeat(taps, np.where(np.arange(len(taps)) == index, times, 1), axis=0)
    return taps


@lru_cache(maxsize=64)
def _radii_of(radius: float, bound: float, count: int, rad_scale: float, growth: str) -> Float:
    radii: list[float] = []
    while radius < bound and len(radii) < count:
        radii.append(radius)
        radius += {"over_radius": rad_scale / radius, "constant": rad_scale, "ratio": radius}[growth]
    return np.array(radii)


def _colors(samples: Samples, model: Model) -> tuple[Float, Float]:
    """Colours of the taps (P, N, 3) and of the pixels themselves (P, 3)."""
    texels = operate(samples.color, model.before).astype(np.float32)
    x, y = pixels_of(samples, model)
    places = spiral_of(model)[:, :2]
    center = np.array([model.shift_center_color])
    taps, own = (
        read(samples, texels, x, y, spots_of(spots, model.color_filter), model.border_color)
        for spots in (places + model.shift_color, center)
    )
    return taps, own[:, 0]


def _guides(samples: Samples, model: Model) -> Guides:
    return guides_of(samples, model, spiral_of(model))


def tap_shares(model: Model, radii: Float, seen: Guides) -> tuple[Float, Float]:
    """Shares of all taps (P, N) and of the pixel itself (P,) in the output."""
    cover = _weights(model, radii, seen)
    return _mean(model, cover)


def _weights(model: Model, radii: Float, seen: Guides) -> Float:
    """How far each tap counts: (P, N)."""
    size, center = _sizes(model, seen.circle), _sizes(model, seen.center_circle)[:, None]
    match model.size_rule:
        case "center":
            size = np.broadcast_to(center, size.shape)
        case "min":
            size = np.minimum(size, center)
        case "max":
            size = np.maximum(size, center)
        case "mean":
            size = 0.5 * (size + center)
    held = _held(model, seen, size, center)
    reach = np.where(held, np.minimum(size, model.behind_factor * center), size)
    middle = radii + model.rim_offset
    match model.rim_shape:
        case "step":
            cover = (reach >= middle).astype(np.float64)
        case "step_low":
            cover = (reach >= middle - 0.5).astype(np.float64)
        case "from_zero":
            cover = np.clip(reach / np.maximum(middle, 1e-6), 0.0, 1.0)
            cover = cover * cover * (3.0 - 2.0 * cover)
        case _:
            cover = np.clip((reach - middle) / model.rim_width + 0.5, 0.0, 1.0)
            if model.rim_shape == "smoothstep":
                cover = cover * cover * (3.0 - 2.0 * cover)
    match model.weight_rule:
        case "all":
            return np.ones_like(cover)
        case "inverse":
            return 1.0 - cover
        case "square":
            return cover * cover
        case "area":
            return cover / np.maximum(reach * reach * math.pi, 1.0)
    return cover


def _sizes(model: Model, circle: Float) -> Float:
    if model.near_scale != 1.0 or model.far_scale != 1.0:
        circle = circle * np.where(circle < 0.0, model.near_scale, model.far_scale)
    return np.maximum(np.minimum(np.abs(circle) * model.coc_scale, model.size_cap), model.size_floor)


def _held(model: Model, seen: Guides, size: Float, center: Float) -> np.ndarray:
    """For which taps the limit holds."""
    here = seen.center_depth[:, None]
    cap = model.size_cap
    match model.order:
        case "behind":
            return seen.depth > here
        case "front":
            return seen.depth < here
        case "always":
            return np.ones(seen.depth.shape, dtype=bool)
        case "differs":
            return seen.depth != here
        case "size":
            return size > center
        case "size_below":
            return size < center
        case "signed_size":
            return np.clip(seen.circle, -cap, cap) > np.clip(seen.center_circle, -cap, cap)[:, None]
    return np.clip(seen.circle, -cap, cap) < np.clip(seen.center_circle, -cap, cap)[:, None]


def _mean(model: Model, cover: Float) -> tuple[Float, Float]:
    """Shares in color / total of every tap (P, N), and of the pixel itself (P,)."""
    count = cover.shape[1]
    total = model.initial_total + np.arange(count)
    missed, last = 1.0 - cover, model.initial_total + count
    match model.mean_rule:
        case "nothing" | "weighted" | "center":
            factor = np.ones_like(cover)
        case "sum":
            factor = 1.0 + missed
        case "next_total":
            factor = 1.0 + missed / (total + 1.0)
        case _:
            factor = 1.0 + missed / total
    after = np.cumprod(factor[:, ::-1], axis=1)[:, ::-1]
    following = np.concatenate([after[:, 1:], np.ones((len(cover), 1))], axis=1)
    own = model.center_share * (after[:, 0] if count else np.ones(len(cover)))
    if model.mean_rule == "center":
        own = own + missed.sum(axis=1)
    divisor = {
        "total": np.full(len(cover), last),
        "taps": np.full(len(cover), last - 1.0),
        "next": np.full(len(cover), last + 1.0),
        "none": np.ones(len(cover)),
        "weights": model.initial_total + cover.sum(axis=1),
    }["weights" if model.mean_rule == "weighted" else model.divisor]
    return cover * following / divisor[:, None], own / divisor


def _left_alone(model: Model, seen: Guides) -> np.ndarray:
    """Pixels that an early end leaves as they are: (P,) bool."""
    name, value = model.early_out
    if name == "sharp":
        return _sizes(model, seen.center_circle) < value
    if name == "sky":
        return seen.center_depth >= seen.far * value
    return np.zeros(len(seen.center_depth), dtype=bool)

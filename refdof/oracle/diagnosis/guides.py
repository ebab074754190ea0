"""Guides: depths and circles, as a model of a port decodes and reads them."""

from functools import partial
from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof.oracle.diagnosis.model import Model
from refdof.oracle.diagnosis.reads import Spots, pixels_of, read, spots_of
from refdof.oracle.diagnosis.samples import Samples

__all__ = ["Guides", "guides_of"]


class Guides(NamedTuple):
    """depth, circle (P, N) of taps, signed [px]; center_depth, center_circle (P,); far, the largest depth."""

    depth: Float
    circle: Float
    center_depth: Float
    center_circle: Float
    far: float


def guides_of(samples: Samples, model: Model, spiral: Float) -> Guides:
    """Read depth and circle at the taps and at the pixels themselves."""
    x, y = pixels_of(samples, model)
    places = spiral[:, :2] + model.shift_depth, np.array([model.shift_center_depth])
    scales = model.depth_scale_tap, model.depth_scale_center
    found = []
    for spots, scale in zip(places, scales, strict=True):
        depth, circle = _maps(samples, model, scale)
        where = spots_of(spots, "nearest" if model.depth_filter == "nearest" else "bilinear")

        at = partial(_read_at, samples, model, (x, y), where)
        if model.depth_filter == "bilinear":
            found += [1.0 / at(1.0 / depth), at(circle)]
        elif model.depth_filter == "bilinear_depth":
            blended = at(depth)
            found += [blended, _circles(samples, model, blended)]
        else:
            found += [at(depth), at(circle)]
    depth, circle, center_depth, center_circle = found
    return Guides(depth, circle, center_depth[:, 0], center_circle[:, 0], samples.far)


def _read_at(samples: Samples, model: Model, pixels: tuple[Index, Index], spots: Spots, values: Float) -> Float:
    return read(samples, values, *pixels, spots, model.border_depth)


def _maps(samples: Samples, model: Model, scale: float) -> tuple[Float, Float]:
    """Depth and circle of all texels, as the port has them."""
    depth = _decoded(samples, model) * (scale if scale > 0.0 else 1.0 / samples.far)
    changed = model.law != "lens" or model.focus_factor != 1.0 or model.focus_add != 0.0
    if model.depth_of_circles and (model.depth != "planar" or scale != 1.0):
        changed = True
    circle = _circles(samples, model, depth) if changed else samples.coc
    if model.depth_flip:
        other = samples.mirror_x if model.depth_flip == "x" else samples.mirror_y
        depth, circle = depth[other], circle[other]
    return depth, circle


def _decoded(samples: Samples, model: Model) -> Float:
    """What the port takes for depth."""
    depth, near, far = samples.depth, samples.near, samples.far
    match model.depth:
        case "reversed":
            return near + far - depth
        case "reversed_from_far":
            return np.maximum(far - depth, 0.0)
        case "inverse":
            return 1.0 / depth
        case "reversed_device":
            return near / depth * far
        case "device":  # a z-buffer, times far
            span = far - near
            return far / span * (1.0 - near / depth) * far if span > 0.0 else depth
        case "decoded":  # linear depth, decoded as if it were a z-buffer
            return near * far / np.maximum(far - depth / far * (far - near), 1e-30)
        case "radial":
            return depth * np.sqrt(1.0 + model.radial**2 * samples.squared)
        case "half_float":
            return np.minimum(depth, 65504.0).astype(np.float16).astype(np.float64)
        case "half_share":
            return (depth / far).astype(np.float16).astype(np.float64) * far
        case "8 bits" | "16 bits":
            levels = 2.0 ** int(model.depth.split()[0]) - 1.0
            return np.rint(depth / far * levels) / levels * far
    return depth


def _circles(samples: Samples, model: Model, depth: Float) -> Float:
    """Signed circles of depths [px]."""
    focus = samples.focus * model.focus_factor + samples.near * model.focus_add
    depth = np.where(depth == 0.0, 1e-30, depth)
    match model.law:
        case "constant":
            return np.full_like(depth, model.law_scale)
        case "linear":
            return samples.coc_scale * model.law_scale * (depth - focus) / focus
        case "linear_far":
            return samples.coc_scale * model.law_scale * (depth - focus) / samples.far
        case "smoothstep":
            share = np.clip(np.abs(depth - focus) / (focus * model.law_scale), 0.0, 1.0)
            return np.sign(depth - focus) * model.size_cap * share * share * (3.0 - 2.0 * share)
    return samples.coc_scale * (1.0 / focus - 1.0 / depth)

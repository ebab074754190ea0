"""Reach: how far a pixel that is no number spreads, by method. A weight of 0 does not stop it: 0 times NaN is NaN."""

import math

import numpy as np

from refdof.methods import circular, poisson, singlepass
from refdof.stability.run import Run

__all__ = ["reach_of"]


def reach_of(run: Run) -> tuple[float, str]:
    """How far a pixel that is no number may spread [px], and why."""
    circle = float(np.abs(run.view.coc_px()).max())
    whole = float(math.hypot(*run.view.camera.size))
    if run.method == "scatter":
        return circle + 1.0, "a pixel writes to those that its disc covers"
    if run.method == "separable":
        return math.sqrt(2.0) * math.ceil(circle), "two passes, each over as many taps as the row's largest circle"
    if run.method == "singlepass":
        return singlepass.Params().max_blur_size + math.sqrt(2.0), (
            "every tap of the spiral is mixed in, also with weight 0; two texels of bilinear colour"
        )
    if run.method == "poisson":
        return _of_poisson(poisson.Params()), (
            "a tap is as far as the largest radius; the small picture's texels are blurred ones, four pixels wide"
        )
    if run.method in ("accumulation", "lensblur", "multiview"):
        return circle + math.sqrt(2.0) + 0.5, "a ray ends inside its circle; colours are read between two texels"
    if run.method in _HALF:
        return _HALF[run.method](circle)
    if run.method == "hexagon":
        return 2.0 * (round(circle) + _TEXEL), "two passes, each of so many steps, between two texels"
    if run.method == "circular":
        params = circular.Params()
        tap = (1.0 + params.transition) * circle / params.fitted_radius
        return math.sqrt(2.0) * (tap + 1.0), "two passes, each as far as its last tap, between two texels"
    return whole, "pyramids and wide blurs: every level is read, also with weight 0"


def _of_halfres(circle: float) -> tuple[float, str]:
    return 2.0 * circle + 5.0 * _TEXEL, "a mean and a maximum, a circle each; texels of the picture, and two of half"


def _of_ringgather(circle: float) -> tuple[float, str]:
    return circle + 7.0 * _TEXEL, "prefilter and rings reach 7/8 of a circle; a texel of the picture, three of half"


def _of_filament(circle: float) -> tuple[float, str]:
    rings = min(5, math.ceil(0.5 * circle + 0.5))
    level = max(0, math.floor(math.log2(0.5 * circle / (rings - 0.5)) + 0.5))
    bound = circle + 2.0 * _TEXEL * (1.5 * 2.0**level + 2.0)
    return bound, "taps and their noise reach a circle; a texel and a half of their level, two of half the size"


_TEXEL = math.sqrt(2.0)  # from a place to the farthest centre of the four texels around it [texels]
_HALF = {"halfres": _of_halfres, "ringgather": _of_ringgather, "filament": _of_filament}


def _of_poisson(params: poisson.Params) -> float:
    tap = float(np.hypot(*params.table[:, :2].T).max())
    small = params.small_size
    return tap * max(params.max_radius, params.small_radius * small) + 3.0 * math.sqrt(2.0) * small

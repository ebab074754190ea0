"""Reach: how far a pixel that is no number spreads, by method. A weight of 0 does not stop it: 0 times NaN is NaN."""

import math

import numpy as np

from refdof.methods import poisson, singlepass
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
    return whole, "pyramids and wide blurs: every level is read, also with weight 0"


def _of_poisson(params: poisson.Params) -> float:
    tap = float(np.hypot(*params.table[:, :2].T).max())
    small = params.small_size
    return tap * max(params.max_radius, params.small_radius * small) + 3.0 * math.sqrt(2.0) * small

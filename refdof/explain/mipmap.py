"""Mipmap: the weight of every pixel of the picture, and of every texel of the mip levels that the pixel reads."""

from typing import Any

import numpy as np

from refdof._check import Float, InputError
from refdof.explain.explanation import COLOR, Explanation, Part
from refdof.explain.impulses import weights_of
from refdof.explain.linear import begin, explain_linear
from refdof.explain.pictures import Pictures
from refdof.methods.mipmap.anisotropic import new_chain
from refdof.methods.mipmap.upsample import SmoothedBlur, upsample

__all__ = ["explain"]


def explain(given: Pictures, params: Any, pixel: tuple[int, int]) -> Explanation:
    """Every pixel, and every texel of the levels.

    Raises
    ------
    InputError
        If the blend is geometric: then the picture is no weighted sum of colours.
    """
    if params.blend != "linear":
        raise InputError(f"blend: got {params.blend!r}, which is no weighted sum of colours; allowed is 'linear'")
    stages, (x, y) = begin("mipmap", given, params, pixel).stages, pixel
    numbers = {name: float(stages[name][y, x]) for name in ("degree", "neighbours", "smoothed", "level")}
    notes = (
        "degree of blur {degree:.6g} px, of nearer neighbours {neighbours:.6g} px, smoothed {smoothed:.6g} px: "
        "level m = {level:.6g}, Eq. (6); levels m - 1 and above are read at nine points, Eq. (8)".format(**numbers),
    )
    return explain_linear("mipmap", given, params, pixel, notes=notes, parts=(_texels(given, stages, pixel),))


def _texels(given: Pictures, stages: dict[str, Float], pixel: tuple[int, int]) -> Part:
    """Texels of the mip levels that the pixel reads: a texel's centre lies at (x, y) of the picture."""
    (height, width), (x, y) = given.coc.shape, pixel
    levels = [given.color, *(stages[name] for name in stages if name.startswith("color "))]
    blur = SmoothedBlur(stages["neighbours"], stages["smoothed"], stages["level"])
    colors = new_chain((height, width, 4), len(levels) - 1, given.color.dtype)
    rows = []
    for k, level in enumerate(levels):

        def respond(color: Float, k: int = k) -> Float:
            colors.texels[:] = 0
            colors.level(k)[..., :3] = color
            return upsample(colors, blur, False)[y : y + 1, x]

        places, weights = weights_of(respond, level.shape[:2], level.dtype.type)
        for (j, i), (weight,) in zip(places, weights, strict=True):
            centre = (i + 0.5) * width / level.shape[1], (j + 0.5) * height / level.shape[0]
            rows.append((k, i, j, *centre, *level[j, i], weight))
    columns = ("level", "column", "row", "x", "y", *COLOR, "weight")
    return Part("texels of the mip levels that the pixel reads; they add up to the pixel, too", columns, np.array(rows))

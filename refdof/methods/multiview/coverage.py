"""Coverage: mip chains of pictures with holes, whose alpha is the part of a texel where there is something.

1. colour times coverage, coverage as last channel    `coverage_mipmaps`
2. read levels as any texture                         `refdof.raster.gpu.texture.trilinear`
3. divide by coverage: the mean of what is there      `average_color`

References
----------
.. [1] Lee, Eisemann & Seidel (2009), Depth-of-Field Rendering with Multiview Synthesis, Section 4.
.. [2] Porter & Duff (1984), Compositing Digital Images, SIGGRAPH.
"""

from typing import Any

import numpy as np

from refdof._check import Float, InputError, as_float, as_instance, shape_of
from refdof.raster.filters.mip_chain import generate_mipmaps
from refdof.raster.gpu.gpu_model import EXACT, GpuModel

__all__ = ["average_color", "coverage_mipmaps"]


def coverage_mipmaps(color: Any, covered: Any, model: GpuModel = EXACT) -> list[Float]:
    """The chain of glGenerateMipmap over premultiplied colour and coverage.

    Parameters
    ----------
    color : (H, W, C) float32, or float64 (only with `EXACT`)
        Where nothing is covered any value, even NaN, has no part.
    covered : (H, W) bool
    model : GpuModel

    Returns
    -------
    list of (h, w, C + 1)
        Premultiplied colour, and coverage in 0 .. 1 as last channel; the full size first, 1 x 1 last.

    Raises
    ------
    InputError
        If a shape or type is not as stated.
    """
    as_instance("model", model, GpuModel)
    shape_of("covered", covered)
    covered = np.asarray(covered)
    if covered.dtype != np.bool_ or covered.ndim != 2:
        raise InputError(f"covered: got {covered.dtype} of shape {covered.shape}; allowed is bool of shape (H, W)")
    if shape_of("color", color)[:2] != covered.shape or np.ndim(color) != 3:
        raise InputError(
            f"color: got shape {np.shape(color)}; allowed is ({covered.shape[0]}, {covered.shape[1]}, any)"
        )
    if getattr(color, "dtype", None) not in (np.float32, np.float64):
        raise InputError(f"color: got {getattr(color, 'dtype', type(color).__name__)}; allowed are float32 and float64")
    premultiplied = np.empty((*covered.shape, color.shape[2] + 1), dtype=color.dtype)
    premultiplied[..., :-1] = np.where(covered[..., None], color, 0)
    premultiplied[..., -1] = covered
    return generate_mipmaps(premultiplied, model)


def average_color(texels: Any) -> Float:
    """Mean colour of what is covered: (..., C + 1) premultiplied, read from any level -> (..., C); 0 where nothing is.

    Infinite where the quotient leaves the type.

    Raises
    ------
    InputError
        If a value is not finite, or there is no colour.
    """
    texels = as_float("texels", texels, shape_of("texels", texels))
    if texels.ndim == 0 or texels.shape[-1] < 2:
        raise InputError(f"texels: got shape {texels.shape}; allowed is (..., C + 1) with C >= 1")
    alpha = texels[..., -1:]
    out = np.zeros_like(texels[..., :-1])
    with np.errstate(over="ignore"):
        return np.divide(texels[..., :-1], alpha, out=out, where=alpha > 0)

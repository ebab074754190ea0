"""Mip chains: as a driver makes them, by a 2 x 2 box, by a 3 x 3 Gaussian, and of least and greatest values.

Each level has half the size of the one before, rounded down, and at least 1.

References
----------
.. [1] Lee, Kim, Choi (2009), Real-Time Depth-of-Field Rendering Using Anisotropically Filtered Mipmap Interpolation,
   IEEE Transactions on Visualization and Computer Graphics 15(3), equation (1).
"""

import math
from typing import Any

import numpy as np

from refdof._check import Float, InputError, as_float, as_number
from refdof.raster.gpu_model import EXACT, GpuModel
from refdof.raster.halving import halve_box, halve_gaussian, halve_highest, halve_linear, halve_lowest
from refdof.raster.texture import as_texture, at_texels

__all__ = ["box_mipmaps", "extreme_mipmaps", "gaussian_mipmaps", "generate_mipmaps"]


def generate_mipmaps(image: Any, model: GpuModel = EXACT) -> list[Any]:
    """The chain of glGenerateMipmap: each level reads the finer one bilinearly at its own texels' centres.

    Parameters
    ----------
    image : (H, W, C) float32, float64 (only with `EXACT`) or uint8
    model : GpuModel

    Returns
    -------
    list of (h, w, C) of the image's type
        The image itself first, 1 x 1 last.

    Raises
    ------
    InputError
        If the image is not a texture.

    Notes
    -----
    Of even sizes that is the 2 x 2 mean; of odd sizes the weights shift from texel to texel. Bytes are rounded at every
    level. For short formats, give every level to `store`.
    """
    levels = [as_texture("image", image, model)]
    while max(levels[-1].shape[:2]) > 1:
        fine = levels[-1]
        if model == EXACT and fine.dtype != np.uint8 and all(n == 1 or n % 2 == 0 for n in fine.shape[:2]):
            levels.append(_halved(halve_linear, fine))
            continue
        level = at_texels(fine, *_centres(fine, model), model)
        levels.append(np.rint(level.astype(np.float64) * 255).astype(np.uint8) if fine.dtype == np.uint8 else level)
    return levels


def box_mipmaps(image: Any) -> list[Float]:
    """Means of 2 x 2 texels.

    The last row or column of an odd size has no part; one of size 1 counts twice.

    Parameters
    ----------
    image : (H, W, C) float32 or float64

    Returns
    -------
    list of (h, w, C) of the image's type
        The image itself first, 1 x 1 last.

    Raises
    ------
    InputError
        If the image is not a texture of floats.
    """
    levels = [_as_floats(image)]
    while max(levels[-1].shape[:2]) > 1:
        levels.append(_halved(halve_box, levels[-1]))
    return levels


def gaussian_mipmaps(image: Any, model: GpuModel = EXACT, std: float = 1.0) -> list[Float]:
    """Equation (1) of [1]: nine bilinear reads a finer texel apart, around each coarse texel's centre.

    Parameters
    ----------
    image : (H, W, C) float32 or float64 (only with `EXACT`)
    model : GpuModel
    std : float > 0
        Of the Gaussian [finer texels]; [1] does not give it, nor the places of the reads.

    Returns
    -------
    list of (h, w, C) of the image's type
        The image itself first, 1 x 1 last.

    Raises
    ------
    InputError
        If the image is not a texture of floats, or `std` is not above 0.
    """
    levels = [_as_floats(as_texture("image", image, model))]
    std = as_number("std", std, above=0.0)
    side = math.exp(-0.5 / std / std)
    weights = np.array([side, 1.0, side]) / (1.0 + 2.0 * side)
    nine = np.outer(weights, weights).astype(levels[0].dtype).ravel()
    while max(levels[-1].shape[:2]) > 1:
        fine = levels[-1]
        if model == EXACT and nine.all() and fine.shape[0] % 2 == fine.shape[1] % 2 == 0:
            levels.append(_halved(halve_gaussian, fine, nine))
            continue
        x, y = _centres(fine, model)
        own = x.dtype.type
        level = np.zeros((*x.shape, fine.shape[2]), dtype=fine.dtype)
        for j in (-1, 0, 1):
            for i in (-1, 0, 1):
                weight = fine.dtype.type(weights[j + 1] * weights[i + 1])
                if weight > 0:
                    level += weight * at_texels(fine, x + own(i), y + own(j), model)
        levels.append(level)
    return levels


def extreme_mipmaps(depth: Any) -> tuple[list[Float], list[Float]]:
    """Chains of the least and of the greatest depth.

    Every finer texel belongs to one coarser texel: the last of an odd size joins the last.

    Parameters
    ----------
    depth : (H, W) float32 or float64
        Any values; infinite ones are empty, as in `refdof.raster.nbuffer`.

    Returns
    -------
    two lists of (h, w) of the type of `depth`
        The full size first, 1 x 1 last; where nothing is, the least is inf and the greatest -inf.

    Raises
    ------
    InputError
        If depth has another shape, no pixels or NaN.
    """
    depth = as_float("depth", depth, (None, None), finite=False)
    if depth.size == 0:
        raise InputError(f"depth: got shape {depth.shape}; allowed are images of at least one pixel")
    infinity, empty = depth.dtype.type(np.inf), np.isinf(depth)
    lowest, highest = [np.where(empty, infinity, depth)], [np.where(empty, -infinity, depth)]
    while max(lowest[-1].shape) > 1:
        for levels, halve in ((lowest, halve_lowest), (highest, halve_highest)):
            levels.append(np.empty(_half(levels[-1]), dtype=depth.dtype))
            halve(*levels[-2:])
    return lowest, highest


def _as_floats(image: Any) -> Float:
    image = as_texture("image", image, EXACT)
    if image.dtype == np.uint8:
        raise InputError("image: got uint8; allowed are float32 and float64")
    return image


def _halved(halve: Any, fine: Float, *arguments: Any) -> Float:
    """One coarser level by a kernel of `refdof.raster.halving`."""
    height, _, channels = fine.shape
    out = np.empty((*_half(fine), channels), dtype=fine.dtype)
    halve(fine.reshape(height, -1), channels, *arguments, out.reshape(len(out), -1))
    return out


def _half(fine: Float) -> tuple[int, int]:
    return max(1, fine.shape[0] // 2), max(1, fine.shape[1] // 2)


def _centres(fine: Float, model: GpuModel) -> tuple[Float, Float]:
    """Centres x, y (h, w) of the coarser level's texels, in texels of the finer."""
    dtype = np.float64 if model == EXACT else np.float32
    (rows, columns), (height, width) = fine.shape[:2], _half(fine)
    y, x = (np.arange(height) + 0.5) * rows / height, (np.arange(width) + 0.5) * columns / width
    x, y = np.meshgrid(x.astype(dtype), y.astype(dtype))
    return x, y

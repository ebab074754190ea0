"""Mip chains: as a driver makes them, by a 2 x 2 box, and by a 3 x 3 Gaussian.

Each level has half the size of the one before, rounded down, and at least 1.

References
----------
.. [1] Lee, Kim, Choi (2009), Real-Time Depth-of-Field Rendering Using Anisotropically Filtered Mipmap Interpolation,
   IEEE Transactions on Visualization and Computer Graphics 15(3), equation (1).
"""

import math
from typing import Any

import numpy as np

from refdof._check import Float, InputError, as_number
from refdof.raster.gpu_model import EXACT, GpuModel
from refdof.raster.texture import as_texture, at_texels

__all__ = ["box_mipmaps", "gaussian_mipmaps", "generate_mipmaps"]


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
        fine = levels[-1]
        height, width = _half(fine)
        down, right = int(fine.shape[0] > 1), int(fine.shape[1] > 1)
        a, b, c, d = (
            fine[y : y + 2 * height : 2, x : x + 2 * width : 2]
            for y, x in ((0, 0), (0, right), (down, 0), (down, right))
        )
        levels.append(((a + b) + (c + d)) / fine.dtype.type(4))
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
    while max(levels[-1].shape[:2]) > 1:
        fine = levels[-1]
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


def _as_floats(image: Any) -> Float:
    image = as_texture("image", image, EXACT)
    if image.dtype == np.uint8:
        raise InputError("image: got uint8; allowed are float32 and float64")
    return image


def _half(fine: Float) -> tuple[int, int]:
    return max(1, fine.shape[0] // 2), max(1, fine.shape[1] // 2)


def _centres(fine: Float, model: GpuModel) -> tuple[Float, Float]:
    """Centres x, y (h, w) of the coarser level's texels, in texels of the finer."""
    dtype = np.float64 if model == EXACT else np.float32
    (rows, columns), (height, width) = fine.shape[:2], _half(fine)
    y, x = (np.arange(height) + 0.5) * rows / height, (np.arange(width) + 0.5) * columns / width
    x, y = np.meshgrid(x.astype(dtype), y.astype(dtype))
    return x, y

"""Mip chains: as a driver makes them, by a 2 x 2 box, by a 3 x 3 Gaussian, and of least and greatest values.

Each level has half the size of the one before, rounded down, and at least 1.

References
----------
.. [1] Lee, Kim, Choi (2009), Real-Time Depth-of-Field Rendering Using Anisotropically Filtered Mipmap Interpolation,
   IEEE Transactions on Visualization and Computer Graphics 15(3), equation (1).
.. [2] Mesa 22.3.6 with LLVM 15.0.6 on a processor with fused multiply-add: measured.
"""

import math
from typing import Any

import numpy as np

from refdof._check import Float, InputError, as_map, as_number
from refdof._jit import kernel, prange
from refdof.raster.filters.downsample import (
    downsample_box,
    downsample_gaussian,
    downsample_highest,
    downsample_linear,
    downsample_lowest,
)
from refdof.raster.gpu.gpu_model import EXACT, GpuModel
from refdof.raster.gpu.texture import as_texture, at_texels
from refdof.raster.gpu.texture_sampling import fused_multiply_add

__all__ = ["box_mipmaps", "extreme_mipmaps", "gaussian_mipmaps", "generate_mipmaps"]


def generate_mipmaps(image: Any, model: GpuModel = EXACT) -> list[Any]:
    """The chain of glGenerateMipmap: each level reads the finer one bilinearly at its own texels' centres [2].

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
    Of even sizes that is the 2 x 2 mean; of odd sizes the weights shift from texel to texel. Models that draw their
    levels miss the centres by some float32 roundings unless sizes are powers of two. Bytes are rounded at every level.
    For short formats, give every level to `store`.
    """
    levels = [as_texture("image", image, model)]
    while max(levels[-1].shape[:2]) > 1:
        fine = levels[-1]
        if model == EXACT and fine.dtype != np.uint8 and all(n == 1 or n % 2 == 0 for n in fine.shape[:2]):
            levels.append(_downsampled(downsample_linear, fine))
            continue
        places = _drawn_centres(fine) if model.drawn_mipmaps else _centres(fine, model)
        level = at_texels(fine, *places, model)
        levels.append(np.rint(level.astype(np.float64) * 255).astype(np.uint8) if fine.dtype == np.uint8 else level)
    return levels


def box_mipmaps(image: Any) -> list[Float]:
    """Means of 2 x 2 texels.

    The last row or column of an odd size has no part; one of size 1 counts twice. Sums of four texels must
    fit the type: beyond a quarter of its largest number, 8e37 in float32, they become infinite.

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
        levels.append(_downsampled(downsample_box, levels[-1]))
    return levels


def gaussian_mipmaps(image: Any, model: GpuModel = EXACT, deviation: float = 1.0) -> list[Float]:
    """Equation (1) of [1]: nine bilinear reads a finer texel apart, around each coarse texel's centre.

    Parameters
    ----------
    image : (H, W, C) float32 or float64 (only with `EXACT`)
    model : GpuModel
    deviation : float > 0
        Of the Gaussian [finer texels]; [1] does not give it, nor the places of the reads.

    Returns
    -------
    list of (h, w, C) of the image's type
        The image itself first, 1 x 1 last.

    Raises
    ------
    InputError
        If the image is not a texture of floats, or `deviation` is not above 0.
    """
    levels = [_as_floats(as_texture("image", image, model))]
    deviation = as_number("deviation", deviation, above=0.0)
    side = math.exp(-0.5 / deviation / deviation)
    weights = np.array([side, 1.0, side]) / (1.0 + 2.0 * side)
    nine = np.outer(weights, weights).astype(levels[0].dtype).ravel()
    while max(levels[-1].shape[:2]) > 1:
        fine = levels[-1]
        if model == EXACT and nine.all() and fine.shape[0] % 2 == fine.shape[1] % 2 == 0:
            levels.append(_downsampled(downsample_gaussian, fine, nine))
            continue
        x, y = _centres(fine, model)
        scalar = x.dtype.type
        level = np.zeros((*x.shape, fine.shape[2]), dtype=fine.dtype)
        for j in (-1, 0, 1):
            for i in (-1, 0, 1):
                weight = fine.dtype.type(weights[j + 1] * weights[i + 1])
                if weight > 0:
                    level += weight * at_texels(fine, x + scalar(i), y + scalar(j), model)
        levels.append(level)
    return levels


def extreme_mipmaps(depth: Any) -> tuple[list[Float], list[Float]]:
    """Chains of the least and of the greatest depth.

    Every finer texel belongs to one coarser texel: the last of an odd size joins the last.

    Parameters
    ----------
    depth : (H, W) float32 or float64
        Any values; infinite ones are empty, as in `refdof.raster.filters.n_buffer`.

    Returns
    -------
    two lists of (h, w) of the type of `depth`
        The full size first, 1 x 1 last; where nothing is, the least is inf and the greatest -inf.

    Raises
    ------
    InputError
        If depth has another shape, no pixels or NaN.
    """
    depth = as_map("depth", depth, (None, None))
    infinity, empty = depth.dtype.type(np.inf), np.isinf(depth)
    lowest, highest = [np.where(empty, infinity, depth)], [np.where(empty, -infinity, depth)]
    while max(lowest[-1].shape) > 1:
        for levels, downsample in ((lowest, downsample_lowest), (highest, downsample_highest)):
            levels.append(np.empty(_half(levels[-1]), dtype=depth.dtype))
            downsample(*levels[-2:])
    return lowest, highest


def _as_floats(image: Any) -> Float:
    image = as_texture("image", image, EXACT)
    if image.dtype == np.uint8:
        raise InputError("image: got uint8; allowed are float32 and float64")
    return image


def _downsampled(downsample: Any, fine: Float, *arguments: Any) -> Float:
    """One coarser level by a kernel of `refdof.raster.filters.downsample`."""
    height, _, channels = fine.shape
    out = np.empty((*_half(fine), channels), dtype=fine.dtype)
    with np.errstate(over="ignore", invalid="ignore"):  # infinite texels, or sums beyond the type
        downsample(fine.reshape(height, -1), channels, *arguments, out.reshape(len(out), -1))
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


def _drawn_centres(fine: Float) -> tuple[Float, Float]:
    """As `_centres`, as they come out of a rectangle of two triangles with corners 0 and 1 (measured [2]).

    A plane starts from the triangle's vertex: at x = 1 in both; at y = 0 above the diagonal from the first corner to
    the last, at y = 1 below it.
    """
    one = np.float32(1)
    (rows, columns), (height, width) = fine.shape[:2], _half(fine)
    part = one / np.float32(width * height)
    slope_x, slope_y = np.float32(height) * part, np.float32(width) * part
    last_x, last_y = np.float32(width - 0.5), np.float32(height - 0.5)
    x = _plane(slope_x, one - slope_x * last_x, width) * np.float32(columns)
    above = _plane(slope_y, slope_y * np.float32(0.5), height) * np.float32(rows)
    below = _plane(slope_y, one - slope_y * last_y, height) * np.float32(rows)
    i, j = np.arange(width), np.arange(height)[:, None]
    y = np.where((2 * j + 1) * width <= (2 * i + 1) * height, above[:, None], below[:, None])
    return np.tile(x, (height, 1)), y


def _plane(slope: np.float32, start: np.float32, count: int) -> Float:
    """Slope k + start for k = 0 .. count - 1, each rounded once."""
    out = np.empty(count, dtype=np.float32)
    _fill_plane(slope, start, out)
    return out


@kernel
def _fill_plane(slope, start, out):
    for k in prange(len(out)):
        out[k] = fused_multiply_add(np.float32(k), slope, start)

"""Texture reads as a graphics pipeline does them: single texels, bilinear and trilinear filters.

An image is (H, W, C): float32, float64, or uint8 for integers that a reader sees as k / 255. Row 0 has v = 0; texel
(x, y) is centred on u = (x + 1/2) / W, v = (y + 1/2) / H. Images may hold infinities and NaN: with `strict_weights` a
texel of weight 0 has no part in the result, otherwise it makes it NaN, as graphics cards do.

References
----------
.. [1] Khronos Group, OpenGL 4.5 specification, section 8.14 (texture minification).
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from refdof._check import Float, Index, InputError, as_float, as_instance, shape_of
from refdof._jit import kernel, prange
from refdof.raster.gpu.gpu_model import EXACT, GpuModel, decode_unorm
from refdof.raster.gpu.texture_reads import Chain, read_chain
from refdof.raster.gpu.texture_sampling import rules_of

__all__ = ["as_texture", "at_texels", "bilinear", "fetch", "level_of_detail", "trilinear"]


_NO_LEVELS = np.zeros(0)


def fetch(image: Any, x: Any, y: Any, model: GpuModel = EXACT) -> Float:
    """Single texels: (..., C) at whole x, y (...); 0 outside the image.

    Raises
    ------
    InputError
        If the image is not a texture, or x and y are not integers or do not fit each other.
    """
    image = _decoded(as_texture("image", image, model), model)
    for name, value in (("x", x), ("y", y)):
        shape_of(name, value)
        if not np.issubdtype(np.asarray(value).dtype, np.integer):
            raise InputError(f"{name}: got {np.asarray(value).dtype}; allowed are integers")
    x, y = _matched(x=np.asarray(x), y=np.asarray(y))
    height, width, channels = image.shape
    inside = (x >= 0) & (x < width) & (y >= 0) & (y < height)
    out = np.zeros((*x.shape, channels), dtype=image.dtype)
    out[inside] = image[y[inside], x[inside]]
    return out


def bilinear(image: Any, u: Any, v: Any, model: GpuModel = EXACT, border: Any = None) -> Float:
    """Blend the four texels around a point, along x first.

    Parameters
    ----------
    image : (H, W, C)
        float64 only with `EXACT`.
    u, v : (...)
        Finite; 0 .. 1 spans the image. float64 with `EXACT`, else float32.
    model : GpuModel
    border : (C,) or None
        Colour outside the image, cut to 0 .. 1 for uint8; None repeats the edge.

    Returns
    -------
    (..., C) : float32, or float64 for a float64 image.

    Raises
    ------
    InputError
        If the image is not a texture, a coordinate is not finite, or shapes disagree.
    """
    image = as_texture("image", image, model)
    if _in_integers(image, model, border):
        x, y = _coordinates(model, u=u, v=v)
        return at_texels(image, x, y, model, border, (image.shape[1], image.shape[0]))
    x, y = _coordinates(model, later=True, u=u, v=v)
    read, finite = _read([image], x, y, _NO_LEVELS, model, border, [(image.shape[1], image.shape[0])])
    if not finite:
        _coordinates(model, u=u, v=v)
    return read


def trilinear(levels: Sequence[Any], u: Any, v: Any, lod: Any, model: GpuModel = EXACT, border: Any = None) -> Float:
    """Blend bilinear reads of two neighbouring levels: textureLod.

    Parameters
    ----------
    levels : images (H, W, C)
        Finest first, all of one type.
    u, v : (...)
        As in `bilinear`.
    lod : (...)
        Finite level; below 0 is 0, above the last is the last.
    model, border
        As in `bilinear`.

    Returns
    -------
    (..., C) : float32, or float64 for float64 images.

    Raises
    ------
    InputError
        As `bilinear`; also if there is no level, or types or channels differ.

    Notes
    -----
    At a whole level the next one is not read. (llvmpipe does read it if a pixel beside needs it: with infinite texels
    the result at whole levels then depends on the neighbours.)
    """
    if not isinstance(levels, list | tuple):
        raise InputError(f"levels: got {type(levels).__name__}; allowed is a list of images")
    images = [as_texture(f"levels[{k}]", level, model) for k, level in enumerate(levels)]
    if not images or any(i.dtype != images[0].dtype or i.shape[2] != images[0].shape[2] for i in images):
        raise InputError("levels: allowed is a list of one or more images with the same type and number of channels")
    u, v, lod = _coordinates(model, u=u, v=v, lod=lod)
    if lod.size and (lod.min() < 0 or lod.max() > len(images) - 1):  # a new array costs more than a look
        lod = np.clip(lod, 0, len(images) - 1)
    if model.filter_bits:
        lod = np.floor(lod * lod.dtype.type(256) + lod.dtype.type(0.5)) / lod.dtype.type(256)
    if _in_integers(images[0], model, border):
        read = _trilinear_bytes(images, u.ravel(), v.ravel(), lod.ravel(), model)
        return read.reshape(*u.shape, images[0].shape[2])
    least, most = (int(lod.min()), math.ceil(lod.max())) if lod.size else (0, 0)
    images, lod = images[least : most + 1], lod - lod.dtype.type(least) if least else lod
    return _read(images, u, v, lod, model, border, [(image.shape[1], image.shape[0]) for image in images])[0]


def level_of_detail(squared: Any, model: GpuModel = EXACT, bias: Any = 0.0) -> Float:
    """The level whose texels have the footprint's size: log2 of it, plus a bias.

    Parameters
    ----------
    squared : (...) > 0
        Square of the footprint's larger side [texels of level 0].
    model : GpuModel
        With `linear_log2`, log2(m 2^e) is e + m - 1 for 1 <= m < 2: up to 0.043 too low.
    bias : (...), or a number
        Levels to add. (Cards cut it, at 14 to 16 levels either way.)
    """
    as_instance("model", model, GpuModel)
    bias = as_float("bias", bias, shape_of("bias", bias))
    squared = as_float("squared", squared, shape_of("squared", squared))
    if not (squared > 0).all():
        raise InputError(f"squared: smallest value is {squared.min():g}; allowed are values > 0")
    squared, bias = _matched(squared=squared, bias=bias)
    if not model.linear_log2:
        return 0.5 * np.log2(squared) + bias
    mantissa, exponent = np.frexp(squared)
    return 0.5 * (exponent - 1 + (2 * mantissa - 1)) + bias


def as_texture(name: str, image: Any, model: GpuModel) -> Any:
    """Return `image` as a C-contiguous (H, W, C) array that `model` can read."""
    as_instance("model", model, GpuModel)
    if not isinstance(image, np.ndarray) or image.dtype not in (np.uint8, np.float32, np.float64):
        kind = getattr(image, "dtype", type(image).__name__)
        raise InputError(f"{name}: got {kind}; allowed is an array of uint8, float32 or float64")
    if image.ndim != 3 or image.size == 0:
        raise InputError(f"{name}: got shape {image.shape}; allowed is (H, W, C), not empty")
    if image.dtype == np.float64 and model != EXACT:
        raise InputError(f"{name}: got float64; allowed are uint8 and float32 for a model other than EXACT")
    return np.ascontiguousarray(image)


def at_texels(
    image: Any, x: Float, y: Float, model: GpuModel, border: Any = None, scale: tuple[int, int] = (1, 1)
) -> Float:
    """`bilinear` at x, y, which times `scale` are texels from the image's corner; nothing but `border` is checked."""
    height, width, channels = image.shape
    if _in_integers(image, model, border):
        with np.errstate(over="ignore"):  # far outside
            x, y = (place * x.dtype.type(factor) for place, factor in zip((x, y), scale, strict=True))
        whole = _filter_bytes(image, _fixed(x, width).ravel(), _fixed(y, height).ravel())
        return decode_unorm(whole, 255, model).reshape(*x.shape, channels)
    return _read([image], x, y, _NO_LEVELS, model, border, [scale])[0]


def _in_integers(image: Any, model: GpuModel, border: Any) -> bool:
    return bool(image.dtype == np.uint8 and model.integer_unorm8 and border is None)


def _read(
    images: Sequence[Any],
    u: Float,
    v: Float,
    lod: Float,
    model: GpuModel,
    border: Any,
    scales: Sequence[tuple[int, int]],
) -> tuple[Float, bool]:
    """Reads (..., C) at u, v (...), which times each level's scale are in its texels; and whether u, v are finite."""
    channels, real = images[0].shape[2], u.dtype
    kind = np.float32 if images[0].dtype == np.float32 else np.float64
    colour = np.zeros(channels) if border is None else as_float("border", border, (channels,), dtype=kind)
    if images[0].dtype == np.uint8:
        colour = np.clip(colour, 0.0, 1.0)
    levels = [_decoded(image, model).reshape(-1, channels) for image in images]
    texels = levels[0] if len(levels) == 1 else np.concatenate(levels)
    height, width = np.array([image.shape[:2] for image in images], dtype=np.int64).T.copy()
    start = np.concatenate([[0], np.cumsum(height * width)[:-1]])
    chain = Chain(texels, start, width, height, *np.array(scales, dtype=real).T.copy())
    rounded, colour, bordered = model.filter_bits > 0, colour.astype(texels.dtype), border is not None
    out = np.empty((u.size, channels), dtype=texels.dtype)
    points = u.ravel(), v.ravel(), lod.ravel().astype(real, copy=False)
    with np.errstate(over="ignore", invalid="ignore"):  # far outside; infinite texels
        finite = read_chain(chain, points, rounded, colour, bordered, rules_of(model), out)
    return out.reshape(*u.shape, channels), bool(finite)


def _trilinear_bytes(images: Sequence[Any], u: Float, v: Float, lod: Float, model: GpuModel) -> Float:
    """`trilinear` in integers: u, v, lod (N,) -> (N, C)."""
    level, scalar = np.floor(lod).astype(np.int64), u.dtype.type
    parts = []
    for step in (0, 1):
        read = np.empty((len(u), images[0].shape[2]), dtype=np.int64)
        chosen = np.minimum(level + step, len(images) - 1)
        for k in np.unique(chosen):
            here, (height, width) = chosen == k, images[k].shape[:2]
            with np.errstate(over="ignore"):  # far outside
                x, y = _fixed(u[here] * scalar(width), width), _fixed(v[here] * scalar(height), height)
            read[here] = _filter_bytes(images[k], x, y)
        parts.append(read)
    weight = np.floor((lod - level) * 256).astype(np.int64)[:, None]
    return decode_unorm(parts[0] + (((parts[1] - parts[0]) * weight + 128) >> 8), 255, model)


@kernel
def _filter_bytes(image, x, y):
    """Bilinear reads (N, C) of an image of bytes in integers; x, y (N,) are in 1/256 texel from the first centre."""
    height, width, channels = image.shape
    out = np.empty((len(x), channels), dtype=np.int64)
    for k in prange(len(x)):
        left, top = min(max(x[k] >> 8, 0), width - 1), min(max(y[k] >> 8, 0), height - 1)
        right, bottom = min(max((x[k] >> 8) + 1, 0), width - 1), min(max((y[k] >> 8) + 1, 0), height - 1)
        for c in range(channels):
            p, q = np.int64(image[top, left, c]), np.int64(image[bottom, left, c])
            p += ((np.int64(image[top, right, c]) - p) * (x[k] & 255) + 128) >> 8
            q += ((np.int64(image[bottom, right, c]) - q) * (x[k] & 255) + 128) >> 8
            out[k, c] = p + (((q - p) * (y[k] & 255) + 128) >> 8)
    return out


def _fixed(x: Float, size: int) -> Index:
    inside = np.clip(x, x.dtype.type(-1), x.dtype.type(size + 1))
    return np.rint(inside * x.dtype.type(256)).astype(np.int64) - 128


def _decoded(image: Any, model: GpuModel) -> Float:
    return decode_unorm(image, 255, model) if image.dtype == np.uint8 else image


def _coordinates(model: GpuModel, later: bool = False, **values: Any) -> list[Float]:
    """Arrays of one shape, in the type in which `model` computes coordinates; finite, if that is not seen later."""
    how: dict[str, Any] = {"dtype": np.float64 if model == EXACT else np.float32, "finite": not later, "nan": later}
    return _matched(**{name: as_float(name, v, shape_of(name, v), **how) for name, v in values.items()})


def _matched(**arrays: Any) -> list[Any]:
    try:
        return list(np.broadcast_arrays(*arrays.values()))
    except ValueError:
        shapes = ", ".join(str(a.shape) for a in arrays.values())
        raise InputError(f"{', '.join(arrays)}: got shapes {shapes}; they must match") from None

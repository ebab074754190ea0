"""How a graphics pipeline rounds: sub-pixel snapping, texture filters and stores to texture formats.

Methods for graphics hardware are written once and run under a `GpuModel`: `EXACT` rounds correctly and spreads nothing
that has no weight, `LLVMPIPE` is bit for bit Mesa's software renderer, `D3D11` is what that interface asks for.

References
----------
.. [1] Microsoft, Direct3D 11.3 Functional Specification, sections 3.1 and 3.2 (floating-point and conversion rules).
.. [2] Mesa 22.3.6 with LLVM 15.0.6 on a processor with fused multiply-add: measured.
"""

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from refdof._check import Float, InputError, as_bool, as_choice, as_instance, as_integer

__all__ = ["D3D11", "EXACT", "FORMATS", "LLVMPIPE", "GpuModel", "store"]

FORMATS = ("f32", "f16", "unorm8", "unorm16", "r11g11b10f")


@dataclass(frozen=True)
class GpuModel:
    """How a pipeline rounds. Every default is the exact behaviour.

    Parameters
    ----------
    subpixel_bits : int
        Bits after the point that vertices keep in screen space; 0 keeps all.
    attributes_from_snapped : bool
        Whether attributes are interpolated from the snapped positions.
    filter_bits : int
        Bits of a filter's weights and of the part of a level behind the point; 0 keeps all.
    fused_lerp : bool
        Whether a filter computes a + (b - a) w with one rounding after the subtraction.
    integer_unorm8 : bool
        Whether textures of 8 bits that are clamped to the edge are filtered in integers, with results of 8 bits.
    float_rounding : "nearest" or "zero"
        Stores to short floats: to nearest even with overflow to infinity, or towards zero with overflow to the largest
        number.
    unorm_rounding : "exact", "even" or "up"
        Stores to integers: to nearest even of the exact product, of the float32 product, or half up of the latter.
    unorm_scale : "quotient" or "product"
        Reads of integers: k / (2^n - 1) rounded once, or k times the rounded inverse.
    flush_denormals : bool
        Whether arithmetic takes and gives 0 for float32 below 2^-126. Copies keep them.
    linear_log2 : bool
        Whether the level of detail comes from a logarithm that is linear between powers of two.
    strict_weights : bool
        Whether texels of weight 0 have no part in a filter, even if infinite or NaN.
    drawn_mipmaps : bool
        Whether mip levels are drawn as two triangles, whose float32 planes give the places to read; else those are the
        texels' centres.
    """

    subpixel_bits: int = 0
    attributes_from_snapped: bool = False
    filter_bits: int = 0
    fused_lerp: bool = False
    integer_unorm8: bool = False
    float_rounding: str = "nearest"
    unorm_rounding: str = "exact"
    unorm_scale: str = "quotient"
    flush_denormals: bool = False
    linear_log2: bool = False
    strict_weights: bool = True
    drawn_mipmaps: bool = False

    def __post_init__(self) -> None:
        for name, allowed in (("subpixel_bits", (0, 4, 8)), ("filter_bits", (0, 8))):
            bits = as_integer(name, getattr(self, name), minimum=0, maximum=8)
            if bits not in allowed:
                raise InputError(f"{name}: got {bits}; allowed are {', '.join(map(str, allowed))}")
            object.__setattr__(self, name, bits)
        for field in fields(self):
            if field.type is bool:
                as_bool(field.name, getattr(self, field.name))
        as_choice("float_rounding", self.float_rounding, ("nearest", "zero"))
        as_choice("unorm_rounding", self.unorm_rounding, ("exact", "even", "up"))
        as_choice("unorm_scale", self.unorm_scale, ("quotient", "product"))


EXACT = GpuModel()
LLVMPIPE = GpuModel(
    subpixel_bits=8,
    fused_lerp=True,
    integer_unorm8=True,
    float_rounding="zero",
    unorm_rounding="even",
    unorm_scale="product",
    flush_denormals=True,
    linear_log2=True,
    strict_weights=False,
    drawn_mipmaps=True,
)
D3D11 = GpuModel(
    subpixel_bits=8,
    attributes_from_snapped=True,
    filter_bits=8,
    float_rounding="zero",
    unorm_rounding="up",
    flush_denormals=True,
    strict_weights=False,
)


def store(values: Float, texture_format: str, model: GpuModel = EXACT) -> Float:
    """Write float32 values to a render target and read them back.

    Parameters
    ----------
    values : float32
        Any shape; the last axis is 3 for "r11g11b10f". Infinities and NaN are allowed.
    texture_format : one of `FORMATS`
    model : GpuModel

    Returns
    -------
    float32 of the same shape: what a reader of that texture sees.

    Raises
    ------
    InputError
        If `values` is not float32, its last axis does not fit, or the format is unknown.

    Notes
    -----
    Integers: below 0 becomes 0, above 1 becomes 1, NaN becomes 0. "r11g11b10f": below 0, also -inf, becomes 0. Floats:
    infinities and NaN stay, and so do denormals.
    """
    as_choice("texture_format", texture_format, FORMATS)
    as_instance("model", model, GpuModel)
    if getattr(values, "dtype", None) != np.float32:
        raise InputError(f"values: got {getattr(values, 'dtype', type(values).__name__)}; allowed is float32")
    if texture_format == "f32":
        return values.copy()
    if texture_format == "f16":
        return _short_float(values, 10, model)
    if texture_format == "r11g11b10f":
        if values.shape[-1:] != (3,):
            raise InputError(f"values: got shape {values.shape}; allowed is (..., 3)")
        return _short_float(np.where(values <= 0, np.float32(0), values), np.array([6, 6, 5]), model)
    top = 255 if texture_format == "unorm8" else 65535
    return decode_unorm(_encode_unorm(values, top, model), top, model)


def decode_unorm(whole: Any, top: int, model: GpuModel) -> Float:
    """Whole numbers 0 .. top as the float32 that a reader sees."""
    if model.unorm_scale == "product":
        return np.asarray(whole).astype(np.float32) * np.float32(1.0 / top)
    return (np.asarray(whole) / top).astype(np.float32)


def _encode_unorm(values: Float, top: int, model: GpuModel) -> Float:
    """float32 to whole numbers 0 .. top, as float64."""
    inside = np.minimum(np.where(values > 0, values, np.float32(0)), np.float32(1))  # NaN and -0 become 0
    if model.unorm_rounding == "exact":
        return np.rint(inside.astype(np.float64) * top)
    product = inside * np.float32(top)
    rounded = np.rint(product) if model.unorm_rounding == "even" else np.floor(product + np.float32(0.5))
    return rounded.astype(np.float64)


def _short_float(values: Float, mantissa_bits: Any, model: GpuModel) -> Float:
    """Round float32 to floats with five bits of exponent. float64 holds every step exactly."""
    with np.errstate(invalid="ignore"):  # signalling NaN
        wide = values.astype(np.float64)
    finite = np.where(np.isfinite(wide), wide, 0.0)
    exponent = np.maximum(np.frexp(finite)[1] - 1, -14)  # below 2^-14 the step stays: denormals
    step = np.ldexp(1.0, exponent - mantissa_bits)
    largest = np.ldexp(2.0 - np.ldexp(1.0, -mantissa_bits), 15)
    if model.float_rounding == "zero":
        rounded = np.clip(np.trunc(finite / step) * step, -largest, largest)
    else:
        rounded = np.rint(finite / step) * step
        rounded = np.where(np.abs(rounded) > largest, np.copysign(np.inf, finite), rounded)
    return np.where(np.isfinite(wide), rounded, wide).astype(np.float32)

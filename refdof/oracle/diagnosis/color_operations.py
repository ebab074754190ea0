"""Colour operations: what ports do to colours before or after the blur that they should not."""

import numpy as np

from refdof._check import Float
from refdof.oracle.diagnosis.model import Operations

__all__ = ["operate"]

_ACES = (2.51, 0.03, 2.43, 0.59, 0.14)  # Narkowicz (2015), ACES Filmic Tone Mapping Curve


def operate(color: Float, operations: Operations) -> Float:
    """Apply (name, value), one after another, to linear RGB (..., 3)."""
    for name, value in operations:
        color = _operate(color, name, value)
    return color


def _operate(color: Float, name: str, value: float) -> Float:
    positive = np.maximum(color, 0.0)
    match name:
        case "gamma":
            return positive**value
        case "clamp_gamma":
            return np.minimum(positive, 1.0) ** value
        case "srgb_encode":
            return np.where(positive <= 0.0031308, 12.92 * positive, 1.055 * positive ** (1 / 2.4) - 0.055)
        case "clamp_srgb_encode":
            return _operate(np.minimum(positive, 1.0), "srgb_encode", value)
        case "srgb_decode":
            return np.where(positive <= 0.04045, positive / 12.92, ((positive + 0.055) / 1.055) ** 2.4)
        case "clamp":
            return np.clip(color, 0.0, value)
        case "reinhard":
            return color / (1.0 + color)
        case "exposure":
            return 1.0 - np.exp(-value * color)
        case "aces":
            a, b, c, d, e = _ACES
            return np.clip(color * (a * color + b) / (color * (c * color + d) + e), 0.0, 1.0)
        case "gain":
            return color * value
        case "offset":
            return color + value
        case "levels":
            return np.rint(np.clip(color, 0.0, 1.0) * value) / value
        case "half_float":
            with np.errstate(over="ignore"):
                return color.astype(np.float16).astype(np.float64)
        case "grey":
            return np.repeat(color @ np.array([[0.2126], [0.7152], [0.0722]]), 3, axis=-1)
        case _:  # an order of channels, such as BGR
            return color[..., ["RGB".index(letter) for letter in name]]

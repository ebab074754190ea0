"""Display image: the linear image clipped to [0, 1] and sRGB-encoded [1].

References
----------
.. [1] IEC 61966-2-1:1999, Multimedia systems and equipment - Default RGB colour space - sRGB.
"""

from typing import Any

import numpy as np
import numpy.typing as npt

from refdof._check import Float, as_image
from refdof._jit import inline

__all__ = ["display", "display_slope", "encode", "encode_one", "levels", "linear_from_display", "to_8_bit"]

# [1]: the straight piece near black, and the power curve above it.
_KNEE = 0.0031308
_SLOPE = 12.92
_SCALE, _OFFSET, _GAMMA = 1.055, 0.055, 2.4


def display(linear: Any) -> Float:
    """Clip to [0, 1] and encode.

    Parameters
    ----------
    linear : (H, W, 3)
        Linear Rec.709 RGB; infinities are clipped like any other value.

    Returns
    -------
    (H, W, 3) float32, C order, in [0, 1]; computed in float64 and rounded once.

    Raises
    ------
    InputError
        If the shape is wrong, there is no pixel, a value is NaN, or pixels have 8 or 16 bits.
    """
    return encode(as_image("image", linear, dtype=np.float64, finite=False)).astype(np.float32)


def encode(light: Float) -> Float:
    """`display` of float64 values of any shape, not rounded."""
    light = np.clip(light, 0.0, 1.0)
    return np.where(light <= _KNEE, _SLOPE * light, _SCALE * np.power(light, 1.0 / _GAMMA) - _OFFSET)


@inline
def encode_one(light):
    """The display value of one linear value, in float64."""
    light = min(max(light, 0.0), 1.0)
    return _SLOPE * light if light <= _KNEE else _SCALE * light ** (1.0 / _GAMMA) - _OFFSET


def to_8_bit(linear: Any) -> npt.NDArray[np.uint8]:
    """Display image of `linear`, rounded to the nearest of 256 levels: (H, W, 3) uint8."""
    return levels(display(linear))


def levels(seen: Float) -> npt.NDArray[np.uint8]:
    """A display image, float32 in [0, 1], rounded to the nearest of 256 levels."""
    return np.rint(seen * np.float32(255.0)).astype(np.uint8)


def linear_from_display(encoded: Any) -> Float:
    """Undo the encoding: display values (H, W, 3) in [0, 1] as linear RGB float32."""
    value = as_image("encoded", encoded, dtype=np.float64, minimum=0.0, maximum=1.0)
    curve = np.power((value + _OFFSET) / _SCALE, _GAMMA)
    return np.where(value <= _SLOPE * _KNEE, value / _SLOPE, curve).astype(np.float32)


def display_slope(linear: Any) -> Float:
    """Slope of the encoding at `linear` clipped to [0, 1]: (H, W, 3) float64, display per linear unit."""
    light = np.clip(as_image("image", linear, dtype=np.float64, finite=False), 0.0, 1.0)
    curve = _SCALE / _GAMMA * np.power(np.maximum(light, _KNEE), 1.0 / _GAMMA - 1.0)
    return np.where(light <= _KNEE, _SLOPE, curve)

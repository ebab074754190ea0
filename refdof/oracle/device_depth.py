"""Device depth: planar depth as a depth buffer holds it, three ways, and what float32 leaves of the circles.

With planes n and f, and z the planar depth:

    standard     d = f (z - n) / (z (f - n))      0 at n, 1 at f        1 / z = 1/n - d (1/n - 1/f)
    reversed     d = n (f - z) / (z (f - n))      1 at n, 0 at f        1 / z = 1/f + d (1/n - 1/f)
    infinite     d = n / z                        1 at n, 0 never       1 / z = d / n

All three are linear in 1 / z. What rounding d costs is a step of 1 / z that is the same everywhere for "standard"
beyond 2 n, and grows with 1 / z for the other two; a circle errs by coc_scale times that.
"""

from typing import NamedTuple

import numpy as np

from refdof._check import Float
from refdof.oracle.pictures import FAR, Picture

__all__ = ["DEVICE_DEPTHS", "Planes", "circle_error", "device_depth", "inverse_depth", "planes_of"]

DEVICE_DEPTHS: dict[str, str] = {
    "depth_device": "f (z - n) / (z (f - n)): 0 at the near plane n, 1 at the far plane f",
    "depth_device_reversed": "n (f - z) / (z (f - n)): 1 at the near plane n, 0 at the far plane f",
    "depth_device_infinite": "n / z: reversed, without a far plane",
}


class Planes(NamedTuple):
    """Near and far plane [scene units]."""

    near: float
    far: float


def planes_of(depth: Float) -> Planes:
    """A power of two at or before the nearest surface; the background's depth, or a power of two beyond it."""
    least, greatest = float(depth.min()), float(depth.max())
    far = FAR if greatest <= FAR else float(np.ldexp(1.0, int(np.frexp(greatest)[1])))
    return Planes(float(np.ldexp(1.0, int(np.frexp(least)[1]) - 1)), far)


def device_depth(name: str, depth: Float, planes: Planes) -> Float:
    """One of `DEVICE_DEPTHS`: (H, W) float32, computed in float64 and rounded once."""
    z, (near, far) = depth.astype(np.float64), planes
    if name == "depth_device":
        device = far * (z - near) / (z * (far - near))
    elif name == "depth_device_reversed":
        device = near * (far - z) / (z * (far - near))
    else:
        device = near / z
    return device.astype(np.float32)


def inverse_depth(name: str, device: Float, planes: Planes) -> Float:
    """1 / z of device depth, in its own type."""
    own = device.dtype.type
    near, far = own(1.0 / planes.near), own(1.0 / planes.far)
    if name == "depth_device":
        return near - device * (near - far)
    if name == "depth_device_reversed":
        return far + device * (near - far)
    return device * near


def circle_error(name: str, picture: Picture, planes: Planes, largest: float = np.inf) -> float:
    """How far circles of a float32 device depth are from the picture's, at most [px]; both cut at `largest` first."""
    device = device_depth(name, picture.depth, planes).astype(np.float64)
    decoded = picture.coc_scale * (1.0 / picture.focus - inverse_depth(name, device, planes))
    true = picture.coc_scale * (1.0 / picture.focus - 1.0 / picture.depth.astype(np.float64))
    return float(np.abs(np.clip(decoded, -largest, largest) - np.clip(true, -largest, largest)).max())

"""Depth kinds: what other programs write as depth, as planar depth.

With planes n and f, planar depth z, a pixel's slopes x and y of its ray (x, y, -1), and stored values r and d:

    planar               z
    radial               r = z sqrt(1 + x^2 + y^2)       the distance to the eye       z = r / sqrt(1 + x^2 + y^2)
    device               d = f (z - n) / (z (f - n))     0 at n, 1 at f                z = n f / ((1 - d) f + d n)
    reversed             d = n (f - z) / (z (f - n))     1 at n, 0 at f                z = n f / ((1 - d) n + d f)
    reversed-infinite    d = n / z                       1 at n, 0 never               z = n / d

Neither form has a difference that cancels: 1 - d is exact from a half on. What a buffer was cleared with is background,
at infinity: 1 of "device", 0 of the other two. So is, of the first two kinds, 1e10, which Blender writes.
"""

from typing import Any

import numpy as np

from refdof._check import Float, InputError, as_choice, as_float, as_instance, as_number, shape_of
from refdof.optics.camera import Camera

__all__ = ["DEPTH_KINDS", "planar_depth", "planar_of", "ray_lengths"]

DEPTH_KINDS: dict[str, str] = {
    "planar": "distance along the optical axis",
    "radial": "distance to the eye",
    "device": "depth buffer, 0 at the near plane and 1 at the far plane",
    "reversed": "depth buffer, 1 at the near plane and 0 at the far plane",
    "reversed-infinite": "depth buffer, near plane / distance along the axis",
}

_BLENDERS_BACKGROUND = 1e10
_PLANES = {"device": 2, "reversed": 2, "reversed-infinite": 1}  # how many planes a kind needs


def planar_depth(
    values: Float, kind: str, camera: Camera, near: float | None = None, far: float | None = None
) -> Float:
    """Planar depth of what another program wrote.

    Parameters
    ----------
    values : (..., H, W)
        Depths of this kind, of any float type.
    kind : one of `DEPTH_KINDS`
    camera : Camera
        Its picture has H rows of W pixels.
    near, far : float, optional
        Planes of a depth buffer [scene units]: "device" and "reversed" need both, "reversed-infinite" near only, and
        the others none.

    Returns
    -------
    (..., H, W) float64
        [scene units], > 0; inf is background.

    Raises
    ------
    InputError
        If a value is NaN or not of this kind, or planes are missing, too many or not in order.
    """
    as_instance("camera", camera, Camera)
    wanted = (None,) * (len(shape_of("depth", values)) - 2) + (camera.height, camera.width)
    stored = as_float("depth", values, wanted, dtype=np.float64, finite=False)
    return planar_of(stored, kind, ray_lengths(camera), near, far)


def planar_of(stored: Float, kind: str, lengths: Float, near: float | None, far: float | None) -> Float:
    """`planar_depth` of float64 with the `ray_lengths` of their pixels."""
    as_choice("kind", kind, DEPTH_KINDS)
    _check_planes(kind, near, far)
    if kind in _PLANES:
        return _of_buffer(stored, kind, near, far)
    if stored.size and not stored.min() > 0.0:
        raise InputError(f"depth: smallest value is {stored.min():g}; allowed for {kind} are values > 0")
    planar = np.where(stored == _BLENDERS_BACKGROUND, np.inf, stored)
    return planar if kind == "planar" else planar / lengths


def ray_lengths(camera: Camera) -> Float:
    """How much longer each pixel's ray is than its planar depth: (H, W)."""
    across = (np.arange(camera.width) + 0.5 - 0.5 * camera.width) / camera.pixels_per_tangent
    down = (np.arange(camera.height) + 0.5 - 0.5 * camera.height) / camera.pixels_per_tangent
    return np.sqrt(1.0 + across**2 + (down**2)[:, None])


def _check_planes(kind: str, near: Any, far: Any) -> None:
    needed = _PLANES.get(kind, 0)
    for count, (name, plane) in enumerate({"near": near, "far": far}.items(), start=1):
        if plane is None and count <= needed:
            raise InputError(f"{name}: got none; allowed for {kind} is the distance of that plane, above 0")
        if plane is not None:
            as_number(name, plane, above=0.0)
        if plane is not None and count > needed:
            raise InputError(f"{name}: got {plane:g} for {kind}, which has no such plane; allowed is none")
    if needed == 2 and not near < far:
        raise InputError(f"far: got {far:g} with near {near:g}; allowed is a number above near")


def _of_buffer(device: Float, kind: str, near: Any, far: Any) -> Float:
    for name, extreme in (("smallest", device.min(initial=1.0)), ("largest", device.max(initial=0.0))):
        if not 0.0 <= extreme <= 1.0:
            raise InputError(f"depth: {name} value is {extreme:g}; allowed for {kind} are values in 0 .. 1")
    n, empty = np.float64(near), device == (1.0 if kind == "device" else 0.0)
    with np.errstate(divide="ignore", over="ignore"):
        if kind == "reversed-infinite":
            return n / device
        f = np.float64(far)
        first, second = (f, n) if kind == "device" else (n, f)
        return np.where(empty, np.inf, n * f / ((1.0 - device) * first + device * second))

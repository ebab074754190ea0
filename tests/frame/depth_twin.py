"""Depth as other programs store it, from its definition, in long double and rounded once."""

import math

import numpy as np


def stored_depth(kind, depth, camera, near, far, dtype=np.float64):
    """Planar depth (H, W) as a kind; background is what a buffer was cleared with."""
    out = np.empty(depth.shape, dtype=dtype)
    tangent = math.tan(math.radians(camera.fov_y) / 2)
    height, width = depth.shape
    n, f = np.longdouble(near), np.longdouble(far)
    for y in range(height):
        for x in range(width):
            z = np.longdouble(depth[y, x])
            right = np.longdouble(2 * (x + 0.5) - width) * tangent / height
            up = np.longdouble(height - 2 * (y + 0.5)) * tangent / height
            empty = np.isinf(z)
            if kind == "planar":
                value = z
            elif kind == "radial":
                value = z if empty else np.sqrt((right * z) ** 2 + (up * z) ** 2 + z**2)
            elif kind == "device":
                value = 1.0 if empty else (1 / n - 1 / z) / (1 / n - 1 / f)
            elif kind == "reversed":
                value = 0.0 if empty else (1 / z - 1 / f) / (1 / n - 1 / f)
            else:
                value = n / z
            out[y, x] = value
    return out

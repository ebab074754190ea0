"""Matting: how much of a surface at depth z belongs to each of K depth layers: one trapezoid per layer.

Layer k has the core [z_(k-1), z_k], where its weight is 1; it rises from 0 at z_(k-2) and falls to 0 at z_(k+1). So
every depth has weight 1 in one layer and two weights that add up to 1 in that layer's neighbours: 2 in all, on purpose,
so that no gap opens where layers are blurred and composed one over the other. Ramps are linear in z. Where they end at
an infinite depth they are linear in 1 / z.

1. find the core a depth lies in and the place inside it: its layer coordinate   `layer_coordinate`
2. read the trapezoid of a layer off the coordinate's distance to the layer      `matte`

A coordinate k + t stands for z_(k-1) + t (z_k - z_(k-1)): the trapezoid of layer k is min(1 + x, 1, 2 - x) with
x = coordinate - k, at least 0.

At the two ends a ramp would need an anchor beyond the last layer. The rules:

===========  ===========================================================================================
extrapolate  use the anchor that the next layer would have; surfaces beyond it count as lying on it
hard         no ramp: what lies in the first or last core has no weight in the neighbouring layer
===========  ===========================================================================================

References
----------
.. [1] Kraus & Strengert (2007), Depth-of-Field Rendering by Pyramidal Image Processing, Computer Graphics Forum 26(3).
.. [2] Schedl & Wimmer (2012), A Layered Depth-of-Field Method for Solving Partial Occlusion, Section 3.2.
"""

import numpy as np

from refdof._check import Float, InputError, as_choice, as_depth, as_float, shape_of
from refdof._jit import borrow, inline, kernel, prange

__all__ = ["ABSENT", "BOUNDARIES", "RAMPS", "layer_coordinate", "matte", "ramp_code"]

RAMPS = ("corrected", "as_printed", "none")
BOUNDARIES = ("extrapolate", "hard")
ABSENT = -4.0  # the coordinate of no surface: no layer gives it weight


def ramp_code(ramp: str) -> int:
    """The number by which `matte` knows a ramp: "corrected", "as_printed" (Eq. (4) of [2] as it stands) or "none"."""
    return RAMPS.index(as_choice("ramp", ramp, RAMPS))


def layer_coordinate(depth: Float, bounds: Float, boundary: str = "extrapolate", dtype: type = np.float32) -> Float:
    """The layer coordinate of every depth.

    Parameters
    ----------
    depth : any shape
        Planar depth [scene units], > 0, inf allowed; NaN means no surface.
    bounds : (K + 1,)
        Anchors z_(-1) .. z_(K-1) in ascending order [scene units]; the first and the last are those that
        `extrapolate` needs beyond the layers, and the last one may be inf.
    boundary : one of `BOUNDARIES`

    Returns
    -------
    Array of the shape of `depth` with values in 0 .. K, or `ABSENT`.

    Raises
    ------
    InputError
        If there are fewer than two anchors, one but the last is infinite, they are not in order, or a depth is not
        above 0.
    """
    bounds = as_float("bounds", bounds, (None,), dtype=np.float64, finite=False)
    if len(bounds) < 2 or not np.isfinite(bounds[:-1]).all() or not (bounds[1:] >= bounds[:-1]).all():
        raise InputError(
            f"bounds: got {bounds.tolist()}; allowed are two or more ascending depths; the last may be inf"
        )
    as_choice("boundary", boundary, BOUNDARIES)
    depth = as_depth(depth, shape_of("depth", depth), dtype=np.float64, nan=True)
    if not isinstance(dtype, type) or dtype not in (np.float32, np.float64):
        raise InputError("dtype: allowed are float32 and float64")
    if depth.size == 0:
        return np.empty(depth.shape, dtype=dtype)
    rows = np.ascontiguousarray(depth).reshape(-1, depth.shape[-1] if depth.ndim else 1)
    out: Float = np.empty(rows.shape, dtype=dtype)
    _coordinates(rows, bounds, boundary == "hard", out)
    return out.reshape(depth.shape)


@kernel
def _coordinates(depth, bounds, hard, out):
    """Fill out (N, W) from depth (N, W)."""
    last = len(bounds) - 2
    for i in prange(len(depth)):
        anchors, row = borrow(bounds), out[i]
        for x in range(len(row)):
            z = depth[i, x]
            if np.isnan(z):
                row[x] = ABSENT
                continue
            k = np.searchsorted(anchors[1 : len(anchors) - 1], z)  # z_(k-1) < z <= z_k
            low, high = anchors[k], anchors[k + 1]
            if hard and k == last:
                t = 1.0 if last > 0 else 0.0
            elif hard and k == 0:
                t = 0.0
            elif high == np.inf:
                t = 1.0 - low / z
            else:
                t = (z - low) / (high - low) if high > low else (1.0 if z > low else 0.0)
            row[x] = k + min(max(t, 0.0), 1.0)


@inline
def matte(x, one, ramp, first):
    """Weight in layer k of a surface with layer coordinate k + x; `one` is 1 in the type of x.

    `first` is True for what a pinhole sees. What lies behind it ends hard at z_k (Eq. (3) of [2]), so that no
    background is blended over nearer layers.
    """
    zero = one - one
    if x >= zero and x <= one:
        return one
    if ramp == 2:
        return zero
    if x < zero:
        return max(one + x, zero)
    if not first or x >= one + one:
        return zero
    return one + one - x if ramp == 0 else x - one

"""Depth formats: how a depth buffer stores a planar depth, and what a reader makes of it.

========  ==========================================  ======================================
linear    d itself                                    in the type of the arithmetic
reversed  near / d, the infinite reversed z           float32: 2^-24 of a depth, near or far
unorm24   far / (far - near) (1 - near / d)           whole numbers 0 .. 2^24 - 1
unorm16   the same                                    whole numbers 0 .. 2^16 - 1
========  ==========================================  ======================================

Every format has a key that grows with depth as far as the format can tell depths apart; the depth test compares keys.
A depth read back is a float64 that is stored as the same key again, so that peeling never meets a surface twice.

References
----------
.. [1] Lapidous & Jiao (1999), Optimal Depth Buffer for Low-Cost Graphics Hardware, Graphics Hardware.
.. [2] Upchurch & Desbrun (2012), Tightening the Precision of Perspective Rendering, Journal of Graphics Tools 16(1).
"""

import math
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float, InputError, as_choice
from refdof._jit import inline

__all__ = ["DEPTH_FORMATS", "DepthCode", "depth_code", "depths_of", "key_of", "keys_of"]

DEPTH_FORMATS = ("linear", "reversed", "unorm24", "unorm16")
_LINEAR, _REVERSED = 0, 1


class DepthCode(NamedTuple):
    """A depth format for kernels: kind (index into `DEPTH_FORMATS`), near, far / (far - near) and the largest key."""

    kind: int
    near: float
    stretch: float
    top: float


def depth_code(depth_format: str, near: float, far: float) -> DepthCode:
    """The code of a format between two planes [any unit], near > 0; far may be infinite.

    Raises
    ------
    InputError
        If the format is unknown, or far is not beyond near.
    """
    kind = DEPTH_FORMATS.index(as_choice("depth_format", depth_format, DEPTH_FORMATS))
    if not far > near:
        raise InputError(f"far: got {far:g}; allowed are values beyond near, {near:g}")
    stretch = 1.0 if math.isinf(far) else far / (far - near)
    return DepthCode(kind, near, stretch, {"unorm24": 2.0**24 - 1, "unorm16": 2.0**16 - 1}.get(depth_format, 0.0))


@inline
def key_of(nearness, code):
    """The key of 1 / depth. Of the formats other than linear the sign is turned where nearer means larger."""
    if code.kind == _LINEAR:
        return 1.0 / nearness
    if code.kind == _REVERSED:
        return -np.float64(np.float32(code.near * nearness))
    return np.rint(min(max(code.stretch * (1.0 - code.near * nearness), 0.0), 1.0) * code.top)


def keys_of(depth: Float, code: DepthCode) -> Float:
    """The keys of depths, which may be infinite: `key_of` for arrays. -inf, nearer than all depths, is kept."""
    if code.kind == _LINEAR:
        return depth
    with np.errstate(divide="ignore"):
        nearness = 1.0 / depth
    if code.kind == _REVERSED:
        keys: Any = -(code.near * nearness).astype(np.float32).astype(np.float64)
    else:
        keys = np.rint(np.clip(code.stretch * (1.0 - code.near * nearness), 0.0, 1.0) * code.top)
    return np.where(np.isneginf(depth), -np.inf, keys)


def depths_of(keys: Float, code: DepthCode) -> Float:
    """The depths that a reader of keys sees: float64 but for the linear format; the key inf is empty and stays so."""
    if code.kind == _LINEAR:
        return keys
    finite = np.where(np.isinf(keys), 0.0, keys)
    with np.errstate(divide="ignore"):
        depth = -code.near / finite if code.kind == _REVERSED else code.near / (1.0 - finite / code.top / code.stretch)
    return np.where(np.isinf(keys), np.inf, np.abs(depth))

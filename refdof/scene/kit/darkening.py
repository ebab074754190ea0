"""Darkening: contact shade and soft shadows as factors for vertex colours; the renderer casts none."""

from collections.abc import Sequence

import numpy as np

from refdof._check import Float
from refdof.scene.kit.noise import smooth

__all__ = ["beside", "capsule_shadow", "corner_shade"]


def beside(points: Float, centre: Sequence[float] | Float, radius: float, reach: float, depth: float) -> Float:
    """Contact shade (N, 1) on the ground around a round foot at `centre` (x, y, z)."""
    distance = np.hypot(points[:, 0] - centre[0], points[:, 2] - centre[2]) - radius
    return (1.0 - depth * np.exp(-np.maximum(distance, 0.0) / reach))[:, None]


def capsule_shadow(
    points: Float,
    foot: Sequence[float] | Float,
    height: float,
    radius: float,
    sun: Sequence[float],
    soft: float,
    depth: float,
) -> Float:
    """Shadow (N, 1) that an upright body of `height` and `radius` casts on the level of its foot.

    `sun` points towards the sun; the rim grows softer away from the foot.
    """
    reach = -height / sun[1] * np.array([sun[0], sun[2]])
    to = points[:, [0, 2]] - np.array([foot[0], foot[2]])
    along = np.clip((to * reach).sum(axis=1) / max((reach * reach).sum(), 1e-12), 0.0, 1.0)
    gap = to - along[:, None] * reach
    width = soft * (0.25 + along)
    rim = smooth(-width, width, np.sqrt((gap * gap).sum(axis=1)) - radius)
    return (1.0 - depth * (1.0 - 0.35 * along) * (1.0 - rim))[:, None]


def corner_shade(distance: Float, reach: float, depth: float) -> Float:
    """Shade (N, 1) where two surfaces meet, from the distance (N,) to the meeting line."""
    return (1.0 - depth * np.exp(-np.abs(distance) / reach))[:, None]

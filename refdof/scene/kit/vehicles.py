"""Vehicles: a small car, nose towards +z, its wheels on the ground."""

import numpy as np

from refdof.scene.kit.mesh import Mesh, join
from refdof.scene.kit.shapes import box, lathe, surface

__all__ = ["car"]

# Side view (z, y) of the body from the rear sill over the roof to the front sill.
_BODY = (
    (-2.0, 0.35),
    (-2.05, 0.55),
    (-2.02, 0.85),
    (-1.75, 0.95),
    (-1.1, 1.0),
    (0.75, 0.98),
    (1.55, 0.86),
    (1.95, 0.7),
    (2.05, 0.5),
    (2.0, 0.35),
)
_CABIN = ((-1.75, 0.94), (-1.35, 1.3), (-0.95, 1.44), (0.0, 1.47), (0.35, 1.42), (0.7, 1.2), (1.0, 0.95))


def car() -> dict[str, Mesh]:
    """Meshes by name: "paint", "glass", "black", "rear" (two lamps) and "front" (two lamps)."""
    body = join([_shell(_BODY, 0.82, 0.86), _side(_BODY, 0.82, 0.35)])
    roof = _shell(_CABIN[1:6], 0.62, 0.66)
    glass = join([_shell(_CABIN[:3], 0.64, 0.78), _shell(_CABIN[4:], 0.64, 0.78), _side(_CABIN, 0.68, 0.9)])
    wheel = lathe(
        [
            [(0.0, -0.1), (0.19, -0.1)],
            [(0.19, -0.1), (0.2, -0.12), (0.31, -0.1), (0.33, 0.0), (0.31, 0.1), (0.2, 0.12), (0.19, 0.1)],
            [(0.19, 0.1), (0.0, 0.1)],
        ],
        16,
    )
    wheel = wheel.turned("z", 90)
    wheels = [wheel.moved(s * 0.74, 0.33, z) for s in (-1, 1) for z in (-1.25, 1.3)]
    bumpers = [box(1.66, 0.18, 0.12).moved(0, 0.36, z) for z in (-2.02, 2.0)]
    rear = [box(0.3, 0.12, 0.04).moved(s * 0.58, 0.68, -2.05) for s in (-1, 1)]
    front = [
        lathe([[(0.0, 0.04), (0.1, 0.03), (0.12, 0.0)]], 12).turned("x", 90).moved(s * 0.56, 0.64, 2.0) for s in (-1, 1)
    ]
    return {
        "paint": join([body, roof]),
        "glass": glass,
        "black": join([*wheels, *bumpers]),
        "rear": join(rear),
        "front": join(front),
    }


def _shell(profile: tuple, narrow: float, wide: float) -> Mesh:
    """Skin across the car along a side view, its edges rounded inwards."""
    z, y = np.asarray(profile).T[:, :, None]
    x = np.array([[-wide, -narrow, -0.5 * narrow, 0.0, 0.5 * narrow, narrow, wide]])
    drop = np.array([[0.05, 0.0, -0.012, -0.016, -0.012, 0.0, 0.05]])
    return surface(np.stack([x + 0 * z, y - drop, z + 0 * x], axis=-1))


def _side(profile: tuple, half: float, sill: float) -> Mesh:
    """Both flanks, down to the sill."""
    z, y = np.asarray(profile).T
    flanks = []
    for s in (-1, 1):
        rows = [
            np.column_stack([np.full(len(z), s * (half + 0.05 * np.sin(np.pi * t))), sill + t * (y - sill), z])
            for t in np.linspace(0.02, 1, 6)
        ]
        flanks.append(surface(np.stack(rows)))
    return join(flanks)

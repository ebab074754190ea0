"""NAME: three balls on a floor before a wall, the nearest in focus."""

from collections.abc import Iterator

import numpy as np

from refdof.scene.kit.shapes import plane, sphere
from refdof.scene.kit.shot import Shot
from refdof.scene.material import Material
from refdof.scene.scene import Part

__all__ = ["NUMBERS", "build"]

NUMBERS = ("spacing",)

_RADIUS = 0.25
_COLORS = ((0.7, 0.2, 0.1), (0.2, 0.5, 0.2), (0.2, 0.3, 0.7))


def build(shot: Shot, rng: np.random.Generator) -> Iterator[Part]:
    """Parts of the scene."""
    yield plane((-8, 0, 1), (16, 0, 0), (0, 0, -9), (40, 40)).part(Material(base_color=(0.4, 0.37, 0.33)))
    yield plane((-8, 0, -8), (16, 0, 0), (0, 8, 0), (20, 20)).part(Material(base_color=(0.6, 0.6, 0.55)))
    for k, color in enumerate(_COLORS):
        x, z = -0.5 + 0.6 * k + rng.uniform(-0.05, 0.05), -2.1 - shot.numbers["spacing"] * k
        yield sphere(_RADIUS, 32, 64).moved(x, _RADIUS, z).part(Material("phong", color, specular=(0.1, 0.1, 0.1)))

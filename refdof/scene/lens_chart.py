"""Lens chart: a black card with white squares in the plane in focus, from the middle of the picture to its corner.

A lens draws the same at every place of the picture that is as far from its middle. So the chart is a strip through the
middle, along which the distance grows to that of the corner: few pixels show all of the field, at twice the picture's
scale. The upper row has squares, whose edges show blur and fringes; the lower one stars, small squares of light that
become what the lens makes of a point.
"""

import math
from typing import NamedTuple

import numpy as np

from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens
from refdof.scene.material import Material
from refdof.scene.scene import Part, Scene

__all__ = ["MAGNIFICATION", "LensChart", "lens_chart", "patch"]

MAGNIFICATION = 2  # of the strip over the picture
_SLENDER = 16  # the strip from the middle to the corner over its height
_SLANT = 8.0  # of the squares against the rows [degrees], so that edges do not fall between pixels
_SQUARE, _STAR = 0.5, 0.1  # sides over those of a cell; 2 px at least, as most methods look at pixel centres only
_STARLIGHT = 4.0  # over the light of the squares
_SHARP_PX = 0.02  # radius of the chart's circle of confusion where the lens is focused at infinity
_CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


class LensChart(NamedTuple):
    """The chart, a camera that sees it, and the window of the picture from the middle to the corner."""

    scene: Scene
    camera: Camera
    window: slice  # of columns


def lens_chart(camera: Camera, lens: ThinLens) -> LensChart:
    """The chart before the lens whose own field of view the camera has."""
    corner = round(MAGNIFICATION * math.hypot(*camera.size) / 2.0)
    cell = max(2, round(corner / _SLENDER / 2.0))
    count = math.ceil(corner / cell) + 1  # one more than is shown: what is at the border is whole
    pixels = MAGNIFICATION * camera.pixels_per_tangent
    angle = math.degrees(2.0 * math.atan(cell / pixels))
    strip = Camera((0, 0, 0), (0, 0, -1), fov_y=angle, size=(2 * count * cell, 2 * cell))
    far = pixels * lens.radius / _SHARP_PX
    depth = min(lens.focus_distance, far)
    parts = [
        patch(strip, side * (column + 0.5) * cell, row * cell, depth, max(share * cell / 2.0, 1.0), light, slant=_SLANT)
        for column in range(count)
        for row, share, light in ((0.5, _SQUARE, 1.0), (-0.5, _STAR, _STARLIGHT))
        for side in (-1.0, 1.0)
    ]
    scene = Scene.from_parts("lens chart", parts, strip, lens, background=(0.0, 0.0, 0.0))
    return LensChart(scene, strip, slice(count * cell, count * cell + corner))


def patch(
    camera: Camera,
    x: float,
    y: float,
    depth: float,
    half: float,
    light: float = 1.0,
    half_y: float | None = None,
    slant: float = 0.0,
) -> Part:
    """An upright rectangle of light before a camera at the origin that looks down -z.

    `x` and `y` are its place from the picture's centre, right and up, and `half` and `half_y` half its sides [px];
    `slant` turns it [degrees].
    """
    turn = math.radians(slant)
    sides = _CORNERS * [half, half if half_y is None else half_y]
    sides = sides @ [[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]]
    corners = np.column_stack([np.add(sides, (x, y)), np.full(4, -camera.pixels_per_tangent)])
    material = Material("unlit", base_color=(0.0, 0.0, 0.0), emission=(light, light, light))
    return Part(corners * (depth / camera.pixels_per_tangent), np.array([[0, 1, 2], [0, 2, 3]]), material)

"""Kernel shape: what a method makes of one small light on a wall of constant circle, beside the ideal disc.

The wall is black and fills the picture; the light is a square of whole pixels in it. So each method, whatever it starts
from, sees an impulse: single-image methods in their pinhole picture, others in the triangles. Methods on mip levels do
not treat all pixels alike, so the light stands at four places, and the four spots are laid over each other.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from importlib.metadata import version
from typing import Any, NamedTuple

import numpy as np

from refdof._check import as_bool, as_instance, as_integer, as_number
from refdof._jit import JIT_DISABLED, source_digest
from refdof._store import stored
from refdof.methods._contract import REACH
from refdof.metrics.artefacts import disc_radius, moments
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens
from refdof.rendering import make_params, render_view
from refdof.scene.material import Material
from refdof.scene.scene import Part, Scene
from refdof.view import View

__all__ = ["KernelShape", "kept_kernel_shapes", "kernel_shape"]

_PLACES = ((0, 0), (1, 2), (2, 3), (3, 1))  # px: every row and column of 4 x 4 once, as mip levels 1 and 2 have them
_FOCUS, _WALL = 1.0, 2.0  # depths; swapped where the wall is in front of focus


class KernelShape(NamedTuple):
    """A method's kernel beside the ideal disc, of unit energy around the light's middle.

    radius : RMS radius over the disc's, the light's own size taken off
    offset_x, offset_y : centroid minus the light's middle [px], y down
    anisotropy : of the second moments, 0 is round; see `refdof.metrics.artefacts.Moments`
    energy : light in the picture over the light's own
    """

    radius: float
    offset_x: float
    offset_y: float
    anisotropy: float
    energy: float


def kernel_shape(
    method: str,
    circle: float = 8.0,
    light: int = 1,
    in_front: bool = False,
    preset: str = "best",
    params: Mapping[str, Any] | None = None,
) -> KernelShape:
    """Measure a method's kernel.

    Parameters
    ----------
    method : str
        A name in `refdof.METHODS`.
    circle : float
        Radius of confusion of the wall [px], 2 .. 32.
    light : int
        Side of the light [px], 1 .. 8.
    in_front : bool
        The wall is in front of the focal plane instead of behind it.
    preset, params
        As of `refdof.render`.

    Returns
    -------
    KernelShape
        NaN, but for `energy`, of a method that loses the light.

    Raises
    ------
    InputError
        If the method, a parameter or a number is not allowed.
    """
    circle = as_number("circle", circle, minimum=2.0, maximum=32.0)
    light = as_integer("light", light, minimum=1, maximum=8)
    in_front = as_bool("in_front", in_front)
    given = {} if params is None else dict(as_instance("params", params, Mapping))
    make_params(method, given, preset)
    reach = math.ceil(REACH * circle) + light
    total = np.zeros((2 * reach + light, 2 * reach + light))
    for x, y in _PLACES:
        image = render_view(method, _view(circle, light, in_front, reach, (x, y)), preset=preset, **given).image
        total += image[y : y + len(total), x : x + len(total)].mean(axis=2, dtype=np.float64)
    found = moments(total)
    own = (light * light - 1.0) / 6.0  # variance of the light's pixel centres, both axes together
    spread = found.radius**2 - own
    radius = 0.0 if spread < 0.0 else math.sqrt(spread) / disc_radius(circle)
    middle = reach + light / 2.0
    energy = found.energy / (len(_PLACES) * light * light)
    return KernelShape(radius, found.x - middle, found.y - middle, found.anisotropy, energy)


def kept_kernel_shapes(
    methods: Sequence[tuple[str, str, Mapping[str, Any]]], progress: Callable[[int, int], None]
) -> list[KernelShape]:
    """`kernel_shape` of methods, presets and parameters, from the store if an earlier run measured them."""
    sources = source_digest(), version("embreex"), JIT_DISABLED
    shapes = []
    for k, (method, preset, params) in enumerate(methods):
        progress(k, len(methods))
        parts = sources, method, make_params(method, dict(params), preset)
        shapes.append(KernelShape(*stored("kernels", parts, partial(_as_tuple, method, preset=preset, params=params))))
    return shapes


def _as_tuple(method: str, **words: Any) -> tuple[float, ...]:
    return tuple(kernel_shape(method, **words))


def _view(circle: float, light: int, in_front: bool, reach: int, place: tuple[int, int]) -> View:
    """The wall, with the light `reach` px from the left and the upper border, moved by `place`."""
    side = 2 * reach + light + 4
    side += side % 2  # so that the axis lies between pixels
    focus, wall = (_WALL, _FOCUS) if in_front else (_FOCUS, _WALL)
    # P = side pixels per unit tangent.
    camera = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=2.0 * math.degrees(math.atan(0.5)), size=(side, side))
    radius = circle / (camera.pixels_per_tangent * abs(1.0 / focus - 1.0 / wall))
    columns, rows = ([-side, reach + start, reach + start + light, 2 * side] for start in place)
    x = (np.array(columns) / side - 0.5) * wall
    y = (0.5 - np.array(rows) / side) * wall
    parts = []
    for j in range(3):
        for i in range(3):
            corners = [[x[i], y[j]], [x[i], y[j + 1]], [x[i + 1], y[j + 1]], [x[i + 1], y[j]]]
            lit = 1.0 if (i, j) == (1, 1) else 0.0
            paint = Material("unlit", base_color=(0.0, 0.0, 0.0), emission=(lit, lit, lit))
            points = np.column_stack([corners, np.full(4, -wall)])
            parts.append(Part(points, np.array([[0, 1, 2], [0, 2, 3]]), paint))
    lens = ThinLens(radius, focus)
    return View(Scene.from_parts("impulse", parts, camera, lens), camera, lens)

"""Cases of geometry: a wall that hides all of a bright background must hide it however it is made of triangles."""

import numpy as np

from refdof._check import Float, Index
from refdof.optics.lens import ThinLens
from refdof.scene.material import Material
from refdof.scene.scene import Part
from refdof.stability.cases.case import Case
from refdof.stability.checks import constant, convex, exact_circles
from refdof.stability.subjects import PIXELS, depth_of, mosaic, view_of_parts, wall
from refdof.view import View

__all__ = ["CASES"]

_SIZE = (33, 25)
_LENS = ThinLens(0.25, 2.0)
_NEAR = 1.0  # depth of circles of 4 px
_ONE = (0.3, 0.6, 0.9)
_OTHER = (0.6, 0.3, 0.1)
_LEAK = (9.0, 9.0, 9.0)


def _mesh(x: Float, y: Float, depth: float, color: tuple[float, float, float] = _ONE) -> Part:
    """A wall of triangles between lines at x and y [px from the middle]."""
    grid_x, grid_y = np.meshgrid(x, y)
    corners = np.stack([grid_x * depth / PIXELS, grid_y * depth / PIXELS, np.full(grid_x.shape, -depth)], axis=-1)
    columns = len(x)
    first = (np.arange(len(y) - 1)[:, None] * columns + np.arange(columns - 1)).ravel()[:, None]
    faces: Index = np.add(first[:, None], [[0, 1, columns + 1], [0, columns + 1, columns]]).reshape(-1, 3)
    return Part(corners.reshape(-1, 3), faces, Material("unlit", base_color=color))


def _hiding(*parts: Part) -> View:
    return view_of_parts(list(parts), _SIZE, _LENS, _LEAK)


def _centres() -> View:
    """Vertices on all pixel centres, edges along all rows and columns of centres."""
    steps = np.arange(-60.0, 61.0)  # an odd picture's middle is a pixel centre
    return _hiding(_mesh(steps, steps, _NEAR))


def _duplicates(second: tuple[float, float, float]) -> View:
    return _hiding(wall(_NEAR, _ONE), wall(_NEAR, second))


def _slivers() -> View:
    """Strips of 1e-9 px and of nothing at all between wide ones."""
    x = np.arange(-60.0, 61.0, 4.0)
    lines = np.sort(np.concatenate([x, x, x + 1e-9, np.nextafter(x, 99.0)]))
    return _hiding(_mesh(lines, np.array([-60.0, 0.3, 60.0]), _NEAR))


def _through_lens(background: tuple[float, float, float]) -> View:
    """A floor from far ahead to behind the eye, through the plane of the lens, and a wall."""
    floor = np.array([[-90.0, -0.5, 90.0], [90.0, -0.5, 90.0], [90.0, -0.5, -90.0], [-90.0, -0.5, -90.0]])
    part = Part(floor, np.array([[0, 1, 2], [0, 2, 3]]), Material("unlit", base_color=_ONE))
    return view_of_parts([part], _SIZE, _LENS, background)


def _in_lens() -> View:
    """A triangle in the plane of the lens itself, and a wall behind it."""
    flat = Part(
        np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]]),
        np.array([[0, 1, 2]]),
        Material("unlit", base_color=_OTHER),
    )
    return _hiding(flat, wall(_NEAR, _ONE))


def _on_bounds() -> View:
    """Depths whose circles are whole px apart, as the bounds of layers are, before a wall."""
    steps = np.random.default_rng(12).integers(-4, 3, (25, 33))
    steps[0, :2] = (-4, 2)
    depth = np.vectorize(lambda step: depth_of(float(step), _LENS))(steps)
    color = np.broadcast_to(np.array(_ONE), (25, 33, 3))
    card = mosaic(color, depth, _LENS, _LEAK).scene
    part = Part(card.vertices, card.faces, card.materials[0], color=card.color)
    return _hiding(part, wall(depth_of(2.0, _LENS), _ONE, 400.0))


def _steep() -> View:
    """A plane that contains the line of sight of the middle column but for 1e-9, and a wall."""
    across = np.array([[0.0, -9.0, -0.5], [0.0, 9.0, -0.5], [1e-9, 9.0, -8.0], [1e-9, -9.0, -8.0]])
    part = Part(across, np.array([[0, 1, 2], [0, 2, 3]]), Material("unlit", base_color=_ONE))
    return _hiding(part, wall(_NEAR * 3.0, _ONE))


CASES = (
    Case("centres", "geometry", "vertices and edges on pixel centres", _centres, (exact_circles, constant(_ONE))),
    Case(
        "duplicates",
        "geometry",
        "each triangle twice, of one colour",
        lambda: _duplicates(_ONE),
        (exact_circles, constant(_ONE)),
    ),
    Case(
        "duplicates-apart",
        "geometry",
        "each triangle twice, of two colours: one wins everywhere, the first",
        lambda: _duplicates(_OTHER),
        (exact_circles, constant(_ONE)),
    ),
    Case(
        "slivers",
        "geometry",
        "triangles of a width of 1e-9 px, of one step of float64, and of none",
        _slivers,
        (exact_circles, constant(_ONE)),
    ),
    Case(
        "through-lens",
        "geometry",
        "triangles from behind the eye to the horizon, of the background's colour",
        lambda: _through_lens(_ONE),
        (constant(_ONE),),
    ),
    Case(
        "through-lens-apart",
        "geometry",
        "the same before a background of another colour",
        lambda: _through_lens(_OTHER),
        (convex(np.minimum(_ONE, _OTHER), np.maximum(_ONE, _OTHER)),),
    ),
    Case("in-lens", "geometry", "a triangle in the plane of the lens", _in_lens, (exact_circles, constant(_ONE))),
    Case(
        "bounds",
        "geometry",
        "depths on the bounds of layers, rays along them",
        _on_bounds,
        (exact_circles, constant(_ONE)),
    ),
    Case("edge-on", "geometry", "a plane seen edge-on", _steep, (exact_circles, constant(_ONE))),
)

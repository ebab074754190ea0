"""Cards: small scenes of flat cards whose right pictures are known, as views and as arrays.

The camera stands at the origin and looks down -z with `PIXELS` per unit tangent; the plane in focus is at depth 1.
A circle of confusion of c px is at depth 1 / (1 - c / (PIXELS radius)).
"""

import math
from typing import NamedTuple

import numpy as np

from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens
from refdof.scene.lens_chart import patch
from refdof.scene.material import Material
from refdof.scene.scene import Part, Scene
from refdof.view import View

__all__ = ["PIXELS", "Card", "card_view", "depth_of", "room_view", "slanted_view"]

PIXELS = 100.0


class Card(NamedTuple):
    """An upright card: its middle from the picture's and half its sides [px], circle of confusion [px], grey."""

    x: float
    y: float
    half_x: float
    half_y: float
    coc: float
    light: float


def depth_of(coc: float, radius: float) -> float:
    """The depth at which a lens of this radius has a circle of confusion [px]."""
    return 1.0 / (1.0 - coc / (PIXELS * radius))


def _camera(size: tuple[int, int]) -> Camera:
    fov_y = 2.0 * math.degrees(math.atan(size[1] / (2.0 * PIXELS)))
    return Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=fov_y, size=size)


def _view(parts: list[Part], camera: Camera, radius: float, background: float) -> View:
    lens = ThinLens(radius, 1.0)
    return View(Scene.from_parts("cards", parts, camera, lens, (background,) * 3), camera, lens)


def card_view(cards: list[Card], size: tuple[int, int], radius: float, background: float = 0.0) -> View:
    """A view of cards before a background at infinity."""
    camera = _camera(size)
    parts = [
        patch(camera, card.x, card.y, depth_of(card.coc, radius), card.half_x, card.light, card.half_y)
        for card in cards
    ]
    return _view(parts, camera, radius, background)


def slanted_view(reach: float, size: tuple[int, int], radius: float, light: float, background: float) -> View:
    """A plane that fills the picture, whose circle of confusion grows along x from -reach to reach [px] across it."""
    camera, strips = _camera(size), 24
    half_x, half_y = 2.0 * size[0], 2.0 * size[1]
    x = np.linspace(-half_x, half_x, strips + 1)
    coc = np.clip(reach * x / (size[0] / 2.0), -4.0 * reach, 4.0 * reach)
    depth = np.array([depth_of(c, radius) for c in coc])
    low, high = (np.stack([x * depth / PIXELS, s * half_y * depth / PIXELS, -depth], axis=1) for s in (-1.0, 1.0))
    k, n = np.arange(strips), strips + 1
    faces = np.concatenate([np.stack([k, k + 1, n + k + 1], axis=1), np.stack([k, n + k + 1, n + k], axis=1)])
    material = Material("unlit", base_color=(light,) * 3)
    return _view([Part(np.concatenate([low, high]), faces, material)], camera, radius, background)


def room_view(seed: int, size: tuple[int, int], radius: float) -> View:
    """A closed room with twelve turned boxes in it, all of grey up to 1, before a background of 1000 that no ray sees.

    Depths are in units of the distance to the plane in focus.
    """
    random = np.random.default_rng(seed)
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    faces = np.array([[quad[0], quad[i], quad[i + 1]] for quad in quads for i in (1, 2)])
    parts = [Part(corners * [2.4, 1.8, 2.8] - [1.2, 0.9, 2.6], faces, Material("unlit", base_color=(0.5,) * 3))]
    for _ in range(12):
        sides, place = random.uniform(0.02, 0.3, 3), random.uniform([-0.6, -0.5, -2.2], [0.4, 0.3, -0.6])
        turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
        grey = float(random.random())
        parts.append(Part((corners * sides) @ turn + place, faces, Material("unlit", base_color=(grey,) * 3)))
    return _view(parts, _camera(size), radius, 1000.0)

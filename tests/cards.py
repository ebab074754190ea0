"""Random scenes of flat cards, and their exact pictures by cutting polygons on the lens.

Seen from the point on the focal plane that belongs to a pixel, each card covers an affine image of itself on the
lens. Cards taken front to back claim what is left of the lens; the claimed areas weigh the colours.
"""

from dataclasses import dataclass

import numpy as np
import shapely

from refdof import Camera, Part, Scene, ThinLens
from tests import flat_scene

# A polygon of the unit disc's area. It leaves the circle by less than (pi / n)^2 / 2 = 7.5e-5, inwards and outwards
# by the same area on every side, so that only the sides a card's outline crosses count: each crossing errs by
# less than 7.5e-5 * (2 pi / n) / pi = 6e-7 of the disc. A dozen crossings, and distances between colours of at most 1:
_SIDES = 256
TRUTH_ERROR = 1e-5


@dataclass(frozen=True)
class Cards:
    scene: Scene
    truth: np.ndarray  # (H, W, 3)
    blurred: np.ndarray  # (H, W) bool: the lens sees more than one colour


def random_cards(seed, width=12, height=9, p=12.0):
    """Three to six cards before, in and behind the focal plane, some concave, seen from anywhere."""
    random = np.random.default_rng([seed, 20])
    focus = random.uniform(1.0, 4.0)
    radius = focus * random.choice([0.03, 0.1, 0.3, 0.6])
    count = random.integers(3, 7)
    near = np.where(random.random(count) < 0.5, random.uniform(0.4, 0.95, count), random.uniform(1.05, 5.0, count))
    near[0] = random.choice([0.7, 1.0, 1.6])  # in one scene of three, a card lies in the focal plane
    depth = focus * near
    color = random.uniform(0.0, 1.0, (count + 1, 3))
    outline = [_star(random, width / p, height / p) * d for d in depth]

    backward, right, up = _axes(random)
    eye = random.normal(0.0, 3.0, 3)
    parts = []
    for corners, d, rgb in zip(outline, depth, color, strict=False):
        points = np.concatenate([[corners.mean(axis=0)], corners])
        world = eye + points[:, :1] * right + points[:, 1:] * up - d * backward
        k = np.arange(len(corners))
        parts.append(Part(world, np.stack([0 * k, k + 1, (k + 1) % len(k) + 1], axis=1), flat_scene.paint(tuple(rgb))))
    shot = Camera.look_at(eye, eye - backward, up, flat_scene.camera(width, height, p).fov_y, (width, height))
    scene = flat_scene.scene_of(parts, shot, ThinLens(radius, focus), tuple(color[-1]))
    share = lens_shares(outline, depth, flat_scene.tangents(width, height, p), radius, focus)
    return Cards(scene, share @ color, share.max(axis=-1) < 1.0 - TRUTH_ERROR)


def lens_shares(outlines, depths, tangents, radius, focus):
    """Share (H, W, N + 1) of the lens through which each card is seen; the last one is the background's."""
    tangents = np.stack(tangents, axis=-1)
    angle = 2.0 * np.pi * np.arange(_SIDES) / _SIDES
    equal = np.sqrt(np.pi / (_SIDES / 2.0 * np.sin(2.0 * np.pi / _SIDES)))
    lens = shapely.Polygon(equal * np.stack([np.cos(angle), np.sin(angle)], axis=1))
    left = np.full(tangents.shape[:-1], lens)
    area = np.full(left.shape, lens.area)
    share = np.zeros((*left.shape, len(depths) + 1))
    for k in np.argsort(depths):
        outline, depth = outlines[k], depths[k]
        if depth == focus:  # the whole lens sees one point
            seen = shapely.contains_xy(shapely.Polygon(outline), tangents[..., 0] * depth, tangents[..., 1] * depth)
            left = np.where(seen, shapely.Polygon(), left)
        else:
            # A ray through lens point E v and focal point t f is at E v (1 - d / f) + t d at depth d.
            on_lens = (outline - tangents[..., None, :] * depth) / (radius * (1.0 - depth / focus))
            left = shapely.difference(left, shapely.polygons(on_lens))
        share[..., k] = area - shapely.area(left)
        area = shapely.area(left)
    share[..., -1] = area
    return share / lens.area


def _star(random, width, height):
    """A polygon that is star-shaped about the mean of its corners, in tangents."""
    while True:
        corners = random.integers(3, 9)
        angle = 2.0 * np.pi * (np.arange(corners) + random.uniform(0.0, 0.6, corners)) / corners
        reach = random.uniform(0.1, 0.6) * random.uniform(0.4, 1.0, corners)
        points = np.stack([np.cos(angle), np.sin(angle)], axis=1) * reach[:, None]
        points += (random.random(2) - 0.5) * [width, height]
        spoke = points - points.mean(axis=0)
        turn = spoke[:, 0] * np.roll(spoke[:, 1], -1) - spoke[:, 1] * np.roll(spoke[:, 0], -1)
        # Every triangle of the fan turns the same way and once around: the fan is the polygon.
        if (turn > 1e-3).all() and shapely.Polygon(points).is_valid:
            return points


def _axes(random):
    """Backward, right and up of a random pose."""
    axes, _ = np.linalg.qr(random.normal(size=(3, 3)))
    backward, right = axes[:, 0], axes[:, 1]
    return backward, right, np.cross(backward, right)

"""A flat scene for tests of pictures: a camera at the origin that looks down -z, and flat cards in front of it.

With the camera there, camera space is world space, and a point (x, y, -d) has its pinhole image at
(W / 2 + P x / d, H / 2 - P y / d) pixels.
"""

import math

import numpy as np

from refdof import Camera, Material, Part, Scene, ThinLens


def camera(width, height, pixels_per_tangent):
    """A camera with a given P [px per unit tangent]."""
    fov_y = 2.0 * math.degrees(math.atan(height / (2.0 * pixels_per_tangent)))
    return Camera.look_at((0, 0, 0), (0, 0, -1), fov_y=fov_y, size=(width, height))


def tangents(width, height, pixels_per_tangent):
    """Tangents (H, W) right and up of the pixel centres."""
    x = (np.arange(width) + 0.5 - width / 2) / pixels_per_tangent
    y = (height / 2 - np.arange(height) - 0.5) / pixels_per_tangent
    return np.broadcast_to(x, (height, width)), np.broadcast_to(y[:, None], (height, width))


def paint(color):
    """A material whose colour no light changes."""
    return Material("unlit", base_color=color)


def rectangle(x0, x1, y0, y1, depth, color=(1.0, 1.0, 1.0)):
    """An upright rectangle at one depth, in scene units."""
    corners = np.array([[x0, y0, -depth], [x1, y0, -depth], [x1, y1, -depth], [x0, y1, -depth]])
    return Part(corners, [[0, 1, 2], [0, 2, 3]], paint(color))


def strips(x, depth, y0, y1, value):
    """A ribbon of len(x) - 1 upright strips through (x, depth), with grey `value` at each x as vertex colours."""
    x, depth, value = np.broadcast_arrays(x, depth, value)
    low = np.stack([x, np.full(len(x), y0), -depth], axis=1)
    high = np.stack([x, np.full(len(x), y1), -depth], axis=1)
    k, n = np.arange(len(x) - 1), len(x)
    faces = np.concatenate([np.stack([k, k + 1, n + k + 1], axis=1), np.stack([k, n + k + 1, n + k], axis=1)])
    grey = np.repeat(np.tile(value, 2)[:, None], 3, axis=1)
    return Part(np.concatenate([low, high]), faces, paint((1.0, 1.0, 1.0)), color=grey)


def scene_of(parts, shot, lens=None, background=(0.0, 0.0, 0.0), light=None):
    """A scene with these parts."""
    return Scene.from_parts("stage", parts, shot, lens or ThinLens(0.0, 1.0), background, light)

"""A shiny surface under a lens: every lens point sees another reflection, against an integral taken here."""

import numpy as np
import pytest

import refdof
from refdof import Camera, Light, Material, Part, Scene, ThinLens

SIZE, FOV = (7, 5), 40.0
EYE, TARGET = np.array([1.0, 2.0, 3.0]), np.array([0.5, 0.2, -1.0])
RADIUS, FOCUS = 0.4, 1.5
NORMAL = np.array([0.3, 0.8, 0.5]) / np.linalg.norm([0.3, 0.8, 0.5])
BASE, SPECULAR, SHININESS = np.array([0.2, 0.1, 0.3]), np.array([0.5, 0.7, 0.9]), 20.0
SUN_AT = np.array([-0.2, 0.9, -0.3]) / np.linalg.norm([-0.2, 0.9, -0.3])
SUN, SKY, GROUND = np.array([2.0, 1.5, 1.0]), np.array([0.3, 0.5, 0.9]), np.array([0.3, 0.2, 0.1])
TEXELS = 64


def glow(direction):
    """A smooth environment, positive everywhere."""
    x, y, z = np.moveaxis(direction, -1, 0)
    return np.stack([1.2 + x, 1.0 + 0.5 * y * z, 1.3 + np.sin(3 * z)], axis=-1)


def octahedron():
    """`glow` at the texels: column and row are x and z of the direction projected on |x| + |y| + |z| = 1."""
    p, q = np.meshgrid(*2 * [(np.arange(TEXELS) + 0.5) / TEXELS * 2 - 1])
    y = 1.0 - np.abs(p) - np.abs(q)
    folded = np.maximum(-y, 0.0)  # the lower half is folded outwards
    direction = np.stack([p - np.copysign(folded, p), y, q - np.copysign(folded, q)], axis=-1)
    return glow(direction / np.linalg.norm(direction, axis=-1, keepdims=True))


def scene(light):
    across = np.cross(NORMAL, [0.0, 0.0, 1.0])
    along = np.cross(NORMAL, across)
    corners = TARGET + 40.0 * np.array([-across - along, across - along, across + along, along - across])
    material = Material("phong", tuple(BASE), specular=tuple(SPECULAR), shininess=SHININESS)
    shot = Camera.look_at(tuple(EYE), tuple(TARGET), fov_y=FOV, size=SIZE)
    lens = ThinLens(RADIUS, FOCUS)
    return Scene.from_parts("mirror", [Part(corners, [[0, 1, 2], [0, 2, 3]], material)], shot, lens, (9, 9, 9), light)


def integral(pixel, environment, radius=RADIUS):
    """The mean over 300 x 300 lens points of equal area; midpoint rule, off by the second power of the step."""
    backward = (EYE - TARGET) / np.linalg.norm(EYE - TARGET)
    right = np.cross([0.0, 1.0, 0.0], backward)
    right /= np.linalg.norm(right)
    up = np.cross(backward, right)
    tangent = 2.0 * np.tan(np.radians(FOV) / 2.0) / SIZE[1]
    x, y = (pixel[0] + 0.5 - SIZE[0] / 2) * tangent, (SIZE[1] / 2 - pixel[1] - 0.5) * tangent
    r, turn = np.sqrt((np.arange(300) + 0.5) / 300), 2 * np.pi * (np.arange(300) + 0.5) / 300
    v = radius * np.stack([np.outer(r, np.cos(turn)).ravel(), np.outer(r, np.sin(turn)).ravel()], axis=1)
    target = FOCUS * (x * right + y * up - backward)
    direction = target - v[:, :1] * right - v[:, 1:] * up
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    mirrored = direction - 2.0 * (direction @ NORMAL)[:, None] * NORMAL
    albedo = SUN * max(0.0, NORMAL @ SUN_AT) + GROUND + (SKY - GROUND) * (1.0 + NORMAL[1]) / 2.0
    lobe = np.maximum(mirrored @ SUN_AT, 0.0)[:, None] ** SHININESS
    return (BASE * albedo + SPECULAR * (SUN * lobe + environment(mirrored))).mean(axis=0)


def dome(direction):
    return GROUND + (SKY - GROUND) * (1.0 + direction[:, 1:2]) / 2.0


@pytest.mark.parametrize(("painted", "environment"), [(False, dome), (True, glow)])
def test_every_lens_ray_is_mirrored_by_itself(painted, environment):
    light = Light(tuple(SUN_AT), tuple(SUN), tuple(SKY), tuple(GROUND), octahedron() if painted else None)
    result = refdof.reference(scene(light), samples=1 << 15)
    # The midpoint rule and float32 normals: below 1e-5. Between 64 texels of 1/32 a smooth map is interpolated with
    # an error of (step / 4)^2 / 8 * the second derivative below 9 * (stretch <= 3)^2 in direction: 2e-3 at the most.
    room = 2e-3 if painted else 1e-5
    for pixel in ((0, 0), (3, 2), (5, 4)):
        truth = integral(pixel, environment)
        got, error = result.image[pixel[1], pixel[0]], result.standard_error[pixel[1], pixel[0]]
        np.testing.assert_array_less(np.abs(got - truth), 6 * error + room)
        # The pinhole's reflection is another: a surface shaded once per pixel would be found out.
        assert (np.abs(integral(pixel, environment, 1e-9) - truth) > 3 * (6 * error + room)).any()

"""Attributes stored in layers shade to the colours that shading at once gives, and to numbers computed by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest

from refdof import Light, Material, Part, ThinLens, View
from refdof._jit import tile_kernel
from refdof.raster.rays.gbuffer import GBUFFER_CHANNELS, gbuffer_of, shade_gbuffer
from tests import flat_scene

pytestmark = pytest.mark.fast

FLOAT32 = 2.0**-23


@tile_kernel
def shade_all(surfaces, attributes, directions):
    out = np.empty((len(attributes), 3))
    for k in range(len(attributes)):
        out[k, 0], out[k, 1], out[k, 2] = shade_gbuffer(
            surfaces, attributes[k], directions[k, 0], directions[k, 1], directions[k, 2]
        )
    return out


def materials():
    texture = np.linspace(0.0, 1.0, 4 * 5 * 3, dtype=np.float32).reshape(4, 5, 3)
    return [
        Material("phong", (0.6, 0.5, 0.3), specular=(0.4, 0.4, 0.5), shininess=9.0, emission=(0.1, 0.2, 0.05)),
        Material("unlit", texture=texture, emission=(0.2, 0.1, 0.3)),
        Material("lambert", (0.2, 0.8, 0.4)),
    ]


def test_same_colours_as_shading_at_once():
    random = np.random.default_rng(4)
    shot = flat_scene.camera(16, 12, 12.0)
    parts = []
    for k, material in enumerate(materials()):
        corners = np.array([[-2.0, -2.0, -2.0 - k], [2.0, -2.0, -3.0 - k], [0.0, 3.0, -2.5 - k]])
        normal = corners * [1, 1, 0] * 0.2 + [0, 0, 1]
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        parts.append(Part(corners, [[0, 1, 2]], material, random.random((3, 2)), random.random((3, 3)), normal))
    view = View(flat_scene.scene_of(parts, shot), shot, ThinLens(0.1, 2.0))
    layers = view.layers(3)
    attributes = gbuffer_of(view.surfaces(), view.projection(), layers.triangle)
    filled = layers.triangle >= 0
    assert len(np.unique(layers.triangle[filled])) == 3
    right, up = flat_scene.tangents(16, 12, 12.0)
    directions = np.broadcast_to(np.stack([right, up, -np.ones_like(up)], axis=-1), (3, 12, 16, 3))
    colors = shade_all(view.surfaces(), attributes[filled], directions[filled])
    # Attributes are rounded to float32; a lobe of exponent 9 makes up to 9 steps out of one.
    np.testing.assert_allclose(colors, layers.color[filled], rtol=20 * FLOAT32)
    np.testing.assert_array_equal(attributes[~filled], 0.0)


def test_by_hand():
    shot = flat_scene.camera(4, 4, 4.0)
    light = Light((0, 0, 1), sun=(2.0, 1.0, 0.5), sky=(0.5, 0.25, 1.0), ground=(0.5, 0.25, 1.0))
    surfaces = View(flat_scene.scene_of([], shot, light=light), shot, ThinLens(0.1, 2.0)).surfaces()
    a = np.zeros((1, GBUFFER_CHANNELS), dtype=np.float32)
    a[0, 0:3], a[0, 3:6] = (0.5, 0.25, 1.0), (0.0, 0.125, 0.0)
    a[0, 6:9] = (0.0, 0.0, 0.25)  # an average: shorter than 1
    a[0, 9:12], a[0, 12] = (0.5, 0.5, 0.5), 4.0
    # The sun stands behind the viewer. Seen 45 degrees aside, the mirror direction has cosine 1 / sqrt 2 to it.
    lobe = math.sqrt(0.5) ** 4
    wanted = [
        0.5 * (2.0 + 0.5) + 0.5 * (2.0 * lobe + 0.5),
        0.25 * (1.0 + 0.25) + 0.125 + 0.5 * (1.0 * lobe + 0.25),
        1.0 * (0.5 + 1.0) + 0.5 * (0.5 * lobe + 1.0),
    ]
    np.testing.assert_allclose(shade_all(surfaces, a, np.array([[1.0, 0.0, -1.0]]))[0], wanted, rtol=1e-12)


@pytest.mark.parametrize("size", [(5, 2), (2, 5)])
def test_what_is_transparent_gives_off_what_is_seen_through_it(size):
    shot = flat_scene.camera(*size, 4.0)
    pane, wall = (flat_scene.rectangle(-9, 9, -9, 9, depth) for depth in (2.0, 3.0))
    pane = replace(pane, material=Material("unlit", (0.8, 0.4, 0.2), opacity=0.5))
    view = View(flat_scene.scene_of([pane, wall], shot), shot, ThinLens(0.1, 2.0))
    triangle = view.layers(2).triangle
    found = gbuffer_of(view.surfaces(), view.projection(), triangle, view.seen_through())
    half = 0.5 * np.array([0.8, 0.4, 0.2]) + 0.5  # of the pane, and of the white wall behind it
    colors = found[..., 0:3] + found[..., 3:6]
    np.testing.assert_allclose(colors[0], np.broadcast_to(half, colors[0].shape), rtol=4 * FLOAT32)
    np.testing.assert_allclose(colors[1], 1.0, rtol=4 * FLOAT32)

"""Leaves cut out of cards by their textures look as leaves made of polygons: in the reference and in every method."""

from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose

import refdof
from refdof import METHODS, Material, Part, ThinLens, View
from tests import flat_scene
from tests.cutouts import cut_card, solid_quads

SIZE, P = (96, 72), 80.0
LENS = ThinLens(0.06, 3.0)
LEAVES = [  # centre, half size, depth, colour; none in focus, where the last bit of a depth has the last word
    ((-0.487, 0.211), 0.75, 1.6, (0.2, 0.7, 0.1)),
    ((0.9, -0.3), 0.9, 3.1, (0.9, 0.5, 0.1)),
    ((0.317, 1.013), 1.6, 6.0, (0.8, 0.2, 0.3)),
]


@cache
def leaf():
    """Opacities (24, 24) of a leaf of five lobes with a soft rim."""
    y, x = (np.mgrid[0:24, 0:24] - 11.5) / 12.0
    reach = 0.55 + 0.35 * np.cos(5.0 * np.arctan2(y, x))
    return np.clip(0.5 + 4.0 * (reach - np.hypot(x, y)), 0.0, 1.0).astype(np.float32)


def scene_of(leaf_part):
    parts = [leaf_part(*words) for words in LEAVES]
    wall = flat_scene.rectangle(-9.0, 9.0, -7.0, 0.3, 9.0, (0.4, 0.5, 0.8))
    return flat_scene.scene_of([*parts, wall], flat_scene.camera(*SIZE, P), LENS, (0.1, 0.1, 0.2))


def cut_out(centre, half, depth, color):
    (x, y), material = centre, Material("unlit", color, opacity_texture=leaf(), cutoff=0.5, wrap="clamp")
    return cut_card((x - half, x + half, y - half, y + half), depth, (0.0, 1.0, 0.0, 1.0), material)


def of_polygons(centre, half, depth, color):
    quads = solid_quads(leaf(), 0.5, ("clamp", "clamp"), (0.0, 0.0), (1.0, 1.0))
    places = np.array(centre) + (2.0 * quads.reshape(-1, 2) - 1.0) * half
    faces = (4 * np.arange(len(quads))[:, None, None] + [[0, 1, 2], [0, 2, 3]]).reshape(-1, 3)
    return Part(np.column_stack([places, np.full(len(places), -depth)]), faces, flat_scene.paint(color))


@pytest.fixture(scope="module")
def views():
    scenes = scene_of(cut_out), scene_of(of_polygons)
    return [View(scene, scene.camera, LENS) for scene in scenes]


def test_the_layers_are_the_same(views):
    cut, polygons = (view.layers() for view in views)
    assert 0.1 < np.mean(cut.depth[0] < 2.0) < 0.5  # the nearest leaf
    assert len(cut.depth) == len(polygons.depth)
    # The leaves stand where no pixel centre lies between a rim's curve and its polygon, 1 / 2048 of a texel.
    assert_allclose(cut.depth, polygons.depth, rtol=1e-9)
    assert_allclose(cut.color, polygons.color, atol=1e-6)


def test_the_reference_is_the_same(views):
    cut, polygons = (refdof.reference(v.scene, v.camera, v.lens, samples=256, seed=k) for k, v in enumerate(views))
    spread = np.hypot(cut.standard_error, polygons.standard_error)
    # Rays that differ between the two scenes are those of the error bars; the curves' own difference is below 1e-4.
    assert np.mean(np.abs(cut.image - polygons.image) <= 3.2 * spread + 1e-4) > 0.9
    assert np.sqrt(np.mean((cut.image - polygons.image) ** 2)) < 1.2 * np.sqrt(np.mean(spread**2)) + 1e-4


@pytest.mark.parametrize("name", sorted(METHODS))
def test_every_method_is_the_same(views, name):
    cut, polygons = (refdof.render(name, v.scene, v.camera, v.lens).image for v in views)
    assert np.std(cut) > 0.1
    if name == "accumulation":  # whose rays meet the curves anywhere: at a rim one ray of 32 may differ
        assert np.sqrt(np.mean((cut - polygons) ** 2)) < 2e-3
    else:  # layers are equal but for their last bits, and so is all that follows
        assert_allclose(cut, polygons, atol=1e-5)


@pytest.mark.parametrize("name", sorted(METHODS))
def test_a_window_over_a_wall_has_the_composited_colour(name):
    color, opacity, behind = np.array([0.9, 0.2, 0.1]), 0.3, np.array([0.1, 0.6, 0.8])
    window = cut_card((-9, 9, -9, 9), 2.0, (0, 1, 0, 1), Material("unlit", tuple(color), opacity=opacity))
    wall = flat_scene.rectangle(-9, 9, -9, 9, 4.0, tuple(behind))
    shot, lens = flat_scene.camera(24, 18, 20.0), ThinLens(0.02, 3.5)
    image = refdof.render(name, flat_scene.scene_of([window, wall], shot, lens), shot, lens).image
    wanted = opacity * color + (1.0 - opacity) * behind
    middle = image[6:-6, 8:-8]  # rims of the picture have rules of their own
    if METHODS[name].METHOD.kind == "reference views":
        # Each pixel's rays meet the window by chance: 4 standard errors of the mean of all.
        count = middle[..., 0].size * METHODS[name].Params().samples
        assert_allclose(middle.mean(axis=(0, 1)), wanted, atol=4.0 * 0.5 * 0.8 / np.sqrt(count))
    else:
        assert_allclose(middle, np.broadcast_to(wanted, middle.shape), atol=1e-5)

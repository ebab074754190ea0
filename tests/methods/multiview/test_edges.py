"""Multiview synthesis where surfaces slant, hide each other or end: against closed forms. Tiny pictures."""

import numpy as np
import pytest

from refdof import Part, ThinLens, View, render
from refdof.methods.multiview import Params
from refdof.methods.multiview.method import _choice
from tests import flat_scene
from tests.closed_forms import half_disc

pytestmark = pytest.mark.fast

BLUE = (0.0, 0.0, 1.0)


def slanted(slope, size=(20, 14)):
    """A black plane over the whole view, whose circle of confusion changes by `slope` px per px along x, before white.

    With P = W and the lens radius 1, c = W (1 / focus - 1 / d), and 1 / d = 0.9 + slope x / W at x px from the middle.
    """
    corners = []
    for x, y in ((-0.7, -0.7), (0.7, -0.7), (0.7, 0.7), (-0.7, 0.7)):
        depth = 1.0 / (0.9 + slope * x)
        corners.append([x * depth, y * depth, -depth])
    shot, lens = flat_scene.camera(*size, float(size[0])), ThinLens(1.0, 1.0 / 0.9)
    return flat_scene.scene_of(
        [Part(np.array(corners), [[0, 1, 2], [0, 2, 3]], flat_scene.paint((0, 0, 0)))], shot, lens, (1,) * 3
    )


@pytest.mark.parametrize("slope", [0.3, -0.9, 0.99])
@pytest.mark.parametrize("words", [{}, {"cones": "none"}, {"cones": "none", "offscreen": "discard"}])
def test_an_opaque_plane_lets_nothing_through(slope, words):
    # As any plane that the whole lens sees from one side, whatever layers it crosses: here up to 20.
    image = render("multiview", slanted(slope), samples=16, **words).image
    np.testing.assert_array_equal(image, 0.0)


@pytest.mark.parametrize("layers", [1, 3])
@pytest.mark.parametrize("cones", ["none", "paper"])
def test_behind_an_edge_the_surface_of_the_same_layer_goes_on(layers, cones):
    # A red half-plane at -4 px before green at 4 px, both in the one layer or not; the backdrop is blue.
    size, p, radius, focus = (24, 8), 24.0, 0.5, 1.0
    near, far = (1.0 / (1.0 / focus - c / (p * radius)) for c in (-4.0, 4.0))
    red = flat_scene.rectangle(-9, 0, -9, 9, near, (1, 0, 0))
    green = flat_scene.rectangle(-9, 9, -9, 9, far, (0, 1, 0))
    shot = flat_scene.camera(*size, p)
    scene = flat_scene.scene_of([red, green], shot, ThinLens(radius, focus), BLUE)
    image = render("multiview", scene, layers=layers, cones=cones, samples=64).image
    np.testing.assert_array_equal(image[..., 2], 0.0)
    share = half_disc((size[0] / 2 - np.arange(size[0]) - 0.5) / 4.0)
    # 64 points: 64^-0.75 of an edge (1 sigma of a random turn), at the worst of 24 columns three times that.
    np.testing.assert_allclose(image[..., 0], np.broadcast_to(share, size[::-1]), rtol=0, atol=3 * 64**-0.75)


def test_a_ray_still_passes_behind_a_near_edge():
    # The same without green: what the half-plane does not cover is the backdrop, by the same closed form.
    # A speck at 4 px in the upper right corner, 6 px from the rows below, makes the layer 8 px deep.
    size, p, radius, focus = (24, 14), 24.0, 0.5, 1.0
    near, far = (1.0 / (1.0 / focus - c / (p * radius)) for c in (-4.0, 4.0))
    red = flat_scene.rectangle(-9, 0, -9, 9, near, (1, 0, 0))
    speck = flat_scene.rectangle(*(np.array([10.0, 11.0, 5.5, 6.5]) * far / p), far)
    scene = flat_scene.scene_of([red, speck], flat_scene.camera(*size, p), ThinLens(radius, focus), BLUE)
    image = render("multiview", scene, layers=1, cones="none", samples=64).image[7:, :, 2]
    share = half_disc((size[0] / 2 - np.arange(size[0]) - 0.5) / 4.0)
    np.testing.assert_allclose(image, 1.0 - np.broadcast_to(share, image.shape), rtol=0, atol=3 * 64**-0.75)


@pytest.mark.parametrize(("rows", "spacing"), [(600, 3.0), (240, 1.2), (1200, 6.0), (48, 1.0)])
def test_layers_are_spaced_as_the_papers_by_hand(rows, spacing):
    # 3 px at 600 rows; no finer than the 1 px that walls reach.
    shot, lens = flat_scene.camera(16, rows, 16.0), ThinLens(0.1, 1.0)
    view = View(flat_scene.scene_of([], shot, lens), shot, lens)
    assert _choice(view, Params())["spacing"] == pytest.approx(spacing, rel=1e-12)
    assert _choice(view, Params(spacing_px=10.0))["spacing"] == 10.0


@pytest.mark.parametrize("culling", [True, False])
def test_a_near_speck_drops_no_rays_far_from_it(culling):
    # A backdrop at 2 px, brighter to the right, and a speck of 1 px at -12 px, 40 px from the left of 48.
    size, p, radius, focus = (48, 10), 48.0, 0.5, 1.0
    near, far = (1.0 / (1.0 / focus - c / (p * radius)) for c in (-12.0, 2.0))
    speck = flat_scene.rectangle(*(np.array([16.1, 16.9, 0.1, 0.9]) * near / p), near)
    ramp = flat_scene.strips(np.array([-48.0, 48.0]) * far / p, far, -9.0, 9.0, np.array([0.0, 1.0]))
    scene = flat_scene.scene_of([speck, ramp], flat_scene.camera(*size, p), ThinLens(radius, focus))
    words = {"offscreen": "discard", "cones": "none", "jitter": "none", "samples": 16, "culling": culling}
    done = render("multiview", scene, stages=True, **words)
    # A ray sees the backdrop's texel at x - 2 v_x, y + 2 v_y, y down, or is dropped.
    points = done.stages["lens_points"][0]
    y, x = np.mgrid[: size[1], :20]
    u, v = x[..., None] + 0.5 - 2.0 * points[:, 0], y[..., None] + 0.5 + 2.0 * points[:, 1]
    inside = (u >= 0) & (v >= 0) & (v < size[1])
    seen = (np.floor(u) + 0.5 - 24.0 + 48.0) / 96.0
    wanted = (seen * inside).sum(axis=-1) / inside.sum(axis=-1)
    assert 0.5 < inside.mean() < 0.99
    # Texels are 1/96 apart; their colours are float32.
    np.testing.assert_allclose(done.image[:, :20, 0], wanted, rtol=0, atol=1e-5)

"""Cones, apertures and weights of multiview synthesis, against numbers by hand and the reference."""

import numpy as np
import pytest

import refdof
from refdof import Aperture, Material, Part, ThinLens, View, render
from refdof.methods.multiview.cones import FOOTPRINT, gather_cones, mip_chain
from refdof.methods.multiview.fields import Search, fields_of
from refdof.optics.pixel_samples import LensPointSets
from tests import flat_scene

SEARCH = Search(False, 3, 5, 0.5, False, True, False)


def test_cones_blend_what_covers_them_by_hand():
    # Layer 0, at -4 px, is red and lacks one texel of each 2 x 2 block; layer 1, at 4 px, is green and whole. Where the
    # cone is 2 px wide it reads level 1, which is 3/4 covered everywhere: whether its middle meets a hole or not.
    coc = np.full((2, 8, 8), -4.0, np.float32)
    coc[0, 1::2, ::2] = np.inf
    coc[1] = 4.0
    color = np.zeros((2, 8, 8, 3), np.float32)
    color[0, ..., 0], color[1, ..., 1] = 1.0, 1.0
    bounds = np.array([-4.0, 4.0], np.float32)
    shot = flat_scene.camera(8, 8, 8.0)
    view = View(flat_scene.scene_of([], shot), shot, ThinLens(0.1, 1.0))
    points = np.array([[0.5, 0.25]])
    pattern = LensPointSets(points[None], np.ones((1, 1)), np.zeros((1, 1), np.int32))
    chain = mip_chain(color, coc, np.zeros(coc.shape, bool), 2.0)
    np.testing.assert_array_equal(chain.texels[0, 64:80], np.tile([0.75, 0.0, 0.0, 0.75, 0.75], (16, 1)))
    fields = fields_of(coc, bounds, bounds, 1.0)
    image = gather_cones(fields, chain, 0.5, pattern, SEARCH, view.projection(), view.surfaces(), (0.0, 0.0, 1.0))
    np.testing.assert_array_equal(image, np.tile(np.float32([0.75, 0.25, 0.0]), (8, 8, 1)))


def test_what_cones_leave_is_background_by_hand():
    coc = np.full((1, 4, 4), -4.0, np.float32)
    coc[0, ::2, ::2] = np.inf
    chain = mip_chain(np.ones((1, 4, 4, 3), np.float32), coc, np.zeros(coc.shape, bool), 2.0)
    shot = flat_scene.camera(4, 4, 4.0)
    view = View(flat_scene.scene_of([], shot), shot, ThinLens(0.1, 1.0))
    pattern = LensPointSets(np.zeros((1, 1, 2)), np.ones((1, 1)), np.zeros((1, 1), np.int32))
    bounds = np.array([-4.0], np.float32)
    fields = fields_of(coc, bounds, bounds, 1.0)
    image = gather_cones(fields, chain, 0.5, pattern, SEARCH, view.projection(), view.surfaces(), (0.0, 0.5, 0.0))
    np.testing.assert_array_equal(image, np.tile(np.float32([0.75, 0.875, 0.75]), (4, 4, 1)))


def through_middle(coc, copied, widening, background):
    """Light that black layers (K, 8, 8), each flat, leave of cones through the lens's middle."""
    bounds = coc.min(axis=(1, 2))
    shot = flat_scene.camera(8, 8, 8.0)
    view = View(flat_scene.scene_of([], shot), shot, ThinLens(0.1, 1.0))
    pattern = LensPointSets(np.zeros((1, 1, 2)), np.ones((1, 1)), np.zeros((1, 1), np.int32))
    chain = mip_chain(np.zeros((*coc.shape, 3), np.float32), coc, copied, widening * np.abs(bounds).max())
    fields = fields_of(coc, bounds, bounds, 1.0, FOOTPRINT * widening)
    words = pattern, SEARCH, view.projection(), view.surfaces(), (background,) * 3
    return gather_cones(fields, chain, widening, *words)[..., 0]


def test_a_copy_is_not_blended_again_by_hand():
    coc = np.full((2, 8, 8), -4.0, np.float32)
    coc[:, 1::2, ::2] = np.inf
    copied = np.zeros(coc.shape, bool)
    # Two sheets that cover 3/4 each, or one sheet that two layers hold.
    np.testing.assert_array_equal(through_middle(coc, copied, 0.5, 1.0), 0.0625)
    copied[1] = np.isfinite(coc[1])
    np.testing.assert_array_equal(through_middle(coc, copied, 0.5, 1.0), 0.25)
    # The second layer goes on where the first one ends: it covers all that is free of copies.
    coc[1] = -4.0
    np.testing.assert_array_equal(through_middle(coc, copied, 0.5, 1.0), 0.0)


def test_the_last_of_a_cone_still_sees_a_bright_background_by_hand():
    # Three layers leave 1 / 64 each, by one hole in 8 x 8 texels.
    coc = np.tile(np.float32([-6.0, -4.0, -2.0])[:, None, None], (1, 8, 8))
    coc[:, 0, 0] = np.inf
    image = through_middle(coc, np.zeros(coc.shape, bool), 8.0, 65504.0)
    np.testing.assert_allclose(image, 65504.0 / 64**3, rtol=1e-6)


@pytest.mark.parametrize("cones", ["none", "paper", "text"])
def test_thin_stripes_keep_their_light(cones):
    # White stripes of 1 px in 4, in a layer of their own or where two layers overlap: bounds at -20, -16, -12 .. 8 px.
    shot, lens = flat_scene.camera(64, 24, 64.0), ThinLens(0.8, 2.0)
    for coc in (-14.0, -12.1):
        depth, near, far = (1.0 / (1.0 / 2.0 - c / 51.2) for c in (coc, -20.0, 8.0))
        parts = [flat_scene.rectangle(k * depth / 16, (k + 0.25) * depth / 16, -99, 99, depth) for k in range(-16, 16)]
        for d in (near, far):
            parts.append(flat_scene.rectangle(-0.5 * d, -0.45 * d, -0.2 * d, -0.15 * d, d, (0, 0, 0)))
        words = {"samples": 32, "spacing_px": 4.0, "cones": cones, "offscreen": "clamp"}
        image = render("multiview", flat_scene.scene_of(parts, shot, lens), **words).image[4:-4, 20:-20, 0]
        # No ray of these columns leaves the picture. Three sigma of 5120 independent points, 0.43 each; there are
        # 12288, which share some of their noise.
        assert image.mean() == pytest.approx(0.25, abs=3 * 0.43 / (8 * 640) ** 0.5)


@pytest.mark.parametrize("search", ["false position", "march"])
def test_culling_changes_no_bit_of_cones(search):
    shot, lens = flat_scene.camera(48, 32, 48.0), ThinLens(0.4, 1.2)
    cards = [
        flat_scene.rectangle(-0.1, 0.1, -0.1, 0.05, 0.8, (1, 0, 0)),
        flat_scene.rectangle(-0.3, 0.4, -0.2, 0.4, 2.5),
    ]
    scene = flat_scene.scene_of(cards, shot, lens, (0, 0.5, 1))
    words = {"samples": 8, "cones": "text", "search": search, "offscreen": "clamp"}
    culled, whole = (render("multiview", scene, culling=culling, **words).image for culling in (True, False))
    np.testing.assert_array_equal(culled, whole)


def test_narrow_cones_are_rays():
    shot, lens = flat_scene.camera(24, 18, 24.0), ThinLens(0.01, 1.0)
    cards = [
        flat_scene.rectangle(-0.2, 0.1, -0.1, 0.2, 0.8, (1, 0, 0)),
        flat_scene.rectangle(-9, 9, -9, 9, 1.6, (0, 1, 0)),
    ]
    scene = flat_scene.scene_of(cards, shot, lens)
    # The circle of confusion is below 0.1 px: every cone reads the finest level within 0.1 texel of a texel's centre.
    plain, wide = (render("multiview", scene, samples=8, cones=cones).image for cones in ("none", "text"))
    assert np.abs(plain - wide).max() < 0.2
    assert np.abs(plain - wide).mean() < 0.01


@pytest.mark.parametrize("depth", [1.2, 3.5])
@pytest.mark.parametrize("cones", ["none", "paper"])
def test_bokeh_is_the_aperture_and_not_its_mirror_image(depth, cones):
    size, p = (64, 48), 48.0
    shot, lens = flat_scene.camera(*size, p), ThinLens(0.7, 2.0, Aperture.polygon(3, rotation=20.0))
    lamp = flat_scene.rectangle(*(np.array([-2, 2, -2, 2]) * depth / p), depth, (20.0, 20.0, 20.0))
    scene = flat_scene.scene_of([lamp], shot, lens)
    exact = refdof.reference(scene, samples=4096).image
    image = render("multiview", scene, samples=1024, pattern="sobol", jitter="none", cones=cones).image
    error = np.sqrt(((image - exact) ** 2).mean())
    for mirror in (exact[::-1], exact[:, ::-1], exact[::-1, ::-1]):
        assert error < 0.35 * np.sqrt(((image - mirror) ** 2).mean())
    # The lamp covers whole texels; its light is kept but for the noise of 1024 points.
    assert image.sum() == pytest.approx(exact.sum(), rel=0.02)


def test_weights_of_an_image_aperture_dim_their_part_of_the_bokeh():
    # Transmission 1 on the left half of the lens, 1/4 on the right.
    half = Aperture.image(np.array([[1.0, 0.25]]))
    size, p = (48, 32), 32.0
    shot, lens = flat_scene.camera(*size, p), ThinLens(0.5, 1.0, half)
    lamp = flat_scene.rectangle(*(np.array([-1, 1, -1, 1]) * 4.0 / p), 4.0, (9.0, 9.0, 9.0))
    scene = flat_scene.scene_of([lamp], shot, lens)
    # Dropped rays would give others more weight.
    image = render("multiview", scene, samples=2048, pattern="sobol", jitter="none", offscreen="clamp").image[..., 0]
    # Behind the focal plane a point is displaced by + c v: the left of the lens is the left of the bokeh.
    left, right = image[:, : size[0] // 2 - 1].sum(), image[:, size[0] // 2 + 1 :].sum()
    assert left / right == pytest.approx(4.0, rel=0.1)
    # A mean over the aperture: 4 texels of 9, whatever the shape. 2048 points: 450 pixels of 9 * 2048^-0.75 (1 sigma).
    assert image.sum() == pytest.approx(36.0, abs=3 * 450**0.5 * 9 * 2048**-0.75)


def test_one_attribute_shades_along_each_lens_ray():
    # A mirror that shows an environment which differs by direction: the picture of the lens's rays, not the pinhole's.
    environment = np.zeros((32, 32, 3), np.float32)
    environment[:, 16:] = 1.0
    light = refdof.Light((0, 0, 1), sun=(0, 0, 0), sky=(0, 0, 0), ground=(0, 0, 0), environment=environment)
    shiny = Material("phong", (0, 0, 0), specular=(1, 1, 1))
    corners = np.array([[-9, -9, -2.0], [9, -9, -2.0], [9, 9, -2.0], [-9, 9, -2.0]])
    shot, lens = flat_scene.camera(24, 16, 16.0), ThinLens(0.5, 1.5)
    scene = flat_scene.scene_of([Part(corners, [[0, 1, 2], [0, 2, 3]], shiny)], shot, lens, light=light)
    exact = refdof.reference(scene, samples=1024).image
    words = {"samples": 256, "offscreen": "clamp"}
    dependent = render("multiview", scene, **words, view_dependent=True).image
    independent = render("multiview", scene, **words).image
    inner = (slice(6, -6), slice(6, -6))
    # Normals are the same in every texel, so only the noise of 256 points is left: 256^-0.75, twice.
    assert np.abs(dependent - exact)[inner].max() < 2 * 256**-0.75 + 0.02
    assert np.abs(independent - exact)[inner].max() > 0.1

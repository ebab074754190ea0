"""Pictures at the numerical extremes: huge and tiny lenses, odd focus, far walls, nothing to see, tiny pictures."""

import math

import numpy as np
import pytest

import refdof
from refdof import Part, ThinLens
from tests import flat_scene
from tests.closed_forms import half_disc

SKY = (0.25, 0.5, 2.0)
CARD = (1.0, 3.0, 0.125)


def picture(parts, shot, lens, **words):
    result = refdof.reference(flat_scene.scene_of(parts, shot, background=SKY), shot, lens, **{"samples": 256, **words})
    assert np.isfinite(result.image).all()
    assert np.isfinite(result.standard_error).all()
    assert result.image.shape == result.standard_error.shape == (*result.samples.shape, 3)
    return result


@pytest.mark.parametrize("lens", [ThinLens(0.0, 1.0), ThinLens(0.2, 1.0), ThinLens(0.2, np.inf), ThinLens(1e3, 1.0)])
@pytest.mark.parametrize("words", [{}, {"pixel_filter": "box"}, {"samples": None, "tolerance": 1e-3}])
def test_nothing_to_see_is_the_background(lens, words):
    words = {k: v for k, v in words.items() if v is not None}
    shot = flat_scene.camera(5, 3, 4.0)
    for parts in ([], [flat_scene.rectangle(-9, 9, -9, 9, -2.0)]):
        result = picture(parts, shot, lens, **words)
        assert (result.image == np.float32(SKY)).all()
        assert (result.standard_error == 0.0).all()


@pytest.mark.parametrize("size", [(1, 1), (1, 17), (19, 1), (17, 2), (16, 16), (33, 5)])
@pytest.mark.parametrize("words", [{}, {"tolerance": 1e-2}])
def test_pictures_of_every_size(size, words):
    shot, lens = flat_scene.camera(*size, 16.0), ThinLens(0.25, 2.0)
    edge = flat_scene.rectangle(-99, 0.02, -99, 99, 1.0, CARD)
    result = picture([edge], shot, lens, **words)
    # 16 * 0.25 * (1 / 2 - 1) = -2 px; the edge is at 0.32 px.
    share = half_disc((0.32 - flat_scene.tangents(*size, 16.0)[0] * 16.0) / 2.0)[..., None]
    truth = share * CARD + (1 - share) * np.array(SKY)
    # Six standard errors, and what all 128 points may miss of a contrast of 2.5; float32.
    assert (np.abs(result.image - truth) <= 6 * result.standard_error + 2.5 * 10 / 128 + 1e-6).all()


@pytest.mark.parametrize("radius", [1e2, 1e4, 1e8, 1e15, 1e30, 1e100, 1e300])
def test_a_lens_much_larger_than_the_scene(radius):
    shot = flat_scene.camera(4, 3, 4.0)
    small = flat_scene.rectangle(-1, 1, -1, 1, 2.0, CARD)
    result = picture([small], shot, ThinLens(radius, 1.0))
    # The card, 4 square units, covers at most 4 / (pi radius^2) = 1.3e-4 of the lens: no more than one of 256 points
    # of a pixel in thirty, none in nearly all.
    off = np.abs(result.image - np.float32(SKY)).max(axis=-1)
    assert (off <= 2.5 / 256 + 1e-6).all()
    assert (off <= 1e-6).mean() >= 0.8
    # A wall at the focal plane does not know the lens, however large.
    if radius <= 1e4:
        focused = picture([flat_scene.rectangle(-1e6, 1e6, -1e6, 1e6, 1.0, CARD)], shot, ThinLens(radius, 1.0))
        np.testing.assert_allclose(focused.image, np.broadcast_to(CARD, focused.image.shape), rtol=1e-6)


@pytest.mark.parametrize("focus", [1e-300, 1e-30, 1e-12, 1e-6, 1e6, 1e30, 1e300, np.inf])
def test_focus_at_the_ends(focus):
    shot = flat_scene.camera(8, 2, 8.0)
    edge = flat_scene.rectangle(-1e4, 0.0, -1e4, 1e4, 2.0, CARD)
    result = picture([edge], shot, ThinLens(0.5, focus), samples=1024)
    coc = 8.0 * 0.5 * abs(1 / focus - 1 / 2.0)
    share = half_disc(-flat_scene.tangents(8, 2, 8.0)[0] * 8.0 / coc)[..., None]
    # Focused at a hair's breadth, rays are all but parallel to the lens: some miss a card of 1e4 units. These see
    # the background, and no closed form is asked of them, but numbers.
    if focus >= 1e-3:
        truth = share * CARD + (1 - share) * np.array(SKY)
        assert (np.abs(result.image - truth) <= 6 * result.standard_error + 2.5 * 10 / 1024 + 1e-6).all()
    else:
        colors = np.stack([CARD, SKY])
        assert (result.image >= colors.min(axis=0) - 1e-6).all()
        assert (result.image <= colors.max(axis=0) + 1e-6).all()


@pytest.mark.parametrize("near", [1e-6, 1e-3, 1.0, 1e3])
@pytest.mark.parametrize("far", [1e3, 1e6, 1e9])
def test_a_far_wall_does_not_coarsen_what_is_near(near, far):
    # A half-plane at `near`, and behind it a wall `far` times farther away, in one acceleration structure.
    p = 32.0
    shot, lens = flat_scene.camera(32, 2, p), ThinLens(0.1 * near, 2.0 * near)
    edge = flat_scene.rectangle(-2 * near, 0.3 * near / p, -2 * near, 2 * near, near, (1.0,) * 3)
    wall = flat_scene.rectangle(*(far * near * np.array([-9, 9, -9, 9])), far * near, (0.25,) * 3)
    result = picture([edge, wall], shot, lens, samples=1024)
    # 32 * 0.1 * (1 / 2 - 1) = -1.6 px.
    share = half_disc((0.3 - flat_scene.tangents(32, 2, p)[0] * p) / 1.6)
    error = np.abs(result.image - (share + 0.25 * (1 - share))[..., None])
    assert (error <= 6 * result.standard_error + 10 / 1024 + 1e-6).all()
    spread = result.standard_error[..., 0] > 1e-4
    assert (error[..., 0][spread] / result.standard_error[..., 0][spread] <= 2.131).mean() >= 0.75  # of 8 pixels


@pytest.mark.parametrize("step", [0.0, 1e-15, 1e-12, 1e-9, 1e-6])
def test_almost_in_focus(step):
    p, focus = 16.0, 3.0
    shot, lens = flat_scene.camera(16, 2, p), ThinLens(0.5, focus)
    for depth in (focus * (1 + step), focus * (1 - step)):
        edge = flat_scene.rectangle(-99, 0.25 * depth / p, -99, 99, depth, CARD)
        image = picture([edge], shot, lens).image
        # The circle is below 1e-5 px and every pixel centre a quarter of a pixel or more from the edge: no blur.
        left = flat_scene.tangents(16, 2, p)[0][..., None] < 0.25 / p
        np.testing.assert_allclose(image, np.where(left, np.float32(CARD), np.float32(SKY)), rtol=1e-6)


def test_focus_at_the_largest_numbers():
    card = flat_scene.rectangle(-0.1, 0.1, -0.1, 0.1, 0.2)
    shot = flat_scene.camera(4, 4, 4.0)
    images = [
        refdof.reference(flat_scene.scene_of([card], shot), lens=ThinLens(1e-3, focus), samples=16).image
        for focus in (1.5e308, math.inf)
    ]
    np.testing.assert_array_equal(*images)  # 1 / focus is below every digit of the rest


@pytest.mark.parametrize("radius", [1e-17, 1e-19, 1e-30, 1e-40])
def test_a_lens_of_hardly_any_radius_is_a_pinhole(radius):
    # In the middle row rays go up or down by less than 1e-17, which must not make them miss what the others meet.
    shot, random = flat_scene.camera(9, 5, 8.0), np.random.default_rng(1)
    cards = [
        flat_scene.rectangle(x - 4.5, x - 3.5, y - 2.5, y - 1.5, 8.0, tuple(random.random(3)))
        for x in range(9)
        for y in range(5)
    ]
    scene = flat_scene.scene_of(cards, shot)
    # One replicate, so that rays of neighbouring pixels share a packet.
    sharp, tiny = (refdof.render("accumulation", scene, lens=ThinLens(e, 16.0), samples=4).image for e in (0.0, radius))
    np.testing.assert_array_equal(tiny, sharp)


def test_what_lies_in_the_plane_of_the_lens_is_not_seen():
    shot = flat_scene.camera(4, 3, 4.0)
    flat = Part([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]], [[0, 1, 2]], flat_scene.paint((9.0, 9.0, 9.0)))
    wall = flat_scene.rectangle(-9, 9, -9, 9, 2.0, CARD)
    for radius in (0.0, 0.25):
        assert (picture([flat, wall], shot, ThinLens(radius, 1.0), samples=16).image == np.float32(CARD)).all()

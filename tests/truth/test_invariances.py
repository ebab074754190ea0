"""What must not change a picture, or must change it in a known way."""

from dataclasses import replace

import numba
import numpy as np
import pytest

import refdof
from refdof import Camera, Light, Material, Part, Scene, ThinLens, View
from tests import flat_scene
from tests.cards import random_cards

FLOAT32 = 2.0**-23  # one step of float32 at 1


def busy(seed=5):
    """Cards, a shiny tilted triangle soup and a texture, from an odd place."""
    random = np.random.default_rng(seed)
    shot = Camera.look_at((0.3, 0.7, 1.9), (0.1, 0.2, -1.0), (0.1, 1.0, 0.0), 41.0, (13, 11))
    texture = random.uniform(0.0, 1.0, (5, 7, 3)).astype(np.float32)
    materials = [
        Material("phong", (0.6, 0.5, 0.3), specular=(0.4, 0.4, 0.5), shininess=9.0),
        Material("unlit", texture=texture, emission=(0.0, 0.1, 0.0)),
        Material("lambert", (0.2, 0.8, 0.4)),
    ]
    parts = []
    for material in materials:
        corners = random.normal(0.0, 0.5, (24, 3)) + random.normal(0.0, [0.6, 0.5, 1.0], (8, 1, 3)).repeat(
            3, axis=1
        ).reshape(-1, 3)
        parts.append(
            Part(
                corners,
                np.arange(24).reshape(-1, 3),
                material,
                random.random((24, 2)),
                random.random((24, 3)),
            )
        )
    return Scene.from_parts("busy", parts, shot, ThinLens(0.11, 2.1), (0.2, 0.3, 0.4), Light())


def render(scene, **words):
    return refdof.reference(scene, **{"samples": 256, "seed": 3, **words})


def assert_same_bits(one, other):
    np.testing.assert_array_equal(one.image, other.image)
    np.testing.assert_array_equal(one.standard_error, other.standard_error)
    np.testing.assert_array_equal(one.samples, other.samples)


def assert_alike(one, other, share=1.0):
    """Pictures of the same truth by independent samples."""
    spread = np.hypot(one.standard_error, other.standard_error)
    # Difference of two Student means: 6 is beyond reach; 10 / N covers slivers that one side's samples all missed.
    assert (np.abs(one.image - other.image) <= 6.0 * spread + 10.0 / one.samples[..., None] + FLOAT32).all()
    # And as often above as below; with variance 15 / 13 or less, and 4 standard errors of the mean.
    z = ((one.image - other.image)[..., 1] / np.where(spread > 0, spread, np.inf)[..., 1])[spread[..., 1] > 1e-4]
    assert len(z) > 30
    assert abs(z.mean()) <= 4.0 * np.sqrt(15 / 13 / len(z))


@pytest.mark.parametrize("color", [(0.25, 1.0, 3.0), (0.1, 0.3, 0.7)])
@pytest.mark.parametrize("words", [{}, {"pixel_filter": "box"}, {"samples": 16}])
def test_one_colour_everywhere_stays(color, words):
    scene = random_cards(1).scene
    parts = [Part(scene.vertices, scene.faces, flat_scene.paint(color))]
    result = render(flat_scene.scene_of(parts, scene.camera, scene.lens, color), **words)
    # Sums of equal float64 numbers round by N 1e-16 at most, far below half a step of float32; a colour in the middle
    # between two float32 numbers may go either way: one step.
    np.testing.assert_allclose(result.image, np.broadcast_to(color, result.image.shape), rtol=FLOAT32)
    assert (result.standard_error <= 1e-12).all()


def test_what_is_in_focus_does_not_know_the_lens():
    random = np.random.default_rng(2)
    # 250 triangles of a wall at distance 2: its colour changes from one to the next.
    wall = flat_scene.strips(np.linspace(-3.0, 3.0, 126), np.full(126, 2.0), -3.0, 3.0, random.random(126))
    shot = flat_scene.camera(16, 12, 14.0)
    pinhole = View(flat_scene.scene_of([wall], shot), shot, ThinLens(0.0, 2.0)).pinhole().color
    for radius in (1e-6, 0.1, 1.0, 3.0):
        image = render(flat_scene.scene_of([wall], shot), lens=ThinLens(radius, 2.0)).image
        # Rays meet at the focal point up to 1e-16 of their length; a strip's slope turns this into 1e-14 of a colour.
        np.testing.assert_allclose(image, pinhole, rtol=2 * FLOAT32)


def test_no_radius_is_a_pinhole():
    scene = busy()
    pinhole = View(scene, scene.camera, scene.lens).pinhole()
    shut = ThinLens(0.0, 2.1)
    result = render(scene, lens=shut)
    np.testing.assert_array_equal(result.image, pinhole.color)
    assert (result.standard_error == 0.0).all()
    np.testing.assert_array_equal(View(scene, scene.camera, shut).pinhole().color, pinhole.color)
    for radius, within in ((1e-5, 1e-4), (1e-8, 1e-6), (1e-300, 1e-6)):
        # Inside a face the colour differs by its slope, below 10 per unit, times the radius; float32 besides. Pixels
        # whose centre is within the blur of an edge are fewer than one in 100.
        near = np.abs(render(scene, lens=ThinLens(radius, 2.1)).image - pinhole.color).max(axis=-1)
        assert np.mean(near <= within) >= 0.99


def test_a_pinhole_with_a_box_filter_still_averages_the_pixel():
    shot = flat_scene.camera(9, 3, 9.0)
    half = flat_scene.rectangle(-99, 0.3 / 9, -99, 99, 1.0)  # its edge is at 0.3 px: 0.8 of the middle pixel
    result = render(flat_scene.scene_of([half], shot), lens=ThinLens(0.0, 1.0), pixel_filter="box", samples=4096)
    # An upright edge across a net of 256 points: each net is off by at most 1 / 16 of its rows' strata.
    truth = np.array([1, 1, 1, 1, 0.8, 0, 0, 0, 0])
    np.testing.assert_allclose(result.image[..., 0], np.broadcast_to(truth, (3, 9)), atol=1 / 256)


@pytest.mark.parametrize("power", [-20, -7, 1, 13, 20])
@pytest.mark.parametrize("make", [busy, lambda: random_cards(3).scene, lambda: random_cards(8).scene])
def test_powers_of_two_change_no_bit(power, make):
    scene = make()
    scaled = scene.scaled(2.0**power)
    assert_same_bits(render(scene), render(scaled))
    own, other = (View(s, s.camera, s.lens).layers() for s in (scene, scaled))
    np.testing.assert_array_equal(own.depth * 2.0**power, other.depth)
    for name in ("color", "normal", "triangle"):
        np.testing.assert_array_equal(getattr(own, name), getattr(other, name))
    np.testing.assert_array_equal(
        View(scene, scene.camera, scene.lens).coc_px(), View(scaled, scaled.camera, scaled.lens).coc_px()
    )


@pytest.mark.parametrize("factor", [10.0, 1e-6, 1e6, 1e-3])
def test_other_units_change_little(factor):
    scene = busy()
    one, other = render(scene), render(scene.scaled(factor))
    # The same lens points; float32 and float64 round otherwise, so that of 256 rays now and then one changes sides
    # of an edge. In no pixel more than two, and in 99 of 100 none.
    difference = np.abs(one.image - other.image).max(axis=-1)
    assert (difference <= 2.0 * 3.0 / 256).all()
    assert np.mean(difference <= 1e-6) >= 0.99


def test_a_mirrored_world_gives_a_mirrored_picture():
    scene = busy()
    flip = np.array([-1.0, 1.0, 1.0])
    camera, light = scene.camera, scene.light
    mirrored = Scene(
        "mirrored", scene.vertices * flip, scene.faces[:, ::-1].copy(), scene.uv, scene.color,
        (scene.normal * flip).astype(np.float32), scene.face_material, scene.materials, scene.background,
        Light(tuple(np.array(light.sun_direction) * flip)),
        Camera(tuple(np.array(camera.eye) * flip), tuple(np.array(camera.target) * flip),
               tuple(np.array(camera.up) * flip), camera.fov_y, camera.size),
        scene.lens,
    )  # fmt: skip
    one, other = (View(s, s.camera, s.lens).pinhole() for s in (scene, mirrored))
    # The same numbers with other signs: only the order of sums differs. Grazing triangles amplify roundings.
    np.testing.assert_allclose(one.depth[:, ::-1], other.depth, rtol=1e-11)
    np.testing.assert_allclose(one.color[:, ::-1], other.color, rtol=1e-5, atol=1e-6)  # float32 attributes
    first, second = render(scene, samples=1024), render(mirrored, samples=1024, seed=4)
    assert_alike(replace(first, image=first.image[:, ::-1], standard_error=first.standard_error[:, ::-1]), second)


@pytest.mark.parametrize("seed", [0, 1])
def test_the_order_of_faces_changes_no_bit(seed):
    scene = busy()
    order = np.random.default_rng(seed).permutation(len(scene.faces))
    shuffled = Scene(**{**vars(scene), "faces": scene.faces[order], "face_material": scene.face_material[order]})
    assert_same_bits(render(scene), render(shuffled))
    own, other = (View(s, s.camera, s.lens).layers() for s in (scene, shuffled))
    np.testing.assert_array_equal(own.depth, other.depth)
    np.testing.assert_array_equal(own.color, other.color)
    np.testing.assert_array_equal(own.triangle, np.where(other.triangle >= 0, order[other.triangle], -1))


@pytest.mark.parametrize("words", [{}, {"tolerance": 5e-3}, {"pixel_filter": "box", "shared_pattern": True}])
def test_the_number_of_threads_changes_no_bit(words):
    scene = busy()
    shot = scene.camera.with_size((40, 37))  # several tiles, some of them cut
    default = render(scene, camera=shot, **words)
    before = numba.get_num_threads()
    try:
        for count in sorted({1, before}):
            numba.set_num_threads(count)
            assert_same_bits(render(scene, camera=shot, **words), default)
            layers = View(scene, shot, scene.lens).layers()
            if count == 1:
                single = layers
            for one, other in zip(single, layers, strict=True):
                np.testing.assert_array_equal(one, other)
    finally:
        numba.set_num_threads(before)


def test_seeds():
    scene = random_cards(4).scene
    first, again, other = render(scene, seed=7), render(scene, seed=7), render(scene, seed=8)
    assert_same_bits(first, again)
    noisy = (first.standard_error > 1e-3).any(axis=-1)
    # Both are multiples of 1 / 256 in a blend of two colours: equal by chance in a few pixels.
    assert (first.image != other.image).any(axis=-1)[noisy].mean() > 0.7
    assert_alike(first, other)


def test_picture_size_does_not_enter_the_view():
    # A pixel's pattern depends on its place, but its truth only on where it looks: the middle third of a picture.
    scene = random_cards(6).scene
    wide = scene.camera.with_size((36, 9))
    one, other = render(scene, samples=1024), render(scene, samples=1024, camera=wide, seed=9)
    parts = {name: getattr(other, name)[:, 12:24] for name in ("image", "standard_error", "samples")}
    assert_alike(one, replace(other, **parts))


def test_what_is_hidden_changes_nothing():
    shot, lens = flat_scene.camera(12, 9, 12.0), ThinLens(0.3, 1.5)
    wall = flat_scene.rectangle(-99, 99, -99, 99, 4.0, (0.2, 0.4, 0.6))
    card = flat_scene.rectangle(-0.2, 0.4, -0.3, 0.1, 1.0, (0.9, 0.1, 0.3))
    hidden = flat_scene.rectangle(-2, 1, -1, 3, 8.0, (50.0, 0.0, 0.0))
    seen, behind = (flat_scene.scene_of(parts, shot, lens) for parts in ([wall, card], [wall, card, hidden]))
    assert_same_bits(render(seen), render(behind))


@pytest.mark.parametrize("radius", [0.02, 0.2])
def test_the_light_of_a_lamp_does_not_depend_on_focus(radius):
    # A lamp of 3 x 2 pixels at depth 2 sends 6 times its radiance, wherever it goes in a picture large enough.
    p = 16.0
    lamp = flat_scene.rectangle(-1.5 * 2 / p, 1.5 * 2 / p, -1.0 * 2 / p, 1.0 * 2 / p, 2.0, (10.0, 20.0, 0.0))
    shot = flat_scene.camera(31, 31, p)
    for focus in (0.25, 1.0, 1.9, 2.0, 7.0, np.inf):
        result = render(
            flat_scene.scene_of([lamp], shot), lens=ThinLens(radius, focus), pixel_filter="box", samples=512
        )
        error = np.sqrt((result.standard_error.astype(float) ** 2).sum(axis=(0, 1)))
        # Independent pixels: 4 standard errors of their sum, and float32.
        np.testing.assert_array_less(np.abs(result.image.sum(axis=(0, 1)) - [60.0, 120.0, 0.0]), 4 * error + 1e-3)


@pytest.mark.parametrize("gap", [1e-6, 1e-4, 1e-2])
@pytest.mark.parametrize("swapped", [False, True])
def test_small_lens_and_pinhole_agree_on_which_of_two_close_surfaces_is_seen(gap, swapped):
    # A label on a wall, nearer by a relative gap. Embree picks the triangle in float32: below 1e-7 it may be either.
    label = flat_scene.rectangle(-9.1, 9.0, -9.0, 9.0, 2.0, (1.0, 0.0, 0.0))
    wall = flat_scene.rectangle(-9.3, 9.2, -9.1, 9.0, 2.0 * (1.0 + gap), (0.0, 1.0, 0.0))
    shot, lens = flat_scene.camera(8, 6, 8.0), ThinLens(1e-3, 2.0)
    scene = flat_scene.scene_of([wall, label] if swapped else [label, wall], shot, lens)
    pinhole = View(scene, shot, lens).pinhole().color
    assert (pinhole == np.float32([1.0, 0.0, 0.0])).all()
    # Nothing is blurred: no edge is in the picture.
    np.testing.assert_array_equal(render(scene).image, pinhole)

"""Lens rays through packed layers by hand: what belongs to a texel, to the picture and to a surface, on the border too.

Pictures are one texel high (or wide). A ray of pixel x through lens point (v, 0), with the focal plane at u = f px of
parallax, is over x + 1/2 + (u - f) v at u. All numbers are binary fractions, so that borders are met exactly.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from refdof import Light, ThinLens, View
from refdof.methods.lensblur.layer_trace import Choices, new_stack, trace_layers
from refdof.optics.pixel_samples import LensPointSets
from refdof.raster.rays.gbuffer import GBUFFER_CHANNELS
from tests import flat_scene

pytestmark = pytest.mark.fast
BACKGROUND = (0.25, 0.5, 0.75)


def stack_of(layers, width):
    """(N, 1, width) of N layers {column: u}."""
    parallax = np.full((len(layers), 1, width), -np.inf)
    for k, layer in enumerate(layers):
        for column, u in layer.items():
            parallax[k, 0, column] = u
    return parallax


def trace(parallax, color, lens, focus, extension=0.0, complete=True, light=None, pinhole=None, **words):
    height, width = parallax.shape[1:]
    shot = flat_scene.camera(width, height, 8.0)
    view = View(flat_scene.scene_of([], shot, background=BACKGROUND, light=light), shot, ThinLens(1.0, 1.0))
    lens = np.array(lens, float).reshape(-1, 2)
    pattern = LensPointSets(lens[None], np.ones((1, len(lens))), np.zeros((1, 1), np.int32))
    pinhole = np.zeros((height, width, 3), np.float32) if pinhole is None else pinhole
    stack, choices = new_stack(parallax, extension, complete), Choices(misses="black", **words)
    return trace_layers(stack, color, view.surfaces(), view.projection(), focus, pattern, pinhole, choices)


def meet(layers, pixel, v, focus, width=4, upright=False, **words):
    """(layer, column) that the ray of a pixel meets, "background" or "missed"; `upright` swaps x and y."""
    parallax, lens = stack_of(layers, width), (v, 0.0)
    color = np.ones((len(layers), 1, width, 3), dtype=np.float32)
    color[..., 0], color[..., 1] = np.arange(len(layers))[:, None, None], np.arange(width)
    color[..., 2] = 9.0
    if upright:  # y is up in the lens and down in the picture
        parallax, color, lens = parallax.transpose(0, 2, 1), color.transpose(0, 2, 1, 3), (0.0, -v)
    found = []
    for iterations in (0, 3):  # bounds and N-buffers change nothing
        traced = trace(parallax, color, lens, focus, iterations=iterations, **words)
        if traced.missed.reshape(-1)[pixel]:
            found.append("missed")
            continue
        red, green, blue = traced.image.reshape(-1, 3)[pixel].tolist()
        found.append((int(red), int(green)) if blue == 9.0 else "background")
        assert blue == 9.0 or (red, green, blue) == BACKGROUND
    assert found[0] == found[1]
    return found[0]


# Pixel 0 through v = 1 at focus 1/2: over u, so that it goes from the right to the left, from texel 2 to 1 at u = 2.
# Pixel 3 through v = -1 at focus 1/4: over 3.75 - u, from texel 1 to 2 at u = 1.75. Both end inside the picture.
LEFT, RIGHT = {"pixel": 0, "v": 1.0, "focus": 0.5}, {"pixel": 3, "v": -1.0, "focus": 0.25}


@pytest.mark.parametrize("upright", [False, True])
def test_a_sample_on_the_border_of_two_texels_is_met_in_either(upright):
    # A high sample where the ray ends and a low one where it begins: it meets neither, but is walked as a whole.
    def left(samples):
        return meet([{0: 9.0, 3: 0.25, **samples}], upright=upright, **LEFT)

    def right(samples):
        return meet([{0: 0.25, 3: 9.0, **samples}], upright=upright, **RIGHT)

    assert left({2: 2.0}) == left({2: 2.0, 1: 2.0}) == (0, 2)
    assert left({1: 2.0}) == left({1: 1.5}) == (0, 1)
    assert left({0: 0.5}) == (0, 0)
    assert left({2: 1.75}) == left({1: 2.25}) == "background"
    assert right({1: 1.75}) == right({1: 1.75, 2: 1.75}) == (0, 1)
    assert right({2: 1.75}) == right({2: 1.5}) == (0, 2)
    assert right({1: 1.5}) == right({2: 2.0}) == "background"


@pytest.mark.parametrize("upright", [False, True])
def test_a_slow_ray_crosses_texels_too(upright):
    # Over 1/2 + (u - 1) / 512: one texel farther at 513 px, between them the border at 257.
    words = {"pixel": 0, "v": 2.0**-9, "focus": 1.0, "upright": upright}
    assert meet([{1: 300.0}], **words) == (0, 1)
    assert meet([{0: 300.0}], **words) == "background"
    assert meet([{0: 200.0}], **words) == (0, 0)
    assert meet([{1: 300.0, 0: 900.0}], **words) == (0, 1)  # from texel 2 on, where it is at 900


@pytest.mark.parametrize("upright", [False, True])
def test_a_ray_comes_into_the_picture_at_its_border(upright):
    # Over 4, the picture's end, at u = 4; and over 0 at u = 3.75.
    assert meet([{3: 4.25}], upright=upright, **LEFT) == "missed"  # it comes in behind that
    assert meet([{3: 4.0}], upright=upright, **LEFT) == (0, 3)
    assert meet([{3: 3.75}], upright=upright, **LEFT) == (0, 3)
    assert meet([{2: 4.25}], upright=upright, **LEFT) == "background"  # not at the border
    assert meet([{0: 4.0}], upright=upright, **RIGHT) == "missed"
    assert meet([{0: 3.75}], upright=upright, **RIGHT) == (0, 0)
    assert meet([{1: 4.0}], upright=upright, **RIGHT) == "background"


def test_a_ray_that_stays_in_the_picture_meets_what_is_as_near_as_may_be():
    for u in (1.0, 1e31, 1e300):
        assert meet([{1: u}], pixel=1, v=0.0, focus=1.0) == (0, 1)


def test_a_pack_is_not_walked_below_what_another_was_met_at():
    # Met at 2.5 in texel 2, in one step. The next pack's walk begins there, too, at 2.75, and leaves that texel at 2.
    parallax = stack_of([{2: 2.5}, {}, {}, {}, {0: 2.75}], 4)
    traced = trace(parallax, np.zeros((5, 1, 4, 3), np.float32), (1.0, 0.0), 0.5, iterations=0)
    assert traced.missed[0, 0] == 0.0
    assert traced.steps[0, 0] == 2.0


@pytest.mark.parametrize("upright", [False, True])
def test_a_ray_that_ends_outside_the_picture_is_missed(upright):
    # Ends at 1/2 - f v from the left side, and at width - 1/2 + f |v|.
    words = {"upright": upright, "layers": [{}]}
    assert meet(pixel=0, v=1.0, focus=0.5, **words) == "background"  # at 0, which is inside
    assert meet(pixel=0, v=1.0, focus=0.75, **words) == "missed"
    assert meet(pixel=3, v=-1.0, focus=0.5, **words) == "missed"  # at 4, which is outside
    assert meet(pixel=3, v=-1.0, focus=0.25, **words) == "background"
    # In a full stack that question comes before the last layer's.
    assert meet([{3: 9.0}], pixel=3, v=-1.0, focus=0.5, upright=upright, complete=False) == "missed"


def test_one_ray_that_leaves_is_enough():
    # Two rays: one stays in the picture, the other ends outside.
    traced = trace(stack_of([{}], 4), np.zeros((1, 1, 4, 3), np.float32), [(0.0, 0.0), (1.0, 0.0)], 0.75)
    np.testing.assert_array_equal(traced.missed[0], [0.5, 0.0, 0.0, 0.0])
    assert_allclose(traced.image[0, 0], np.array(BACKGROUND) / 2.0, rtol=1e-6)


@pytest.mark.parametrize(
    ("stored", "complete", "seen"), [(2, False, "missed"), (1, False, "background"), (2, True, "background")]
)
def test_a_ray_that_ends_behind_a_full_stack_is_missed(stored, complete, seen):
    # Pixel 1 through v = 1/2 at focus 1: over 1 + u / 2, so it is in texel 1 below u = 2, and ends there.
    column = [{1: 9.0}, {1: 8.0}][:stored] + [{}] * (2 - stored)
    assert meet(column, pixel=1, v=0.5, focus=1.0, complete=complete) == seen


def test_of_surfaces_in_one_place_the_first_layer_counts():
    # Into texel 1 at 2, behind three samples or four. The fourth and the fifth, which is in the next pack, agree.
    assert meet([{1: 9.0}, {1: 8.0}, {1: 7.0}, {1: 1.5}, {1: 1.5}], **LEFT) == (3, 1)
    assert meet([{1: 9.0}, {1: 8.0}, {1: 7.0}, {1: 6.0}, {1: 1.5}], **LEFT) == (4, 1)


# --- extension: a sample is met at the side of its texel, too


@pytest.mark.parametrize("upright", [False, True])
def test_a_sample_is_met_at_the_side_from_above_its_own_surface(upright):
    # Into texel 1 at 2, where the sample is at 2.5. Before it, texel 2 has a sample that the ray has not passed: below
    # 2, and at most the extension below 2.5.
    for extension in (0.5, 1.0, 2.0):
        for before in (2.125, 2.0, 1.75, 1.5, 1.25, 0.5, 0.25):
            wanted = (0, 2) if before >= 2.0 else (0, 1) if before >= 2.5 - extension else "background"
            assert meet([{2: before, 1: 2.5}], extension=extension, upright=upright, **LEFT) == wanted
    # Not from above nothing.
    assert meet([{1: 2.5}], extension=2.0, upright=upright, **LEFT) == "background"
    # A second sample of the texel before counts as well, in whichever pack it is.
    assert meet([{2: 9.0, 1: 2.5}, {2: 1.75}], extension=1.0, upright=upright, **LEFT) == (0, 1)
    deep = [{2: 9.0, 1: 2.5}, {2: 8.0}, {2: 7.0}, {2: 6.0}, {2: 1.75}]
    assert meet(deep, extension=1.0, upright=upright, **LEFT) == (0, 1)
    # One of another pack just where the ray comes in is not passed either, and the first layer counts.
    deep[4] = {2: 2.0}
    assert meet(deep, extension=1.0, upright=upright, **LEFT) == (0, 1)


# --- colours between texels


def colors(*reds):
    out = np.zeros((1, 1, len(reds), 3), np.float32)
    out[0, 0, :, 0] = reds
    return out


def test_neighbours_on_the_same_surface_are_blended():
    # Through v = 1/4 at focus 1 and u = 2: a quarter of a texel to the right of the pixel's centre.
    def red(parallax, *reds):
        return trace(np.array(parallax)[None, None], colors(*reds), (0.25, 0.0), 1.0, linear=True).image[0, 1, 0]

    assert red([2.0, 2.0, 2.0], 0.0, 16.0, 32.0) == 20.0
    assert red([2.0, 2.0, 1.5], 0.0, 16.0, 32.0) == 20.0  # half a pixel of parallax belongs to the surface
    assert red([2.0, 2.0, 2.5], 0.0, 16.0, 32.0) == 20.0
    assert red([2.0, 2.0, 1.4375], 0.0, 16.0, 32.0) == 16.0
    assert red([2.0, 2.0, 2.5625], 0.0, 16.0, 32.0) == 16.0
    # The other way: to the left.
    left = trace(np.full((1, 1, 3), 2.0), colors(0.0, 16.0, 32.0), (-0.25, 0.0), 1.0, linear=True).image[0, 1, 0]
    assert left == 12.0
    assert trace(np.full((1, 1, 3), 2.0), colors(0, 16, 32), (-0.25, 0.0), 1.0).image[0, 1, 0] == 16.0


@pytest.mark.parametrize("channels", [3, GBUFFER_CHANNELS])
def test_four_texels_are_blended_bilinearly_up_to_the_last(channels):
    # A quarter to the right and an eighth down, in a picture of 3 x 3 texels; at the borders the last texel repeats.
    red = np.float32([[0, 8, 24], [64, 80, 128], [256, 272, 512]])
    parallax, color = np.full((1, 3, 3), 2.0), np.zeros((1, 3, 3, channels), np.float32)
    color[0, ..., 0 if channels == 3 else 3] = red  # of attributes, the light that is given off
    image = trace(parallax, color, (0.25, -0.125), 1.0, linear=True).image[..., 0]
    wide = np.pad(red, ((0, 1), (0, 1)), mode="edge")
    across = 0.75 * wide[:, :-1] + 0.25 * wide[:, 1:]
    np.testing.assert_array_equal(image, 0.875 * across[:-1] + 0.125 * across[1:])
    # Up and to the left.
    image = trace(parallax, color, (-0.25, 0.125), 1.0, linear=True).image[..., 0]
    wide = np.pad(red, ((1, 0), (1, 0)), mode="edge")
    across = 0.75 * wide[:, 1:] + 0.25 * wide[:, :-1]
    np.testing.assert_array_equal(image, 0.875 * across[1:] + 0.125 * across[:-1])


def test_attributes_are_shaded_along_the_ray():
    # A mirror that faces the viewer, and a sun to the right and above. The ray that ends at (ax, ay) comes back along
    # ((ax - 2) / P, (2 - ay) / P, 1).
    light = Light((0.6, 0.48, 0.64), sun=(1.0, 1.0, 1.0), sky=(0, 0, 0), ground=(0, 0, 0))
    values = np.zeros((1, 4, 4, GBUFFER_CHANNELS), np.float32)
    values[..., 8], values[..., 9:12], values[..., 12] = 1.0, 1.0, 3.0
    image = trace(np.full((1, 4, 4), 2.0), values, (0.125, 0.25), 1.0, light=light).image[..., 0]
    x, y = np.arange(4) + 0.5 - 0.125, np.arange(4) + 0.5 + 0.25  # at u = 0
    right, up = np.meshgrid((x - 2.0) / 8.0, (2.0 - y) / 8.0)
    lobe = (0.6 * right + 0.48 * up + 0.64) / np.sqrt(right**2 + up**2 + 1.0)
    assert_allclose(image, lobe**3, rtol=1e-6)


def test_sets_of_lens_points_go_by_row_and_column():
    # Two by two sets: (column of the set, row of the set) is the pixel's place modulo 2.
    shot = flat_scene.camera(3, 3, 8.0)
    view = View(flat_scene.scene_of([], shot, background=BACKGROUND), shot, ThinLens(1.0, 1.0))
    points = np.zeros((4, 1, 2))
    points[1, 0, 0] = 1.0  # of pixels at odd columns and even rows only
    pattern = LensPointSets(points, np.ones((4, 1)), np.array([[0, 1], [2, 3]], np.int32))
    color = np.zeros((1, 3, 3, 3), np.float32)
    color[0, ..., 0] = np.arange(9).reshape(3, 3)
    traced = trace_layers(
        new_stack(np.full((1, 3, 3), 2.0), 0.0, True), color, view.surfaces(), view.projection(), 1.0, pattern,
        np.zeros((3, 3, 3), np.float32),
    )  # fmt: skip
    # Through v = 1 at u = 2, one texel to the right.
    np.testing.assert_array_equal(traced.image[..., 0], [[0, 2, 2], [3, 4, 5], [6, 8, 8]])


def test_all_rays_missed_show_the_pinhole():
    shot = flat_scene.camera(2, 1, 8.0)
    view = View(flat_scene.scene_of([], shot, background=BACKGROUND), shot, ThinLens(1.0, 1.0))
    pattern = LensPointSets(np.array([[[-4.0, 0.0]]]), np.ones((1, 1)), np.zeros((1, 1), np.int32))
    pinhole = np.float32([[[1, 2, 3], [4, 5, 6]]])
    stack = new_stack(np.full((1, 1, 2), 0.25), 0.0, False)
    for misses, wanted in (("renormalise", pinhole), ("pinhole", pinhole), ("black", np.zeros((1, 2, 3)))):
        traced = trace_layers(
            stack,
            np.ones((1, 1, 2, 3), np.float32),
            view.surfaces(),
            view.projection(),
            1.0,
            pattern,
            pinhole,
            Choices(misses=misses),
        )
        np.testing.assert_array_equal(traced.missed, 1.0)
        np.testing.assert_array_equal(traced.image, wanted)

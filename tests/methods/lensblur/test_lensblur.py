"""Lens blur on tiny pictures: against its naive twin, lossless cuts, misses, closed forms."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from refdof import InputError, ThinLens, View
from refdof.methods.lensblur.layer_trace import Choices, new_stack, trace_layers
from refdof.methods.lensblur.method import FOOTPRINTS
from refdof.methods.lensblur.tile_walk import TILE
from refdof.optics.pixel_samples import LensPointSets
from refdof.rendering import make_params, render_view
from tests import flat_scene
from tests.methods.lensblur import naive

pytestmark = pytest.mark.fast

BACKGROUND = (0.25, 0.5, 0.75)
SIZES = [(7, 5), (1, 1), (1, 6), (9, 1), (8, 6)]


def empty_view(width, height):
    shot = flat_scene.camera(width, height, 10.0)
    return View(flat_scene.scene_of([], shot, background=BACKGROUND), shot, ThinLens(1.0, 1.0))


def random_layers(random, count, width, height, nearest):
    """Layers (N, H, W) of parallax, front to back, from touching to far apart, slanted, with holes and open stacks."""
    step = nearest / (count + 1) * random.choice([0.1, 1.0, 3.0], (count, height, width))
    slant = 0.3 * np.arange(width) * random.normal()
    parallax = nearest + slant - np.cumsum(step * random.random(step.shape), axis=0)
    return np.where((parallax > 0.0) & (random.random((height, width)) < 0.9), parallax, -np.inf)


def random_pattern(random, rays, reach):
    points = random.normal(size=(4, rays, 2))
    points *= reach * np.sqrt(random.random((4, rays, 1))) / np.linalg.norm(points, axis=-1, keepdims=True)
    points[:, 0] = [[0.0, 0.0], [reach, 0.0], [0.0, -reach], [-reach, 0.0]]  # along the axes, and none at all
    weights = random.random((4, rays))
    weights[1] = 1.0
    return LensPointSets(points, weights, random.integers(0, 4, (3, 3)).astype(np.int32))


def picture(seed, size, dtype=np.float64, twin=True, **words):
    """A random stack traced, the twin's picture, and where the twin's answer hangs on a rounding."""
    random = np.random.default_rng([seed, 5])
    width, height = size
    count = int(random.integers(0, 10))
    nearest = float(random.choice([0.5, 3.0, 12.0]))
    parallax = random_layers(random, count, width, height, nearest).astype(dtype)
    color = random.random((count, height, width, 3)).astype(np.float32)
    pinhole = random.random((height, width, 3)).astype(np.float32)
    pattern = random_pattern(random, 6, float(random.choice([0.1, 0.6, 1.0])))
    focus, extension = nearest * random.random(), float(random.choice([0.0, 0.5, 1.0]))
    complete = bool(random.integers(2))
    view = empty_view(width, height)
    stack = new_stack(parallax, extension, complete, int(random.integers(1, 4)))
    ours = trace_layers(stack, color, view.surfaces(), view.projection(), focus, pattern, pinhole, Choices(**words))

    if not twin:
        return (ours,)
    sets = pattern.set[np.arange(height)[:, None] % 3, np.arange(width) % 3]
    facts = (color, BACKGROUND, pinhole, focus, pattern.points[sets], pattern.weights[sets], extension, complete)
    if count == 0:  # the twin wants a layer
        facts = (np.zeros((1, height, width, 3)), *facts[1:])
        parallax = np.full((1, height, width), -np.inf)
    image, hit = naive.trace(parallax.astype(np.float64), *facts)
    edge = np.zeros((height, width), dtype=bool)
    slip = 1e-9 if dtype == np.float64 else 1e-4  # some 100 roundings of a place of up to 20 px
    for shift in np.array([(1, 0.3, 0), (-1, -0.3, 0), (-0.3, 1, 0), (0.3, -1, 0), (0, 0, 1), (0, 0, -1)]) * slip:
        edge |= (naive.trace(parallax.astype(np.float64), *facts, shift=shift)[1] != hit).any(axis=-1)
    return ours, image, edge


@pytest.mark.long
@settings(max_examples=20)
@given(st.integers(0, 10**6), st.sampled_from(SIZES), st.sampled_from(["closed", "rays"]), st.integers(0, 4))
def test_every_ray_meets_what_an_exhaustive_march_meets(seed, size, footprint, iterations):
    ours, image, edge = picture(seed, size, stride=FOOTPRINTS[footprint], iterations=iterations)
    # Colours are float32 and so is the picture: half an ulp of 1, and sums in another order.
    np.testing.assert_allclose(ours.image[~edge], image[~edge], atol=2e-7)


@pytest.mark.parametrize("seed", range(6))
def test_float32_meets_the_same(seed):
    ours, image, edge = picture(seed, (8, 6), np.float32)
    np.testing.assert_allclose(ours.image[~edge], image[~edge], atol=2e-7)  # as above
    assert edge.mean() < 0.2


@pytest.mark.long
def test_a_row_of_more_than_one_tile():
    ours, image, edge = picture(1, (TILE + 3, 2), np.float32)
    np.testing.assert_allclose(ours.image[~edge], image[~edge], atol=2e-7)  # as above
    assert edge.mean() < 0.2


@pytest.mark.long
@settings(max_examples=20)
@given(st.integers(0, 10**6), st.sampled_from(SIZES), st.sampled_from([np.float32, np.float64]))
def test_bounds_and_n_buffers_change_no_bit(seed, size, dtype):
    whole, *_ = picture(seed, size, dtype, twin=False, iterations=0)
    for footprint in ("closed", "rays"):
        cut, *_ = picture(seed, size, dtype, twin=False, stride=FOOTPRINTS[footprint], iterations=4)
        np.testing.assert_array_equal(cut.image, whole.image)
        np.testing.assert_array_equal(cut.missed, whole.missed)
        assert (cut.steps <= whole.steps).all()
        assert (cut.near <= whole.near).all()


def test_a_fifth_layer_is_met_from_the_side_above_a_first_one():
    # Two texels: u = 9.5, and 20, 19, 18, 17, 10. The ray x = 0.5 - (u - 10.2) comes from the first into the second at
    # u = 9.7: below 10, above 9.5. The second pack alone holds 10, the first alone 9.5.
    parallax = np.full((5, 1, 2), -np.inf)
    parallax[0, 0, 0], parallax[:, 0, 1] = 9.5, (20.0, 19.0, 18.0, 17.0, 10.0)
    color = np.zeros((5, 1, 2, 3), dtype=np.float32)
    color[4, 0, 1] = (1.0, 2.0, 3.0)
    pattern = LensPointSets(np.array([[[-1.0, 0.0]]]), np.ones((1, 1)), np.zeros((1, 1), dtype=np.int32))
    view = empty_view(2, 1)
    for iterations in (0, 3):
        traced = trace_layers(
            new_stack(parallax, 1.0, True), color, view.surfaces(), view.projection(), 10.2, pattern,
            np.zeros((1, 2, 3), dtype=np.float32), Choices(iterations=iterations),
        )  # fmt: skip
        np.testing.assert_array_equal(traced.image[0, 0], [1.0, 2.0, 3.0])


def cards(*parts, width=24, height=16, radius=2.0, focus=2.0, background=BACKGROUND):
    """A view of cards; a card at depth d has 10 radius |1 / focus - 1 / d| px of blur."""
    shot = flat_scene.camera(width, height, 10.0)
    return View(flat_scene.scene_of(parts, shot, background=background), shot, ThinLens(radius, focus))


def wall(depth, color=(1.0, 1.0, 1.0), left=-99.0):
    return flat_scene.rectangle(left, 99.0, -99.0, 99.0, depth, color)


@pytest.mark.long
def test_missed_rays_count_as_asked():
    view = cards(wall(1.0))  # a circle of 10 px: every pixel loses some rays across the border, 16 px are all there is
    results = {
        m: render_view("lensblur", view, True, misses=m, samples=36) for m in ("renormalise", "black", "pinhole")
    }
    missed = results["black"].stages["missed"][..., None]
    assert 0.3 < missed.mean() < 0.9
    np.testing.assert_allclose(results["renormalise"].image, 1.0, atol=1e-6)
    np.testing.assert_allclose(results["pinhole"].image, 1.0, atol=1e-6)
    np.testing.assert_allclose(results["black"].image, np.broadcast_to(1.0 - missed, (16, 24, 3)), atol=1e-6)


@pytest.mark.long
def test_a_full_stack_hides_what_may_be_behind_it():
    # Behind the left card's edge lies the wall, which one layer does not hold: rays past the edge are missed there, and
    # no background leaks in.
    parts = [flat_scene.rectangle(-99.0, 0.0, -99.0, 99.0, 1.5, (0.0, 0.0, 0.0)), wall(3.0, (0.0, 0.0, 0.0))]
    one, two = (render_view("lensblur", cards(*parts), True, layers=k, samples=36) for k in (1, 2))
    assert one.image.max() == two.image.max() == 0.0
    inner = np.s_[4:12, 8:12]
    assert one.stages["missed"][inner].max() > 0.1
    assert two.stages["missed"][inner].max() == 0.0


@pytest.mark.long
def test_linear_colours_make_a_blurred_ramp_exact():
    # A ramp in one plane: its mean over the lens is its value at the mean lens point. 10 * 2 * (1/2 - 1/4) = 5 px.
    ramp = flat_scene.strips(np.array([-99.0, 99.0]), np.array([4.0, 4.0]), -99.0, 99.0, np.array([0.0, 1.0]))
    view = cards(ramp, background=(0, 0, 0))
    linear, nearest = (render_view("lensblur", view, True, filter=f) for f in ("linear", "nearest"))
    mean = linear.stages["points"][0].mean(axis=0)
    x = np.arange(24) + 0.5 - 12.0 - 5.0 * mean[0]
    truth = 0.5 + x / 10.0 * 4.0 / 198.0
    inner = np.s_[6:10, 6:18]
    assert np.abs(linear.image[inner][..., 0] - truth[6:18]).max() < 1e-6  # float32
    assert np.abs(nearest.image[inner][..., 0] - truth[6:18]).max() > 1e-5


@pytest.mark.long
def test_a_slanted_plane_has_no_slits():
    # 1 / depth = 0.62 + 0.45 t at tangent t falls by 0.9 px of parallax a pixel; 1 would cut the lens's rim.
    tangent = np.array([-1.3, 1.3])
    depth = 1.0 / (0.62 + 0.45 * tangent)
    view = cards(flat_scene.strips(tangent * depth, depth, -999.0, 999.0, np.ones(2)), background=(100.0, 100.0, 100.0))
    assert render_view("lensblur", view, samples=36).image.max() <= 1.0 + 1e-6
    assert render_view("lensblur", view, samples=36, peel="plain").image.max() > 1.1  # where no sample is extended


@pytest.mark.parametrize("radius", [1e-300, 1e-30, 1e6, 1e30])
@pytest.mark.parametrize("focus", [1e-30, 2.0, np.inf])
@pytest.mark.parametrize("unit", [1e-20, 1e20])
def test_extreme_lenses_and_units_stay_inside_the_colours(radius, focus, unit):
    near = flat_scene.rectangle(-9.0 * unit, 2.0 * unit, -9.0 * unit, 9.0 * unit, 1.5 * unit, (0.2, 0.3, 0.4))
    far = flat_scene.rectangle(-99.0 * unit, 99.0 * unit, -99.0 * unit, 99.0 * unit, 4.0 * unit, (0.8, 0.7, 0.6))
    view = cards(near, far, width=5, height=4, radius=radius, focus=focus)
    image = render_view("lensblur", view, samples=5).image
    assert image.min() >= 0.2 - 1e-6
    assert image.max() <= 0.8 + 1e-6


@pytest.mark.parametrize(
    ("words", "name"),
    [
        ({"samples": 0}, "samples"),
        ({"samples": 4097}, "samples"),
        ({"layers": -1}, "layers"),
        ({"iterations": 17}, "iterations"),
        ({"peel": "onion"}, "peel"),
        ({"jitter": "nose"}, "jitter"),
        ({"pattern": "x"}, "pattern"),
        ({"footprint": "half"}, "footprint"),
        ({"misses": "white"}, "misses"),
        ({"filter": "cubic"}, "filter"),
        ({"deferred": 2}, "deferred"),
        ({"seed": -1}, "seed"),
    ],
)
def test_bad_parameters_are_named(words, name):
    with pytest.raises(InputError, match=f"^{name}: got"):
        make_params("lensblur", words)


def test_the_papers_numbers():
    params = make_params("lensblur", {})
    assert (params.samples, params.layers, params.iterations) == (100, 4, 3)  # [1]: of all figures


def test_stages_are_recorded():
    stages = render_view("lensblur", cards(wall(3.0), wall(1.0, left=0.0)), True, samples=5).stages
    assert {name: array.shape for name, array in stages.items()} == {
        "parallax": (4, 16, 24),
        "layer_count": (16, 24),
        "lowest": (1, 5, 8, 12),
        "highest": (1, 5, 8, 12),
        "points": (1, 5, 2),
        "set": (1, 1),
        "near": (1, 16, 24),
        "far": (1, 16, 24),
        "steps": (16, 24),
        "missed": (16, 24),
    }
    np.testing.assert_array_equal(stages["layer_count"][0], [1] * 12 + [2] * 12)
    np.testing.assert_array_equal(stages["parallax"][0, 0], np.float32([20 / 3] * 12 + [20.0] * 12))

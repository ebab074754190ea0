"""Cascaded layers: the naive twin in the paper's units, closed forms, printed numbers, and rings at layer borders."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import refdof
from refdof import InputError, ThinLens, View
from refdof.methods import cascaded
from refdof.methods.cascaded import Params, blur_buffers, layering_of
from refdof.methods.cascaded.layers import cluster_layers, deviation, filter_layers, inverse_coc
from refdof.stages import StageRecorder
from tests import flat_scene
from tests.methods.cascaded import naive

pytestmark = pytest.mark.fast

F, F_NUMBER = 0.1, 1.4  # the paper's lens [m]


def shot(focus, width=11, height=9, pixels_per_tangent=60.0):
    """The paper's lens behind a small picture, and the same in the twin's terms."""
    camera = flat_scene.camera(width, height, pixels_per_tangent)
    image_distance = F * focus / (focus - F)
    twin = naive.Lens(F, F_NUMBER, focus, image_distance / pixels_per_tangent)
    return camera, ThinLens.from_f_number(F, F_NUMBER, focus), twin


def buffers(seed, count=3, width=11, height=9, near=0.15, far=2.5):
    """Random buffers, front to back, with gaps and some background."""
    random = np.random.default_rng(seed)
    color = random.random((count, height, width, 3))
    depth = np.sort(random.uniform(near, far, (count, height, width)), axis=0)
    depth[-1][random.random((height, width)) < 0.3] = np.inf
    depth[-1][random.random((height, width)) < 0.3] = np.nan
    return color, depth


def flat(value, width=11, height=9):
    return np.full((1, height, width), value)


@pytest.mark.parametrize("boundary", ["hard", "extrapolate"])
@pytest.mark.parametrize("border", ["clamp", "transparent"])
@pytest.mark.parametrize("cascade", [True, False])
@pytest.mark.parametrize("focus", [0.3, 0.8, 20.0])
def test_picture_is_the_naive_twins(focus, cascade, border, boundary):
    camera, lens, twin = shot(focus)
    color, depth = buffers(1)
    expected = naive.picture(color, depth, twin, cascade, border, boundary)
    params = Params(cascade=cascade, border=border, boundary=boundary)
    found = blur_buffers(color, depth, camera, lens, params)
    # float64: sums of up to 1000 taps of numbers below 1, divided by alpha above 0.05.
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11)
    single = blur_buffers(color.astype(np.float32), depth, camera, lens, params)
    assert single.dtype == np.float32
    # The same in float32, 2^29 times coarser, with fewer roundings that add up like random ones.
    np.testing.assert_allclose(single, expected, rtol=0, atol=2e-5)


@pytest.mark.parametrize("boundary", ["hard", "extrapolate"])
def test_layers_are_the_naive_twins(boundary):
    camera, lens, twin = shot(0.8)
    color, depth = buffers(2)
    recorder = StageRecorder(on=True)
    blur_buffers(color, depth, camera, lens, Params(boundary=boundary), recorder)
    k_focus, parts = naive.layers(color, depth, twin, boundary)
    assert len(parts) == len(recorder.stages["layers"]) >= 5
    np.testing.assert_allclose(recorder.stages["layers"], parts, rtol=0, atol=1e-11)
    expected = [twin.layer_coc(abs(k - k_focus)) / 4.0 / twin.pitch for k in range(len(parts))]
    np.testing.assert_allclose(recorder.stages["deviation"], expected, rtol=1e-13)


@given(st.integers(0, 200), st.floats(0.5, 4.0))
def test_the_recursion_has_its_closed_form(n, step):
    # Eq. (15): variances of the steps add up; n(n+1)(2n+1)/6 is the sum of squares.
    assert deviation(n, step) ** 2 == pytest.approx(step**2 * sum(k * k for k in range(n + 1)), rel=1e-13)


def test_steps_of_a_cascade_are_its_distances_from_focus():
    layering = filter_layers(-30.0, 20.0, 50.0, 1.0, 1.0, 1000.0)
    n = np.arange(len(layering.step)) - layering.focus
    np.testing.assert_allclose(layering.step, np.abs(n), rtol=0, atol=1e-10)  # differences of numbers below 1000
    assert 0 < layering.focus < len(n) - 1


@given(st.floats(-50.0, 50.0), st.floats(0.11, 30.0))
def test_depths_invert_the_circle_of_confusion(coc, focus):
    camera, lens, twin = shot(focus)
    scale = camera.pixels_per_tangent * lens.radius
    depth = float(inverse_coc(coc, scale, focus))
    if depth < 1e6:
        # 1 / depth is a difference of numbers below 1 / focus + 50 / scale.
        room = 1e-13 * (1.0 / focus + 50.0 / scale) * scale
        assert float(lens.coc_px(depth, camera)) == pytest.approx(coc, abs=room)
        printed = twin.d1(2 * abs(coc) * twin.pitch) if coc < 0 else twin.d2(2 * coc * twin.pitch)
        assert depth == pytest.approx(printed, rel=1e-9 * max(depth / focus, 1.0))


def test_layers_hold_the_scene_and_no_more():
    camera, lens, twin = shot(0.8)
    layering = layering_of(np.array([[[0.4, 5.0]]]).repeat(2, 1), camera, lens)
    k_focus, count = naive.layer_count(twin, 0.4, 5.0)
    assert (layering.focus, len(layering.deviation)) == (k_focus, count)
    expected = [twin.anchor(k, k_focus) for k in range(-1, count)]
    np.testing.assert_allclose(layering.bounds, expected, rtol=1e-11)
    assert layering.bounds[0] <= 0.4 < layering.bounds[1]
    assert layering.bounds[-2] < 5.0 <= layering.bounds[-1]


@pytest.mark.parametrize(("focus", "diameter"), [(3.0, 105.1), (18.5, 16.56)])
def test_the_papers_shots_on_a_sensor_of_24_mm(focus, diameter):
    camera, lens = paper_shot(focus)
    # By hand: 0.01 / (1.4 * 2.9) * 1024 / 0.024 = 105.09 and 0.01 / (1.4 * 18.4) * 1024 / 0.024 = 16.563.
    assert 2.0 * lens.coc_px(np.inf, camera) == pytest.approx(diameter, rel=3e-4)


def test_the_papers_anchors_behind_the_stone_wall():
    camera, lens = paper_shot(18.5)
    layering = layering_of(np.full((1, 4, 4), np.inf), camera, lens)
    # Eq. (7) by hand for d = 2, 6.472 and 11.955 px; the next, 18.4 px, breaks Eq. (8): it is more than 16.56 px.
    np.testing.assert_allclose(layering.bounds[1:-1], [21.04, 30.37, 66.50], rtol=3e-4)
    assert layering.bounds[-1] == np.inf


def paper_shot(focus):
    sensor, rows = 0.024, 1024
    camera = flat_scene.camera(rows, rows, F * focus / (focus - F) * rows / sensor)
    return camera, ThinLens.from_f_number(F, F_NUMBER, focus)


@pytest.mark.parametrize("placement", ["filter", "kmeans"])
def test_one_surface_in_focus_is_itself(placement):
    camera, lens, _ = shot(0.8)
    color = buffers(3, 1)[0]
    np.testing.assert_array_equal(blur_buffers(color, flat(0.8), camera, lens, Params(placement=placement)), color[0])


VARIANTS = (
    {},
    {"cascade": False},
    {"filter": "box"},
    {"filter": "pyramid"},
    {"ramp": "none"},
    {"ramp": "as_printed"},
    {"boundary": "extrapolate"},
    {"border": "transparent"},
    {"boundary": "as_printed"},
    {"placement": "kmeans"},
    {"sigma_step": 0.6},
)


@pytest.mark.parametrize("options", VARIANTS)
def test_a_constant_colour_stays(options):
    camera, lens, _ = shot(0.8)
    _, depth = buffers(4)
    color = np.broadcast_to([0.2, 0.5, 4.0], (*depth.shape, 3)).copy()
    found = blur_buffers(color, depth, camera, lens, Params(**options))
    np.testing.assert_allclose(found, color[0], rtol=1e-12)  # colours are alpha times one number, but for roundings


def test_unblurred_layers_compose_to_alpha_one():
    camera, lens, _ = shot(0.8)
    color, depth = buffers(5)
    recorder = StageRecorder(on=True)
    blur_buffers(color, depth, camera, lens, recorder=recorder)
    left = np.prod(1.0 - recorder.stages["layers"][..., 3], axis=0)
    assert left.max() == 0.0  # one layer has weight 1 at every pixel


@pytest.mark.parametrize("depth", [0.4, 2.0])
def test_cascade_is_one_blur_for_an_unoccluded_layer(depth):
    camera, lens, _ = shot(0.8, 61, 59, 200.0)
    color = np.zeros((1, 59, 61, 3))
    color[0, 29, 30] = 1.0
    surface = np.full((1, 59, 61), np.nan)
    surface[0, 24:35, 25:36] = depth
    one, many = (
        blur_buffers(color, surface, camera, lens, Params(cascade=c, ramp="none", normalize=False))[..., 0]
        for c in (False, True)
    )
    assert len(layering_of(surface, camera, lens).deviation) >= 3
    # Kernels cut at 3 deviations lose 0.27 % of their light in tails: differences of that share of the peak, twice.
    assert np.abs(one - many).max() < 2 * 0.0027 * one.max()
    assert one.sum() == pytest.approx(many.sum(), rel=1e-6)


def slanted(focus=0.8):
    """A plane through the focal plane, its inverse depth linear along x, seen in front of black."""
    camera, lens, _ = shot(focus, 96, 24, 160.0)
    nearness = np.linspace(1.0 / 0.45, 1.0 / 1.6, 96)
    depth = np.stack([np.broadcast_to(1.0 / nearness, (24, 96)), np.full((24, 96), np.inf)])
    color = np.zeros((2, 24, 96, 3))
    color[0] = 1.0
    return color, depth, camera, lens


def darkest(depth_count=2, **options):
    """How far a white slanted plane falls below white, away from the borders."""
    color, depth, camera, lens = slanted()
    found = blur_buffers(color[:depth_count], depth[:depth_count], camera, lens, Params(**options))
    return 1.0 - found[12, 16:-16, 0].min()


def test_rings_on_a_slanted_plane():
    # Where a layer's blurred edge meets its neighbour's, alpha is 1 - (1 - a)(1 - b): 3 / 4 for a = b = 1 / 2, and a
    # little less where a third layer is near.
    assert 0.2 < darkest(1, ramp="none", normalize=False) < 0.35
    # With nothing behind, division by alpha takes them away; in front of black, only matting does.
    assert darkest(1, ramp="none") < 1e-12
    assert darkest(2, ramp="none") > 0.15
    # Ramps leave a dip only where both copies are thin: a hundredth of the ring. Without ramps into the first and the
    # last core it is a twentieth, at the edges of those.
    assert darkest(2, boundary="extrapolate") < 0.003
    assert darkest(1, boundary="extrapolate", normalize=False) < 0.003
    assert 0.003 < darkest(2) < 0.02
    assert darkest(1) < 1e-12


@pytest.mark.parametrize("name", ["gaussian", "box", "pyramid"])
def test_a_card_that_fills_the_picture_hides_what_is_behind_it(name):
    camera, lens, _ = shot(0.8, 40, 30)
    depth = np.broadcast_to(np.array([0.25, 2.0])[:, None, None], (2, 30, 40))
    assert lens.coc_px(0.25, camera) < -5.0
    color = np.broadcast_to(np.array([1.0, 0.0])[:, None, None, None], (2, 30, 40, 3))
    # The lens sees nothing but the card, at any pixel; 1e-12: sums of taps that add up to 1 but for roundings.
    found = blur_buffers(color, depth, camera, lens, Params(filter=name))
    np.testing.assert_allclose(found, 1.0, rtol=0, atol=1e-12)
    # With nothing outside, card and backdrop keep half of their opacity along each axis, and a little more, since the
    # corner pixel's centre is inside: the card has (1/4) / (1/4 + 3/4 1/4) = 0.57 of a corner.
    leaking = blur_buffers(color, depth, camera, lens, Params(filter=name, border="transparent"))
    assert leaking[0, 0, 0] == pytest.approx(0.57, abs=0.06)


def test_the_papers_parameters_are_other_ones():
    usual, printed = Params(), Params(**cascaded.METHOD.paper)
    assert cascaded.METHOD.paper
    assert all(getattr(usual, name) != getattr(printed, name) for name in cascaded.METHOD.paper)


def test_the_printed_ramp_rings():
    assert darkest(2, ramp="as_printed") > 3.0 * darkest(2)


def test_the_printed_boundary_blurs_the_foreground_too_little():
    camera, lens, _ = shot(0.8)
    depth = flat(0.3)
    meant, printed = (layering_of(depth, camera, lens, Params(boundary=b)) for b in ("hard", "as_printed"))
    assert len(printed.deviation) == len(meant.deviation) - 1
    assert printed.deviation[0] == meant.deviation[1] < meant.deviation[0]
    assert printed.focus == meant.focus - 1


def test_k_means_puts_layers_where_surfaces_are():
    camera, lens, _ = shot(0.8)
    coc = np.repeat([-9.0, -8.0, 6.0], 50)
    layering = cluster_layers(coc, 4, camera.pixels_per_tangent * lens.radius, 0.8, 1.0)
    assert layering.deviation[layering.focus] == 0.0
    # Bins of the histogram are 15 / 4096 px wide; a deviation is half a radius.
    np.testing.assert_allclose(layering.deviation, [4.25, 0.0, 3.0], rtol=0, atol=0.5 * 15 / 4096)
    wider = np.concatenate([coc, np.repeat([12.0], 50)])
    assert len(cluster_layers(wider, 5, camera.pixels_per_tangent * lens.radius, 0.8, 1.0).deviation) == 4


def test_steps_between_empty_layers_are_joined():
    camera, lens, _ = shot(0.8, 41, 43)
    depth = np.full((2, 43, 41), 0.8)
    depth[0] = np.where(np.indices((43, 41))[1] < 15, 0.15, np.nan)
    color = np.random.default_rng(6).random((2, 43, 41, 3))
    joined, apart = (blur_buffers(color, depth, camera, lens, Params(ramp="none", cascade=c)) for c in (True, False))
    # One layer in front and nothing up to the focus: the joined steps are that layer's whole blur, but for roundings.
    assert len(layering_of(depth, camera, lens).deviation) >= 4
    np.testing.assert_allclose(joined, apart, rtol=0, atol=1e-12)


def test_what_is_hidden_shows_through_a_blurred_bar():
    camera, lens, _ = shot(0.8, 33, 21)
    stripes = (np.indices((21, 33))[0] // 3 % 2).astype(float)
    bar = np.abs(np.indices((21, 33))[1] - 16) < 2
    color = np.zeros((2, 21, 33, 3))
    color[0], color[1] = np.where(bar, 0.5, stripes)[..., None], stripes[..., None]
    depth = np.stack([np.where(bar, 0.3, 0.8), np.where(bar, 0.8, np.nan)])
    seen = blur_buffers(color, depth, camera, lens)[3:-3, 16, 0]
    assert np.corrcoef(seen, stripes[3:-3, 16])[0, 1] > 0.9
    alone = blur_buffers(color[:1], depth[:1], camera, lens)[3:-3, 16, 0]
    assert seen.std() > 3.0 * alone.std()


@pytest.mark.parametrize("exponent", [-300, -40, 60, 300])
def test_the_unit_of_length_changes_no_bit(exponent):
    scene = refdof.load_scene("branches")
    camera = scene.camera.with_size((20, 15))
    expected = refdof.render("cascaded", scene, camera).image
    scaled = scene.scaled(2.0**exponent)
    image = refdof.render("cascaded", scaled, scaled.camera.with_size((20, 15))).image
    np.testing.assert_array_equal(image, expected)


@pytest.mark.parametrize(
    "lens", [ThinLens(0.5, math.inf), ThinLens(5.0, 0.01), ThinLens(0.5, 1e-6), ThinLens(1e6, 2.0)]
)
def test_extreme_lenses_stay_finite(lens):
    camera = flat_scene.camera(11, 9, 60.0)
    color, depth = buffers(7)
    for placement in ("filter", "kmeans"):
        found = blur_buffers(color.astype(np.float32), depth, camera, lens, Params(placement=placement))
        assert np.isfinite(found).all()
        assert len(layering_of(depth, camera, lens, Params(placement=placement)).deviation) < 40


def test_a_background_is_there_once_and_only_buffers_that_exist_count():
    camera = flat_scene.camera(12, 8, 12.0)
    card = flat_scene.rectangle(-0.4, 0.4, -9, 9, 2.0, (0.8, 0.4, 0.2))
    scene = flat_scene.scene_of([card], camera, ThinLens(0.0, 1.0), (0.1, 0.2, 0.3))
    recorder = StageRecorder(on=True)
    cascaded.render(View(scene, camera, ThinLens(0.3, 1.0)), Params(), recorder)
    coordinate = recorder.stages["coordinate"]
    assert len(coordinate) == 2  # the card, and what is behind it
    on_card = coordinate[1, 4] >= 0
    assert on_card.sum() == 4  # 4.8 px wide around x = 6: centres 4.5 to 7.5
    whole = StageRecorder(on=True)
    cascaded.render(View(scene, camera, ThinLens(0.3, 1.0)), Params(buffers="all"), whole)
    assert np.array_equal(whole.stages["coordinate"], coordinate)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"buffers": 0}, "buffers: got 0"),
        ({"buffers": "al"}, "buffers: got 'al'; allowed are a whole number >= 1 and all"),
        ({"filter": "gauss"}, "filter: got 'gauss'; did you mean 'gaussian'"),
        ({"placement": "k"}, "placement: got 'k'"),
        ({"ramp": "up"}, "ramp: got 'up'"),
        ({"boundary": "soft"}, "boundary: got 'soft'"),
        ({"border": "mirror"}, "border: got 'mirror'"),
        ({"cascade": 1}, "cascade: got 1"),
        ({"normalize": "no"}, "normalize: got 'no'"),
        ({"sigma_step": 0.1}, "sigma_step: got 0.1"),
        ({"sigma_step": math.nan}, "sigma_step: got nan"),
    ],
)
def test_bad_parameters_are_named(values, words):
    with pytest.raises(InputError, match=words):
        Params(**values)


@pytest.mark.parametrize(
    ("color", "depth", "words"),
    [
        (np.zeros((1, 9, 12, 3)), flat(1.0), "color: got shape"),
        (np.zeros((0, 9, 11, 3)), np.zeros((0, 9, 11)), "color: got shape"),
        (np.full((1, 9, 11, 3), np.nan), flat(1.0), "color: has 297 NaN"),
        (np.zeros((1, 9, 11, 3)), flat(1.0, 12), "depth: got shape"),
        (np.zeros((1, 9, 11, 3)), flat(0.0), "depth: smallest value is 0"),
        (np.zeros((1, 9, 11, 3)), flat(np.nan), "depth: has no surface"),
    ],
)
def test_bad_buffers_are_named(color, depth, words):
    camera, lens, _ = shot(0.8)
    with pytest.raises(InputError, match=words):
        blur_buffers(color, depth, camera, lens)


@pytest.mark.parametrize("options", VARIANTS)
def test_every_option_changes_the_picture(options):
    camera, lens, _ = shot(0.8)
    color, depth = buffers(8, near=0.12)
    usual = blur_buffers(color, depth, camera, lens)
    changed = np.abs(blur_buffers(color, depth, camera, lens, Params(**options)) - usual).max()
    assert changed == 0.0 if not options else changed > 1e-3

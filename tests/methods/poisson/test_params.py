"""Params of the Poisson disc filter: every field against the naive loop, and the difference that it makes."""

import math

import numpy as np
import pytest

import refdof
from refdof import InputError, Stages
from refdof.methods.poisson import TAP_TABLES, Params, blur, bounds, code_of
from tests.methods import naive_baselines

pytestmark = pytest.mark.fast

PLANES = {"near_plane": 1.0, "focus_plane": 2.0, "far_plane": 6.0}
CHANGES = [
    {"code": "thin_lens"},
    {"max_radius": 3.0},
    {"taps": "eight"},
    {"taps": "twelve_close"},
    {"taps": "nine_grid"},
    {"taps": [(0.5, 0.25), (-1.0, 0.125)]},
    {"max_taps": 5},
    {"near_plane": 0.5},
    {"focus_plane": 2.5},
    {"far_plane": 9.0},
    {"far_limit": 0.25},
    {"small_size": 2},
    {"small_radius": 0.75},
    {"row_order": "up"},
]


def picture(height=9, width=10):
    random = np.random.default_rng(6)
    depth = random.uniform(0.8, 8.0, (height, width))
    return random.random((height, width, 3)) * 3.0, depth, 5.0 - 10.0 / depth


def naive(color, depth, coc, **use):
    """The listing's loop with the fields of `Params`, pixel by pixel; every size is a multiple of small_size."""
    value = {**dict(code="linear", max_radius=5.0, taps="twelve", max_taps=None, far_limit=1.0), **use}
    value = {**dict(small_size=4, small_radius=0.4, row_order="down"), **value}
    height, width = depth.shape
    code = np.empty(depth.shape)
    for key in np.ndindex(height, width):
        z, near, focus, far = depth[key], value["near_plane"], value["focus_plane"], value["far_plane"]
        if value["code"] == "thin_lens":
            b = min(max(coc[key] / value["max_radius"], -1.0), value["far_limit"])
        elif z > focus:
            b = min((z - focus) / (far - focus), value["far_limit"])
        else:
            b = max((z - focus) / (focus - near), -1.0)
        code[key] = (1.0 + b) / 2.0
    taps = TAP_TABLES[value["taps"]] if isinstance(value["taps"], str) else value["taps"]
    reads, high, side = naive_baselines.Reads(), np.concatenate([color, code[..., None]], axis=-1), value["small_size"]
    box = np.array(
        [
            [high[y : y + side, x : x + side].mean(axis=(0, 1)) for x in range(0, width // side * side, side)]
            for y in range(0, height // side * side, side)
        ]
    )
    low = np.zeros_like(box)
    for y, x in np.ndindex(box.shape[:2]):
        for j, i in np.ndindex(3, 3):
            low[y, x] += (1, 2, 1)[j] * (1, 2, 1)[i] / 16.0 * reads.at(box, x + i - 0.5, y + j - 0.5)
    out, step = np.empty_like(color), -1.0 if value["row_order"] == "up" else 1.0
    for y, x in np.ndindex(height, width):
        radius, light, total = abs(2.0 * code[y, x] - 1.0) * value["max_radius"], 0.0, 0.0
        for dx, dy in taps[: value["max_taps"]]:
            sharp = reads.at(high, x + 0.5 + dx * radius, y + 0.5 + step * dy * radius)
            far = side * value["small_radius"] * radius
            soft = reads.at(
                low, (x + 0.5 + dx * far) * box.shape[1] / width, (y + 0.5 + step * dy * far) * box.shape[0] / height
            )
            t = abs(2.0 * sharp[3] - 1.0)
            tap = (1.0 - t) * sharp + t * soft
            weight = 1.0 if tap[3] >= code[y, x] else abs(2.0 * tap[3] - 1.0)
            light, total = light + weight * tap[:3], total + weight
        out[y, x] = light / total if total > 0.0 else color[y, x]
    return out


def name_of(changes):
    return ",".join(f"{name}={value}" for name, value in changes.items())


@pytest.mark.parametrize("changes", [{}, *CHANGES], ids=name_of)
def test_every_field_is_that_of_the_naive_loop(changes):
    images, use = picture(4, 8), {**PLANES, **changes}
    # Values up to 3, tens of roundings; no tap's code is its pixel's.
    np.testing.assert_allclose(blur(*images, Params(**use)), naive(*images, **use), rtol=0, atol=1e-12)


@pytest.mark.parametrize("changes", CHANGES, ids=name_of)
def test_every_field_makes_a_difference(changes):
    images = picture()
    difference = np.abs(blur(*images, Params(**{**PLANES, **changes})) - blur(*images, Params(**PLANES))).max()
    assert difference > 0.01


def test_planes_that_are_not_given_are_the_pictures():
    _, depth, coc = picture()
    found = code_of(depth, coc, Params())
    given = code_of(depth, coc, Params(near_plane=depth.min(), focus_plane=2.0, far_plane=depth.max()))
    np.testing.assert_allclose(given, found, rtol=0, atol=1e-13)
    assert np.abs(code_of(depth, 0.0 * coc, Params(focus_plane=2.0)) - found).max() < 1e-13  # circles are not asked


def test_codes_by_hand():
    depth = np.array([[0.5, 1.0, 1.5, 2.0, 4.0, 6.0, 9.0, np.inf]])
    code = code_of(depth, np.zeros_like(depth), Params(**PLANES))
    np.testing.assert_allclose(code, [[0.0, 0.0, 0.25, 0.5, 0.75, 1.0, 1.0, 1.0]], rtol=0, atol=1e-15)
    code = code_of(depth, np.zeros_like(depth), Params(**PLANES, far_limit=0.6))
    np.testing.assert_allclose(code, [[0.0, 0.0, 0.25, 0.5, 0.75, 0.8, 0.8, 0.8]], rtol=0, atol=1e-15)
    flat = code_of(np.ones((1, 2)), np.full((1, 2), 3.0), Params(far_limit=0.5))
    assert flat.tolist() == [[0.75, 0.75]]


def test_rows_from_below_are_the_picture_turned_over():
    images = picture(8, 12)  # the small picture begins at the top: multiples of 4
    over = [np.ascontiguousarray(image[::-1]) for image in images]
    params, up = Params(**PLANES), Params(**PLANES, row_order="up")
    np.testing.assert_allclose(blur(*over, up)[::-1], blur(*images, params), rtol=0, atol=1e-12)


def test_stages():
    images, params = picture(), Params(**PLANES)
    image, stages = blur(*images, params, stages=Stages((0, 3, 12)))
    assert list(stages) == ["coc", "code", "small", "mean 0", "mean 3", "mean 12"]
    assert np.array_equal(image, blur(*images, params))
    assert np.array_equal(stages["mean 12"], image)
    assert np.array_equal(stages["mean 0"], images[0])
    assert np.array_equal(stages["mean 3"], blur(*images, Params(**PLANES, max_taps=3)))
    assert stages["small"].shape == (2, 2, 4)


# Ties


def test_bounds_by_hand():
    # Two pixels at code 1/4 and a tap on the other one: equal codes count in full, or by |2/4 - 1|. One tap is on the
    # pixel itself. Colours are 0 and 1; the small picture, of 1 texel, is both, half, at blur 1/2: 1/4 and 3/4.
    color = np.array([[[0.0] * 3, [1.0] * 3]])
    depth, coc = np.full((1, 2), 1.5), np.zeros((1, 2))
    params = Params(**PLANES, max_radius=2.0, taps=[(0.0, 0.0), (1.0, 0.0)])
    found = bounds(color, depth, coc, params)
    # Left: taps of 1/4 and 3/4, each of weight 1 or 1/2.
    np.testing.assert_allclose(found.low[0, 0], (0.25 + 0.5 * 0.75) / 1.5, rtol=1e-12)
    np.testing.assert_allclose(found.high[0, 0], (0.5 * 0.25 + 0.75) / 1.5, rtol=1e-12)
    # Right: both taps read the right pixel, and the edge beyond it.
    np.testing.assert_allclose([found.low[0, 1], found.high[0, 1]], 0.75, rtol=1e-12)
    assert found.ambiguity.tolist() == [[True, False]]


def test_without_ties_both_bounds_are_the_picture():
    images, params = picture(), Params(**PLANES)
    found = bounds(*images, params, hair=0.0)
    assert np.array_equal(found.low, found.high)
    np.testing.assert_allclose(found.low, blur(*images, params), rtol=0, atol=1e-12)


@pytest.mark.parametrize("changes", [{}, *CHANGES], ids=name_of)
def test_bounds_hold_every_choice(changes):
    # Two depths: a tap within a card is as far as its pixel. Places that are a little off give it either order.
    color, _, _ = picture(6, 7)
    depth = np.where(np.random.default_rng(3).random((6, 7)) < 0.5, 1.4, 3.0)
    coc, params = 5.0 - 10.0 / depth, Params(**{**PLANES, **changes})
    found = bounds(color, depth, coc, params)
    assert (found.low <= found.high).all()
    random = np.random.default_rng(4)
    for _ in range(2):
        noise = 1.0 + 1e-7 * random.standard_normal((2, 6, 7))
        image = blur(color, depth * noise[0], coc * noise[1], params)
        assert (image >= found.low - 1e-5).all()
        assert (image <= found.high + 1e-5).all()


def test_a_pixel_whose_taps_may_all_weigh_nothing_may_be_any_of_them():
    # A pixel behind the focus among sharp ones, whose codes are 1/2 but for a hair: 0 / 0 or 1e-6 / 1e-6.
    color, depth = np.zeros((9, 9, 3)), np.full((9, 9), 2.0)
    color[4, 4], depth[4, 4] = 1.0, 6.0
    params = Params(**PLANES, taps=[(1.0, 0.0)], small_radius=0.0)
    found = bounds(color, depth, np.zeros((9, 9)), params)
    assert found.low[4, 4].max() == 0.0
    assert found.high[4, 4].min() == 1.0


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"taps": "ten"}, "taps: got 'ten'.*allowed are twelve, eight, twelve_close, nine_grid"),
        ({"taps": []}, "taps: got .*allowed are .* pairs"),
        ({"taps": [(1.0,)]}, "taps: got"),
        ({"taps": [(math.nan, 0.0)]}, "taps: got"),
        ({"taps": [(5.0, 0.0)]}, "taps: got"),
        ({"taps": None}, "taps: got"),
        ({"max_taps": 0}, "max_taps: got 0"),
        ({"near_plane": 0.0}, "near_plane: got 0"),
        ({"near_plane": 3.0, "far_plane": 2.0}, "far_plane: got 2; allowed is more than near_plane, 3"),
        ({"near_plane": 2.0, "focus_plane": 2.0}, "focus_plane: got 2"),
        ({"far_limit": 1.5}, "far_limit: got 1.5"),
        ({"small_size": 3}, "small_size: got 3; allowed are 1, 2, 4 .. 64"),
        ({"small_radius": -1.0}, "small_radius: got -1"),
        ({"row_order": "dwn"}, "row_order: got 'dwn'"),
    ],
)
def test_bad_values_are_named(values, words):
    with pytest.raises(InputError, match=f"^{words}"):
        Params(**values)


@pytest.mark.parametrize("hair", [-1e-9, 0.26, math.nan, "wide"])
def test_bad_hairs_are_named(hair):
    with pytest.raises(InputError, match=r"^hair: got "):
        bounds(*picture(), hair=hair)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_planes_are_in_the_unit_of_depth(dtype):
    """Depths beyond 1, of a wider type than colour's: by hand, (6 - 4) / (12 - 4) of the way to full blur behind."""
    depth = np.array([[3.0, 4.0, 6.0, 12.0]])
    params = Params(near_plane=2.0, focus_plane=4.0, far_plane=12.0)
    _, stages = blur(np.ones((1, 4, 3), dtype=dtype), depth, np.array([[-1.0, 0.0, 1.0, 2.0]]), params, stages=True)
    np.testing.assert_allclose(stages["code"], [[0.25, 0.5, 0.625, 1.0]], atol=1e-7)


def test_planes_are_in_the_unit_of_a_scene():
    scene = refdof.load_scene("branches")
    camera, focus = scene.camera.with_size((24, 18)), scene.lens.focus_distance
    planes = {"near_plane": 0.5 * focus, "focus_plane": focus, "far_plane": 2.0 * focus}
    stages = refdof.render("poisson", scene, camera, stages=True, **planes).stages
    depth = refdof.View(scene, camera, scene.lens).pinhole().depth
    behind, before = (depth - focus) / focus, (depth - focus) / (0.5 * focus)
    expected = 0.5 + 0.5 * np.clip(np.where(depth > focus, behind, before), -1.0, 1.0)
    np.testing.assert_allclose(stages["code"], expected, atol=1e-6)  # float32

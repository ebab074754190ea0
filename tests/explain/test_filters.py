"""Explanations of single-image filters: the table's sum is the method's pixel, and weights that a hand can compute."""

import math
from dataclasses import replace

import numpy as np
import pytest

from refdof import METHODS, InputError
from refdof.explain import EXPLAINERS, explain_pictures
from refdof.explain.impulses import weights_of
from refdof.explain.pictures import given_pictures
from refdof.oracle.inputs import cards, noise

WIDTH, HEIGHT = 16, 12
PIXELS = [(0, 0), (7, 5), (15, 11), (9, 6)]  # corners, and both sides of the cards' edges
FILTERS = [name for name, module in METHODS.items() if module.METHOD.kind == "single image"]
SETTINGS = {
    "scatter": [{}, {"order": "far_to_near"}],
    "poisson": [{}, {"code": "thin_lens"}],
    "circular": [{}, {"components": 3, "fields": "near_far"}],
    "ringgather": [{}, {"working": "tonemapped", "fill": True}],
}
CASES = [(name, values) for name in FILTERS for values in SETTINGS.get(name, [{}])]


def explained(method, picture, pixel, values=None, stage="image"):
    params = METHODS[method].Params(**(values or {}))
    return explain_pictures(method, given_pictures(*picture[:3]), params, pixel, stage)


def total(columns, rows):
    """The sum of weight times colour over a table, in this file's own words."""
    names = list(columns)
    weight = rows[:, names.index("weight")]
    return sum(weight[n] * rows[n, names.index("red") : names.index("red") + 3] for n in range(len(rows)))


def flat(coc, depth=2.0, width=9, height=9):
    """Black but for a white pixel in the middle; one depth and one circle."""
    color = np.zeros((height, width, 3), dtype=np.float32)
    color[height // 2, width // 2] = 1.0
    return color, np.full((height, width), depth, np.float32), np.full((height, width), coc, np.float32)


@pytest.mark.fast
def test_every_method_has_an_explanation():
    assert set(EXPLAINERS) == set(METHODS)


@pytest.mark.parametrize("made", [cards, noise])
@pytest.mark.parametrize(("method", "values"), CASES)
def test_the_table_adds_up_to_the_picture(method, values, made):
    picture = made(WIDTH, HEIGHT)
    image = METHODS[method].blur(*picture[:3], METHODS[method].Params(**values))
    for x, y in PIXELS:
        found = explained(method, picture, (x, y), values)
        assert (found.value == image[y, x]).all()
        # Weights of at most some hundred rows, each rounded to 2^-24 some times; colours are at most 1.
        np.testing.assert_allclose(total(found.columns, found.rows), image[y, x], rtol=0, atol=2e-5)
        assert found.column("weight").sum() == pytest.approx(1.0, abs=2e-5)
        assert found.agrees
        assert (found.tolerance < 2e-4).all()


def test_a_missing_row_is_noticed():
    found = explained("separable", cards(WIDTH, HEIGHT), (0, 0))
    assert not replace(found, rows=found.rows[1:]).agrees


@pytest.mark.parametrize(("x", "y", "weight"), [(4, 4, 1 / 9), (4, 3, 1 / 9), (5, 5, 1 / 9), (0, 0, 1 / 4)])
def test_separable_by_hand(x, y, weight):
    """Circles of 2 px: a neighbour at distance 1 counts 1, at distance 2 nothing: three taps a pass, two in corners."""
    found = explained("separable", flat(2.0), (x, y))
    np.testing.assert_allclose(found.column("weight"), weight, rtol=1e-6)
    np.testing.assert_allclose(found.column("across"), math.sqrt(weight), rtol=1e-6)
    np.testing.assert_allclose(found.column("down"), math.sqrt(weight), rtol=1e-6)
    assert found.value == pytest.approx([weight if x >= 3 else 0.0] * 3)
    assert len(found.rows) == round(1 / weight)


def test_scatter_by_hand():
    """A disc of radius 1 holds its own pixel whole: 1 / pi of its light."""
    found = explained("scatter", flat(1.0), (4, 4))
    own = (found.column("x") == 4.5) & (found.column("y") == 4.5)
    assert found.column("share")[own] == pytest.approx(1 / math.pi, rel=1e-6)
    assert found.value == pytest.approx([1 / math.pi] * 3, rel=1e-6)
    assert found.column("share").sum() == pytest.approx(1.0, rel=1e-6)


def test_singlepass_by_hand():
    """Where all taps reach the pixel each has the same weight; where none does the pixel has all."""
    blurred, sharp = (explained("singlepass", flat(coc), (4, 4), {"loop_bound": 10.0}) for coc in (15.0, 0.0))
    np.testing.assert_allclose(blurred.column("weight"), 1 / len(blurred.rows), rtol=1e-6)
    assert sharp.column("weight")[0] == pytest.approx(1.0, rel=1e-9)
    assert not sharp.column("weight")[1:].any()


def test_pyramidal_layers_share_the_pixel():
    found = explained("pyramidal", cards(WIDTH, HEIGHT), (7, 5))
    (layers,) = found.parts
    assert layers.rows[:, -1].sum() == pytest.approx(1.0)
    for number, share in layers.rows[:, [0, -1]]:
        weight = found.column("weight")[found.column("sub_image") == number].sum()
        assert weight == pytest.approx(share, abs=1e-5)


def test_mipmap_texels_add_up_to_the_pixel():
    for pixel in PIXELS:
        found = explained("mipmap", cards(WIDTH, HEIGHT), pixel)
        (texels,) = found.parts
        np.testing.assert_allclose(total(texels.columns, texels.rows), found.value, rtol=0, atol=1e-6)


@pytest.mark.parametrize(
    ("method", "summed", "chosen", "choice"),
    [
        ("ringgather", "rings", "median", np.median),
        ("filament", "gathered", "median", np.median),
        ("halfres", "far_mean", "far_brightest", np.max),
    ],
)
def test_texels_of_half_the_size_by_their_stages(method, summed, chosen, choice):
    """One table adds up to the texel before, the other holds values of which the texel is the median or greatest."""
    picture = cards(WIDTH, HEIGHT)
    y, x = np.unravel_index(picture.coc.argmax(), picture.coc.shape)  # behind, so that halfres tells of its far picture
    _, stages = METHODS[method].blur(*picture[:3], stages=True)
    of_many, of_sum = sorted(explained(method, picture, (x, y)).parts[:2], key=lambda part: "weight" in part.columns)
    values = of_many.rows[:, [of_many.columns.index(name) for name in ("red", "green", "blue")]]
    np.testing.assert_allclose(choice(values, axis=0), stages[chosen][y // 2, x // 2, :3], rtol=0, atol=2e-6)
    found = stages[summed][y // 2, x // 2, :3]
    assert found.any()
    np.testing.assert_allclose(total(of_sum.columns, of_sum.rows), found, rtol=0, atol=2e-5)


def test_a_far_picture_that_is_added():
    picture = cards(WIDTH, HEIGHT)
    for pixel in PIXELS:
        assert explained("halfres", picture, pixel, {"variant": "pmndrs"}).agrees


@pytest.mark.fast
def test_a_geometric_blend_is_refused():
    with pytest.raises(InputError, match=r"^blend: got 'geometric'"):
        explained("mipmap", cards(WIDTH, HEIGHT), (0, 0), {"blend": "geometric"})


@pytest.mark.fast
def test_impulses_recover_any_weights():
    weights = np.random.default_rng(1).random((3, 5, 7)) * (np.random.default_rng(2).random((3, 5, 7)) < 0.2)
    calls = []

    def respond(color):
        calls.append(1)
        return np.array([(weights[..., None] * color).sum(axis=(0, 1, 2)), 2.0 * color.sum(axis=(0, 1, 2))])

    places, found = weights_of(respond, weights.shape, np.float64)
    np.testing.assert_allclose(found[:, 0], weights[weights > 0])
    assert (places == np.argwhere(weights > 0)).all()
    assert (found[:, 1] == 2.0).all()
    assert len(calls) < weights.size

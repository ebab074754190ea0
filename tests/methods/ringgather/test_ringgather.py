"""ringgather beside its naive twin, by hand, and beside what was measured of the engine's table."""

import math
from itertools import product

import numpy as np
import pytest

from refdof.methods.ringgather import Params, blur
from tests.methods.ringgather.naive_ringgather import naive_blur

pytestmark = pytest.mark.fast


def case(name):
    """Colour, depth and circles: everything at once, hardly any blur, one circle, more or less from tile to tile."""
    random = np.random.default_rng(7)
    size = {"all": (9, 40), "wide": (3, 170), "tall": (170, 3)}.get(name, (5, 7))
    color, depth = random.random((*size, 3)), random.uniform(1.0, 2.0, size)
    coc = {"all": random.uniform(-6, 6, size), "none": np.full(size, 0.7), "one": np.full(size, -5.0)}.get(name)
    if coc is None:
        tiles = np.indices(size).sum(axis=0) // 32
        coc = random.uniform(1.0, 1.2, size) * (6.0 - tiles if name == "tall" else 1.0 + tiles)
        coc[::3] *= 0.2
        depth += 0.2 * tiles
    if name == "all":
        depth[:3], coc[:3] = np.inf, 3.0
        depth[-1, ::2], coc[3] = 1e-3, 0.0
    return color, depth, coc


WORDS = [{}, {"fill": True, "gain": 2.0, "foreground": 3.0}, {"working": "tonemapped"}]


@pytest.mark.parametrize(("name", "words"), [*product(["all", "none", "one"], WORDS), ("wide", {}), ("tall", {})])
def test_matches_the_naive_twin(name, words):
    color, depth, coc = case(name)
    params = Params(largest_px=4.0, **words)
    expected = naive_blur(color, depth, coc, params)
    # Sums of 49 taps with weights of up to 1, then quotients, mixes and a median: 300 roundings.
    np.testing.assert_allclose(blur(color, depth, coc, params), expected, rtol=0, atol=300 * 2.3e-16)
    narrow = blur(*(part.astype(np.float32) for part in (color, depth, coc)), params)
    # Taps whose place falls on an edge between texels in one type may read the other texel: few do.
    off = np.abs(narrow - expected).max(axis=2)
    assert np.quantile(off, 0.9) < 300 * 1.2e-7


@pytest.mark.long
@pytest.mark.parametrize(("fill", "over_disc"), [(False, 0.857), (True, 1.143)])
def test_the_kernel_reaches_three_quarters(fill, over_disc):
    # By hand: 8, 16 and 24 taps at j quarters, and the centre: a mean square of 18 / 49 radii; the disc's is 1 / 2.
    assert math.sqrt(18 / 49 * (16 / 9 if fill else 1) * 2) == pytest.approx(over_disc, abs=0.0005)
    side, circle = 160, 32.0
    color = np.zeros((side, side, 3))
    color[70:90, 70:90] = 1.0  # large, so that the median leaves it
    image = blur(color, np.ones((side, side)), np.full((side, side), circle), Params(fill=fill))[..., 0]
    y, x = np.indices(image.shape) - (side - 1) / 2
    assert image.sum() == pytest.approx(400, rel=0.02)
    square = (image * (x * x + y * y)).sum() / image.sum() - 2 * (20**2 - 1) / 12
    # The prefilter spreads by an eighth of the circle, and half the size by as much as a tent of two pixels.
    spread = 2 * 8 / 9 * (circle / 8) ** 2 / 2 + 2 * (2 * 4 - 1) / 12
    assert math.sqrt((square - spread) * 2) / circle == pytest.approx(over_disc, rel=0.02)


@pytest.mark.long
@pytest.mark.parametrize(("circle", "left"), [(2.0, 0.24), (32.0, 0.66)])
def test_the_median_takes_small_lights_away(circle, left):
    color = np.zeros((160, 160, 3))
    color[80, 80, 0] = 1.0
    staged = blur(color, np.ones((160, 160)), np.full((160, 160), circle), stages=True)
    assert 4 * staged.stages["rings"][..., 0].sum() == pytest.approx(1.0, abs=1e-9)
    assert staged.image.sum() == pytest.approx(left, abs=0.01)  # as it was seen: no bound is known

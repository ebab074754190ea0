"""filament beside its naive twin, and beside what was measured of the engine's rings."""

import math

import numpy as np
import pytest

from refdof.methods.filament import Params, blur
from tests.methods.filament.naive_filament import naive_blur


def case(name):
    """Colour and circles over several tiles: near, far and in focus beside each other, one circle, hardly any.

    What is filled up repeats the edge: only a side of 16 n px has texels that differ at its end.
    """
    random = np.random.default_rng(8)
    size = {"all": (20, 90), "alike": (16, 18), "little": (9, 20), "behind": (18, 40)}[name]
    color = random.random((*size, 3)) ** 3 * 4
    y, x = np.indices(size)
    if name == "all":
        coc = np.where(x < 12, -9.0 + 0.1 * y, np.where(x < 30, 0.2, np.where(x < 50, 6.0, 3.0 + 0.05 * x)))
        coc[:5, 20:60] = -3.0
    elif name == "behind":
        coc = 1.5 + 0.4 * x + random.uniform(0, 1, size)
    else:
        coc = np.full(size, 5.0 if name == "alike" else -1.3)
    return color, coc


@pytest.mark.parametrize("name", ["all", "alike", "little", "behind"])
def test_matches_the_naive_twin(name):
    color, coc = case(name)
    ones = np.ones(coc.shape)
    for rings in (5, 3) if name == "all" else (5,):
        params = Params(rings=rings)
        expected = naive_blur(color, coc, params)
        # Colours up to 4, sums of 81 taps, quotients of sums: 1000 roundings. A tap on an edge between texels may be
        # read on either side of it: none is, in float64.
        np.testing.assert_allclose(blur(color, ones, coc, params), expected, rtol=0, atol=4000 * 2.3e-16)
        narrow = blur(color.astype(np.float32), ones, coc, params)
        assert np.quantile(np.abs(narrow - expected), 0.98) < 4000 * 1.2e-7  # in float32 some are


@pytest.mark.long
@pytest.mark.fast
@pytest.mark.parametrize(("rings", "over_disc"), [(3, 0.960), (5, 0.988)])
def test_the_rings_beside_the_disc(rings, over_disc):
    # By hand: the centre, and 8 i taps at i / (n - 1/2) radii.
    square = sum(8 * i * (i / (rings - 0.5)) ** 2 for i in range(rings)) / (2 * rings - 1) ** 2
    assert math.sqrt(2 * square) == pytest.approx(over_disc, abs=0.0005)
    side, circle, light = 192, 24.0, 32
    color = np.zeros((side, side, 3))
    start = (side - light) // 2
    color[start : start + light, start : start + light] = 0.5
    coc = np.full((side, side), circle)
    image = blur(color, np.ones((side, side)), coc, Params(rings=rings))[..., 0]
    y, x = np.indices(image.shape) - (side - 1) / 2
    found = (image * (x * x + y * y)).sum() / image.sum() - 2 * (light**2 - 1) / 12
    # Half the size, a level of 2 or 4 texels of it, and noise of a quarter of the rings' distance spread it, too.
    assert over_disc < math.sqrt(2 * found) / circle < over_disc + 0.06


@pytest.mark.fast
def test_what_is_in_focus_is_left_alone():
    random = np.random.default_rng(9)
    color, ones = random.random((20, 35, 3)), np.ones((20, 35))
    np.testing.assert_array_equal(blur(color, ones, 0.9 * ones), color)
    np.testing.assert_array_equal(blur(color, ones, 9.0 * ones, Params(largest_px=0.0)), color)

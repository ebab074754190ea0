"""Depth in a wider type than colours is the same depth: for pictures, for their bounds and for what explains them.

Depths are whole numbers of 1/64, so that both types hold them. Constants of some parameters are in their unit.
"""

import numpy as np
import pytest

from refdof import METHODS
from refdof.explain import explain_pictures
from refdof.explain.pictures import given_pictures
from refdof.methods import poisson, singlepass

pytestmark = pytest.mark.fast

IN_UNITS = {
    "halfres": [{"circles": "smoothstep", "focus_plane": 5.0, "focus_range": 3.0}],
    "poisson": [{"near_plane": 1.0, "focus_plane": 5.0, "far_plane": 9.0}],
    "scatter": [{"order": "far_to_near"}],
}
FILTERS = [name for name, module in METHODS.items() if module.METHOD.kind == "single image"]
CASES = [(name, values) for name in FILTERS for values in [{}, *IN_UNITS.get(name, [])]]


def picture():
    random = np.random.default_rng(3)
    depth = random.integers(128, 576, (7, 9)) / 64.0
    depth[0, 0] = np.inf
    return random.random((7, 9, 3), dtype=np.float32), depth, random.uniform(-3.0, 3.0, (7, 9)).astype(np.float32)


def both(function, *more, **words):
    """What a function makes of a depth in float32, and in float64."""
    color, depth, coc = picture()
    return [function(color, one, coc, *more, **words) for one in (depth.astype(np.float32), depth)]


@pytest.mark.parametrize(("method", "values"), CASES)
def test_pictures(method, values):
    narrow, wide = both(METHODS[method].blur, METHODS[method].Params(**values))
    np.testing.assert_allclose(wide, narrow, rtol=0, atol=5e-7)  # 4 * 2^-23: codes of poisson are of other units


@pytest.mark.parametrize("values", [{}, *IN_UNITS["poisson"]])
def test_bounds_of_poisson(values):
    (image, _), (narrow, wide) = (
        both(poisson.blur, poisson.Params(**values)),
        both(poisson.bounds, poisson.Params(**values)),
    )
    for one in (narrow, wide):
        assert ((one.low <= image + 1e-6) & (image <= one.high + 1e-6)).all()  # float32
    np.testing.assert_allclose(wide.low, narrow.low, rtol=0, atol=5e-7)


def test_bounds_of_singlepass():
    (image, _), (narrow, wide) = both(singlepass.blur), both(singlepass.bounds)
    assert ((wide.low <= image + 1e-5) & (image <= wide.high + 1e-5)).all()  # a running mean of 398 taps in float32
    np.testing.assert_allclose(wide.low, narrow.low, rtol=0, atol=5e-7)


@pytest.mark.long
@pytest.mark.parametrize(("method", "values"), CASES)
def test_explanations(method, values):
    color, depth, coc = picture()
    params = METHODS[method].Params(**values)
    found = explain_pictures(method, given_pictures(color, depth, coc), params, (4, 3), "image")
    assert (found.value == METHODS[method].blur(color, depth, coc, params)[3, 4]).all()
    assert found.agrees

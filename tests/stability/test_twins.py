"""Twins: a filter in float64 is given what it is given in float32, so that the two differ by roundings alone."""

import numpy as np
import pytest

from refdof.methods import METHODS
from refdof.optics.lens import ThinLens
from refdof.stability.subjects import mosaic, random_picture
from refdof.stability.twins import narrow, wide

pytestmark = pytest.mark.fast

FILTERS = [name for name, module in METHODS.items() if module.METHOD.kind == "single image"]
DEPTH = np.random.default_rng(2).choice([0.7, 1.0, 2.0, 5.0], (5, 7))


@pytest.mark.parametrize("unit", [1.0, 0.01])  # also where depth is not brought to a unit of its own
@pytest.mark.parametrize("method", FILTERS)
def test_twins_differ_by_roundings(method, unit):
    view = mosaic(random_picture(3, (7, 5)), DEPTH, ThinLens(0.09, 2.0), scale=unit)
    # Up to 1000 sums in float32; a wrong unit of depth, or a wrong depth, changes the first digits.
    np.testing.assert_allclose(narrow(method, view).image, wide(method, view).image, rtol=0, atol=2e-5)

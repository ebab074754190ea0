"""Mipmap interpolation where the picture has more levels than its blur needs, against the equations pixel by pixel."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from refdof.methods.mipmap import method as mipmap
from refdof.methods.mipmap.method import Params
from refdof.stages import StageRecorder
from tests.methods.mipmap import naive

pytestmark = pytest.mark.fast


# 2/3 of the largest degree of blur against 1/2, 1, 2: Eq. (6) gives levels of 1 + log2 of it, rounded up.
@pytest.mark.parametrize(("largest", "levels"), [(0.74, 0), (0.76, 1), (1.4, 1), (1.6, 2), (2.9, 2), (3.1, 3)])
@pytest.mark.parametrize("blend", ["linear", "geometric"])
def test_levels_that_small_blurs_need(largest, levels, blend):
    random = np.random.default_rng(8)
    color, coc = random.random((18, 17, 3)), random.uniform(-largest, largest, (18, 17))
    coc[4, 5] = -largest
    trace = StageRecorder(on=True)
    image = mipmap._blur(color, coc, Params(blend=blend), trace)
    expected, twin = naive.mipmap(color, coc, geometric=blend == "geometric")
    assert sum(name.startswith("color ") for name in trace.stages) == len(twin["colors"]) == levels
    # A hundred roundings in float64 of numbers up to 1.
    assert_allclose(image, expected, rtol=0, atol=1e-13)
    assert_allclose(trace.stages["level"], twin["level"], rtol=0, atol=1e-12)

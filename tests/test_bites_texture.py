"""Texture filters at the ends of their weights and of normal numbers."""

import numpy as np
import pytest

from refdof._jit import tile_kernel
from refdof.raster.filters import lerp, rules_of
from refdof.raster.gpu_model import D3D11, EXACT, LLVMPIPE
from refdof.raster.texture import bilinear

pytestmark = pytest.mark.fast


@tile_kernel
def blend(a, b, w, rules):
    return lerp(a, b, w, rules)


@pytest.mark.parametrize("real", [np.float32, np.float64])
@pytest.mark.parametrize("other", [0.3, np.inf, -np.inf, np.nan])
def test_a_texel_of_weight_zero_has_no_part(real, other):
    # At weight 1 the second texel is all, at weight 0 the first.
    with np.errstate(invalid="ignore"):
        assert blend(real(other), real(0.7), real(1.0), rules_of(EXACT)) == real(0.7)
        assert blend(real(0.7), real(other), real(0.0), rules_of(EXACT)) == real(0.7)


@pytest.mark.parametrize("model", [EXACT, LLVMPIPE, D3D11], ids=["exact", "llvmpipe", "d3d11"])
def test_the_smallest_normal_number_is_kept(model):
    image = np.full((1, 2, 1), 2.0**-126, dtype=np.float32)
    assert bilinear(image, 0.5, 0.5, model).item() == 2.0**-126
    below = np.nextafter(image, np.float32(0.0))
    assert bilinear(below, 0.5, 0.5, model).item() == (0.0 if model.flush_denormals else below.item(0))

"""Texture filters at the ends of their weights and of normal numbers."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from refdof._jit.compile import tile_kernel
from refdof.raster.filters.mip_chain import _drawn_centres
from refdof.raster.gpu.gpu_model import D3D11, EXACT, LLVMPIPE
from refdof.raster.gpu.texture import bilinear, trilinear
from refdof.raster.gpu.texture_reads import _choose_levels
from refdof.raster.gpu.texture_sampling import lerp, rules_of

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


def test_a_weight_that_rounds_to_one_takes_the_second_texel():
    # 2^-30 texels before a centre: float32 has no such weight but 1.
    image = np.random.default_rng(2).random((2, 256, 3)).astype(np.float32)
    first, second = image[:, :-1], image[:, 1:]
    assert (first + (second - first) != second).any()  # plain arithmetic would not do
    u, v = np.meshgrid((np.arange(255) + 1.5 - 2.0**-30) / 256, [0.25, 0.75])
    assert_array_equal(bilinear(image, u, v), second)
    tall = np.ascontiguousarray(image.transpose(1, 0, 2))
    assert_array_equal(bilinear(tall, v, u), second)


@pytest.mark.parametrize("model", [EXACT, LLVMPIPE, D3D11], ids=["exact", "llvmpipe", "d3d11"])
def test_a_whole_level_of_detail_reads_one_level(model):
    levels = [np.full((4, 4, 1), 1.0), np.full((2, 2, 1), 2.0), np.full((1, 1, 1), np.inf)]
    levels = [level.astype(np.float32) for level in levels]
    with np.errstate(invalid="ignore"):
        # The last point reads the infinite level, so that it is looked at; the others have no part in it.
        read = trilinear(levels, 0.4, 0.6, [-1.0, 0.0, 0.5, 1.0, 1.5], model)[:, 0]
    assert_array_equal(read[:4], [1.0, 1.0, 1.5, 2.0])
    assert not np.isfinite(read[4])


@pytest.mark.parametrize("side", [6, 10, 12, 14, 22, 26])
def test_centres_on_the_diagonal_belong_to_the_upper_triangle(side):
    # By the top-left rule: the diagonal is the left side of the triangle above it. That one's plane starts at y = 0.
    count, real = side // 2, np.float32
    slope = real(count) * (real(1) / real(count * count))
    above = [real(np.float64(j) * np.float64(slope) + np.float64(slope * real(0.5))) * real(side) for j in range(count)]
    last = real(1) - slope * real(count - 0.5)
    below = [real(np.float64(j) * np.float64(slope) + np.float64(last)) * real(side) for j in range(count)]
    _, y = _drawn_centres(np.zeros((side, side, 1), np.float32))
    for j, i in np.ndindex(count, count):
        assert y[j, i] == (above if i >= j else below)[j]


@pytest.mark.parametrize("weight", [0, 1, 64, 127, 128, 255])
def test_bytes_are_blended_in_steps_of_a_256th(weight):
    # From the first centre on: 0 + (255 weight + 128 >> 8).
    value = (255 * weight + 128) // 256
    image = np.array([[[0], [255]]], dtype=np.uint8)
    for texels, u, v in (
        (image, (0.5 + weight / 256) / 2, 0.5),
        (image.reshape(2, 1, 1), 0.5, (0.5 + weight / 256) / 2),
    ):
        assert bilinear(texels, u, v, LLVMPIPE).item() == np.float32(value) * np.float32(1 / 255)


def test_levels_and_shares_by_hand():
    level, share = np.zeros(3, np.int32), np.zeros(3)
    assert _choose_levels(np.array([0.25, 1.5, 2.0]), level, share) == 2
    assert (level.tolist(), share.tolist()) == ([0, 1, 2], [0.25, 0.5, 0.0])

"""Texture reads and mip chains: against sums in exact fractions, closed forms and hand-computed integers."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from refdof._check import InputError
from refdof.raster.filters.mip_chain import box_mipmaps, gaussian_mipmaps, generate_mipmaps
from refdof.raster.gpu.gpu_model import D3D11, EXACT, LLVMPIPE
from refdof.raster.gpu.texture import bilinear, fetch, level_of_detail, trilinear
from refdof.raster.gpu.texture_sampling import fused_multiply_add
from tests.raster.gpu import naive_texture as naive

pytestmark = pytest.mark.fast

SHAPES = [(1, 1), (1, 7), (5, 3), (8, 8)]
every_model = pytest.mark.parametrize("model", [EXACT, LLVMPIPE, D3D11], ids=["exact", "llvmpipe", "d3d11"])


def noise(shape, dtype=np.float64, channels=3):
    return np.random.default_rng(41).random((*shape, channels)).astype(dtype)


def places(count=150):
    random = np.random.default_rng(42)
    at = random.uniform(-0.4, 1.4, (2, count))
    at[:, ::4] = random.integers(-4, 12, at[:, ::4].shape) / 8
    return at


# Values in [0, 1]: a coordinate up to 8 texels with one rounding, 2^-50, and three blends of two roundings each.
@pytest.mark.parametrize(("dtype", "tolerance"), [(np.float64, 3e-15), (np.float32, 5e-7)])
@pytest.mark.parametrize("border", [None, (2.0, -1.0, 0.5)])
@pytest.mark.parametrize("shape", SHAPES)
def test_reads_are_those_of_fractions(shape, border, dtype, tolerance):
    levels = generate_mipmaps(noise(shape, dtype))
    u, v = places()
    lod = np.random.default_rng(43).uniform(-1, len(levels), u.shape)
    wanted = [[float(c) for c in naive.bilinear(levels[0], *at, border)] for at in zip(u, v, strict=True)]
    assert np.abs(bilinear(levels[0], u, v, border=border) - wanted).max() <= tolerance
    wanted = [[float(c) for c in naive.trilinear(levels, *at, border)] for at in zip(u, v, lod, strict=True)]
    result = trilinear(levels, u, v, lod, border=border)
    assert result.dtype == dtype
    assert np.abs(result - wanted).max() <= tolerance


@pytest.mark.parametrize("channels", [2, 4])
def test_many_points_and_few_that_meet_an_infinite_texel(channels):
    levels = generate_mipmaps(noise((9, 6), np.float32, channels))
    levels[0][7, 4, 1] = np.inf
    u, v = np.random.default_rng(44).uniform(-0.1, 1.1, (2, 1100))
    u[:900], lod = u[:900] * 0.4, np.random.default_rng(45).uniform(0, 1.5, 1100)
    lod[::3] = np.round(lod[::3])
    met = (np.abs(u * 6 - 4.5) < 1) & (np.abs(v * 9 - 7.5) < 1)
    assert met.any()
    assert not met[:900].any()
    levels_without = [np.where(np.isfinite(level), level, np.float32(0.5)) for level in levels]
    for reads, level_of_point in ((bilinear(levels[0], u, v), 0.0), (trilinear(levels, u, v, lod), lod)):
        inside = met & (np.broadcast_to(level_of_point, met.shape) < 1)
        assert np.array_equal(~np.isfinite(reads[:, 1]), inside)
        places = zip(u, v, np.broadcast_to(level_of_point, met.shape), strict=True)
        wanted = np.array([[float(c) for c in naive.trilinear(levels_without, *at)] for at in places])
        others = np.delete(np.arange(channels), 1)
        assert np.abs(reads - wanted)[~inside].max() <= 5e-7
        assert np.abs(reads - wanted)[:, others].max() <= 5e-7


@every_model
def test_a_constant_stays(model):
    levels = generate_mipmaps(np.full((6, 5, 2), 0.3, dtype=np.float32), model)
    u, v = places()
    assert (trilinear(levels, u, v, 5 * v, model) == np.float32(0.3)).all()


@every_model
def test_eight_bits_of_weight(model):
    image = np.array([[[0.0], [1.0]]], dtype=np.float32)
    u = 0.25 + 0.5 * np.arange(0, 4097) / 4096
    read = bilinear(image, u, 0.5, model)[:, 0]
    steps = 256 if model.filter_bits else 4096
    # half up; all these numbers are exact in float32
    assert np.array_equal(read, np.floor(np.arange(0, 4097) / 4096 * steps + 0.5) / steps)


def test_integers_by_hand():
    image = np.array([[[10], [20]], [[50], [91]]], dtype=np.uint8)
    # Both weights are 128: 10 + (1280 + 128 >> 8) = 15; 50 + (5248 + 128 >> 8) = 71; 15 + (7168 + 128 >> 8) = 43.
    assert bilinear(image, 0.5, 0.5, LLVMPIPE) == np.float32(43) * np.float32(1 / 255)
    assert bilinear(image, 0.5, 0.5, EXACT) == pytest.approx((10 + 20 + 50 + 91) / 4 / 255, rel=3e-7)
    # the next level is the same 43; level 0 at texel (0, 0) is 10; 0.75 of 256 is 192: 10 + (6336 + 128 >> 8) = 35
    levels = generate_mipmaps(image, LLVMPIPE)
    assert levels[1] == 43
    assert trilinear(levels, 0.25, 0.25, 0.75, LLVMPIPE) == np.float32(35) * np.float32(1 / 255)


def test_weight_zero_and_infinite_texels():
    image = np.array([[[1.0], [np.inf], [np.nan], [-np.inf]]], dtype=np.float32)
    u = np.array([1, 2, 3, 7]) / 8  # on texel 0, half way, on texel 1, on texel 3
    with np.errstate(invalid="ignore"):
        assert bilinear(image, u, 0.5)[:, 0].tolist() == [1.0, np.inf, np.inf, -np.inf]
        assert np.isnan(bilinear(image, 0.625, 0.5))  # on NaN
        for model in (LLVMPIPE, D3D11):
            assert np.isnan(bilinear(image, 0.125, 0.5, model))
    huge = np.array([[[-3e38], [3e38]]], dtype=np.float32)
    assert bilinear(huge, 0.5, 0.5) == 0  # the difference does not fit


def test_denormals_are_flushed_in_arithmetic_only():
    image = np.full((1, 2, 1), 1e-40, dtype=np.float32)
    assert bilinear(image, 0.5, 0.5, EXACT) == image[0, 0, 0]
    assert bilinear(image, 0.5, 0.5, LLVMPIPE) == 0
    assert fetch(image, 0, 0, LLVMPIPE) == image[0, 0, 0]


def test_fetch():
    image = noise((3, 4))
    x, y = np.meshgrid(np.arange(-2, 6), np.arange(-2, 5))
    padded = np.pad(image, ((2, 2), (2, 2), (0, 0)))
    assert np.array_equal(fetch(image, x, y), padded)


short = st.floats(width=32, min_value=-(2.0**60), max_value=2.0**60)


@every_model
def test_no_points(model):
    image = noise((2, 3), np.float32)
    assert fetch(image, np.zeros(0, dtype=int), 0, model).shape == (0, 3)
    assert trilinear([image], np.zeros((0, 4)), 0.5, 0.0, model).shape == (0, 4, 3)


@given(short, short, short)
def test_fused_rounds_once(x, y, z):
    got = fused_multiply_add(np.float32(x), np.float32(y), np.float32(z))
    exact = Fraction(x) * Fraction(y) + Fraction(z)
    assert got == naive.nearest_float32(exact) or abs(exact) >= 2**127


def test_fused_where_rounding_twice_is_wrong():
    # x y = 2^-24 - 2^-60: float64 drops 2^-60 beside 1, and leaves a tie that goes to even
    x, y, z = np.float32(2.0**-12 * (1 + 2.0**-18)), np.float32(2.0**-12 * (1 - 2.0**-18)), np.float32(1 + 2.0**-23)
    for one, other in ((x, z), (-x, -z), (x, -z), (-x, z)):
        twice = np.float32(np.float64(one) * np.float64(y) + np.float64(other))
        assert abs(twice) in (1, 1 + 2.0**-22)
        assert abs(fused_multiply_add(one, y, other)) == z


def test_level_of_detail():
    squared = np.array([1.0, 4.0, 2.25, 9.0, 7.3**2])
    assert np.allclose(level_of_detail(squared), [0, 1, math.log2(1.5), math.log2(3), math.log2(7.3)], rtol=1e-15)
    # m 2^e by hand: 2.25 = 1.125 2^1, 9 = 1.125 2^3, 53.29 = 1.6653125 2^5
    assert np.allclose(level_of_detail(squared, bias=[0, -2, 1, 0.5, 0])[:2], [0, -1], rtol=1e-15)
    assert level_of_detail(4.0, LLVMPIPE, bias=0.25) == 1.25
    assert np.allclose(level_of_detail(squared, LLVMPIPE), [0, 1, 0.5625, 1.5625, 2.83265625], rtol=1e-15)


@pytest.mark.parametrize("shape", [*SHAPES, (6, 64), (13, 9)])
def test_sizes_of_chains(shape):
    image = noise(shape)
    for levels in (generate_mipmaps(image), box_mipmaps(image), gaussian_mipmaps(image)):
        sizes = [level.shape[:2] for level in levels]
        assert sizes == [tuple(max(1, n >> k) for n in shape) for k in range(max(shape).bit_length())]


def test_means_of_even_sizes():
    image = noise((16, 8))
    blocks = image.reshape(8, 2, 4, 2, 3).mean(axis=(1, 3))
    for levels in (generate_mipmaps(image), box_mipmaps(image)):
        assert np.allclose(levels[1], blocks, rtol=4e-16 * 4)  # four roundings
        assert np.allclose(levels[3][:, 0], image.reshape(2, 8, 8, 3).mean(axis=(1, 2)), rtol=4e-16 * 12)


def test_odd_sizes_by_hand():
    image = np.arange(5.0).reshape(1, 5, 1) ** 2  # 0 1 4 9 16
    # centres 5/4 and 15/4: 3/4 and 13/4 from the first texel's
    assert generate_mipmaps(image)[1].ravel().tolist() == [0.75, 9 + 7 / 4]
    assert box_mipmaps(image)[1].ravel().tolist() == [0.5, 6.5]


@pytest.mark.parametrize("deviation", [0.3, 1.0, 4.0])
def test_gaussian_of_one_bright_texel(deviation):
    image = np.zeros((16, 16, 1))
    image[7, 8] = 1.0
    e = math.exp(-0.5 / deviation**2)
    # each read is a 2 x 2 mean: per axis e, 1 + e, 1 + e, e over 2 (1 + 2 e); coarse texel k covers 2 k - 1 .. 2 k + 2
    inner, outer = (1 + e) / (2 + 4 * e), e / (2 + 4 * e)
    wanted = np.zeros((8, 8))
    wanted[np.ix_([3, 4], [3, 4])] = np.outer([inner, outer], [outer, inner])
    assert np.allclose(gaussian_mipmaps(image, deviation=deviation)[1][..., 0], wanted, rtol=1e-14, atol=0)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_gaussian_keeps_a_constant(dtype):
    for level in gaussian_mipmaps(np.full((7, 12, 1), 0.7, dtype=dtype)):
        assert np.allclose(level, 0.7, rtol=9 * np.finfo(dtype).eps * 4, atol=0)  # nine sums, four levels


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: bilinear([[1.0]], 0, 0), "image: got list"),
        (lambda: bilinear(np.ones((2, 2, 1), dtype=int), 0, 0), "image: got int64"),
        (lambda: bilinear(np.ones((2, 2)), 0, 0), r"image: got shape \(2, 2\)"),
        (lambda: bilinear(np.ones((0, 2, 1)), 0, 0), "image: got shape"),
        (lambda: bilinear(noise((2, 2)), 0, 0, LLVMPIPE), "image: got float64"),
        (lambda: bilinear(noise((2, 2)), np.nan, 0), "u: has 1 NaN"),
        (lambda: bilinear(noise((2, 2)), 0, np.inf), "v: has 1 infinite"),
        (lambda: bilinear(noise((2, 2)), [0, 1], [0, 1, 2]), "u, v: got shapes"),
        (lambda: bilinear(noise((2, 2)), 0, 0, border=(0, 1)), "border: got shape"),
        (lambda: trilinear([], 0, 0, 0), "levels"),
        (lambda: trilinear([noise((2, 2)), noise((1, 1), np.float32)], 0, 0, 0), "levels"),
        (lambda: fetch(noise((2, 2)), 0.5, 0), "x: got float64"),
        (lambda: fetch(noise((2, 2)), [0, 1], [0, 1, 1]), "x, y: got shapes"),
        (lambda: fetch(noise((2, 2)), [[0], [1, 2]], 0), "x: got a list; allowed are numbers"),
        (lambda: bilinear(noise((2, 2)), 0, [[0], [1, 2]]), "v: got a list; allowed are numbers"),
        (lambda: level_of_detail(0.0), "squared"),
        (lambda: level_of_detail([1.0, 2.0], bias=[0.0] * 3), "squared, bias: got shapes"),
        (lambda: gaussian_mipmaps(noise((2, 2)), deviation=0), "deviation"),
        (lambda: box_mipmaps(np.ones((2, 2, 1), dtype=np.uint8)), "image: got uint8"),
    ],
)
def test_bad_input(call, message):
    with pytest.raises(InputError, match=message):
        call()

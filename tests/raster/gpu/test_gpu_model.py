"""Stores to texture formats: against NumPy's float16, hand-computed cases and the formats' own definitions."""

import dataclasses

import numpy as np
import pytest

from refdof._check import InputError
from refdof.raster.gpu.gpu_model import D3D11, EXACT, FORMATS, LLVMPIPE, GpuModel, store

pytestmark = pytest.mark.fast

MODELS = {"exact": EXACT, "llvmpipe": LLVMPIPE, "d3d11": D3D11}
every_model = pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)


def bits(values):
    return np.asarray(values, dtype=np.float32).view(np.uint32)


def f32(*values):
    return np.array(values, dtype=np.float32)


def halves():
    """Every float16 from 0 to 65504, ascending."""
    return np.arange(0x7C00, dtype=np.uint16).view(np.float16).astype(np.float32)


@every_model
@pytest.mark.parametrize("sign", [1, -1])
def test_every_float16_stays(model, sign):
    values = np.float32(sign) * halves()
    assert np.array_equal(bits(store(values, "f16", model)), bits(values))


@every_model
def test_float16_specials(model):
    values = f32(np.inf, -np.inf, np.nan)
    assert np.array_equal(store(values, "f16", model), values, equal_nan=True)


def test_float16_to_nearest_is_numpys():
    value = halves()
    middle = (value[:-1] + value[1:]) / 2  # exact in float32
    around = [middle, np.nextafter(middle, f32(0)), np.nextafter(middle, f32(np.inf))]
    edge = f32(65519.996, 65520.0, 65535.0, 65536.0, 3e38, 1e-45, 2.0**-25, 2.0**-24)
    random = np.random.default_rng(1).integers(0, 0x7F800000, 100_000, dtype=np.uint32).view(np.float32)
    values = np.concatenate([*around, edge, random])
    with np.errstate(over="ignore"):
        wanted = np.concatenate([values, -values]).astype(np.float16).astype(np.float32)
    assert np.array_equal(bits(store(np.concatenate([values, -values]), "f16")), bits(wanted))


@pytest.mark.parametrize("model", [LLVMPIPE, D3D11])
def test_float16_towards_zero(model):
    value = halves()
    last = np.nextafter(value[1:], f32(0))  # the last float32 before the next float16
    middle = (value[:-1] + value[1:]) / 2
    for inside in (last, middle):
        assert np.array_equal(bits(store(inside, "f16", model)), bits(value[:-1]))
        assert np.array_equal(bits(store(-inside, "f16", model)), bits(-value[:-1]))
    assert np.array_equal(store(f32(65535, 65536, 3e38, -3e38), "f16", model), f32(65504, 65504, 65504, -65504))


# 0.5 * 255 = 127.5, 2.5 / 255 and 3.5 / 255 round to float32 whose exact product is just above or below the half;
# the float32 product is the half itself.
@pytest.mark.parametrize(
    ("model", "value", "wanted"),
    [
        (EXACT, 0.5, 128),
        (LLVMPIPE, 0.5, 128),
        (D3D11, 0.5, 128),
        (LLVMPIPE, 2.5 / 255, 2),
        (D3D11, 2.5 / 255, 3),
        (LLVMPIPE, 3.5 / 255, 4),
        (D3D11, 3.5 / 255, 4),
        (EXACT, -0.1, 0),
        (LLVMPIPE, -np.inf, 0),
        (D3D11, np.nan, 0),
        (EXACT, np.nan, 0),
        (EXACT, 7.0, 255),
        (D3D11, np.inf, 255),
    ],
)
def test_unorm8_by_hand(model, value, wanted):
    assert store(f32(value), "unorm8", model) * 255 == pytest.approx(wanted, rel=2e-7)  # the read rounds twice at most


@pytest.mark.parametrize(("name", "top"), [("unorm8", 255), ("unorm16", 65535)])
def test_every_integer_stays(name, top):
    values = (np.arange(top + 1) / top).astype(np.float32)
    for model in (EXACT, D3D11):
        assert np.array_equal(bits(store(values, name, model)), bits(values))
    # llvmpipe multiplies by the rounded inverse: half a step of float32 for that and half for the product
    assert np.allclose(store(values, name, LLVMPIPE), values, rtol=2.0**-23, atol=0)


def test_exact_unorm_is_the_nearest():
    values = np.random.default_rng(2).random(10_000, dtype=np.float32)
    whole = store(values, "unorm16").astype(np.float64) * 65535
    # half a step, and the read's rounding: 65535 * 2^-24
    assert np.abs(whole - values.astype(np.float64) * 65535).max() <= 0.5 + 65535 * 2.0**-24


@every_model
def test_eleven_bits_by_hand(model):
    zero = model.float_rounding == "zero"
    values = f32([1 + 2**-6 + 2**-7, 1 + 2**-7, 1 + 2**-5 + 2**-6], [1e30, 65024, 1e30], [-1, -np.inf, -0.0])
    largest = [65024, 64512] if zero else [np.inf, np.inf]
    wanted = f32(
        [1 + 2**-6 if zero else 1 + 2**-5, 1, 1 + 2**-5 if zero else 1 + 2**-4],
        [largest[0], 65024, largest[1]],
        [0, 0, 0],
    )
    assert np.array_equal(bits(store(values, "r11g11b10f", model)), bits(wanted))
    specials = f32([np.nan, np.inf, np.nan], [2.0**-20, 2.0**-14, 2.0**-19])  # last row: kept denormals
    assert np.array_equal(store(specials, "r11g11b10f", model), specials, equal_nan=True)


@every_model
@pytest.mark.parametrize("name", FORMATS)
def test_a_second_store_changes_nothing(model, name):
    values = np.random.default_rng(3).integers(0, 1 << 32, (4000, 3), dtype=np.uint32).view(np.float32)
    once = store(values, name, model)
    assert once.shape == values.shape
    assert once.dtype == np.float32
    assert np.array_equal(store(once, name, model), once, equal_nan=True)


@pytest.mark.parametrize(
    ("values", "name", "message"),
    [
        (f32(1), "f15", "texture_format"),
        (np.ones(3), "f16", "values: got float64"),
        ([1.0], "f16", "values: got list"),
        (f32(1, 2), "r11g11b10f", r"values: got shape \(2,\)"),
    ],
)
def test_bad_stores(values, name, message):
    with pytest.raises(InputError, match=message):
        store(values, name)


@pytest.mark.parametrize(
    "change",
    [{"subpixel_bits": 3}, {"filter_bits": 7}, {"float_rounding": "up"}, {"unorm_rounding": ""}, {"unorm_scale": "x"}],
)
def test_bad_models(change):
    with pytest.raises(InputError, match=next(iter(change))):
        dataclasses.replace(EXACT, **change)
    assert GpuModel() == EXACT

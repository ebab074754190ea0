"""Planar padded images: shifted slices are clamped gathers, and offsets split without loss."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import ndimage

from refdof.methods.singlepass.planar import pad_planes, tap_of

pytestmark = pytest.mark.fast


@pytest.mark.parametrize("shape", [(1, 1), (1, 4), (3, 1), (4, 5), (3, 4, 2), (2, 3, 3)])
@pytest.mark.parametrize("margin", [0, 1, 7])
def test_padded_planes_are_a_gather_with_clamped_indices(shape, margin):
    image = np.random.default_rng(4).random(shape).astype(np.float32)
    planes = pad_planes(image, margin)
    rows = np.clip(np.arange(-margin, shape[0] + margin), 0, shape[0] - 1)
    columns = np.clip(np.arange(-margin, shape[1] + margin), 0, shape[1] - 1)
    clamped = image.reshape(*shape[:2], -1)[rows][:, columns]
    assert planes.dtype == np.float32
    assert planes.flags.c_contiguous
    assert np.array_equal(planes, clamped.transpose(2, 0, 1))


def test_padding_by_hand():
    planes = pad_planes(np.array([[1.0, 2.0], [3.0, 4.0]]), 1)
    assert planes.tolist() == [[[1.0, 1.0, 2.0, 2.0], [1.0, 1.0, 2.0, 2.0], [3.0, 3.0, 4.0, 4.0], [3.0, 3.0, 4.0, 4.0]]]


@pytest.mark.parametrize(
    ("offset", "tap"),
    [
        ((0.0, 0.0), (0, 0, 0.0, 0.0)),
        ((1.25, -0.25), (1, -1, 0.25, 0.75)),
        ((-3.0, 2.5), (-3, 2, 0.0, 0.5)),
    ],
)
def test_offsets_by_hand(offset, tap):
    assert tap_of(*offset) == tap


@given(st.floats(-1000.0, 1000.0), st.floats(-1000.0, 1000.0))
def test_an_offset_is_its_texel_and_its_weights(dx, dy):
    tap = tap_of(dx, dy)
    for offset, texel, weight in ((dx, tap.x, tap.weight_x), (dy, tap.y, tap.weight_y)):
        assert texel <= offset
        assert 0.0 <= weight <= 1.0  # 1 only where a tiny negative offset is rounded: the right texel all the same
        # One subtraction: half a rounding step of a number below 1.
        assert abs(texel + weight - offset) <= 2.0**-53 * max(1.0, abs(offset))


def test_a_tap_is_scipys_linear_interpolation():
    image = np.random.default_rng(5).random((6, 7))
    dx, dy, margin = 1.3, -2.6, 4
    tap, plane = tap_of(dx, dy), pad_planes(image, margin)[0]

    def shifted(right, below):
        top, left = margin + tap.y + below, margin + tap.x + right
        return plane[top : top + 6, left : left + 7]

    u, v = tap.weight_x, tap.weight_y
    ours = (1 - v) * ((1 - u) * shifted(0, 0) + u * shifted(1, 0)) + v * ((1 - u) * shifted(0, 1) + u * shifted(1, 1))
    y, x = np.indices(image.shape)
    theirs = ndimage.map_coordinates(image, [y + dy, x + dx], order=1, mode="nearest")
    # Values below 1, about ten roundings each.
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-14)

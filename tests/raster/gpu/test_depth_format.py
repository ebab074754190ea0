"""Depth formats against fractions, their stated precision, and peeling that never meets a surface twice."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from refdof import Camera, InputError
from refdof.raster.gpu.depth_format import DEPTH_FORMATS, depth_code, depths_of, key_of, keys_of
from refdof.raster.gpu.depth_peeling import peel_raster
from refdof.raster.gpu.rasterize import rasterize

pytestmark = pytest.mark.fast

CAMERA = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=60.0, size=(12, 9))
SHORT = DEPTH_FORMATS[1:]


def wall(depth, tilt=0.0):
    """Two triangles far beyond the picture, at one depth in its middle column."""
    side = 50.0 * depth
    return np.array([[x, y, -depth - tilt * x] for x, y in ((-side, -side), (side, -side), (0.0, 2.0 * side))])


@pytest.mark.parametrize(("name", "bits"), [("unorm16", 16), ("unorm24", 24)])
def test_unorm_keys_are_the_nearest_whole_numbers(name, bits):
    near, far = 0.5, 100.0
    code, top = depth_code(name, near, far), 2**bits - 1
    depth = np.random.default_rng(1).uniform(near, far, 500)
    for d, key in zip(depth, keys_of(depth, code), strict=True):
        z = Fraction(far) / (Fraction(far) - Fraction(near)) * (1 - Fraction(near) / Fraction(float(d)))
        assert abs(Fraction(float(key)) - z * top) <= Fraction(1, 2) + Fraction(1, 10**6)  # float64 in between
    assert keys_of(np.array([near, far]), code).tolist() == [0, top]


def test_reversed_keys_are_single_precision():
    code = depth_code("reversed", 0.25, math.inf)
    depth = np.array([0.25, 1.0, 3.0, 1e6, np.inf])
    np.testing.assert_array_equal(keys_of(depth, code), -np.float32(0.25 / depth).astype(np.float64))


@given(st.sampled_from(SHORT), st.floats(0.01, 1.0), st.floats(2.0, 1e4), st.floats(0.0, 1.0))
def test_a_depth_read_back_is_stored_as_the_same_key(name, near, span, place):
    code = depth_code(name, near, near * span)
    depth = np.array([near * span**place])
    keys = keys_of(depth, code)
    back = depths_of(keys, code)
    np.testing.assert_array_equal(keys_of(back, code), keys)
    assert float(keys[0]) == float(key_of(1.0 / depth[0], code))


@given(st.sampled_from(DEPTH_FORMATS), st.floats(0.1, 1.0), st.floats(1.0, 100.0), st.floats(1.0, 2.0))
def test_keys_grow_with_depth(name, near, depth, factor):
    code = depth_code(name, near, 1000.0)
    nearer, farther = keys_of(np.array([depth, depth * factor]), code)
    assert nearer <= farther


def test_reversed_is_as_fine_far_away_as_nearby():
    depth = np.geomspace(0.01, 1e7, 2000)
    back = {name: depths_of(keys_of(depth, c), c) for name in SHORT for c in [depth_code(name, 0.01, np.inf)]}
    # Half a step of float32, relative; and the division back.
    assert (np.abs(back["reversed"] / depth - 1.0) <= 2.0**-24 * 1.001).all()
    # A step of 24 bits is d^2 / near / 2^24 [1]: at 1000 m with a near plane of 1 cm, 6 m.
    at = depth > 900.0
    assert (np.abs(back["unorm24"] - depth)[at & (depth < 1100.0)]).max() == pytest.approx(3.0, rel=0.25)


def test_what_a_format_cannot_tell_apart_goes_to_the_first_triangle():
    vertices = np.concatenate([wall(1000.0), wall(999.9)])
    faces = np.array([[0, 1, 2], [3, 4, 5]])
    for name, expected in (("linear", 1), ("reversed", 1), ("unorm24", 0), ("unorm16", 0)):
        ours = rasterize(vertices, faces, CAMERA, near=0.01, far=2000.0, depth_format=name)
        assert set(np.unique(ours.triangle)) == {expected}


@pytest.mark.parametrize("name", DEPTH_FORMATS)
@pytest.mark.parametrize("precision", ["float32", "float64"])
def test_peeling_ends_and_meets_every_triangle_once(name, precision):
    random = np.random.default_rng(8)
    depth = random.uniform(1.0, 2.0, 12)
    vertices = np.concatenate([wall(d, t) for d, t in zip(depth, random.uniform(-0.2, 0.2, 12), strict=True)])
    faces = np.arange(36).reshape(-1, 3)
    layers = peel_raster(vertices, faces, CAMERA, near=0.5, far=9.0, depth_format=name, precision=precision)
    met = np.sort(layers.triangle.reshape(12, -1).T)
    again = (np.diff(met) == 0) & (met[:, 1:] >= 0)
    assert not again.any()
    # Where planes cross, 16 bits store both as one depth, and one is lost.
    assert (met < 0).sum() <= (12 if name == "unorm16" else 0)
    order = layers.depth.reshape(12, -1)
    assert (order[1:] > order[:-1])[np.isfinite(order[1:])].all()


def test_nothing_beyond_the_far_plane():
    ours = rasterize(np.concatenate([wall(3.0), wall(5.0)]), np.array([[0, 1, 2], [3, 4, 5]]), CAMERA, far=4.0)
    assert set(np.unique(ours.triangle)) == {0}
    assert (rasterize(wall(5.0), np.array([[0, 1, 2]]), CAMERA, far=4.0).triangle == -1).all()


@pytest.mark.parametrize(("name", "near", "far", "message"), [("d24", 1, 2, "depth_format"), ("linear", 2, 2, "far")])
def test_bad_input(name, near, far, message):
    with pytest.raises(InputError, match=f"{message}: got"):
        depth_code(name, near, far)

"""Depth kinds: by hand, against a plain twin, and there and back."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from refdof import InputError
from refdof.frame.depth_kinds import DEPTH_KINDS, planar_depth
from refdof.frame.frame import frame_camera
from tests.frame.depth_twin import stored_depth

pytestmark = pytest.mark.fast
CAMERA = frame_camera(90.0, (2, 2))  # P = 1 px: slopes of -0.5 and 0.5
ONE = frame_camera(40.0, (1, 1))


def planar(value, kind, near=None, far=None, dtype=np.float64):
    return planar_depth(np.array([[value]], dtype=dtype), kind, ONE, near, far)[0, 0]


def test_by_hand():
    # n = 1, f = 9. Halfway between both in 1/z, at d = 0.5: 1/z = (1 + 1/9) / 2 = 5/9.
    assert planar(0.5, "device", 1.0, 9.0) == pytest.approx(1.8, rel=1e-15)
    assert planar(0.5, "reversed", 1.0, 9.0) == pytest.approx(1.8, rel=1e-15)
    assert planar(0.0, "device", 1.0, 9.0) == 1.0
    assert planar(1.0, "reversed", 1.0, 9.0) == 1.0
    # A quarter: 1/z = 1 - (1/4) (8/9) = 7/9 for device, 1/9 + (1/4) (8/9) = 1/3 for reversed.
    assert planar(0.25, "device", 1.0, 9.0) == pytest.approx(9 / 7, rel=1e-15)
    assert planar(0.25, "reversed", 1.0, 9.0) == pytest.approx(3.0, rel=1e-15)
    assert planar(0.125, "reversed-infinite", 0.25) == 2.0
    # 3 away along (0.5, 0.5, -1), of length sqrt(1.5), in every corner.
    radial = planar_depth(np.full((2, 2), 3.0), "radial", CAMERA)
    assert radial == pytest.approx(np.full((2, 2), 6**0.5), rel=1e-15)


def test_background_is_at_infinity():
    for value, kind, planes in (
        (1.0, "device", (1, 9)), (0.0, "reversed", (1, 9)), (0.0, "reversed-infinite", (1,)),
        (1e10, "planar", ()), (1e10, "radial", ()), (np.inf, "planar", ()), (np.inf, "radial", ()),
    ):  # fmt: skip
        assert planar(value, kind, *planes) == np.inf
        assert planar(value, kind, *planes, dtype=np.float32) == np.inf
    assert planar(1.0000001e10, "planar") == 1.0000001e10


@settings(deadline=None)
@given(st.floats(0.0, 1.0), st.floats(1e-3, 1e3), st.floats(1.001, 1e6), st.sampled_from(["device", "reversed"]))
def test_no_difference_cancels(value, near, ratio, kind):
    """Exact numbers say the same: a few roundings of float64, 1.1e-16 each, whatever d is."""
    far = near * ratio
    d, n, f = Fraction(value), Fraction(near), Fraction(far)
    empty = value == (1.0 if kind == "device" else 0.0)
    exact = 1 / n - d * (1 / n - 1 / f) if kind == "device" else 1 / f + d * (1 / n - 1 / f)
    wanted = np.inf if empty else float(1 / exact)
    assert planar(value, kind, near, far) == pytest.approx(wanted, rel=1e-15)


@pytest.mark.parametrize("kind", DEPTH_KINDS)
def test_there_and_back_over_a_picture(kind):
    # The twin stores in long double, rounded once to float64. What that costs is relative z / n roundings at most,
    # of 1.1e-16, and some of the way back.
    camera = frame_camera(50.0, (7, 5))
    depth = np.random.default_rng(3).uniform(0.6, 90.0, (5, 7))
    depth[2, 3] = np.inf
    near, far = 0.5, 100.0
    planes = {"device": (near, far), "reversed": (near, far), "reversed-infinite": (near, None)}.get(kind, (None, None))
    back = planar_depth(stored_depth(kind, depth, camera, near, far), kind, camera, *planes)
    assert np.array_equal(np.isinf(back), np.isinf(depth))
    near_one = depth < np.inf
    np.testing.assert_allclose(back[near_one], depth[near_one], rtol=1.1e-16 * (90.0 / 0.5 + 4))


def test_rays_by_hand_off_the_diagonal():
    """Rows are y: a picture of one row and three columns has slopes -1, 0, 1 in x only."""
    camera = frame_camera(2 * np.degrees(np.arctan(0.5)), (3, 1))  # P = 1
    back = planar_depth(np.array([[2.0, 2.0, 2.0]]), "radial", camera)
    assert back == pytest.approx(np.array([[2**0.5, 2.0, 2**0.5]]), rel=1e-15)


@pytest.mark.parametrize(
    ("value", "kind", "planes", "said"),
    [
        (1.5, "device", (1, 9), r"depth: largest value is 1.5; allowed for device are values in 0 .. 1"),
        (-0.5, "reversed", (1, 9), r"depth: smallest value is -0.5; allowed for reversed are values in 0 .. 1"),
        (3.0, "reversed-infinite", (1,), r"depth: largest value is 3; allowed for reversed-infinite are values in"),
        (np.inf, "device", (1, 9), r"depth: largest value is inf; allowed for device"),
        (np.nan, "planar", (), r"depth: has 1 NaN values; none are allowed"),
        (-2.0, "planar", (), r"depth: smallest value is -2; allowed for planar are values > 0"),
        (0.0, "radial", (), r"depth: smallest value is 0; allowed for radial are values > 0"),
        (0.5, "device", (), r"near: got none; allowed for device is the distance of that plane"),
        (0.5, "reversed", (1.0,), r"far: got none; allowed for reversed"),
        (0.5, "reversed-infinite", (1.0, 2.0), r"far: got 2 for reversed-infinite, which has no such plane"),
        (0.5, "planar", (1.0,), r"near: got 1 for planar, which has no such plane"),
        (0.5, "device", (2.0, 2.0), r"far: got 2 with near 2; allowed is a number above near"),
        (0.5, "device", (-1.0, 2.0), r"near: got -1; allowed is"),
        (0.5, "device", (1.0, np.nan), r"far: got nan; allowed is"),
        (0.5, "z-buffer", (), r"kind: got 'z-buffer'; allowed are planar, radial"),
    ],
)
def test_what_contradicts_the_kind_is_refused(value, kind, planes, said):
    with pytest.raises(InputError, match=said):
        planar(value, kind, *planes)


def test_what_float64_cannot_hold_is_refused():
    with pytest.raises(InputError, match="depth: "):
        planar_depth(np.array([["a"]]), "planar", ONE)
    with pytest.raises(InputError, match=r"depth: got shape \(2, 1\); allowed is \(1, 1\)"):
        planar_depth(np.ones((2, 1)), "planar", ONE)

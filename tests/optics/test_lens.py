"""Circle of confusion against hand-computed numbers, exact fractions and limits."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from refdof._check import InputError
from refdof.optics.aperture import Aperture
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens

pytestmark = pytest.mark.fast

CAMERA = Camera.look_at((0, 0, 0), (0, 0, -1), fov_y=40.0, size=(640, 480))


def photographer():
    """A 50 mm f/1.4 lens focused at 2 m on a sensor 24 mm high with 480 rows: 20 pixels per millimetre.

    The image lies at v = f s / (s - f) = 50 * 2000 / 1950 = 51.28205 mm behind the lens, which sets the field
    of view; a distant point's blur has the diameter f^2 / (N (s - f)) = 2500 / (1.4 * 1950) = 0.915751 mm.
    """
    fov_y = 2.0 * math.degrees(math.atan(12.0 / 51.28205128205128))
    camera = Camera.look_at((0, 0, 0), (0, 0, -1), fov_y=fov_y, size=(720, 480))
    return camera, ThinLens.from_f_number(focal_length=0.05, f_number=1.4, focus_distance=2.0)


def test_fifty_millimetres_at_two_metres():
    camera, lens = photographer()
    assert lens.radius == pytest.approx(0.01785714, rel=1e-6)  # 25 mm / 1.4; seven digits are written out
    # Radius of a distant point: 0.915751 mm / 2 * 20 px/mm = 9.15751 px; six digits are written out.
    assert lens.coc_px(math.inf, camera) == pytest.approx(9.15751, rel=1e-6)
    # At half the focus distance 1/s - 1/d = -1/2, the negative of what it is at infinity.
    assert lens.coc_px(1.0, camera) == pytest.approx(-9.15751, rel=1e-6)
    # At twice the focus distance it is half of that at infinity.
    assert lens.coc_px(4.0, camera) == pytest.approx(4.578755, rel=1e-6)


def test_sign_and_focus():
    lens = ThinLens(0.1, 2.0)
    coc = lens.coc_px([0.5, 1.999, 2.0, 2.001, 1e30, np.inf], CAMERA)
    assert (coc[:2] < 0).all()
    assert coc[2] == 0.0
    assert (coc[3:] > 0).all()
    assert np.isfinite(coc).all()
    assert coc[4] == coc[5]  # 1e-30 is below half an ulp of 1


def test_focus_at_infinity():
    coc = ThinLens(0.1, math.inf).coc_px([2.0, math.inf], CAMERA)
    # 480 / (2 tan 20 deg) * 0.1 / 2 = 659.3944 * 0.05; eight digits are written out.
    assert coc[0] == pytest.approx(-32.96973, rel=1e-6)
    assert coc[1] == 0.0


@pytest.mark.parametrize("focus", [0.3, math.inf])
def test_pinhole_is_exactly_sharp(focus):
    depth = np.array([1e-30, 0.3, 1.0, np.inf], dtype=np.float32)
    coc = ThinLens(0.0, focus).coc_px(depth, CAMERA)
    assert coc.dtype == np.float32
    assert (coc == 0.0).all()


@pytest.mark.parametrize("focus", [2.0, math.inf])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_shape_and_type_are_kept(dtype, focus):
    depth = np.linspace(1.0, 5.0, 24, dtype=dtype).reshape(2, 3, 4)
    coc = ThinLens(0.1, focus).coc_px(depth, CAMERA)
    assert coc.shape == depth.shape
    assert coc.dtype == dtype


def exact_coc(lens, depth):
    """P E (1 / focus - 1 / depth) in fractions, from the same doubles."""
    scale = Fraction(CAMERA.pixels_per_tangent) * Fraction(lens.radius)
    return scale * (1 / Fraction(lens.focus_distance) - 1 / Fraction(depth))


@given(
    focus=st.floats(1e-3, 1e3),
    distance=st.floats(1e-16, 1.0),
    sign=st.sampled_from([-0.999, 1.0]),
)
@settings(max_examples=200, deadline=None)
def test_no_digits_are_lost_near_focus(focus, distance, sign):
    lens, depth = ThinLens(0.37, focus), focus * (1.0 + sign * distance)
    exact = exact_coc(lens, depth)
    # One rounding (2^-53) each of the difference (none near focus), the quotient, the scale twice and the
    # product, the quotient's doubled where 1 - focus / depth is 1/2: six in all, below 4 ulp of 2^-52.
    assert abs(Fraction(float(lens.coc_px(depth, CAMERA))) - exact) <= abs(exact) * 4 * Fraction(1, 2**52)


@given(depth=st.floats(1e-6, 1e6))
@settings(max_examples=200, deadline=None)
def test_any_depth_agrees_with_fractions(depth):
    lens = ThinLens(0.37, 1.7)
    exact = exact_coc(lens, depth)
    assert abs(Fraction(float(lens.coc_px(depth, CAMERA))) - exact) <= abs(exact) * 4 * Fraction(1, 2**52)


def test_single_precision_is_the_exact_value_rounded_once():
    depth = np.float32([1.6999999, 1.7, 1.7000002, 3.3])
    lens = ThinLens(0.37, 1.7)
    exact = [float(exact_coc(lens, float(d))) for d in depth]
    np.testing.assert_array_equal(lens.coc_px(depth, CAMERA), np.float32(exact))


def test_absurd_depths_stay_finite():
    smallest = np.array([5e-324, 1e-300])
    for lens in (ThinLens(1.0, 1.0), ThinLens(1.0, math.inf)):
        for depth in (smallest, np.float32([1e-45, 1e-38])):
            coc = lens.coc_px(depth, CAMERA)
            assert np.isfinite(coc).all()
            assert (coc < -1e30).all()


@given(factor=st.sampled_from([2.0**-20, 0.5, 2.0, 2.0**30]))
def test_the_unit_of_length_changes_nothing(factor):
    depth = np.geomspace(0.1, 100.0, 50)
    coc = ThinLens(0.1, 2.0).coc_px(depth, CAMERA)
    scaled = ThinLens(0.1 * factor, 2.0 * factor).coc_px(depth * factor, CAMERA)
    np.testing.assert_array_equal(coc, scaled)  # powers of two round nothing


def test_twice_the_rows_are_twice_the_pixels():
    depth = np.array([0.5, 3.0, np.inf])
    lens, large = ThinLens(0.1, 2.0), CAMERA.with_size((1280, 960))
    np.testing.assert_array_equal(2.0 * lens.coc_px(depth, CAMERA), lens.coc_px(depth, large))


@pytest.mark.parametrize("focus", [0.05, 0.04, 0.0, -1.0, math.nan])
def test_no_image_within_the_focal_length(focus):
    with pytest.raises(InputError, match=r"^focus_distance: got "):
        ThinLens.from_f_number(focal_length=0.05, f_number=1.4, focus_distance=focus)


@pytest.mark.parametrize("name", ["focal_length", "f_number"])
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf, "wide"])
def test_from_f_number_refuses(name, value):
    arguments = {"focal_length": 0.05, "f_number": 1.4, "focus_distance": 2.0, name: value}
    with pytest.raises(InputError, match=f"^{name}: got "):
        ThinLens.from_f_number(**arguments)


@pytest.mark.parametrize("radius", [-1e-9, math.nan, math.inf, "big", None])
def test_bad_radius(radius):
    with pytest.raises(InputError, match=r"^radius: got .*allowed is a finite number >= 0"):
        ThinLens(radius, 1.0)


@pytest.mark.parametrize("focus", [0.0, -1.0, math.nan, -math.inf, None])
def test_bad_focus(focus):
    with pytest.raises(InputError, match=r"^focus_distance: got .*allowed is a number > 0"):
        ThinLens(0.1, focus)


def test_bad_aperture():
    with pytest.raises(InputError, match=r"^aperture: got str"):
        ThinLens(0.1, 1.0, "hexagon")


@pytest.mark.parametrize("depth", [0.0, -1.0, [1.0, math.nan], [1.0, -math.inf], [[0.0, 1.0]], "far"])
@pytest.mark.parametrize("radius", [0.0, 0.1])
def test_bad_depth(depth, radius):
    with pytest.raises(InputError, match=r"^depth: "):
        ThinLens(radius, 1.0).coc_px(depth, CAMERA)


def test_the_aperture_is_kept():
    hexagon = Aperture.polygon(6)
    assert ThinLens.from_f_number(0.05, 2.0, 1.0, hexagon).aperture is hexagon

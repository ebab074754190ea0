"""Paraxial numbers against closed forms, published ones, traced rays near the axis and Seidel's theory."""

import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from refdof._check import InputError
from refdof.optics.systems.glass import AIR, LINE_C, LINE_D, LINE_F, Glass, glass_of
from refdof.optics.systems.paraxial import (
    Pupil,
    cardinal_points,
    entrance_pupil,
    exit_pupil,
    f_number,
    focal_length,
    image_scale,
    sensor_for,
    stopped_down,
    transmission,
)
from refdof.optics.systems.system import LensSystem, Surface, ThickLens
from refdof.optics.systems.trace import trace
from tests.optics.systems.lenses import double_gauss, doublet, singlet

pytestmark = pytest.mark.fast

LENSES = {"double gauss": double_gauss(), "singlet": singlet(), "doublet": doublet()}


def crossing(system, height, wavelength=LINE_D):
    """z where a ray from infinity at a height meets the axis."""
    found = trace(system, [[height, 0.0, -10.0]], [[0.0, 0.0, 1.0]], wavelength)
    (x, _, z), (dx, _, dz) = found.origins[0], found.directions[0]
    return z - x * dz / dx


@pytest.mark.parametrize(
    ("r1", "r2", "t"), [(60.0, -80.0, 6.0), (40.0, 90.0, 9.0), (math.inf, -50.0, 4.0), (-70.0, 45.0, 2.0)]
)
def test_lensmaker_with_thickness(r1, r2, t):
    """The closed forms of a single lens, measured from its vertices."""
    n = 1.6
    points = cardinal_points(ThickLens(r1, r2, t, 20.0, Glass("plain", n)).system())
    f = 1.0 / ((n - 1) * (1 / r1 - 1 / r2 + (n - 1) * t / (n * r1 * r2)))
    assert points.focal_length == pytest.approx(f, rel=1e-13)
    assert points.back_focal_distance == pytest.approx(f * (1 - (n - 1) * t / (n * r1)), rel=1e-13)
    assert points.front_focal_distance == pytest.approx(f * (1 + (n - 1) * t / (n * r2)), rel=1e-13)
    assert points.front_principal == pytest.approx(-f * (n - 1) * t / (n * r2), abs=1e-12)
    assert points.back_principal - t == pytest.approx(-f * (n - 1) * t / (n * r1), abs=1e-12)


def test_thin_limit():
    """A lens of thickness t differs from the thin lens by a relative (n-1) t / (n (R1 - R2)): order 1 in t."""
    n, thin = 1.5, 1.0 / (0.5 * (1 / 50 + 1 / 50))
    errors = [
        focal_length(LensSystem("thin", ThickLens(50.0, -50.0, t, 1.0, Glass("plain", n)).system().surfaces)) - thin
        for t in (0.1, 0.05)
    ]
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=1e-3)


def test_double_gauss_has_its_published_focal_length():
    # 50.35816 mm in two other programs; the stop of 17.1 mm and the rest are from the table itself.
    assert focal_length(double_gauss()) == pytest.approx(50.35816, abs=1e-5)
    with np.load(Path(__file__).with_name("optiland_rays.npz")) as optiland:
        for name, system in LENSES.items():
            printed = float(optiland[f"{name.replace(' ', '_')}_focal_length"])
            assert focal_length(system, 0.51) == pytest.approx(printed, rel=1e-9)
    assert f_number(double_gauss()) == pytest.approx(2.03, abs=0.005)  # sold as f/2


@pytest.mark.parametrize("name", LENSES)
def test_rays_tend_to_the_paraxial_focus_with_order_two(name):
    """The error of a real ray is spherical aberration: it falls by 4 when the height is halved."""
    system = LENSES[name]
    focus = cardinal_points(system).back_focus
    errors = [crossing(system, height) - focus for height in (0.4, 0.2, 0.1)]
    for wide, narrow in pairwise(errors):
        assert wide / narrow == pytest.approx(4.0, rel=0.01)  # the next order is a relative height^2 / 1000 mm^2


@pytest.mark.parametrize("name", LENSES)
def test_the_pupils_are_images_of_the_stop(name):
    """A narrow ray of the stop's centre points to both pupils' centres, one along the axis at a height to theirs."""
    system, small = LENSES[name], 1e-4
    stop = system.vertices[system.stop]
    behind = [replace(surface, is_stop=False) for surface in system.surfaces[system.stop + 1 :]]
    behind = [replace(system.surfaces[system.stop], is_stop=True), *behind]
    before = [replace(surface, is_stop=k == 0) for k, surface in enumerate(system.surfaces[: system.stop])]
    for pupil, surfaces, shift, way in (
        (exit_pupil(system), behind, stop, 1.0),
        (entrance_pupil(system), before, 0.0, -1.0),
    ):
        radius = system.surfaces[system.stop].semi_diameter
        if not surfaces:  # the first surface is the stop
            assert (pupil.z, pupil.radius) == (0.0, radius)
            continue
        start = np.array([[0.0, 0.0, stop - shift], [small * radius, 0.0, stop - shift]])
        part, ahead = LensSystem("part", tuple(surfaces)), np.array([[small, 0.0, way], [0.0, 0.0, way]])
        found = trace(part, start, ahead, LINE_D, reverse=way < 0)
        assert found.passed.all()
        x, z = found.origins[:, 0], found.origins[:, 2] + shift
        slope = found.directions[:, 0] / found.directions[:, 2]
        assert z[0] - x[0] / slope[0] == pytest.approx(pupil.z, abs=1e-5)  # small^2 of the lens's size
        assert (x[1] + (pupil.z - z[1]) * slope[1]) / small == pytest.approx(pupil.radius, rel=1e-6)


def test_pupils_of_a_reversed_lens_change_places():
    for system in LENSES.values():
        back, length = system.reversed(), system.vertices[-1]
        assert entrance_pupil(back).z == pytest.approx(length - exit_pupil(system).z, abs=1e-12)
        assert exit_pupil(back).radius == pytest.approx(entrance_pupil(system).radius, rel=1e-13)
        assert focal_length(back) == pytest.approx(focal_length(system), rel=1e-13)


def test_spherical_aberration_of_a_singlet_is_seidels():
    """Third-order longitudinal aberration of a thin lens for distant points, in Coddington's shape factor q.

    LA = h^2 / (8 f n (n-1)) [n^3 / (n-1) + (3n+2)(n-1) p^2 + 4 (n+1) p q + (n+2) / (n-1) q^2], p = -1 for distant
    points: Jenkins & White, Fundamentals of Optics, 4th edition, chapter 9.
    """
    n, f = 1.5, 100.0
    for q in (-2.0, 0.0, 0.714285714, 1.0, 2.0):
        # q = (R2 + R1) / (R2 - R1)
        r1 = 2.0 * f * (n - 1) / (q + 1.0)
        r2 = math.inf if q == 1.0 else 2.0 * f * (n - 1) / (q - 1.0)
        lens = ThickLens(r1, r2, 0.02, 1.2, Glass("plain", n)).system()
        height = 0.5
        found = cardinal_points(lens).back_focus - crossing(lens, height)
        shape = n**3 / (n - 1) + (3 * n + 2) * (n - 1) - 4 * (n + 1) * q + (n + 2) / (n - 1) * q * q
        expected = height**2 / (8 * f * n * (n - 1)) * shape
        assert found == pytest.approx(expected, rel=2e-3)  # the lens is 0.02 of 100 mm thick: 2e-4 times its shape


def test_axial_colour_of_a_singlet():
    """A thin lens has 1/F = (n - 1) (1/R1 - 1/R2) at every wavelength."""
    lens = ThickLens(80.0, -80.0, 0.02, 1.0, glass_of("N-BK7")).system()
    thin = {line: 40.0 / (glass_of("N-BK7").index(line) - 1.0) for line in (LINE_C, LINE_D, LINE_F)}
    spread = focal_length(lens, LINE_C) - focal_length(lens, LINE_F)
    assert spread == pytest.approx(thin[LINE_C] - thin[LINE_F], rel=2e-4)  # thickness / radius
    assert spread == pytest.approx(thin[LINE_D] / 64.17, rel=0.01)  # the textbook's f / V, of first order in 1 / V
    assert focal_length(doublet(), LINE_C) - focal_length(doublet(), LINE_F) < spread * 100.0 / thin[LINE_D] / 10.0


def test_field_curvature_is_petzvals_and_astigmatisms():
    """A thin lens with its stop at the lens has Petzval's curvature 1 / (n f) and astigmatism.

    Sagittal foci lie h^2 / 2 (1/(n f) + 1/f) before the image plane, tangential ones h^2 / 2 (1/(n f) + 3/f).
    """
    n, f, tilt = 1.5, 100.0, 0.02
    lens = ThickLens(100.0, -100.0, 0.02, 2.0, Glass("plain", n)).system()
    focus = cardinal_points(lens)
    small = 1e-3
    aim = np.array([[0.0, 0.0], [small, 0.0], [0.0, small]])
    direction = np.tile([tilt, 0.0, 1.0], (3, 1))
    origin = np.column_stack([aim, np.zeros(3)]) - direction
    found = trace(lens, origin, direction, LINE_D)
    x, y, z = found.origins.T
    dx, dy, _ = (found.directions / found.directions[:, 2:]).T
    tangential = z[0] - ((x[1] - x[0]) - dx[1] * (z[1] - z[0])) / (dx[1] - dx[0])
    sagittal = z[0] - (y[2] - dy[2] * (z[2] - z[0])) / dy[2]
    height = f * tilt
    assert focus.back_focus - sagittal == pytest.approx(height**2 / 2 * (1 / (n * f) + 1 / f), rel=2e-3)
    assert focus.back_focus - tangential == pytest.approx(height**2 / 2 * (1 / (n * f) + 3 / f), rel=2e-3)


@pytest.mark.parametrize("name", LENSES)
def test_focused_on_a_distance_a_point_there_is_sharp(name):
    system, distance = LENSES[name], 900.0
    sensor = sensor_for(system, distance)
    z = entrance_pupil(system).z - distance
    found = trace(system, [[0.0, 0.0, z]], [[2e-5, 0.0, 1.0]], LINE_D)
    (x, _, place), (dx, _, dz) = found.origins[0], found.directions[0]
    assert place - x * dz / dx == pytest.approx(sensor, abs=1e-4)  # spherical aberration at a height of 0.02 mm
    # A point off the axis by a small tangent, through the entrance pupil's centre.
    tangent = 1e-4
    chief = trace(system, [[-distance * tangent, 0.0, z]], [[tangent, 0.0, 1.0]], LINE_D)
    (x, _, place), (dx, _, dz) = chief.origins[0], chief.directions[0]
    # On the sensor the chief ray is off the image point by the aberration of a pupil of height 0: none.
    assert x + (sensor - place) * dx / dz == pytest.approx(tangent * image_scale(system, distance), rel=1e-5)


def test_focus_at_infinity_and_breathing():
    system = double_gauss()
    assert sensor_for(system, math.inf) == pytest.approx(cardinal_points(system).back_focus, rel=1e-15)
    assert image_scale(system, math.inf) == pytest.approx(50.35816, abs=1e-5)
    # 39.34 degrees on a sensor 36 mm wide; nearer, the field shrinks.
    fields = [2.0 * math.degrees(math.atan(18.0 / image_scale(system, d))) for d in (math.inf, 1000.0, 500.0)]
    assert fields[0] == pytest.approx(39.34, abs=0.005)
    assert fields[0] > fields[1] > fields[2]


def test_stopping_down():
    system = stopped_down(double_gauss(), 5.6)
    assert f_number(system) == pytest.approx(5.6, rel=1e-13)
    assert focal_length(system) == focal_length(double_gauss())
    assert stopped_down(double_gauss(), 2.0) == double_gauss()  # engraved f/2, and 2.03 in truth
    with pytest.raises(InputError, match=r"^f_stop: got 1\.8; allowed is at least the lens's own, 2\.03"):
        stopped_down(double_gauss(), 1.8)
    with pytest.raises(InputError, match=r"^f_stop: got 0; "):
        stopped_down(double_gauss(), 0.0)


def test_what_has_no_focus():
    plate = LensSystem("plate", (Surface(math.inf, 5.0, Glass("p", 1.5), 9.0, True), Surface(math.inf, 1.0, AIR, 9.0)))
    assert math.isinf(focal_length(plate))
    with pytest.raises(InputError, match=r"^system: got 'plate', which has no focal length"):
        cardinal_points(plate)
    diverging = ThickLens(-60.0, 60.0, 4.0, 20.0, Glass("p", 1.5)).system("diverging")
    assert focal_length(diverging) < 0
    with pytest.raises(InputError, match=r"^system: got 'diverging', whose image lies inside"):
        sensor_for(diverging, 500.0)
    for distance in (-1.0, 10.0, 47.0, math.nan):
        with pytest.raises(InputError, match=r"^focus_distance: got"):
            sensor_for(double_gauss(), distance)
    assert sensor_for(singlet(), 66.0) > 1e4  # just outside the front focus


def two(radius1, radius2, thickness=2.0, rim=5.0):
    """A lens of index 1.5 whose first rim is the stop."""
    glass = Glass("plain", 1.5)
    return LensSystem("two", (Surface(radius1, thickness, glass, rim, True), Surface(radius2, 3.0, AIR, rim)))


@pytest.mark.parametrize("radius", [1e300, -1e300, 1.7e308, 1e160, 1e12, -1e12, math.inf])
def test_huge_radii_are_a_plate(radius):
    """Whose pupils are those of a flat one, and whose focus is so far that nothing near the lens has digits."""
    plate = two(radius, -radius)
    # 1 / f = (n - 1) (2 / R - (n - 1) t / (n R^2)), of which the second part is below 1e-12 of the first.
    assert focal_length(plate) == pytest.approx(radius, rel=1e-11)
    assert f_number(plate) == pytest.approx(abs(radius) / 10.0, rel=1e-11)
    assert entrance_pupil(plate) == Pupil(0.0, 5.0)
    assert exit_pupil(plate).z == pytest.approx(2.0 - 2.0 / 1.5, abs=1e-11)
    assert exit_pupil(plate).radius == pytest.approx(5.0, rel=1e-11)
    for call in (cardinal_points, lambda s: sensor_for(s, 900.0), lambda s: sensor_for(s, math.inf),
                 lambda s: image_scale(s, 900.0), lambda s: image_scale(s, math.inf)):  # fmt: skip
        with pytest.raises(InputError, match=r"^system: got 'two', which has no focal length up to 1e\+09 mm; allowed"):
            call(plate)
    with pytest.raises(InputError, match=r"^f_stop: got 8; allowed is at least the lens's own"):
        stopped_down(plate, 8.0)
    ThickLens(radius, -radius, 2.0, 10.0, Glass("plain", 1.5)).system()


def test_the_longest_focal_lengths():
    """Newton's equation is exact for the distances that it allows, to 1e-16 of the focal length."""
    long = two(9e8, -9e8)
    assert sensor_for(long, math.inf) == pytest.approx(9e8, rel=1e-8)
    with pytest.raises(InputError, match=r"^focus_distance: got 1e\+06 mm; allowed is more than 9e\+08 mm"):
        sensor_for(long, 1e6)
    with pytest.raises(InputError, match=r"^system: got 'two', whose image lies inside"):
        sensor_for(two(-9e8, 9e8), 1e6)


def test_tiny_radii():
    """A lens made smaller by a power of two has all numbers smaller by it, to the last digit."""
    large, small = two(1.0, -1.0, 2.0, 1.0), two(2.0**-600, -(2.0**-600), 2.0**-599, 2.0**-600)
    assert focal_length(small) == math.ldexp(focal_length(large), -600)
    assert f_number(small) == f_number(large)
    assert entrance_pupil(small).radius == math.ldexp(entrance_pupil(large).radius, -600)
    assert exit_pupil(small).z == math.ldexp(exit_pupil(large).z, -600)
    assert sensor_for(small, math.inf) == math.ldexp(sensor_for(large, math.inf), -600)
    assert sensor_for(small, math.ldexp(9.0, -600)) == math.ldexp(sensor_for(large, 9.0), -600)
    assert sensor_for(small, 1e300) == sensor_for(small, math.inf)
    assert image_scale(small, math.ldexp(9.0, -600)) == math.ldexp(image_scale(large, 9.0), -600)
    assert f_number(stopped_down(small, 8.0)) == pytest.approx(8.0, rel=1e-13)
    ThickLens(1e-200, -1e-200, 2e-200, 2e-200, Glass("plain", 1.5)).system()


def test_tiny_radii_far_apart_leave_the_range_of_numbers():
    apart = two(1e-160, -1e-160, 2.0, 1e-160)
    for call in (focal_length, cardinal_points, exit_pupil, f_number, lambda s: sensor_for(s, 900.0),
                 lambda s: image_scale(s, 900.0), lambda s: stopped_down(s, 8.0)):  # fmt: skip
        with pytest.raises(InputError, match=r"^system: got 'two', whose rays leave the range of numbers; allowed"):
            call(apart)
    assert entrance_pupil(apart) == Pupil(0.0, 1e-160)


def test_a_stop_in_the_focus_of_the_front_cannot_be_closed_to_an_f_number():
    """Its entrance pupil is at infinity: the front lens's back focal distance is R / (n - 1), powers of two."""
    flat, n = math.inf, 1.5
    front = (Surface(flat, 2.0, Glass("plain", n), 5.0), Surface(-64.0, 128.0, AIR, 5.0))
    lens = LensSystem("telecentric", (*front, Surface(flat, 3.0, AIR, 2.0, True)))
    assert entrance_pupil(lens) == Pupil(math.inf, math.inf)
    for call in (lambda s: stopped_down(s, 8.0), lambda s: sensor_for(s, 900.0), lambda s: image_scale(s, 900.0)):
        with pytest.raises(InputError, match=r"^system: got 'telecentric', whose entrance pupil is at infinity"):
            call(lens)


def test_transmission_is_fresnels_at_normal_incidence():
    """Closed form: 1 - ((n - n') / (n + n'))^2 = 4 n n' / (n + n')^2 at each surface."""
    n = 1.5168  # of N-BK7 at the d line
    assert transmission(singlet()) == pytest.approx((4.0 * n / (1.0 + n) ** 2) ** 2, rel=1e-5)
    assert transmission(singlet()) == pytest.approx(0.9174, abs=1e-4)  # 4.2 % are lost at each face
    flint = 1.67271  # N-SF5
    cemented = 4.0 * n / (1.0 + n) ** 2 * (4.0 * n * flint / (n + flint) ** 2) * (4.0 * flint / (1.0 + flint) ** 2)
    assert transmission(doublet()) == pytest.approx(cemented, rel=1e-5)  # and the stop in air loses nothing
    assert transmission(doublet().reversed()) == pytest.approx(cemented, rel=1e-5)

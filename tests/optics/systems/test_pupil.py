"""Bounds of the exit pupil: a real lens's measured vignetting, nothing lost, little wasted.

Millions of rays: not among the fast tests, which are interpreted.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from refdof._check import InputError
from refdof.optics.systems.glass import LINE_D
from refdof.optics.systems.paraxial import exit_pupil, sensor_for, stopped_down
from refdof.optics.systems.prescription import LENSES, load_lens
from refdof.optics.systems.pupil import bounds_at, pupil_bounds
from refdof.optics.systems.trace import trace
from tests.optics.systems.lenses import double_gauss, singlet

SENSOR = sensor_for(double_gauss(), math.inf)
HEIGHTS = (0.0, 10.0, 18.0, 21.6)  # [mm] on the film


def disc(radius, count, start):
    """Points of a disc, even in area: a sunflower's, which leave less noise than random ones."""
    k = np.arange(count) + 0.5
    turn, size = start + np.pi * (3.0 - math.sqrt(5.0)) * k, radius * np.sqrt(k / count)
    return size * np.cos(turn), size * np.sin(turn)


def through(system, height, sensor, x, y):
    """Which rays pass from the sensor point (height, 0) by points of the last vertex's plane, and their cos^4."""
    origins = np.tile([height, 0.0, sensor], (len(x), 1))
    directions = np.stack([x, y, np.full(len(x), system.vertices[-1])], axis=1) - origins
    cosine = directions[:, 2] / np.linalg.norm(directions, axis=1)
    return trace(system, origins, directions, LINE_D, reverse=True).passed, cosine**4


# Width over height of the pupil, illumination over that of the centre, and the share of rays through the rear surface's
# disc that pass: measured in another program with 400 000 rays, printed with two digits. None: not printed.
MEASURED = {
    2.0: ((1.00, 0.75, 0.52, 0.40), (1.0, 0.65, 0.29, 0.15), (0.85, 0.58, 0.29, 0.16)),
    2.8: ((1.00, 1.00, 0.63, 0.41), None, None),
    5.6: ((1.00, 1.00, 1.01, 0.84), None, (0.10, 0.10, 0.10, 0.09)),
}


@pytest.mark.parametrize("f_stop", MEASURED)
def test_vignetting_of_the_double_gauss(f_stop):
    system = stopped_down(double_gauss(), f_stop)
    shapes, lights, shares = MEASURED[f_stop]
    x, y = disc(10.0, 30_000, 3)
    light = []
    for k, height in enumerate(HEIGHTS):
        passed, weight = through(system, height, SENSOR, x, y)
        light.append(weight[passed].sum())
        assert np.ptp(x[passed]) / np.ptp(y[passed]) == pytest.approx(shapes[k], abs=0.02)
        assert light[-1] / light[0] == pytest.approx(lights[k], abs=0.02) if lights else True
        assert passed.mean() == pytest.approx(shares[k], abs=0.01) if shares else True


@pytest.mark.parametrize("f_stop", [2.0, 5.6, 16.0])
def test_no_ray_is_lost(f_stop):
    """Whatever passes lies in the box, also between the distances of the table."""
    system = stopped_down(double_gauss(), f_stop)
    bounds = pupil_bounds(system, 22.0, sensor=SENSOR, intervals=128)
    for k, height in enumerate(np.linspace(0.0, 22.0, 35) * 0.9999):
        x0, x1, y1 = bounds_at(bounds, height)
        centre, half = (x0 + x1) / 2.0, (x1 - x0) / 2.0  # a disc around a box twice as wide
        x, y = disc(2.5 * max(half, y1), 4_000, k)
        passed, _ = through(system, height, SENSOR, x + centre, y)
        assert passed.sum() > 100
        outside = (x + centre < x0) | (x + centre > x1) | (np.abs(y) > y1)
        assert not (passed & outside).any()


@pytest.mark.parametrize("f_stop", [2.0, 2.8, 5.6])
def test_few_rays_are_wasted(f_stop):
    """A disc fills pi / 4 of its box, so 1.27 rays pay for one; lens shapes cost up to 1.44 without any margin."""
    system = stopped_down(double_gauss(), f_stop)
    bounds = pupil_bounds(system, 22.0, sensor=SENSOR)
    u, v = np.random.default_rng(4).uniform(0.0, 1.0, (2, 20_000))
    for height in HEIGHTS:
        x0, x1, y1 = bounds_at(bounds, height)
        passed, _ = through(system, height, SENSOR, x0 + (x1 - x0) * u, y1 * (2.0 * v - 1.0))
        assert 1.2 < 1.0 / passed.mean() < 1.44 * 1.03  # the margin is 1 / 256 on every side, and 1 % of noise


def test_a_singlet_on_the_axis_has_its_rim_as_box():
    """The stop is the first surface: the paraxial exit pupil, seen from far, bounds the rays but for aberration."""
    system = stopped_down(singlet(), 40.0)
    sensor = sensor_for(system, math.inf)
    pupil = exit_pupil(system)
    x0, x1, y1 = bounds_at(pupil_bounds(system, 1.0, sensor=sensor, intervals=1), 0.0)
    half = pupil.radius * (sensor - 6.0) / (sensor - pupil.z)
    assert (x1, -x0, y1) == pytest.approx((half, half, half), rel=2.5 / 256)  # the margin is 1 to 2 cells


def test_a_pinhole_is_found():
    """At f/500 the pupil is smaller than a cell of the first grid."""
    system = stopped_down(double_gauss(), 500.0)
    bounds = pupil_bounds(system, 10.0, sensor=SENSOR, intervals=4)
    assert (bounds.boxes[:, 1] > bounds.boxes[:, 0]).all()
    assert bounds.boxes[0, 1] < 0.05


@pytest.mark.parametrize("name", LENSES)
def test_tiny_stops_are_found_all_over_the_film(name):
    """Smaller than a cell of any grid over the last surface, and off the axis far from their paraxial image."""
    system = load_lens(name)
    sensor = sensor_for(system, math.inf)
    wide = pupil_bounds(stopped_down(system, 100.0), 21.6, sensor=sensor).boxes
    for f_stop in (1e3, 1e4):
        small = pupil_bounds(stopped_down(system, f_stop), 21.6, sensor=sensor).boxes
        # The pupil is as large as the stop: 10 and 100 times smaller, but for a cell of its grid and its aberrations.
        np.testing.assert_allclose(np.diff(small[:, :2]) * f_stop, 100.0 * np.diff(wide[:, :2]), rtol=0.05)
        np.testing.assert_allclose(small[:, 2] * f_stop, 100.0 * wide[:, 2], rtol=0.05)


def test_where_no_light_comes_the_box_is_empty():
    """A point 80 mm off the axis sees the double Gauss's barrel only: its circle of light has a radius of about 30."""
    bounds = pupil_bounds(double_gauss(), 80.0, sensor=SENSOR, intervals=8)
    assert (bounds.boxes[-1] == 0.0).all()
    assert bounds_at(bounds, 80.0) == (0.0, 0.0, 0.0)
    assert bounds_at(bounds, 81.0) == (0.0, 0.0, 0.0)
    assert bounds_at(bounds, -1.0) == (0.0, 0.0, 0.0)


def test_without_rims_the_stop_alone_bounds_the_light():
    """At f/5.6 rims cut the corner's pupil by a sixth; without them it is as wide as the axis's, up to distortion."""
    system = stopped_down(double_gauss(), 5.6)
    kept, free = (pupil_bounds(system, 22.0, sensor=SENSOR, rims=rims, intervals=8) for rims in (True, False))
    wide = [box[1] - box[0] for box in (bounds_at(kept, 21.6), bounds_at(free, 21.6), bounds_at(free, 0.0))]
    assert wide[0] < 0.9 * wide[1]
    assert wide[1] == pytest.approx(wide[2], rel=0.05)


@pytest.mark.parametrize(
    ("words", "start"),
    [
        ({"reach": 0.0}, "reach: got 0"),
        ({"sensor": 32.0}, "sensor: got 32; allowed is a finite number > 32.04"),
        ({"intervals": 0}, "intervals: got 0"),
        ({"rims": 1}, "rims: got 1"),
        ({"wavelength_um": 550.0}, "wavelength_um: got 550"),
        ({"system": replace(double_gauss().surfaces[0])}, "system: got Surface"),
    ],
)
def test_bad_calls(words, start):
    with pytest.raises(InputError, match=f"^{start}"):
        pupil_bounds(**{"system": double_gauss(), "reach": 20.0, **words})

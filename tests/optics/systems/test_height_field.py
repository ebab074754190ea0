"""Splines through samples, their bounds, and the first hit, beside SciPy and by hand."""

import numpy as np
import pytest
from scipy.interpolate import RectBivariateSpline

from refdof.optics.systems.height_field import FieldSurface, first_hit, limits_of, sag_and_slope, spline_of

pytestmark = pytest.mark.fast

HALF = 3.0


def random_map(count, seed=0):
    return np.random.default_rng(seed).normal(size=(count, count))


@pytest.mark.parametrize("count", [8, 9, 21])
def test_the_spline_is_scipys(count):
    sag, at = random_map(count), np.linspace(-HALF, HALF, count)
    spline, other = spline_of(sag), RectBivariateSpline(at, at, sag, kx=3, ky=3, s=0)
    for x, y in np.random.default_rng(1).uniform(-HALF, HALF, (100, 2)):
        wanted = (other(y, x)[0, 0], other(y, x, dy=1)[0, 0], other(y, x, dx=1)[0, 0])
        # Roundings of numbers of order 10 in systems whose condition is below 10.
        assert sag_and_slope(spline, HALF, x, y) == pytest.approx(wanted, abs=1e-12)


def test_cubic_polynomials_are_kept():
    """A spline whose first two pieces are one polynomial, on each side, is exact for cubics, edges included."""
    at = np.linspace(-HALF, HALF, 9)
    x, y = np.meshgrid(at, at)
    spline = spline_of(x**3 - 2.0 * x * y**2 + 0.5 * y**3 + x)
    for a, b in [(-HALF, HALF), (0.1, -0.7), (HALF, HALF), (2.9, -2.9)]:
        wanted = (a**3 - 2 * a * b**2 + 0.5 * b**3 + a, 3 * a**2 - 2 * b**2 + 1.0, -4 * a * b + 1.5 * b**2)
        assert sag_and_slope(spline, HALF, a, b) == pytest.approx(wanted, abs=1e-12)


def test_limits_hold_over_the_disc():
    """Second derivatives by differences of slopes; a bound may be wide, but not by more than 20 for noise."""
    spline = spline_of(random_map(12))
    low, high, steepest, bend, half = limits_of(spline, HALF)
    assert half == HALF
    random, step = np.random.default_rng(2), 1e-5
    radius, angle = HALF * np.sqrt(random.uniform(0.0, 1.0, 500)), random.uniform(0.0, 2.0 * np.pi, 500)
    sags, slopes, bends = [], [], []
    for x, y in zip(radius * np.cos(angle), radius * np.sin(angle), strict=True):
        sag, sx, sy = sag_and_slope(spline, HALF, x, y)
        (_, ax, ay), (_, bx, by) = sag_and_slope(spline, HALF, x + step, y), sag_and_slope(spline, HALF, x, y + step)
        sags.append(sag)
        slopes.append(np.hypot(sx, sy))
        bends.append(np.linalg.norm(np.array([[ax - sx, bx - sx], [ay - sy, by - sy]]) / step, 2))
    assert low < min(sags)
    assert max(sags) < high
    assert max(slopes) < steepest < 20.0 * max(slopes)
    assert max(bends) < bend * (1.0 + 1e-4) < 20.0 * max(bends)


def test_limits_of_a_paraboloid_by_hand():
    """Sag r^2 / 20 to radius 3, and three cells of 0.06 beyond, with room of 0.003: slope r / 10, and 1 / 10."""
    at = np.linspace(-HALF, HALF, 101)
    limits = limits_of(spline_of((at**2 + at[:, None] ** 2) / 20.0), HALF)
    # A coefficient lies below a curve by a sixth of its second derivative times the square of the cell, in x and in y.
    assert limits[0] == pytest.approx(-0.003 - 2.0 * 0.1 * 0.06**2 / 6.0, rel=1e-9)
    assert 0.45 < limits[1] < (3.0 + 0.18 + 0.06) ** 2 / 20.0 + 0.003
    assert 0.3 < limits[2] < 2.0**0.5 * 0.324
    assert limits[3] == pytest.approx(0.1, rel=1e-6)


def wave(steep):
    """A wave along x and nothing along y: sag 0.3 sin(steep x)."""
    at = np.linspace(-HALF, HALF, 241)
    spline = spline_of(np.tile(0.3 * np.sin(steep * at), (241, 1)))
    return spline, limits_of(spline, HALF)


def face(spline, limits, forward=1.0):
    return FieldSurface(spline, limits, 0.0, HALF**2, 1.0, forward)


@pytest.mark.parametrize("forward", [1.0, -1.0])
@pytest.mark.parametrize("slope", [4.0, 7.0, 11.0])
def test_the_first_of_many_hits(slope, forward):
    """Rays nearly along the waves meet several crests; the scan of 20 000 points is the truth."""
    spline, limits = wave(5.0)
    random, several = np.random.default_rng(3), 0
    for x, y in zip(random.uniform(-3.0, -1.0, 40), random.uniform(-1.0, 1.0, 40), strict=True):
        way = np.array([slope, 0.3, forward]) / np.hypot(np.hypot(slope, 0.3), 1.0)
        start = np.array([x, y, -forward * 0.303]) - 0.1 * way
        t = np.linspace(0.1, 8.0, 20001)
        px, py, pz = start[:, None] + way[:, None] * t
        inside = np.hypot(px, py) <= HALF
        gaps = forward * (pz - 0.3 * np.sin(5.0 * px))
        hits = np.flatnonzero((gaps[:-1] < 0) & (gaps[1:] >= 0) & inside[1:])
        entered = np.flatnonzero(inside)
        hidden = not len(hits) or (len(entered) and gaps[entered[0]] >= 0)
        found, slope_x, slope_y, met = first_hit(face(spline, limits, forward), -np.inf, *start, *way)
        assert met == (not hidden)
        if met:
            several += len(hits) > 1
            assert t[hits[0]] - 2e-4 < found < t[hits[0] + 1] + 2e-4  # the spline is off by 1e-5, at a slant
            place = start + found * way
            assert place[2] == pytest.approx(0.3 * np.sin(5.0 * place[0]), abs=1e-5)
            assert (slope_x, slope_y) == pytest.approx((1.5 * np.cos(5.0 * place[0]), 0.0), abs=1e-3)
    assert several > 5


def test_a_hit_is_exact():
    """The gap at the hit is a rounding."""
    spline, limits = spline_of(random_map(12)), limits_of(spline_of(random_map(12)), HALF)
    random, count = np.random.default_rng(4), 0
    for _ in range(100):
        aim = np.append(random.uniform(-1.5, 1.5, 2), 0.0)
        way = np.append(random.uniform(-0.3, 0.3, 2), 1.0)
        way /= np.linalg.norm(way)
        start = aim - 200.0 * way
        found, *slopes, met = first_hit(face(spline, limits), -np.inf, *start, *way)
        if met:
            count += 1
            place = start + found * way
            sag, *wanted = sag_and_slope(spline, HALF, *place[:2])
            assert place[2] == pytest.approx(sag, abs=1e-12)  # z of 200 has roundings of 3e-14, slopes are up to 10
            assert slopes == pytest.approx(wanted, abs=1e-10)
    assert count > 50


def test_what_meets_nothing():
    flat = spline_of(np.zeros((8, 8)))
    surface = face(flat, limits_of(flat, HALF))
    down = (0.0, 0.0, 1.0)
    assert first_hit(surface, -np.inf, 1.0, 0.0, -5.0, *down) == (5.0, 0.0, 0.0, True)
    assert first_hit(surface, -np.inf, 1.0, 0.0, 5.0, *down)[::3] == (-5.0, True)  # rays are lines
    assert not first_hit(surface, 0.0, 1.0, 0.0, 5.0, *down)[3]  # unless they begin here
    assert not first_hit(surface, -np.inf, 3.1, 0.0, -5.0, *down)[3]
    assert not first_hit(surface, -np.inf, 1.0, 0.0, -5.0, 0.0, 0.0, -1.0)[3]
    assert not first_hit(surface, -np.inf, 0.0, 0.0, -5.0, 1.0, 0.0, 0.0)[3]
    assert not first_hit(surface, -np.inf, 5.0, 5.0, -5.0, 0.6, 0.0, 0.8)[3]
    # From 0.003 before the surface a flat ray comes to it 0.02 farther out: inside the disc, and beyond its rim.
    slant = (0.99, 0.0, np.sqrt(1.0 - 0.99**2))
    assert first_hit(surface, -np.inf, 2.9, 0.0, -0.003, *slant)[3]
    assert not first_hit(surface, -np.inf, 2.99, 0.0, -0.003, *slant)[3]

"""Rays against a naive twin in 50 digits, closed forms, and rays run back."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from refdof._check import InputError
from refdof._jit import JIT_DISABLED, use_threads
from refdof.optics.systems.glass import AIR, Glass
from refdof.optics.systems.system import LensSystem, Surface, ThickLens
from refdof.optics.systems.trace import table_of, trace, trace_path, trace_ray
from tests.optics.systems import naive
from tests.optics.systems.lenses import double_gauss, doublet, singlet

pytestmark = pytest.mark.fast

LENSES = {"double gauss": double_gauss(), "singlet": singlet(), "doublet": doublet()}
WAVELENGTH = 0.51


def skew_rays(system, count, seed, *, reverse=False, spread=0.35):
    """Origins and directions through points of a disc at the first surface that a ray meets."""
    random = np.random.default_rng(seed)
    end, sign = (-1, -1.0) if reverse else (0, 1.0)
    radius, z = 1.05 * system.surfaces[end].semi_diameter, system.vertices[end]
    turn, size = random.uniform(0.0, 2.0 * np.pi, count), radius * np.sqrt(random.uniform(0.0, 1.0, count))
    aim = np.stack([size * np.cos(turn), size * np.sin(turn), np.full(count, z)], axis=1)
    direction = np.stack([*random.uniform(-spread, spread, (2, count)), np.full(count, sign)], axis=1)
    return aim - 40.0 * direction, direction


@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize("name", LENSES)
def test_skew_rays_match_the_naive_twin(name, reverse):
    system = LENSES[name]
    origins, directions = skew_rays(system, 150, 5, reverse=reverse)
    found = trace(system, origins, directions, WAVELENGTH, reverse=reverse)
    expected = [
        naive.trace_one(system, o, d, WAVELENGTH, reverse=reverse) for o, d in zip(origins, directions, strict=True)
    ]
    passed = np.array([e[2] for e in expected])
    assert 20 < passed.sum() < 150
    assert (found.passed == passed).all()
    points, ways = (np.array([e[k] for e in expected]) for k in (0, 1))
    # A dozen surfaces, some ten roundings each, of numbers up to 100.
    assert np.abs(found.origins - points)[passed].max() < 1e-11
    assert np.abs(found.directions - ways)[passed].max() < 1e-13
    assert np.abs(np.linalg.norm(found.directions[passed], axis=1) - 1.0).max() < 1e-14


def test_a_ray_alone_goes_through_all_surfaces():
    system = LENSES["double gauss"]
    table, passed = table_of(system, WAVELENGTH), 0
    for origin, direction in zip(*skew_rays(system, 30, 8, reverse=True), strict=True):
        unit = direction / np.linalg.norm(direction)
        found = trace_ray(table, True, *origin, *unit)
        point, way, through = naive.trace_one(system, origin, direction, WAVELENGTH, reverse=True)
        assert found[6] == through
        if through:  # as above
            passed += 1
            assert np.abs(np.array(found[:3]) - point).max() < 1e-11
            assert np.abs(np.array(found[3:6]) - way).max() < 1e-13
    assert passed > 3


@pytest.mark.parametrize("name", LENSES)
def test_a_ray_sent_back_comes_back(name):
    system = LENSES[name]
    origins, directions = skew_rays(system, 200, 6)
    there = trace(system, origins, directions, WAVELENGTH)
    back = trace(system, there.origins + 30.0 * there.directions, -there.directions, WAVELENGTH, reverse=True)
    assert (back.passed[there.passed]).all()
    unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    assert np.abs(back.directions + unit)[there.passed].max() < 1e-12
    offset = np.cross(back.origins - origins, unit)  # distance of the two lines
    assert np.abs(offset)[there.passed].max() < 1e-11


@pytest.mark.parametrize("name", LENSES)
def test_a_reversed_lens_is_the_lens_seen_from_behind(name):
    system = LENSES[name]
    origins, directions = skew_rays(system, 100, 7, reverse=True)
    mirror, shift = np.array([1.0, 1.0, -1.0]), np.array([0.0, 0.0, system.vertices[-1]])
    one = trace(system, origins, directions, WAVELENGTH, reverse=True)
    two = trace(system.reversed(), origins * mirror + shift, directions * mirror, WAVELENGTH)
    assert (one.passed == two.passed).all()
    assert np.abs((one.origins * mirror + shift) - two.origins)[one.passed].max() < 1e-11
    assert np.abs(one.directions * mirror - two.directions)[one.passed].max() < 1e-13


def test_flat_plate_shifts_a_ray():
    """A plate of thickness t moves a ray at angle i by t sin(i - i') / cos i', whatever its direction afterwards."""
    plate = LensSystem(
        "plate", (Surface(math.inf, 10.0, Glass("plate", 1.5), 50.0, is_stop=True), Surface(math.inf, 1.0, AIR, 50.0))
    )
    angle = math.radians(40.0)
    inside = math.asin(math.sin(angle) / 1.5)
    direction = np.array([[math.sin(angle), 0.0, math.cos(angle)]])
    found = trace(plate, [[-5.0, 0.0, -5.0]], direction, WAVELENGTH)
    assert found.directions == pytest.approx(direction, abs=1e-15)
    shift = np.linalg.norm(np.cross(found.origins[0] - [-5.0, 0.0, -5.0], direction[0]))
    assert shift == pytest.approx(10.0 * math.sin(angle - inside) / math.cos(inside), rel=1e-14)


def test_aplanatic_points_of_a_sphere():
    """From R / n inside the centre, all rays seem to come from n R: Young's aplanatic points, exact at any angle."""
    index, radius = 1.5, 10.0
    ball = LensSystem(
        "half ball",
        (
            Surface(math.inf, radius + radius / index, Glass("ball", index), 9.0, is_stop=True),
            Surface(-radius, 1.0, AIR, 10.0),
        ),
    )
    # The object point lies in the flat face, which rays leave in the glass: aim them so that they enter there.
    angle = np.linspace(0.05, 0.6, 9)
    outside = np.arcsin(index * np.sin(angle))
    directions = np.stack([np.sin(outside), 0 * angle, np.cos(outside)], axis=1)
    found = trace(ball, np.zeros((9, 3)), directions, WAVELENGTH)
    assert found.passed.all()
    # The centre is at radius / index; the image at n R in front of it.
    crossing = found.origins[:, 2] - found.origins[:, 0] * found.directions[:, 2] / found.directions[:, 0]
    assert crossing == pytest.approx(np.full(9, radius / index - index * radius), rel=1e-13)


def test_total_reflection_begins_at_the_critical_angle():
    """Glass to air at a flat face: sin i = 1 / n. Rays enter through a sphere around the place where they leave."""
    index = 1.5
    dome = LensSystem(
        "dome",
        (Surface(10.0, 10.0, Glass("dome", index), 10.0, is_stop=True), Surface(math.inf, 1.0, AIR, 20.0)),
    )
    critical = math.asin(1.0 / index)
    angle = critical + np.array([-1e-6, 1e-6])
    directions = np.stack([np.sin(angle), 0 * angle, np.cos(angle)], axis=1)  # through the centre: not bent
    found = trace(dome, np.array([0.0, 0.0, 10.0]) - 30.0 * directions, directions, WAVELENGTH)
    assert found.passed.tolist() == [True, False]
    assert found.directions[0, 0] == pytest.approx(index * math.sin(angle[0]), rel=1e-12)


def test_nearly_flat_surfaces_tend_to_flat_ones():
    """The sag at height h is h^2 / (2 R): what a radius of 1e7 or 1e15 mm changes is about that."""
    origins, directions = skew_rays(singlet(), 50, 8)

    def end(radius):
        front, back = singlet().surfaces
        return trace(LensSystem("bent", (front, replace(back, radius=radius))), origins, directions, WAVELENGTH)

    flat = end(math.inf)
    for radius in (1e7, -1e7, 1e15, -1e300):
        bent = end(radius)
        assert (bent.passed == flat.passed).all()
        error = np.abs(bent.directions - flat.directions)[flat.passed].max()
        assert error < 0.6 * 12.5 / abs(radius) * 1.5 + 1e-15  # a normal turned by h / R turns rays by (n - 1) of it


def test_rims_missed_spheres_and_wrong_ways_block():
    system = singlet()
    edge = np.array([[12.4999, 0.0, -9.0], [12.5001, 0.0, -9.0], [500.0, 0.0, -9.0], [0.0, 0.0, -9.0]])
    ahead = np.tile([0.0, 0.0, 1.0], (4, 1))
    ahead[3, 2] = -1.0
    assert trace(system, edge, ahead, WAVELENGTH).passed.tolist() == [True, False, False, False]
    assert trace(system, edge, -ahead, WAVELENGTH).passed.tolist() == [False, False, False, True]
    sideways = np.array([[1.0, 0.0, 0.0]])
    assert not trace(system, [[0.0, 0.0, 0.0]], sideways, WAVELENGTH).passed[0]


def test_the_far_half_of_a_sphere_is_no_surface():
    """A flat ray enters the whole sphere of a half ball's dome behind the rim; its mirror image enters the dome."""
    still = Glass("bends nothing", 1.0)
    dome = LensSystem(
        "dome",
        (Surface(10.0, 60.0, still, 10.0, is_stop=True), Surface(math.inf, 1.0, AIR, 1000.0)),
    )
    direction = np.array([[0.995, 0.0, 0.0998]])
    depth = math.sqrt(100.0 - 9.5**2)
    for z, passes in ((10.0 + depth, False), (10.0 - depth, True)):
        start = np.array([[-9.5, 0.0, z]]) - 3.0 * direction
        assert trace(dome, start, direction, WAVELENGTH).passed[0] == passes


def test_a_stopped_ray_stays_where_it_was_stopped():
    system = double_gauss()
    found = trace(system, [[12.7, 0.0, -5.0], [12.5, 0.0, -5.0]], [[0.0, 0.0, 1.0]] * 2, WAVELENGTH)
    assert not found.passed.any()
    # The first meets surface 1 outside its rim of 12.6 mm: its sag there is R - sqrt(R^2 - h^2).
    assert found.origins[0] == pytest.approx([12.7, 0.0, 29.475 - math.sqrt(29.475**2 - 12.7**2)], rel=1e-14)
    assert found.directions[0].tolist() == [0.0, 0.0, 1.0]
    assert found.origins[1, 2] > 3.0  # the second is stopped farther in


def test_without_rims_only_the_stop_blocks():
    table = table_of(double_gauss(), WAVELENGTH, rims=False)
    assert np.isinf(table.rim).tolist() == [k != 5 for k in range(11)]
    assert table.rim[5] == 8.55**2


def test_path_ends_where_the_ray_does():
    system = double_gauss()
    origins, directions = skew_rays(system, 40, 9)
    for reverse in (False, True):
        if reverse:
            origins, directions = skew_rays(system, 40, 9, reverse=True)
        found = trace(system, origins, directions, WAVELENGTH, reverse=reverse)
        path = trace_path(system, origins, directions, WAVELENGTH, reverse=reverse)
        assert path.shape == (40, 12, 3)
        assert (path[:, 0] == origins).all()
        assert (np.isfinite(path[:, -1, 0]) == found.passed).all()
        assert (path[found.passed, -1] == found.origins[found.passed]).all()
        # Every point lies on its surface: by the sphere's equation from its vertex.
        order = range(10, -1, -1) if reverse else range(11)
        for place, k in enumerate(order):
            x, y, z = path[found.passed, place + 1].T
            z = z - system.vertices[k]
            curvature = system.surfaces[k].curvature
            assert np.abs(curvature * (x * x + y * y + z * z) - 2.0 * z).max() < 1e-13


def test_float32_beside_float64():
    """Measured over 20 000 rays: 9.4e-6 mm and 1.3e-6; the bounds are three times as wide. float32 rounds by 6e-8."""
    system = double_gauss()
    origins, directions = skew_rays(system, 500, 10)
    single = trace(system, origins.astype(np.float32), directions.astype(np.float32), WAVELENGTH)
    double = trace(system, origins.astype(np.float32).astype(float), directions.astype(np.float32), WAVELENGTH)
    assert single.origins.dtype == single.directions.dtype == np.float32
    assert (single.passed != double.passed).mean() < 0.01  # at rims
    both = single.passed & double.passed
    assert np.abs(single.origins - double.origins)[both].max() < 3e-5
    assert np.abs(single.directions - double.directions)[both].max() < 4e-6


@pytest.mark.skipif(JIT_DISABLED, reason="interpreted kernels have one thread")
def test_threads_change_no_bit():
    origins, directions = skew_rays(double_gauss(), 1001, 11)
    results = []
    for threads in (1, 2):
        use_threads(threads)
        results.append(trace(double_gauss(), origins, directions, WAVELENGTH))
    for one, two in zip(*results, strict=True):
        assert one.tobytes() == two.tobytes()


def test_bad_rays():
    lens = ThickLens(60.0, -80.0, 6.0, 25.0, Glass("plain", 1.5)).system()
    ray = ([[0.0, 0.0, -9.0]], [[0.0, 0.0, 1.0]])
    assert trace(lens, np.zeros((0, 3)), np.zeros((0, 3)), WAVELENGTH).passed.shape == (0,)
    with pytest.raises(InputError, match=r"^directions: got 1 of length 0"):
        trace(lens, ray[0], [[0.0, 0.0, 0.0]], WAVELENGTH)
    with pytest.raises(InputError, match=r"^directions: got shape"):
        trace(lens, ray[0], np.ones((2, 3)), WAVELENGTH)
    with pytest.raises(InputError, match=r"^origins: has 1 NaN"):
        trace(lens, [[0.0, math.nan, 0.0]], ray[1], WAVELENGTH)
    with pytest.raises(InputError, match=r"^system: got ThickLens"):
        trace(ThickLens(60.0, -80.0, 6.0, 25.0, Glass("plain", 1.5)), *ray, WAVELENGTH)
    with pytest.raises(InputError, match=r"^wavelength_um: got 510"):
        trace(lens, *ray, 510.0)


@pytest.mark.parametrize("name", LENSES)
def test_optiland_traces_the_same_rays(name):
    """1000 skew rays per lens; `make_optiland_rays.py` made them. Glass is optiland's own, from its catalogue."""
    rays = np.load(Path(__file__).with_name("optiland_rays.npz"))[f"{name.replace(' ', '_')}_rays"]
    origins, directions, points, ways = rays
    assert len(origins) == 1000
    found = trace(LENSES[name], origins, directions, WAVELENGTH)
    assert found.passed.all()
    # Measured: 3e-14 mm and 4e-15; a hundred times that is still far below any error of a formula.
    assert np.abs(found.origins - points).max() < 3e-12
    assert np.abs(found.directions - ways).max() < 4e-13

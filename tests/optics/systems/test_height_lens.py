"""Rays through height lenses, beside spheres, closed forms and a naive twin; and its paraxial system."""

import math
from dataclasses import replace

import numpy as np
import pytest

from refdof import InputError
from refdof._jit import thread_count, use_threads
from refdof.optics.systems.glass import LINE_D, Glass, glass_of
from refdof.optics.systems.height_lens import HeightLens
from refdof.optics.systems.paraxial import cardinal_points, focal_length
from refdof.optics.systems.system import ThickLens
from refdof.optics.systems.trace import trace, trace_path
from tests.optics.systems import naive_height

pytestmark = pytest.mark.fast

PLAIN = Glass("plain", 1.5)
SPHERICAL = ThickLens(60.0, -80.0, 6.0, 25.0, glass_of("N-BK7"))
DOWN = np.array([0.0, 0.0, 1.0])


def flat(x, y):
    return 0.0 * x


def waves(amplitude=0.15, count=65):
    """A biconvex lens with waves on both faces: nothing about it is symmetric."""

    def front(x, y):
        return (x * x + y * y) / 120.0 + amplitude * np.sin(1.1 * x + 0.4 * y) * np.cos(0.5 * y)

    def back(x, y):
        return -(x * x + 2.0 * y * y) / 200.0 + amplitude * np.sin(0.3 * x - 0.8 * y + 1.0)

    return HeightLens.from_functions(front, back, 6.0, 25.0, PLAIN, count)


def skew(count, reach=8.0, slope=0.2, seed=1):
    """Rays from 40 mm before the lens."""
    random = np.random.default_rng(seed)
    directions = np.column_stack([random.uniform(-slope, slope, (count, 2)), np.ones(count)])
    return np.column_stack([random.uniform(-reach, reach, (count, 2)), np.zeros(count)]) - 40.0 * directions, directions


@pytest.mark.parametrize("reverse", [False, True])
def test_a_sampled_sphere_converges_to_the_sphere(reverse):
    """Slopes of splines are of the third order: twice the samples, an eighth of the error."""
    origins, directions = skew(300)
    if reverse:
        origins, directions = [0.0, 0.0, 6.0] - origins * [-1, -1, 1], directions * [1, 1, -1]
    wanted, errors = trace(SPHERICAL.system(), origins, directions, 0.55, reverse=reverse), []
    for count in (33, 65, 129):
        found = trace(HeightLens.of(SPHERICAL, count), origins, directions, 0.55, reverse=reverse)
        assert found.passed.all()
        assert wanted.passed.all()
        errors.append([np.abs(one - two).max() for one, two in zip(found[:2], wanted[:2], strict=True)])
    errors = np.array(errors)
    assert (errors[0] < [2e-7, 1e-7]).all()  # [mm], and a direction's sine, with samples 0.8 mm apart
    assert errors[:-1] / errors[1:] == pytest.approx(np.full((2, 2), 8.0), rel=0.2)  # of 300 rays the worst


def test_beside_the_naive_twin():
    lens = replace(waves(), stop_diameter=16.0)
    for reverse in (False, True):
        origins, directions = skew(60, 11.0, 0.4, seed=2)
        if reverse:
            origins, directions = [0.0, 0.0, 6.0] - origins * [-1, -1, 1], directions * [1, 1, -1]
        found, passed = trace(lens, origins, directions, LINE_D, reverse=reverse), 0
        for k in range(len(origins)):
            points, way, through, _ = naive_height.trace_one(lens, origins[k], directions[k], LINE_D, reverse=reverse)
            assert found.passed[k] == through
            if through:
                passed += 1
                assert found.origins[k] == pytest.approx(points[-1], abs=1e-11)  # roundings at distances of 40 mm
                assert found.directions[k] == pytest.approx(way, abs=1e-11)
        assert 10 < passed < 50


def test_the_first_hit_counts():
    """Slanted rays meet a front with crests of 0.6 mm up to six times; the twin finds all, and takes the first."""

    def front(x, y):
        return 0.6 * np.sin(3.0 * x)

    lens = HeightLens.from_functions(front, flat, 6.0, 25.0, PLAIN, 129)
    random = np.random.default_rng(5)
    directions = np.column_stack([random.uniform(4.0, 9.0, 40), np.zeros(40), np.ones(40)])
    aim = np.column_stack([random.uniform(-9.0, 2.0, 40), random.uniform(-4.0, 4.0, 40), np.full(40, -0.6)])
    origins = aim - 0.5 * directions
    found, several = trace_path(lens, origins, directions, LINE_D), 0
    for k in range(len(origins)):
        points, _, through, hits = naive_height.trace_one(lens, origins[k], directions[k], LINE_D)
        assert (~np.isnan(found[k, 1:, 0])).tolist() == [len(points) > 0, through]  # into glass all light passes
        assert found[k, 1] == pytest.approx(points[0], abs=1e-10)
        several += hits[0] > 1
    assert several > 35


def test_a_plate_shifts_rays():
    """By t sin(i) (1 - cos(i) / (n cos(i'))), across the ray; the direction stays."""
    plate = HeightLens.from_functions(flat, flat, 6.0, 25.0, PLAIN, 8)
    for angle in (0.0, 0.2, 0.7):
        way = np.array([math.sin(angle), 0.0, math.cos(angle)])
        found = trace(plate, np.array([[-2.0, 1.0, 0.0]]) - 10.0 * way, way[None], LINE_D)
        inside = math.asin(math.sin(angle) / 1.5)
        shift = 6.0 * math.sin(angle) * (1.0 - math.cos(angle) / (1.5 * math.cos(inside)))
        offset = found.origins[0] - [-2.0, 1.0, 0.0]
        assert offset[2] * math.sin(angle) - offset[0] * math.cos(angle) == pytest.approx(shift, abs=1e-13)
        assert found.directions[0] == pytest.approx(way, abs=1e-15)
        assert found.origins[0, 1:] == pytest.approx([1.0, 6.0], abs=1e-14)


@pytest.mark.parametrize("axis", [0, 1])
def test_a_wedge_bends_towards_its_thick_end(axis):
    """Front z = 0.2 x: light along the axis is turned by asin(n sin(a - asin(sin(a) / n))) with tan(a) = 0.2."""
    wedge = HeightLens.from_functions(lambda x, y: 0.2 * (x, y)[axis], flat, 6.0, 25.0, PLAIN, 9)
    slant = math.atan(0.2)
    turned = math.asin(1.5 * math.sin(slant - math.asin(math.sin(slant) / 1.5)))
    found = trace(wedge, np.array([[1.0, 2.0, -20.0]]), DOWN[None], LINE_D)
    wanted = [0.0, 0.0, math.cos(turned)]
    wanted[axis] = -math.sin(turned)  # the front recedes towards +x: glass is thick at -x
    assert found.directions[0] == pytest.approx(wanted, abs=1e-14)


def axial_bundle(count=200, reach=12.0):
    random = np.random.default_rng(6)
    radius, angle = reach * np.sqrt(random.uniform(0.0, 1.0, count)), random.uniform(0.0, 2.0 * np.pi, count)
    origins = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.full(count, -10.0)])
    return origins, np.tile(DOWN, (count, 1))


def crossing(found, z):
    """Where rays meet a plane."""
    return (
        found.origins[:, :2] + ((z - found.origins[:, 2]) / found.directions[:, 2])[:, None] * found.directions[:, :2]
    )


def test_an_ellipsoid_focuses_without_spherical_aberration():
    """Eccentricity 1 / n: a bundle along the axis meets in the far focus, a (1 + e) behind the vertex.

    The back is a sphere around that focus, which bends no ray.
    """
    n, a = 1.5, 40.0
    e, focus, thickness = 1.0 / n, a * (1.0 + 1.0 / n), 8.0

    def front(x, y):
        return a - a * np.sqrt(1.0 - (x * x + y * y) / (a * a * (1.0 - e * e)))

    def back(x, y):
        return focus - thickness - np.sqrt((focus - thickness) ** 2 - x * x - y * y)

    spots = []
    for count in (33, 65):
        lens = HeightLens.from_functions(front, back, thickness, 25.0, PLAIN, count)
        found = trace(lens, *axial_bundle(), LINE_D)
        assert found.passed.all()
        spots.append(np.abs(crossing(found, focus)).max())
    assert spots[1] < 2e-5  # [mm]; with spheres of the same power it is 1.1 mm
    assert spots[0] / spots[1] > 5.0  # the third order; what is left is the sampling's
    assert cardinal_points(lens.paraxial).back_focus == pytest.approx(focus, rel=1e-5)  # the fit leaves r^8


def hyperbolic(count=65):
    """Plano-convex, f = 50 mm at f/2; the back is a hyperboloid of eccentricity n."""
    n, radius = 1.5, 25.0

    def back(x, y):
        square = x * x + y * y
        return -square / radius / (1.0 + np.sqrt(1.0 + (n * n - 1.0) * square / radius**2))

    return HeightLens.from_functions(flat, back, 8.0, 25.0, PLAIN, count)


def test_a_hyperboloid_focuses_without_spherical_aberration():
    """A flat front and a back of conic constant -n^2: the bundle meets at R / (n - 1) behind the back's vertex."""
    found = trace(hyperbolic(), *axial_bundle(), LINE_D)
    assert np.abs(crossing(found, 8.0 + 50.0)).max() < 1e-4
    assert focal_length(hyperbolic().paraxial) == pytest.approx(50.0, rel=2e-5)  # the fit leaves r^8
    sphere = trace(ThickLens(math.inf, -25.0, 8.0, 25.0, PLAIN).system(), *axial_bundle(), LINE_D)
    assert np.abs(crossing(sphere, 8.0 + 50.0)).max() > 1.0


def test_total_reflection_and_rims_block():
    steep = HeightLens.from_functions(lambda x, y: 1.2 * x, flat, 20.0, 20.0, PLAIN, 9)
    # In the glass a ray along the axis is 50.2 - 30.8 degrees off it: out. From the other side it meets 50.2 degrees.
    origins = np.array([[1.0, 0.0, -40.0]])
    assert trace(steep, origins, DOWN[None], LINE_D).passed.all()
    assert not trace(steep, -origins, -DOWN[None], LINE_D, reverse=True).passed.any()
    lens = HeightLens.of(SPHERICAL).with_stop(5.0)
    heights = np.array([4.99, 5.01, 12.49, 12.51])
    origins = np.column_stack([heights * 0.6, heights * 0.8, np.full(4, -9.0)])
    assert trace(lens, origins, np.tile(DOWN, (4, 1)), LINE_D).passed.tolist() == [True, False, False, False]
    back = [[0.0, 12.45, 30.0], [0.0, 12.55, 30.0]]
    whole = lens.with_stop(12.5)
    assert trace(whole, np.array(back), -np.tile(DOWN, (2, 1)), LINE_D, reverse=True).passed.tolist() == [True, False]


def test_a_way_through_and_back():
    """Light is reversible: the ray that left, sent back, is the ray that came."""
    lens = waves()
    origins, directions = skew(100)
    there = trace(lens, origins, directions, LINE_D)
    again = trace(lens, there.origins + 30.0 * there.directions, -there.directions, LINE_D, reverse=True)
    both = there.passed & again.passed  # a wave may hide the way back
    assert both.sum() > 90
    units = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    assert again.directions[both] == pytest.approx(-units[both], abs=1e-12)


def test_rays_are_lines():
    """As for spheres: a ray may begin behind the lens."""
    lens, (origins, directions) = waves(), skew(50)
    one, two = (trace(lens, origins + along * directions, directions, LINE_D) for along in (0.0, 90.0))
    assert two.passed.all()
    assert two.origins == pytest.approx(one.origins, abs=1e-11)
    assert two.directions == pytest.approx(one.directions, abs=1e-11)


def test_a_constant_added_to_a_map_changes_nothing():
    lens = waves()
    moved = replace(lens, front=lens.front + 2.0, back=lens.back - 3.0)
    for one, two in zip(trace(lens, *skew(50), LINE_D), trace(moved, *skew(50), LINE_D), strict=True):
        assert one == pytest.approx(two, abs=1e-12)


def test_float32_is_near_float64():
    """Seen: 7e-6 mm and 2e-6. A float32 at 40 mm has roundings of 2e-6 mm, and a step of the search ends at 1e-5."""
    lens, (origins, directions) = waves(), skew(500)
    double = trace(lens, origins, directions, LINE_D)
    single = trace(lens, origins.astype(np.float32), directions.astype(np.float32), LINE_D)
    assert single.origins.dtype == single.directions.dtype == np.float32
    assert (single.passed == double.passed).all()
    assert np.abs(single.origins - double.origins).max() < 4e-5
    assert np.abs(single.directions - double.directions).max() < 1e-5


def test_the_same_bits_for_any_thread_count():
    count, found = thread_count(), []
    try:
        for threads in (1, 2):
            use_threads(threads)
            found.append(trace(waves(), *skew(1000), LINE_D))
    finally:
        use_threads(count)
    for one, two in zip(*found, strict=True):
        np.testing.assert_array_equal(one, two)


def test_the_paraxial_system_is_the_spheres():
    paraxial, wanted = HeightLens.of(SPHERICAL, 33).paraxial, SPHERICAL.system()
    for one, two in zip(paraxial.surfaces, wanted.surfaces, strict=True):
        assert one.radius == pytest.approx(two.radius, rel=1e-6)
        assert (one.semi_diameter, one.is_stop, one.glass) == (two.semi_diameter, two.is_stop, two.glass)
    assert paraxial.surfaces[0].thickness == 6.0
    assert focal_length(paraxial) == pytest.approx(focal_length(wanted), rel=1e-6)
    # Of x^2 / 200 and y^2 / 100 the mean; tilt and waves of the third order do not count.
    lens = HeightLens.from_functions(lambda x, y: x * x / 200.0 + y * y / 100.0 + 0.1 * x, flat, 6.0, 25.0, PLAIN)
    assert lens.paraxial.surfaces[0].curvature == pytest.approx(0.015, rel=1e-9)


ZEROS = np.zeros((9, 9))
PEAK = np.where(np.arange(81).reshape(9, 9) == 40, 9.0, 0.0)
RAMP = np.tile(np.linspace(-3.0, 3.0, 9), (9, 1))
DEEP = np.linspace(-2.4, 2.4, 9) ** 2 + ZEROS


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"front": np.zeros((7, 7))}, r"front: got shape \(7, 7\); allowed is N x N with N in 8 .. 1025"),
        ({"front": np.zeros((9, 10))}, r"front: got shape \(9, 10\)"),
        ({"back": np.zeros((10, 10))}, r"back: got shape \(10, 10\)"),
        ({"front": np.zeros(9)}, "front: got shape"),
        ({"back": np.full((9, 9), np.nan)}, "back: has 81 NaN"),
        ({"front": np.full((9, 9), np.inf)}, "front: "),
        ({"front": "no"}, "front: "),
        ({"thickness": 0.0}, "thickness: got 0"),
        ({"diameter": -1.0}, "diameter: got -1"),
        ({"glass": "N-BK7"}, "glass: got str"),
        ({"stop_diameter": 11.0}, "stop_diameter: got 11"),
        ({"name": 3}, "name: got int"),
        ({"front": PEAK}, "front: has a slope of .*; allowed is at most 5"),
        ({"front": RAMP}, "thickness: got 2; allowed is at least 3, so that .* at x = 5, y = 0"),
        ({"front": DEEP, "thickness": 9.0}, r"front: has a radius of curvature of 4\.3"),
    ],
)
def test_bad_input(change, words):
    with pytest.raises(InputError, match=f"^{words}"):
        HeightLens(**{"front": ZEROS, "back": ZEROS, "thickness": 2.0, "diameter": 10.0, "glass": PLAIN, **change})


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"front": 3}, "front: got int; allowed is a function"),
        ({"back": lambda x, y: np.zeros((2, 65, 65))}, "back: got shape"),
        ({"front": lambda x, y: x + np.nan}, "front: has "),
        ({"back": len}, "back: gives no array for x and y of 65 x 65 each"),
        ({"samples": 7}, "samples: got 7"),
        ({"diameter": np.nan}, "diameter: "),
    ],
)
def test_bad_functions(change, words):
    with pytest.raises(InputError, match=f"^{words}"):
        HeightLens.from_functions(
            **{"front": flat, "back": flat, "thickness": 2.0, "diameter": 10.0, "glass": PLAIN, **change}
        )


def test_a_sphere_must_reach_the_corners():
    with pytest.raises(InputError, match=r"^lens: has a radius of 13 mm; allowed is at least 17.85"):
        HeightLens.of(ThickLens(13.0, -80.0, 12.0, 25.0, PLAIN))

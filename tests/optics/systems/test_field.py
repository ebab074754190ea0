"""What a lens does off its axis, against closed forms and against a published table of the double Gauss."""

import math
from pathlib import Path

import numpy as np
import pytest

from refdof.optics.systems.data_sheet import data_sheet, focused
from refdof.optics.systems.field import (
    bundle,
    chief_rays,
    distortion,
    focal_surfaces,
    illumination,
    longitudinal_aberration,
    spot,
)
from refdof.optics.systems.glass import AIR, LINE_D, Glass
from refdof.optics.systems.paraxial import image_scale, stopped_down
from refdof.optics.systems.prescription import load_lens
from refdof.optics.systems.system import LensSystem, Surface
from refdof.optics.systems.trace import trace, trace_path

HEIGHTS = np.array([0.0, 10.0, 18.0, 21.6])
INDEX = 1.5
GLASS = Glass("1.5", INDEX)


def stop(thickness, radius):
    return Surface(math.inf, thickness, AIR, radius, is_stop=True)


def ball(radius=40.0):
    """A ball of glass with its stop at the centre, focused at infinity: f = n R / (2 (n - 1))."""
    focal_length = INDEX * radius / (2.0 * (INDEX - 1.0))
    return focal_length, LensSystem(
        "ball",
        (
            Surface(radius, radius, GLASS, 0.9 * radius),
            Surface(math.inf, radius, GLASS, 2.0, is_stop=True),
            Surface(-radius, focal_length - radius, AIR, 0.9 * radius),
        ),
    )


def plano_convex(radius=50.0, thickness=4.0):
    """Flat towards the scene, so that rays of the axis bend at the sphere only."""
    flat = Surface(math.inf, thickness, GLASS, 10.0, is_stop=True)
    return LensSystem("plano-convex", (flat, Surface(-radius, radius / (INDEX - 1.0), AIR, 20.0)))


def crossing(height, radius=50.0, thickness=4.0):
    """Where a ray of the axis crosses it behind `plano_convex`, and its angle: Snell's law at the sphere, by hand."""
    inside = np.arcsin(height / radius)
    turn = np.arcsin(INDEX * np.sin(inside)) - inside
    place = thickness - radius + radius * np.cos(inside)
    return place + height / np.tan(turn), turn


@pytest.mark.fast
@pytest.mark.parametrize("name", ["double_gauss", "petzval", "telephoto", "wide_angle"])
@pytest.mark.parametrize("distance", [math.inf, 5000.0])
def test_chief_rays_pass_the_centre_of_the_stop_and_meet_the_film_at_the_height(name, distance):
    system = focused(load_lens(name), distance)
    chief = chief_rays(system, HEIGHTS)
    at_stop = trace_path(system, *chief, LINE_D)[:, 1 + system.stop]
    assert np.abs(at_stop[:, :2]).max() < 2e-6  # [mm]; the search ends below 1e-6
    behind = trace(system, *chief, LINE_D)
    assert behind.passed.all()
    step = (system.sensor - behind.origins[:, 2:]) / behind.directions[:, 2:]
    at_film = behind.origins + step * behind.directions
    np.testing.assert_allclose(at_film[:, :2], np.column_stack([0.0 * HEIGHTS, HEIGHTS]), atol=1e-9)


@pytest.mark.fast
def test_a_ball_with_its_stop_at_the_centre_is_sharp_on_a_sphere_and_has_no_distortion():
    focal_length, system = ball()
    heights = np.array([0.0, 5.0, 12.0, 21.6])
    cosine = focal_length / np.hypot(focal_length, heights)
    assert np.abs(distortion(system, heights, math.inf)).max() < 1e-9
    sagittal, tangential = focal_surfaces(system, heights, math.inf)
    # A bundle of the width of a thousandth of the stop has aberrations of some 1e-6 of its depth of focus.
    np.testing.assert_allclose(sagittal, focal_length * (cosine - 1.0), atol=1e-5)
    np.testing.assert_allclose(tangential, focal_length * (cosine - 1.0), atol=1e-5)


@pytest.mark.fast
def test_a_symmetric_lens_at_unit_magnification_has_no_distortion():
    half = (Surface(60.0, 5.0, GLASS, 12.0), Surface(300.0, 12.0, AIR, 12.0))
    other = (Surface(-300.0, 5.0, GLASS, 12.0), Surface(-60.0, 50.0, AIR, 12.0))
    system = LensSystem("symmetric", (*half, stop(12.0, 3.0), *other))
    distance = 200.0  # found by Newton's method: where the image is as large as the object
    for _ in range(50):
        scale = image_scale(system, distance) / distance
        distance *= 1.0 + 0.5 * (scale - 1.0)
    system = focused(system, distance)
    assert image_scale(system, distance) == pytest.approx(distance, rel=1e-9)
    assert np.abs(distortion(system, HEIGHTS, distance)).max() < 1e-8
    assert np.abs(distortion(focused(system, math.inf), HEIGHTS, math.inf)).max() > 1e-4  # it has elsewhere


@pytest.mark.fast
def test_longitudinal_aberration_is_snells_law():
    system = plano_convex()
    fractions = np.linspace(0.1, 0.99, 9)
    where = longitudinal_aberration(system, fractions, math.inf, LINE_D)
    expected = crossing(10.0 * fractions)[0] - system.sensor
    np.testing.assert_allclose(where, expected, rtol=1e-10)
    assert np.isnan(longitudinal_aberration(system, np.array([1.01]), math.inf, LINE_D)).all()


@pytest.mark.fast
def test_the_spot_of_the_axis_is_snells_law():
    system = plano_convex()
    points = spot(system, 0.0, math.inf, LINE_D, 40)
    assert 1000 < len(points) < 1600  # of 40 x 40 in a square, those in its disc
    where, turn = crossing(np.array([9.5, 10.0]))  # a cell of the lattice is 0.5 mm
    low, high = (where - system.sensor) * -np.tan(turn)
    assert low < np.hypot(*points.T).max() <= high
    np.testing.assert_allclose(points.mean(axis=0), 0.0, atol=1e-9)


@pytest.mark.fast
@pytest.mark.parametrize("front", [10.0, 13.0, 15.7])
def test_a_spot_has_the_rays_of_the_rim_whatever_stands_in_front(front):
    """The lattice is found by rays over twice the front rim: none of the pupil may be left out."""
    window = Surface(math.inf, 1.0, AIR, front)
    system = LensSystem("window", (window, *plano_convex().surfaces))
    points = spot(system, 0.0, math.inf, LINE_D, 160)
    # The lattice is wider than the pupil by at most one cell of the first on each side, 4 / 96 of the front rim.
    cell = (20.0 + 2.0 * front * 4.0 / 96.0) / 160.0
    where, turn = crossing(np.array([10.0 - cell, 10.0]))
    low, high = (where - plano_convex().sensor) * -np.tan(turn)
    for along, across in (points.T, -points.T, points.T[::-1], -points.T[::-1]):
        assert low < along[np.abs(across) < 0.02 * high].max() <= high * (1.0 + 1e-12)


@pytest.mark.fast
@pytest.mark.parametrize("name", ["double_gauss", "cooke_triplet"])
def test_spots_of_corrected_lenses_are_as_large_as_optilands(name):
    """RMS radius [mm] of a distant point of the axis, in paraxial focus; `make_optiland_rays.py` made it."""
    with np.load(Path(__file__).with_name("optiland_rays.npz")) as optiland:
        wanted = float(optiland[f"{name}_spot"])
    points = spot(focused(load_lens(name), math.inf), 0.0, math.inf, LINE_D, 200)
    found = math.sqrt(((points - points.mean(axis=0)) ** 2).sum(axis=1).mean())
    # Lattices of 200 and 400 rays across round the rim by some 1 / 200 of its radius at single places, by a tenth of
    # that in the mean; the square of the spot grows with up to the eighth power of it.
    assert found == pytest.approx(wanted, rel=5e-3)


def test_light_through_a_hole_falls_as_the_fourth_power_of_the_cosine():
    distance = 30.0
    system = LensSystem("pinhole", (stop(distance, 0.01),))
    heights = np.array([0.0, 10.0, 30.0])
    light = illumination(system, heights)
    # A disc on a lattice of 240 cells: some 0.1 % of the area is rounded.
    np.testing.assert_allclose(light.relative, (distance / np.hypot(distance, heights)) ** 4, rtol=5e-3)
    np.testing.assert_allclose(light.cat_eye, 1.0, rtol=0.01)


def test_two_rims_leave_the_overlap_of_two_discs():
    far, gap = 1e4, 20.0
    system = LensSystem("tube", (Surface(math.inf, gap, AIR, 5.0), stop(far, 5.0)))
    heights = np.array([1000.0, 2500.0, 4000.0])
    light = illumination(system, heights)
    offset = heights / far * gap / (1.0 + gap / far)  # of the front rim's shadow on the stop
    front = 5.0 / (1.0 + gap / far)  # its radius there
    y = (offset**2 + 25.0 - front**2) / (2.0 * offset)  # two circles meet at this height, by Pythagoras
    area = 25.0 * np.arccos(y / 5.0) - y * np.sqrt(25.0 - y**2)
    area += front**2 * np.arccos((offset - y) / front) - (offset - y) * np.sqrt(25.0 - y**2)
    cosine = far / np.hypot(far, heights)
    np.testing.assert_allclose(light.relative, area / (math.pi * front**2) * cosine**4, rtol=0.01)
    np.testing.assert_allclose(light.cat_eye, (front + 5.0 - offset) / (2.0 * np.sqrt(25.0 - y**2)), rtol=0.02)


def test_the_double_gauss_shades_its_corners_as_is_published():
    """Measured independently with 400 000 rays from each film point: cat eye and light, focused at infinity."""
    system = load_lens("double_gauss")
    wide, half, closed = (illumination(stopped_down(system, stop), HEIGHTS) for stop in (2.0, 2.8, 5.6))
    np.testing.assert_allclose(wide.relative, [1.0, 0.65, 0.29, 0.15], atol=0.02)
    # The table does not say in which plane it measures the bounds of the pupil, which is neither flat nor upright.
    np.testing.assert_allclose(wide.cat_eye, [1.0, 0.75, 0.52, 0.40], atol=0.03)
    np.testing.assert_allclose(half.cat_eye, [1.0, 1.0, 0.63, 0.41], atol=0.03)
    np.testing.assert_allclose(closed.cat_eye, [1.0, 1.0, 1.01, 0.84], atol=0.05)


def test_the_field_of_the_double_gauss_breathes():
    """Of a film of 36 mm, by the thin lens of f = 50.358 mm in the principal planes; 39.34 degrees at infinity."""
    system = load_lens("double_gauss")
    focal_length, front, pupil = 50.35816, 23.2364, 19.9465  # from the first vertex, by hand
    for distance, expected in ((math.inf, 39.34), (1000.0, 37.50), (500.0, 35.64)):  # from the principal plane
        from_pupil = distance - front + pupil
        sheet = data_sheet(focused(system, from_pupil), from_pupil)
        image = focal_length if math.isinf(distance) else focal_length * distance / (distance - focal_length)
        assert 2.0 * math.degrees(math.atan(18.0 / image)) == pytest.approx(expected, abs=0.005)
        ratio = 1.0 if math.isinf(distance) else distance / from_pupil  # the pupil is nearer or farther than the plane
        tangent = math.tan(math.radians(0.5 * sheet.field_width))
        assert tangent == pytest.approx(18.0 / image * ratio, rel=1e-5)


@pytest.mark.fast
def test_a_bundle_of_a_near_point_leaves_that_point():
    system = focused(load_lens("petzval"), 3000.0)
    chief = chief_rays(system, np.array([15.0]))
    rays = bundle(system, chief, np.array([[0.0, 0.0], [3.0, 4.0]]), 3000.0)
    step = (rays.origins[0, 2] - chief.origins[0, 2]) / chief.directions[0, 2]
    np.testing.assert_allclose(rays.origins[0], chief.origins[0] + step * chief.directions[0], atol=1e-9)
    np.testing.assert_allclose(rays.origins + rays.directions, [[0.0, 0.0, 0.0], [3.0, 4.0, 0.0]], atol=1e-9)


def test_light_does_not_depend_on_how_tiny_the_stop_is():
    heights = np.array([10.0, 18.0, 21.6])
    wanted = illumination(stopped_down(load_lens("double_gauss"), 16.0), heights)
    for f_stop in (100.0, 1e3, 1e4):
        found = illumination(stopped_down(load_lens("double_gauss"), f_stop), heights)
        # Rims cut nothing at f/16; the pupil's edge is known to a cell, 1/160 of its width.
        np.testing.assert_allclose(found.relative, wanted.relative, rtol=0.02)
        np.testing.assert_allclose(found.cat_eye, wanted.cat_eye, rtol=0.02)

"""Renders through height lenses: a sampled sphere is the sphere, bounds of the pupil hold, the stop's light is right.

Not among the fast tests, which are interpreted: a render takes hundreds of thousands of rays.
"""

import math

import numpy as np
import pytest

from refdof import Camera, HeightLens, InputError, SystemLens, ThinLens, metrics, reference, render
from refdof._jit import thread_count, use_threads
from refdof.optics.systems.glass import LINE_D, Glass
from refdof.optics.systems.lens_map import lens_map_of, lens_map_ray, lens_map_rays
from refdof.optics.systems.pupil import bounds_at, light_through, pupil_bounds
from refdof.optics.systems.system import ThickLens
from refdof.optics.systems.trace import table_of, trace
from refdof.report.rows import lens_as_json
from tests.flat_scene import rectangle, scene_of
from tests.optics.systems.test_height_lens import waves

CAMERA = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=20.0, size=(24, 18))
BIG = 20.0  # mm per scene unit
SPHERICAL = ThickLens(60.0, -80.0, 6.0, 20.0, Glass("plain", 1.5))
GREEN = (LINE_D,)


def cards(lens):
    """A wall, and a card before it and one in front of the focal plane."""
    parts = [
        rectangle(-30.0, 30.0, -30.0, 30.0, 60.0, (0.2, 0.4, 0.8)),
        rectangle(-1.0, 0.5, -1.0, 1.5, 20.0, (0.9, 0.5, 0.1)),
        rectangle(0.6, 1.0, -2.0, 0.2, 9.0, (0.1, 0.9, 0.3)),
    ]
    return scene_of(parts, CAMERA, lens)


def test_rays_of_a_sampled_sphere_are_the_spheres():
    """The same places and the same points of the same boxes: rays differ by the spline's error, 1e-8 a face."""
    random = np.random.default_rng(1)
    places, squares = random.uniform(0.0, 18.0, (5000, 2)), random.uniform(0.0, 1.0, (5000, 2))
    maps = [lens_map_of(x, CAMERA, 2.0, wavelengths_um=GREEN) for x in (SPHERICAL.system(), HeightLens.of(SPHERICAL))]
    assert maps[1].inverse_centre == pytest.approx(maps[0].inverse_centre, rel=1e-3)  # squares along the rim
    assert (maps[1].sensor, maps[1].pitch, maps[1].eye) == pytest.approx(
        (maps[0].sensor, maps[0].pitch, maps[0].eye), rel=1e-6
    )
    same = {name: getattr(maps[0], name) for name in ("boxes", "inverse_centre", "sensor", "pitch", "eye")}
    (one, light), (two, also) = (lens_map_rays(x, places, squares) for x in (maps[0], maps[1]._replace(**same)))
    assert ((light > 0.0) == (also > 0.0)).mean() > 0.999  # but within 1e-8 mm of a rim
    both = (light > 0.0) & (also > 0.0)
    assert both.mean() > 0.5
    assert two[both] == pytest.approx(one[both], abs=1e-7)  # [m], and slopes; seen: 3e-8
    assert also[both] == pytest.approx(light[both], rel=1e-8)  # the pitch, and so the place in the table of boxes


def test_a_render_through_a_sampled_sphere_is_the_spheres():
    lenses = (SPHERICAL.system(), HeightLens.of(SPHERICAL, 33))
    spheres, sampled = (SystemLens(lens, 20.0, mm_per_unit=BIG) for lens in lenses)
    assert sampled.radius == pytest.approx(spheres.radius, rel=1e-6)
    assert sampled.seen_by(CAMERA).fov_y == pytest.approx(spheres.seen_by(CAMERA).fov_y, rel=1e-6)
    one, two = (reference(cards(lens), CAMERA, lens, samples=1024) for lens in (spheres, sampled))
    # Boxes of the pupil, and with them the samples, differ: noise, of which the error bars tell. 1296 numbers: 4.5.
    error = np.hypot(one.standard_error, two.standard_error) + 1e-3
    assert (np.abs(one.image - two.image) / error).max() < 4.5
    assert abs(float((one.image - two.image).mean())) < 1e-3
    thin = reference(cards(spheres), CAMERA, ThinLens(spheres.radius, spheres.focus_distance), samples=256).image
    assert metrics.rmse(one.image, two.image) < 0.005  # the noise floors of both, 54 dB, make 0.003
    assert metrics.rmse(one.image, thin) > 0.02  # the lens is not the thin one


def test_methods_that_trace_rays_agree_on_waves_and_others_take_the_thin_lens():
    lens = SystemLens(waves(0.05), 20.0, 4.0, mm_per_unit=BIG)
    truth = reference(cards(lens), CAMERA, lens, samples=4096).image
    for method, words, bound in (
        ("accumulation", {"samples": 1024}, 0.01),  # one set of points for all pixels
        ("lensblur", {"samples": 256, "layers": 0}, 0.03),  # and texels: half a pixel of edges
    ):
        assert metrics.rmse(truth, render(method, cards(lens), CAMERA, lens, **words).image) < bound
    thin = ThinLens(lens.radius, lens.focus_distance)
    first, second = (render("scatter", cards(x), CAMERA, x).image for x in (lens, thin))
    np.testing.assert_array_equal(first, second)
    assert lens_as_json(lens)["system"]["name"] == "height lens"
    assert lens_as_json(lens)["system"]["f_number"] == pytest.approx(4.0)


@pytest.mark.parametrize(("stop", "wide"), [(25.0, 20.0), (6.0, 8.0), (1.0, 5.0)])
def test_the_pupils_box_holds_in_every_direction(stop, wide):
    """Rays from sensor points all around the axis, through a square of the plane that is wider than the box."""
    lens = waves().with_stop(stop / 2.0)
    bounds, random, count = pupil_bounds(lens, 15.0, sensor=50.0, intervals=16), np.random.default_rng(3), 40000
    radius, angle = random.uniform(0.0, 15.0, count), random.uniform(0.0, 2.0 * np.pi, count)
    origins = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.full(count, 50.0)])
    aims = np.column_stack([random.uniform(-wide, wide, (count, 2)), np.full(count, bounds.plane)])
    passed = trace(lens, origins, aims - origins, LINE_D, reverse=True).passed
    assert passed.sum() > 200
    along = aims[:, 0] * np.cos(angle) + aims[:, 1] * np.sin(angle)
    across = aims[:, 1] * np.cos(angle) - aims[:, 0] * np.sin(angle)
    for k in np.flatnonzero(passed):
        x0, x1, y1 = bounds_at(bounds, radius[k])
        assert x0 < along[k] < x1
        assert abs(across[k]) < y1


@pytest.mark.parametrize("stop", [20.0, 6.0, 2.0])
def test_boxes_of_a_sampled_sphere_are_around_the_spheres(stop):
    """And not much larger: a third of a box or more is the other's; the sampler loses the rest."""
    lens = HeightLens.of(SPHERICAL)
    wide, narrow = (
        pupil_bounds(x.with_stop(stop / 2.0), 12.0, sensor=70.0, intervals=8).boxes for x in (lens, lens.paraxial)
    )
    assert (wide[:, 0] < narrow[:, 0] + 0.1).all()  # [mm]; spheres' boxes have a margin of a cell and a half of 256
    assert (wide[:, 1:] > narrow[:, 1:] - 0.1).all()
    areas = [(boxes[:, 1] - boxes[:, 0]) * boxes[:, 2] for boxes in (narrow, wide)]
    assert (areas[0] / areas[1]).min() > 1.0 / 3.0


def test_light_in_the_middle_is_that_of_the_stops_disc():
    """A flat plate, stopped down: from the sensor's centre its front, a plane behind 6 mm of glass, is a disc.

    A ray of the rim, at an angle a in air and b in glass, meets it at d tan(a) + 6 tan(b) = 3. Its light is
    pi sin(a)^2 over that of the same angle in the back's plane, d tan(a).
    """
    flat = np.zeros((9, 9))
    plate = HeightLens(flat, flat, 6.0, 25.0, Glass("plain", 1.5), stop_diameter=6.0)
    angle = np.linspace(0.0, 0.2, 200001)
    height = 44.0 * np.tan(angle) + 6.0 * np.tan(np.arcsin(np.sin(angle) / 1.5))
    rim = angle[np.searchsorted(height, 3.0)]
    found = light_through(table_of(plate, LINE_D), pupil_bounds(plate, 5.0, sensor=50.0))
    # The integral of cos^4 over the plane at the distance d is pi d^2 sin(a)^2; d = 44.
    assert found == pytest.approx(math.pi * 44.0**2 * math.sin(rim) ** 2, rel=2e-3)  # squares along the rim


def test_a_ray_alone_is_the_ray_of_a_block():
    lens_map = lens_map_of(waves(), CAMERA, 2.0, wavelengths_um=GREEN)
    random = np.random.default_rng(2)
    places, squares = random.uniform(0.0, 18.0, (100, 2)), random.uniform(0.0, 1.0, (100, 2))
    rays, weights = lens_map_rays(lens_map, places, squares)
    for k in range(100):
        assert lens_map_ray(lens_map, *places[k], *squares[k], 0) == (*rays[k], weights[k])


def test_the_image_is_not_turned():
    """Through a wedge, thick at -x or -y, the middle of the picture sees what lies on that side, by 0.05 (n - 1)."""
    for axis in (0, 1):
        lens = HeightLens.from_functions(
            lambda x, y, axis=axis: (x * x + y * y) / 100.0 + 0.05 * (x, y)[axis],
            lambda x, y: -(x * x + y * y) / 100.0,
            6.0,
            16.0,
            Glass("plain", 1.5),
        )
        lens_map = lens_map_of(lens, CAMERA, 2.0, wavelengths_um=GREEN)
        squares = np.random.default_rng(4).uniform(size=(500, 2))
        rays, weights = lens_map_rays(lens_map, np.tile([12.0, 9.0], (500, 1)), squares)
        slope = np.average(rays[:, 2:], axis=0, weights=weights)
        # Light is bent towards the thick end, so it came from there.
        assert slope[axis] == pytest.approx(-0.05 * 0.5, rel=0.1)
        assert abs(slope[1 - axis]) < 2e-3


def test_the_same_bits_for_any_thread_count():
    lens, count, both = SystemLens(waves(0.05), 20.0, mm_per_unit=BIG), thread_count(), []
    try:
        for threads in (1, 2):
            use_threads(threads)
            both.append(reference(cards(lens), CAMERA, lens, samples=64).image)
    finally:
        use_threads(count)
    np.testing.assert_array_equal(*both)


def test_bad_input():
    lens = waves()
    with pytest.raises(InputError, match=r"^focus_distance: got 0\.01; allowed is more than"):
        SystemLens(lens, 0.01)
    with pytest.raises(InputError, match=r"^f_number: got 0\.5; allowed is at least the lens's own"):
        SystemLens(lens, 2.0, 0.5)
    with pytest.raises(InputError, match=r"^system: got 'height lens', whose image lies inside it"):
        SystemLens(HeightLens.of(ThickLens(-60.0, 60.0, 6.0, 20.0, Glass("plain", 1.5))), 2.0)
    with pytest.raises(InputError, match=r"^sensor: is 0\.01 mm behind the lens; allowed is more than its back's sag"):
        pupil_bounds(lens, 5.0, sensor=6.01)

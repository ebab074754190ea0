"""Rays in camera space: the thin lens in the paraxial limit, brightness, orientation, colour.

Not among the fast tests, which are interpreted: the exit pupil's bounds take hundreds of thousands of rays.
"""

import math
from functools import cache

import numpy as np
import pytest

from refdof._check import InputError
from refdof.optics.camera import Camera
from refdof.optics.systems.glass import Glass, glass_of
from refdof.optics.systems.lens_map import RGB_WAVELENGTHS, lens_map_of, lens_map_ray, lens_map_rays
from refdof.optics.systems.paraxial import entrance_pupil, image_scale, stopped_down
from refdof.optics.systems.system import ThickLens
from tests.optics.systems.lenses import double_gauss, singlet

CAMERA = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=24.0, size=(96, 64))
FILM = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), size=(360, 240))  # 36 x 24 mm at 0.1 mm / px
GREEN = (0.5876,)
SQUARE = np.random.default_rng(1).uniform(0.0, 1.0, (4000, 2))


@cache
def focused(distance):
    return lens_map_of(double_gauss(), CAMERA, distance, wavelengths_um=GREEN)


def rays_of(lens_map, column, row, wavelength=0):
    """Rays that pass from one place in the image, and all weights."""
    rays, weights = lens_map_rays(lens_map, np.tile([column, row], (len(SQUARE), 1)), SQUARE, wavelength)
    return rays[weights > 0.0], weights


def at(rays, depth):
    """Places (N, 2) of rays at a depth."""
    return rays[:, :2] + depth * rays[:, 2:]


@pytest.mark.parametrize("focus", [0.8, 3.0, math.inf])
def test_in_its_paraxial_limit_it_is_the_thin_lens(focus):
    """A thin lens's ray starts on the lens and meets its pixel's pinhole ray at the focus distance.

    Aberrations of the third order are left: halving field and aperture together leaves an eighth.
    """
    errors = []
    for size in (1.0, 0.5):
        camera = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=4.0 * size, size=(4, 4))
        lens = ThickLens(50.0, -50.0, 0.2 * size**2, 4.0 * size, Glass("plain", 1.5)).system()
        lens_map = lens_map_of(lens, camera, focus, wavelengths_um=GREEN)
        rays, _ = rays_of(lens_map, 3.5, 0.5)
        tangent = np.array([1.5, 1.5]) / camera.pixels_per_tangent
        assert np.hypot(*rays[:, :2].T).max() == pytest.approx(0.002 * size, rel=0.02)  # the lens's radius [m]
        error = rays[:, 2:] - tangent if math.isinf(focus) else at(rays, focus) / focus - tangent
        errors.append(np.abs(error).max())
    # By hand, at f/12.5 and 2 degrees: 1e-4 of spherical aberration, 1e-4 of field curvature, some coma.
    assert errors[0] < 3e-4
    assert errors[0] / errors[1] == pytest.approx(8.0, rel=0.1)


def test_of_the_circle_the_error_is_the_square_of_the_aperture():
    """Spherical aberration is the cube of the aperture, and the circle its first power: halved, a quarter is left."""
    camera = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=1.0, size=(4, 4))
    errors = []
    for diameter in (4.0, 2.0, 1.0):
        lens = ThickLens(50.0, -50.0, 0.5, diameter, Glass("plain", 1.5)).system()
        rays, _ = rays_of(lens_map_of(lens, camera, 3.0, wavelengths_um=GREEN), 2.0, 2.0)
        errors.append(np.hypot(*at(rays, 3.0).T).max() / (0.0005 * diameter))
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)  # the outermost of 4000 rays: within 1 % of the rim
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.1)


def test_blur_of_a_real_lens_is_the_thin_lenss_circle():
    """Stopped down, the axis's rays at a depth d fill a circle of radius E |1 - d / focus|, E the entrance pupil's."""
    system = stopped_down(double_gauss(), 16.0)
    rays, _ = rays_of(lens_map_of(system, CAMERA, 2.0, wavelengths_um=GREEN), 48.0, 32.0)
    radius = entrance_pupil(system).radius / 1000.0
    for depth in (1.0, 1.5, 4.0, 20.0):
        assert np.hypot(*at(rays, depth).T).max() == pytest.approx(radius * abs(1.0 - depth / 2.0), rel=0.02)
    assert np.hypot(*at(rays, 2.0).T).max() < 0.01 * radius


def test_the_image_is_upright():
    lens_map = focused(3.0)
    for column, row, signs in ((80.0, 10.0, (1, 1)), (10.0, 10.0, (-1, 1)), (80.0, 60.0, (1, -1))):
        rays, _ = rays_of(lens_map, column, row)
        middle = at(rays, 3.0).mean(axis=0)
        tangent = np.array([column - 48.0, 32.0 - row]) / CAMERA.pixels_per_tangent
        assert np.sign(middle).tolist() == list(signs)
        # The double Gauss's distortion and coma over this small field are below one in a hundred.
        assert middle == pytest.approx(3.0 * tangent, rel=0.01)


def test_the_lens_is_round():
    """Places turned by a right angle about the axis have turned rays, to the last digits."""
    camera = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), size=(64, 64))
    lens_map = lens_map_of(double_gauss(), camera, 2.0, wavelengths_um=GREEN)
    one, weight = lens_map_rays(lens_map, np.tile([50.0, 32.0], (4000, 1)), SQUARE)
    two, turned = lens_map_rays(lens_map, np.tile([32.0, 14.0], (4000, 1)), SQUARE)
    assert (weight == turned).all()
    assert two[:, 1] == pytest.approx(one[:, 0], abs=1e-15)
    assert two[:, 2] == pytest.approx(-one[:, 3], abs=1e-14)


def test_brightness_of_the_double_gauss():
    """Mean weights are illumination: 1 in the centre; 0.65, 0.29 and 0.15 at 10, 18 and 21.6 mm, f/2, at infinity."""
    lens_map = lens_map_of(double_gauss(), FILM, math.inf, wavelengths_um=GREEN, sensor_height=24.0)
    assert lens_map.pitch == pytest.approx(0.1)
    diagonal = np.array([180.0, 120.0]) / math.hypot(180.0, 120.0)
    for height, light in ((0.0, 1.0), (10.0, 0.65), (18.0, 0.29), (21.6, 0.15)):
        column, row = np.array([180.0, 120.0]) + diagonal * height / 0.1
        _, weights = rays_of(lens_map, column, row)
        # Two digits are printed; 4000 rays, of which a fifth to a third is lost, have 1 % of noise.
        assert weights.mean() == pytest.approx(light, abs=0.02)


def test_the_field_of_view_is_the_cameras_or_the_sensors():
    system, tangent = double_gauss(), 32.0 / CAMERA.pixels_per_tangent
    for focus in (1.0, math.inf):
        matched = lens_map_of(system, CAMERA, focus, wavelengths_um=GREEN)
        assert 32.0 * matched.pitch == pytest.approx(tangent * image_scale(system, focus * 1000.0), rel=1e-12)
    fixed = [lens_map_of(system, CAMERA, f, wavelengths_um=GREEN, sensor_height=24.0) for f in (0.5, math.inf)]
    near, far = (np.median(rays_of(lens_map, 48.0, 1.0)[0][:, 3]) for lens_map in fixed)
    assert fixed[0].pitch == fixed[1].pitch
    assert near < 0.95 * far  # it breathes


def test_blue_is_focused_nearer_than_red():
    lens = stopped_down(singlet(), 8.0)
    lens_map = lens_map_of(lens, CAMERA, 2.0)
    assert lens_map.ratios.shape == (3, 2, 2)
    depths = []
    for wavelength in range(3):
        rays, _ = rays_of(lens_map, 48.0, 32.0, wavelength)
        edge = rays[np.hypot(rays[:, 0], rays[:, 1]) > 0.003]
        depths.append(np.median(-(edge[:, 0] * edge[:, 2] + edge[:, 1] * edge[:, 3]) / (edge[:, 2:] ** 2).sum(axis=1)))
    # 1 / depth changes by (n - n_d) (1/R1 - 1/R2): 0.02917 / mm times 3.69e-3 and 2.4e-3.
    glass = glass_of("N-BK7")
    index = np.array([glass.index(w) for w in RGB_WAVELENGTHS])
    change = 1000.0 * (1 / 60 + 1 / 80) * (index - index[0])
    assert 1.0 / np.array(depths) - 1.0 / depths[0] == pytest.approx(change, rel=0.03)  # a thick lens, 6 of 67 mm
    assert depths[0] > depths[1] > depths[2]


def test_units_of_length_change_nothing():
    """In millimetres the same picture has the same rays, a thousand times as long."""
    metres = focused(2.0)
    small = lens_map_of(double_gauss(), CAMERA, 2000.0, wavelengths_um=GREEN, millimetres=1.0)
    one, two = (rays_of(lens_map, 10.0, 20.0)[0] for lens_map in (metres, small))
    assert two[:, :2] == pytest.approx(1000.0 * one[:, :2], rel=1e-12)
    assert (two[:, 2:] == one[:, 2:]).all()


def test_a_ray_alone_is_the_ray_of_a_block():
    """Renderers may ask for one ray at a time; both ways make the same bits."""
    lens_map, places = focused(2.0), np.random.default_rng(2).uniform(0.0, 64.0, (100, 2))
    rays, weights = lens_map_rays(lens_map, places, SQUARE[:100])
    for k in range(100):
        assert lens_map_ray(lens_map, *places[k], *SQUARE[k], 0) == (*rays[k], weights[k])


def test_outside_the_reach_no_light_comes():
    lens_map = focused(2.0)
    rays, weights = rays_of(lens_map, 500.0, 20.0)
    assert rays.shape == (0, 4)
    assert (weights == 0.0).all()


@pytest.mark.parametrize(
    ("words", "start"),
    [
        ({"focus_distance": 0.01}, "focus_distance: got 10 mm; allowed is more than"),
        ({"focus_distance": -1.0}, "focus_distance: got -1"),
        ({"wavelengths_um": ()}, "wavelengths_um: allowed is a list"),
        ({"wavelengths_um": (550.0,)}, "wavelengths_um: got 550"),
        ({"sensor_height": 0.0}, "sensor_height: got 0"),
        ({"millimetres": 0.0}, "millimetres: got 0"),
        ({"camera": None}, "camera: got NoneType"),
        ({"system": ThickLens(-60.0, 60.0, 4.0, 20.0, Glass("p", 1.5)).system()}, "system: got 'thick lens'"),
    ],
)
def test_bad_calls(words, start):
    with pytest.raises(InputError, match=f"^{start}"):
        lens_map_of(**{"system": double_gauss(), "camera": CAMERA, "focus_distance": 2.0, **words})


@pytest.mark.parametrize(
    ("words", "start"),
    [
        ({"lens_map": None}, "lens_map: got NoneType"),
        ({"places": [[math.nan, 0.0]]}, "places: has 1 NaN"),
        ({"squares": [[0.5, 1.5]]}, "squares: largest value is 1.5"),
        ({"squares": [[0.5, 0.5]] * 2}, "squares: got shape"),
        ({"wavelength": 1}, "wavelength: got 1"),
    ],
)
def test_bad_rays(words, start):
    lens_map = focused(2.0)
    with pytest.raises(InputError, match=f"^{start}"):
        lens_map_rays(**{"lens_map": lens_map, "places": [[1.0, 1.0]], "squares": [[0.5, 0.5]], **words})

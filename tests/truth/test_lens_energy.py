"""Light through lens systems is conserved: what comes through the entrance pupil is on the film, and no more.

A lamp of radiance L and area A, flat and upright at the depth d, sends L A times the pupil's projected solid angle
through it: the pupil's area times cos^4 / d^2, if it is small. An even scene of radiance 1 gives the film's centre the
light 1, by definition; a lamp in focus there covers A P^2 / d^2 pixels. So the sum of a lamp's picture is

    L A (P / d)^2 cos^4    [px],    wherever it lies, sharp or not

through any lens that cuts nothing; through a thin lens of this project without the cosines. Not among the fast tests,
which are interpreted: the exit pupil's bounds take hundreds of thousands of rays.
"""

import math

import numpy as np
import pytest
from scipy.stats import qmc

from refdof import Camera, ThinLens, reference, render
from refdof.optics.systems.glass import LINE_D
from refdof.optics.systems.lens_map import lens_map_of, lens_map_rays
from refdof.optics.systems.prescription import load_lens
from refdof.optics.systems.system_lens import SystemLens
from tests.flat_scene import rectangle, scene_of
from tests.optics.systems.lenses import double_gauss, doublet, singlet

CAMERA = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=20.0, size=(48, 36))
P = CAMERA.pixels_per_tangent
FOCUS, SMALL = 20.0, 5.0  # scene units; mm per unit: circles of some pixels
SIDE, RADIANCE = 4, 3.0  # px of the lamp, from a border of pixels to another
# At f/16 the relative terms that a small pupil leaves out are some (1 / 32)^2.
LENSES = {"stop in front": (doublet(), 16.0), "stop inside": (double_gauss(), 16.0), "singlet": (singlet(), 16.0)}
PLACES = {"sharp": (0, 0, 20.0), "far": (0, 0, 80.0), "near": (0, 0, 12.0), "far aside": (12, -6, 80.0)}  # px, units


def lamp(camera, lens, column, row, depth):
    """A square of light whose lower left corner is `column`, `row` px right of and above the middle."""
    x0, y0, side = column * depth / P, row * depth / P, SIDE * depth / P
    return scene_of([rectangle(x0, x0 + side, y0, y0 + side, depth, (RADIANCE,) * 3)], camera, lens)


def cosine(column, row):
    """Of the angle at which the pupil's centre sees the lamp's."""
    return 1.0 / math.sqrt(1.0 + ((column + SIDE / 2) ** 2 + (row + SIDE / 2) ** 2) / P**2)


def both(name):
    """The lens, and the thin lens of its pupil; and how often the cosine falls on a lamp's light through each."""
    system, f_number = LENSES[name]
    real = SystemLens(system, FOCUS, f_number, mm_per_unit=SMALL)
    return (ThinLens(real.radius, FOCUS), 0), (real, 4)


@pytest.mark.parametrize("name", LENSES)
@pytest.mark.parametrize("place", PLACES)
def test_a_lamps_light_is_on_the_film(name, place):
    for lens, falls in both(name):
        found = reference(lamp(CAMERA, lens, *PLACES[place]), CAMERA, lens, samples=1024, pixel_filter="box")
        wanted = RADIANCE * SIDE**2 * cosine(*PLACES[place][:2]) ** falls
        # Pixels have patterns of their own, so squares of their errors add up. A pupil of f/16 leaves out 1 / 1024; a
        # lens of two surfaces has some thousandths of other aberrations.
        error = np.sqrt((found.standard_error.astype(float) ** 2).sum(axis=(0, 1)))
        assert (error < 0.005 * wanted).all()
        assert (np.abs(found.image.sum(axis=(0, 1)) - wanted) < 4.0 * error + 0.003 * wanted).all()


@pytest.mark.parametrize("name", LENSES)
@pytest.mark.parametrize("place", PLACES)
def test_lensblur_keeps_a_lamps_light(name, place):
    (thin, _), (real, falls) = both(name)
    wanted = RADIANCE * SIDE**2
    # A thin lens's ray meets a square of 16 texels from 16 pixels, wherever it comes from the lens; sums are float32.
    image = render("lensblur", lamp(CAMERA, thin, *PLACES[place]), CAMERA, thin, samples=1024).image
    np.testing.assert_allclose(image.sum(axis=(0, 1)), wanted, rtol=1e-5)
    # One set of 1024 points for all pixels knows the area of the pupil in its box to 1 / 1024^(3/4) or so.
    image = render("lensblur", lamp(CAMERA, real, *PLACES[place]), CAMERA, real, samples=1024).image
    np.testing.assert_allclose(image.sum(axis=(0, 1)), wanted * cosine(*PLACES[place][:2]) ** falls, rtol=0.015)


@pytest.mark.parametrize("name", LENSES)
def test_an_even_scene_keeps_its_brightness_in_the_middle(name):
    """Whatever the distance of the wall: out of focus as well as in it."""
    _, (lens, _) = both(name)
    middle = np.s_[17:19, 23:25]
    for depth in (12.0, 20.0, 80.0):
        wall = scene_of([rectangle(-99.0, 99.0, -99.0, 99.0, depth, (RADIANCE,) * 3)], CAMERA, lens)
        found = reference(wall, CAMERA, lens, samples=1024)
        error = np.sqrt((found.standard_error[middle].astype(float) ** 2).sum(axis=(0, 1))) / 4.0  # of four pixels
        wanted = RADIANCE * (1.0 + 0.5 / P**2) ** -2  # cos^4 at half a pixel's diagonal from the axis: 1 - 2e-5
        assert (np.abs(found.image[middle].mean(axis=(0, 1)) - wanted) < 4.0 * error + 0.001 * wanted).all()
        image = render("lensblur", wall, CAMERA, lens, samples=1024).image
        np.testing.assert_allclose(image[middle], wanted, rtol=0.015)  # as above


@pytest.mark.parametrize("name", ["double_gauss", "petzval", "achromat"])
def test_without_rims_a_wide_open_lens_keeps_a_lamps_light(name):
    """Rays of film points about the picture of a lamp in focus, on the axis and where rims would cut its light."""
    system, focus, half, reach = load_lens(name), 3.0, 0.02, 3.5  # [m], [m], [px]: a third of it is the lamp
    lens = SystemLens(system, focus)
    camera = Camera(CAMERA.eye, CAMERA.target, fov_y=30.0, size=(60, 40))
    points = qmc.Sobol(4, rng=np.random.default_rng(6)).random_base2(18)
    wanted, light = (2.0 * half / focus * camera.pixels_per_tangent) ** 2, {}
    for rims in (True, False):
        lens_map = lens_map_of(lens.stopped, camera, focus, wavelengths_um=(LINE_D,), rims=rims)
        for tangent in (0.0, 0.2):
            centre = 30.0 + camera.pixels_per_tangent * tangent, 20.0
            rays, weights = lens_map_rays(lens_map, centre + reach * (2.0 * points[:, :2] - 1.0), points[:, 2:])
            aside = np.abs(rays[:, :2] + focus * rays[:, 2:] - [focus * tangent, 0.0]).max(axis=1)
            light[rims, tangent] = (weights * (aside < half)).mean() * (2.0 * reach) ** 2 / wanted
    # 2^18 points in four dimensions know an area of a third to some thousandths; at f/2 other terms are some 1 / 64.
    assert light[False, 0.0] == pytest.approx(1.0, abs=0.02)
    assert light[False, 0.2] == pytest.approx(1.04**-2, abs=0.02)
    if name != "achromat":  # whose stop is in front
        assert light[True, 0.2] < 0.7

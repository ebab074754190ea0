"""Lenses with dispersion at many wavelengths: beside a plain spectral sum, and what must not change.

Not among the fast tests, which are interpreted: the exit pupil's bounds take hundreds of thousands of rays.
"""

import math
from functools import cache

import numpy as np
import pytest

from refdof import Camera, metrics, reference, render
from refdof._jit import thread_count, use_threads
from refdof.optics.systems.glass import AIR, Glass, glass_of
from refdof.optics.systems.paraxial import image_scale, sensor_for
from refdof.optics.systems.spectrum import channel_weights, wavelengths_of
from refdof.optics.systems.system import LensSystem, Surface
from refdof.optics.systems.system_lens import SystemLens
from tests.flat_scene import rectangle, scene_of
from tests.optics.systems.test_spectrum import weights_of_the_table
from tests.truth.spectral_sum import Card, Singlet, colours

SHAPE = Singlet(60.0, -80.0, 6.0, 6.0, 9.0)
CROWN = glass_of("N-BK7")
PIXELS = 2500.0  # per tangent: red and blue are some pixels apart
WIDTH = 14
CARD = Card(-1.0, 2500.0)  # mm; the lens is focused at 2 m, and a pixel is 1 mm there: texels end at the edge
CAMERA = Camera(
    (0, 0, 0), (0, 0, -1), fov_y=2.0 * math.degrees(math.atan(0.5 / PIXELS)), size=(WIDTH, 1)
)  # the edge of the card is a pixel from its middle


def singlet(glass=CROWN):
    """N-BK7, f/5.6, 69 mm."""
    front = Surface(SHAPE.radius1, SHAPE.thickness, glass, SHAPE.rim1, is_stop=True)
    return LensSystem("singlet", (front, Surface(SHAPE.radius2, 60.0, AIR, SHAPE.rim2)))


def fringe(wavelengths, glass=CROWN):
    """A scene and a lens: a white card on the right, before black."""
    lens = SystemLens(singlet(glass), 2.0, wavelengths=wavelengths)
    parts = [rectangle(CARD.edge / 1000.0, 9.0, -9.0, 9.0, CARD.distance / 1000.0)]
    return scene_of(parts, CAMERA, lens), CAMERA, lens


@cache
def summed(wavelengths, weights, lattice):
    """The twin's row; weights as a tuple of tuples."""
    film = sensor_for(singlet(), 2000.0)
    pitch = image_scale(singlet(), 2000.0) / PIXELS
    places = [(WIDTH / 2 - k - 0.5) * pitch for k in range(WIDTH)]
    return colours(SHAPE, CROWN.index, film, places, CARD, wavelengths, np.array(weights), lattice)


def twin(count, weights=None, lattice=300):
    weights = channel_weights(count) if weights is None else weights
    return summed(wavelengths_of(count), tuple(map(tuple, weights.tolist())), lattice)


# Errors of the reference are 0.001 at 16384 samples, of the lattice 0.0005; the greatest of 42 is 3 or 4 times that.
@pytest.mark.parametrize("count", [3, 7])
def test_a_grey_edge_is_the_spectral_sum(count):
    image = reference(*fringe(count), samples=16384).image[0]
    wanted = twin(count)
    assert np.ptp(wanted, axis=1).max() > 0.2  # it is coloured
    np.testing.assert_allclose(image, wanted, atol=0.004)


def test_a_grey_edge_is_what_the_cies_own_table_says():
    image = reference(*fringe(15), samples=16384).image[0]
    # Weights are off by 0.002 each as the fit is, 15 of them by 0.008 if they are independent; noise is 0.001.
    np.testing.assert_allclose(image, twin(15, weights_of_the_table()), atol=0.01)


def test_more_wavelengths_converge():
    """By the twin, which has no noise; the figures of docs/lenses.md are of more pixels."""
    truth = twin(31, lattice=150)  # the same lattice for all: its error is common to them
    errors = {count: metrics.rmse(truth[None], twin(count, lattice=150)[None]) for count in (3, 7, 15)}
    assert errors[3] > 0.01  # other colours, not a rougher sum
    assert errors[7] < 0.003
    assert errors[15] < 0.001
    assert truth.min() < 0.0  # colours of the spectrum lie outside of Rec.709


def test_lensblur_has_the_colours_too():
    scene, camera, lens = fringe(7)
    height, margin = 25, 10  # px: rays that leave the picture do not count
    large = Camera(
        camera.eye, camera.target, fov_y=2.0 * math.degrees(math.atan(0.5 * height / PIXELS)),
        size=(WIDTH + 2 * margin, height),
    )  # fmt: skip

    def middle(lens):
        picture = render("lensblur", scene, large, lens, samples=1024, layers=0).image
        return picture[height // 2, margin : margin + WIDTH]

    # Its points are shared by all pixels, which know an edge's share to 1 / 1024^(3/4), 0.0055.
    assert metrics.rmse(twin(7)[None], middle(lens)[None]) < 0.0055
    assert metrics.rmse(twin(3)[None], middle(SystemLens(singlet(), 2.0))[None]) < 0.0055
    assert metrics.rmse(twin(7)[None], twin(3)[None]) > 0.025
    noisy = render("accumulation", scene, camera, lens, samples=4096).image[0]
    np.testing.assert_allclose(noisy, twin(7), atol=0.02)  # one net of 4096 points: 0.004, and the greatest of 42


def test_the_same_bits_for_any_thread_count():
    big = Camera((0, 0, 0), (0, 0, -1), fov_y=2.0, size=(40, 30))
    scene, _, lens = fringe(5)
    count, both = thread_count(), []
    try:
        for threads in (1, 2):
            use_threads(threads)
            picture = render("lensblur", scene, big, lens, samples=16).image
            both.append((reference(scene, big, lens, samples=64), picture))
    finally:
        use_threads(count)
    for name in ("image", "standard_error", "low", "high"):
        np.testing.assert_array_equal(*(getattr(one, name) for one, _ in both))
    np.testing.assert_array_equal(both[0][1], both[1][1])


def test_without_dispersion_one_pass_is_enough_and_no_bit_changes():
    images = []
    for count in (3, 31):
        scene, camera, lens = fringe(count, Glass("plain", 1.5))
        assert len(lens.map_of(camera).ratios) == 1
        images.append(
            (
                reference(scene, camera, lens, samples=256).image,
                render("lensblur", scene, camera, lens, samples=16).image,
            )
        )
        assert (np.ptp(images[-1][0], axis=2) == 0.0).all()  # grey stays grey
    np.testing.assert_array_equal(images[0][0], images[1][0])
    np.testing.assert_array_equal(images[0][1], images[1][1])


def test_as_many_passes_as_wavelengths():
    for count in (3, 4, 31):
        _, camera, lens = fringe(count)
        assert len(lens.map_of(camera).ratios) == count


def test_an_even_scene_keeps_its_colour():
    """But for the little by which the pupil's size depends on the wavelength."""
    color = (0.2, 0.5, 0.8)
    lens = SystemLens(singlet(), 2.0, wavelengths=7)
    scene = scene_of([rectangle(-9.0, 9.0, -9.0, 9.0, 4.0, color)], CAMERA, lens)
    image = reference(scene, CAMERA, lens, samples=4096).image
    # Between violet and red the index changes by 0.016, a hundredth; the rim, which is the first surface's, stays.
    np.testing.assert_allclose(image, np.broadcast_to(np.float32(color), image.shape), rtol=0.01)
    blurred = render("lensblur", scene, CAMERA, lens, samples=256).image
    np.testing.assert_allclose(blurred, np.broadcast_to(np.float32(color), image.shape), rtol=0.02)
    assert metrics.rmse(image, blurred) < 0.01

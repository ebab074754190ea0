"""Renders through lens systems: brightness, the thin lens in the paraxial limit, `lensblur` beside the reference.

Not among the fast tests, which are interpreted: the exit pupil's bounds take hundreds of thousands of rays.
"""

import math

import numpy as np
import pytest

from refdof import Camera, ThinLens, metrics, reference, render
from refdof._jit import thread_count, use_threads
from refdof.optics.systems.glass import Glass
from refdof.optics.systems.system import ThickLens
from refdof.optics.systems.system_lens import SystemLens
from tests.flat_scene import rectangle, scene_of
from tests.optics.systems.lenses import double_gauss

CAMERA = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=20.0, size=(48, 36))
BIG = 20.0  # mm per scene unit: a lens as large as the scene asks for
PLAIN = ThickLens(80.0, -80.0, 0.1, 2.0, Glass("plain", 1.5)).system()  # f/40: hardly an aberration; no second rim


def cards(lens, size=1.0):
    """A wall, a card before it and one in front of the focal plane."""
    parts = [
        rectangle(-30.0, 30.0, -30.0, 30.0, 60.0, (0.2, 0.4, 0.8)),
        rectangle(-size, 0.5 * size, -size, 1.5 * size, 20.0, (0.9, 0.5, 0.1)),
        rectangle(0.6 * size, size, -2.0 * size, 0.2 * size, 9.0, (0.1, 0.9, 0.3)),
    ]
    return scene_of(parts, CAMERA, lens)


@pytest.mark.parametrize(
    ("f_number", "wanted"), [(2.0, (1.0, 0.65, 0.29, 0.15)), (5.6, (1.0, 0.95, 0.83, 0.72))]
)  # at f/2 measured with another tracer; at f/5.6 nothing is cut but at the corner, and cos^4 of the exit pupil is left
def test_vignetting_of_the_double_gauss(f_number, wanted):
    """Film heights of 0, 10, 18 and 21.6 mm, focused at infinity: on the axis an even scene has its own brightness."""
    lens = SystemLens(double_gauss(), math.inf, f_number)
    width = 433  # px, odd: 0.1 mm each, so that pixel centres are at whole tenths
    half = 0.05 / 50.35816  # tangent of half a pixel
    camera = Camera(CAMERA.eye, CAMERA.target, fov_y=math.degrees(2.0 * math.atan(half)), size=(width, 1))
    scene = scene_of([rectangle(-1e-3, 1e-3, -1e-3, 1e-3, 1e6)], camera, lens, (0.5, 0.5, 0.5))
    row = reference(scene, camera, lens, samples=1024).image[0, :, 1] / 0.5
    found = row[[216, 316, 396, 432]]
    np.testing.assert_allclose(found, wanted, atol=0.02)  # the table's figures have two digits
    np.testing.assert_allclose(row, row[::-1], atol=0.05)  # 1024 samples in 4 nets, a quarter blocked: noise of 0.01


def test_in_the_paraxial_limit_both_methods_see_what_the_thin_lens_sees():
    real = SystemLens(PLAIN, 20.0, mm_per_unit=BIG)
    thin = ThinLens(real.radius, real.focus_distance)
    near_axis = Camera(CAMERA.eye, CAMERA.target, fov_y=2.0, size=CAMERA.size)  # circles of 2 and 3 px
    # One set of 256 points for all pixels knows the area of a disc in a square to 1 / 256^(3/4) or so.
    for method, words, mean in (
        ("accumulation", {"samples": 256}, 1e-3),
        ("lensblur", {"samples": 256, "layers": 0}, 0.01),
    ):
        first = render(method, cards(real, 0.1), near_axis, real, **words).image
        second = render(method, cards(thin, 0.1), near_axis, thin, **words).image
        # Different points of the same lens, 256 of them: at an edge 0.4 of the contrast / 256^(3/4) is 0.006.
        assert metrics.rmse(first, second) < 0.01, method
        assert abs(float((first - second).mean())) < mean, method


def test_lensblur_converges_to_the_reference():
    lens = SystemLens(double_gauss(), 20.0, mm_per_unit=BIG)
    scene = cards(lens)
    truth = reference(scene, CAMERA, lens, samples=4096)
    errors = []
    for samples in (16, 256):
        image = render("lensblur", scene, CAMERA, lens, samples=samples, layers=0, footprint="rays").image
        errors.append(metrics.rmse(truth.image, image))
    assert errors[1] < 0.5 * errors[0]
    assert errors[1] < 0.015  # texels: half a pixel of edges, of which a tenth of the picture is blurred little
    thin = reference(scene, CAMERA, ThinLens(lens.radius, lens.focus_distance), samples=1024).image
    assert metrics.rmse(truth.image, thin) > 3.0 * errors[1]  # the lens is not the thin one


def test_all_footprints_give_the_same_picture():
    lens = SystemLens(double_gauss(), 20.0, mm_per_unit=BIG)
    words = {"samples": 64, "layers": 0}
    images = [
        render("lensblur", cards(lens), CAMERA, lens, **words, **given).image
        for given in ({"footprint": "rays"}, {"footprint": "closed"}, {"iterations": 0})
    ]
    for image in images[1:]:
        np.testing.assert_array_equal(image, images[0])


def test_the_same_bits_for_any_thread_count():
    lens = SystemLens(double_gauss(), 20.0, mm_per_unit=BIG)
    scene, count = cards(lens), thread_count()
    try:
        both = []
        for threads in (1, 2):
            use_threads(threads)
            both.append(
                (
                    reference(scene, CAMERA, lens, samples=64).image,
                    render("lensblur", scene, CAMERA, lens, samples=16).image,
                )
            )
    finally:
        use_threads(count)
    np.testing.assert_array_equal(both[0][0], both[1][0])
    np.testing.assert_array_equal(both[0][1], both[1][1])


def test_other_methods_take_the_thin_lens():
    real = SystemLens(double_gauss(), 20.0, mm_per_unit=BIG)
    thin = ThinLens(real.radius, real.focus_distance)
    for method in ("scatter", "multiview"):
        first, second = (render(method, cards(lens), CAMERA, lens).image for lens in (real, thin))
        np.testing.assert_array_equal(first, second)

"""The blur of a lamp has the shape of the aperture, upright behind the focal plane and turned before it."""

import numpy as np
import pytest

import refdof
from refdof import Aperture, ThinLens, View
from refdof.rendering import render_view
from tests import flat_scene


@pytest.mark.parametrize("depth", [2.0, 0.6])
def test_blur_has_the_shape_of_the_opening(depth):
    p, size, focus = 16.0, 41, 1.0
    coc = 10.0 if depth > focus else -10.0
    quarter = Aperture.image(np.array([[0.0, 1.0], [0.0, 0.0]]))  # right and up, centred on (1/2, 1/2)
    radius = abs(coc / (p * (1 / focus - 1 / depth)))
    half = 0.5 * depth / p
    lamp = flat_scene.rectangle(-half, half, -half, half, depth, (100.0,) * 3)
    shot = flat_scene.camera(size, size, p)
    x, y = np.meshgrid(np.arange(size) - size // 2, size // 2 - np.arange(size))
    for opening, shift, third in ((quarter, 0.5, None), (Aperture.polygon(3), 0.0, 0.025)):
        result = refdof.reference(
            flat_scene.scene_of([lamp], shot), shot, ThinLens(radius, focus, opening), samples=8192, pixel_filter="box"
        )
        red, error = result.image[..., 0].astype(float), result.standard_error[..., 0].astype(float)
        # A point behind the focal plane moves with the lens point, one before it against it. Four standard errors
        # of sums over independent pixels.
        for offset, expected in ((x, shift), (y, shift)):
            room = 4 * np.sqrt((error**2 * offset**2).sum()) / 100
            assert (red * offset).sum() / 100 == pytest.approx(coc * expected, abs=room)
        if third is not None:
            # A triangle with a corner at (1, 0): the mean of x^3 is 1/40, by barycentric moments 1/10, 1/30, 1/60.
            room = 4 * np.sqrt((error**2 * x**6.0).sum()) / 100
            assert room < 6  # of 25
            assert (red * x**3).sum() / 100 == pytest.approx(coc**3 * third, abs=room)


def edge_view(depth, aperture):
    """A white card right of x = 20 px before black, 40 x 12 px: circles of 20 (1 / 2 - 1 / depth) px."""
    shot = flat_scene.camera(40, 12, 10.0)
    card = flat_scene.rectangle(0.0, 99.0, -99.0, 99.0, depth)
    return View(flat_scene.scene_of([card], shot), shot, ThinLens(2.0, 2.0, aperture))


@pytest.mark.parametrize("depth", [1.5, 4.0])
@pytest.mark.parametrize("method", ["lensblur", "multiview"])
def test_eight_rays_through_an_image_know_its_ramp(method, depth):
    image = np.zeros((16, 16))
    image[6:8, 8:12] = 1.0  # x in 0 .. 1/2: 1/25 of the disc
    view = edge_view(depth, Aperture.image(image))
    shown = render_view(method, view, samples=8, jitter="none", pattern="sobol").image[6, :, 0]
    # A pixel at x sees the card through lens points with x - c v >= 20; of 8 points of a net, one lies in each eighth.
    c = 20.0 * (1 / 2 - 1 / depth)
    reach = (np.arange(40) + 0.5 - 20.0) / c
    inside = np.clip(reach / 0.5, 0.0, 1.0)
    expected = inside if c > 0 else 1.0 - inside
    np.testing.assert_allclose(shown[10:30], expected[10:30], atol=1 / 8 + 1e-6)


@pytest.mark.parametrize("method", ["lensblur", "multiview"])
@pytest.mark.parametrize("pattern", ["sobol", "halton", "vogel", "poisson", "jittered", "random"])
@pytest.mark.parametrize("samples", [1, 2, 8])
def test_few_rays_find_a_small_hole(method, pattern, samples):
    image = np.zeros((33, 33))
    image[16, 16] = 1.0
    view = edge_view(4.0, Aperture.image(image))
    rays = {"cones": "none"} if method == "multiview" else {}  # a single cone is as wide as the lens
    shown = render_view(method, view, samples=samples, jitter="none", pattern=pattern, **rays).image[6, :, 0]
    # Lens points up to 1/33 away: circles of 5/33 px leave pixel centres half a pixel from the edge alone.
    np.testing.assert_allclose(shown[10:30], (np.arange(10, 30) >= 20).astype(float), atol=1e-6)


def test_bounds_cut_no_ray_through_texels_outside_the_lens_circle():
    view = edge_view(1.0, Aperture.image(np.ones((1, 1))))  # corners at 1.41
    whole, cut = (render_view("lensblur", view, samples=64, iterations=k).image for k in (0, 3))
    np.testing.assert_array_equal(cut, whole)

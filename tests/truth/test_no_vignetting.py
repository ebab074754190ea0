"""Lenses in which nothing but the stop blocks light: the fall of light that is left, round pupils, no way round.

Not among the fast tests, which are interpreted: the exit pupil's bounds take hundreds of thousands of rays.
"""

import math

import numpy as np
import pytest

from refdof import Camera, reference, render
from refdof.optics.systems.glass import AIR, Glass
from refdof.optics.systems.lens_map import lens_map_rays
from refdof.optics.systems.paraxial import image_scale, sensor_for
from refdof.optics.systems.prescription import LENSES, load_lens
from refdof.optics.systems.system import LensSystem, Surface
from refdof.optics.systems.system_lens import SystemLens
from tests.flat_scene import rectangle, scene_of

FILM = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), size=(360, 240))  # 36 x 24 mm, 0.1 mm a pixel
SQUARE = np.random.default_rng(1).uniform(0.0, 1.0, (20000, 2))
PLAIN = Glass("plain", 1.5)
# Its rims cut what comes from the side, and its stop is the last thing that light passes.
BEHIND = LensSystem(
    "stop behind",
    (
        Surface(60.0, 4.0, PLAIN, 8.0),
        Surface(-120.0, 12.0, AIR, 8.0),
        Surface(math.inf, 1.0, AIR, 5.0, is_stop=True),
    ),
)


def even_row(lens, width=181, step=0.2, samples=4096):
    """A row of the film, `step` mm a pixel, of an even scene, over the scene's own brightness."""
    tangent = step / image_scale(lens.system, math.inf)
    camera = Camera((0, 0, 0), (0, 0, -1), fov_y=math.degrees(2.0 * math.atan(tangent / 2.0)), size=(width, 1))
    scene = scene_of([rectangle(-1e-3, 1e-3, -1e-3, 1e-3, 1e6)], camera, lens, (0.5, 0.5, 0.5))
    return reference(scene, camera, lens, samples=samples).image[0, :, 1].astype(float) / 0.5


def rays_at(lens, height):
    """Rays (N, 4) that pass from a film point beside the axis, and the mean weight."""
    lens_map = lens.map_of(lens.seen_by(FILM))
    rays, weights = lens_map_rays(lens_map, np.tile([180.0 + 10.0 * height, 120.0], (len(SQUARE), 1)), SQUARE)
    return rays[weights > 0.0], float(weights.mean())


def width_over_height(rays):
    return float(np.ptp(rays[:, 0]) / np.ptp(rays[:, 1]))


def spread(light):
    """Standard deviation of where light (N,) falls [px]."""
    places = np.arange(len(light))
    mean = (light * places).sum() / light.sum()
    return math.sqrt((light * (places - mean) ** 2).sum() / light.sum())


def test_light_falls_as_seen_from_the_film_through_a_disc():
    """A stop behind the lens is its own exit pupil: a disc before an even scene, whose light has a closed form.

    E(h) = 1/2 [1 - (Z^2 + h^2 - r^2) / sqrt((Z^2 + h^2 + r^2)^2 - 4 r^2 h^2)]: of a small plane that is parallel to a
    disc, Foote 1915. Where r is small it is the cosine^4.
    """
    heights = 0.2 * (np.arange(181) - 90)
    distance, radius = sensor_for(BEHIND, math.inf) - 16.0, 5.0
    near, far = distance**2 + heights**2 - radius**2, distance**2 + heights**2 + radius**2
    wanted = 0.5 * (1.0 - near / np.sqrt(far**2 - 4.0 * radius**2 * heights**2))
    wanted /= wanted[90]
    assert wanted == pytest.approx((1.0 + (heights / distance) ** 2) ** -2.0, abs=0.002)

    # Of 4096 points in 4 nets, a fifth misses the disc in its box: an error of about 0.4 / 1024^(3/4) / 2, 0.1 %.
    found = even_row(SystemLens(BEHIND, math.inf, vignetting=False))
    np.testing.assert_allclose(found, wanted, atol=0.01)
    assert abs(float((found - wanted).mean())) < 5e-4
    assert even_row(SystemLens(BEHIND, math.inf), samples=256)[0] < 0.9 * wanted[0]


@pytest.mark.parametrize("name", LENSES)
def test_cats_eyes_are_gone(name):
    """Also of lenses whose surfaces, if they go on, let rays through that no lens has: the Cooke triplet's."""
    system = load_lens(name)
    free, cut = (SystemLens(system, math.inf, vignetting=given) for given in (False, True))
    assert free.radius == cut.radius  # the entrance pupil
    assert free.seen_by(FILM) == cut.seen_by(FILM)
    for height in (0.0, 10.0, 17.9):
        rays, light = rays_at(free, height)
        # Pupils have aberrations: they grow by up to 7 % towards the corner.
        assert width_over_height(rays) == pytest.approx(1.0, abs=0.08)
        assert light >= rays_at(cut, height)[1] - 0.01
    if name in ("double_gauss", "petzval", "telephoto"):
        assert width_over_height(rays_at(cut, 17.9)[0]) < 0.75


def test_lamps_in_the_corner_are_round():
    """A small lamp far behind the plane in focus, drawn by both: narrow, or round but for aberrations."""
    system = load_lens("double_gauss")
    for vignetting, ratio in ((True, (0.4, 0.8)), (False, (0.88, 1.05))):
        lens = SystemLens(system, 0.25, vignetting=vignetting)
        camera = lens.seen_by(Camera((0, 0, 0), (0, 0, -1), size=(150, 80)))  # of a wider film
        lamp = [rectangle(2.36, 2.44, -0.04, 0.04, 10.0, (100.0, 100.0, 100.0))]
        scene = scene_of(lamp, camera, lens)
        for image in (
            reference(scene, camera, lens, samples=256).image,
            render("lensblur", scene, camera, lens, samples=256, layers=0).image,
        ):
            light = image[..., 1].astype(float)
            wide, high = spread(light.sum(axis=0)), spread(light.sum(axis=1))
            assert high > 3.0  # px; of a disc it is half the radius
            assert ratio[0] < wide / high < ratio[1]

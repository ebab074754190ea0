"""Renders through an expressive lens: each control beside thin lenses, closed forms and a tracer of its own."""

import math

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from refdof import Camera, ExpressiveLens, InputError, ThinLens, metrics, reference, render
from refdof._jit import thread_count, use_threads
from refdof.optics.aperture import Aperture
from refdof.report.rows import lens_as_json
from tests.flat_scene import rectangle, scene_of

CAMERA = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=20.0, size=(48, 36))
RADIUS, FOCUS, FOCAL = 1.5, 20.0, 2.0


# A card in front of the focal plane, one in it, and a wall: left, right, bottom, top, depth and colour.
CARDS = (
    (0.6, 1.0, -2.0, 0.2, 9.0, (0.1, 0.9, 0.3)),
    (-1.0, 0.5, -1.0, 1.5, 20.0, (0.9, 0.5, 0.1)),
    (-30.0, 30.0, -30.0, 30.0, 60.0, (0.2, 0.4, 0.8)),
)


def cards(lens):
    return scene_of([rectangle(*card) for card in CARDS], CAMERA, lens)


def lens_of(**controls):
    return ExpressiveLens(RADIUS, FOCUS, FOCAL, **controls)


def picture(lens, method="reference", samples=256):
    if method == "reference":
        return reference(cards(lens), CAMERA, lens, samples=samples).image
    return render(method, cards(lens), CAMERA, lens, samples=samples, layers=0, footprint="rays").image


def thin(inverse_focus):
    return ThinLens(RADIUS, 1.0 / inverse_focus)


@pytest.mark.parametrize("method", ["reference", "lensblur"])
def test_without_a_control_it_is_the_thin_lens(method):
    plain = ThinLens(RADIUS, FOCUS)
    # The same points of the lens, placed by other roundings: a ray in a million may meet another triangle or texel.
    tolerance = 1e-6 if method == "reference" else 2e-3
    assert np.abs(picture(lens_of(), method, 64) - picture(plain, method, 64)).mean() < tolerance


@pytest.mark.parametrize("method", ["reference", "lensblur"])
def test_another_power_everywhere_is_another_focus(method):
    # Power 0.98 / 2: of the image plane at 1 / (1/2 - 1/20), 1/d = 0.49 - 0.45.
    changed = picture(lens_of(power=(0.98, 0.98, 0.98)), method, 64)
    assert np.abs(changed - picture(thin(0.04), method, 64)).mean() < 2e-3
    assert metrics.rmse(changed, picture(lens_of(), method, 64)) > 0.02


@pytest.mark.parametrize("method", ["reference", "lensblur"])
def test_each_colour_has_the_focus_of_its_index(method):
    # n - 1 of 0.49, 0.50, 0.51 over 0.5: powers of 0.49, 0.5 and 0.51 at the image plane's 0.45.
    image = picture(lens_of(indices=(1.49, 1.50, 1.51)), method, 64)
    for channel, inverse_focus in enumerate((0.04, 0.05, 0.06)):
        wanted = picture(thin(inverse_focus), method, 64)[..., channel]
        assert np.abs(image[..., channel] - wanted).mean() < 2e-3


def test_a_displaced_image_plane_is_another_focus():
    # The plane at 1 / 0.45 moves to 1 / 0.44: 1/d = 0.5 - 0.44.
    offset = 1.0 / 0.44 - 1.0 / 0.45
    for given in ((offset, offset), np.full((3, 5), offset)):
        assert np.abs(picture(lens_of(image_offset=given)) - picture(thin(0.06))).mean() < 1e-5


def test_an_offset_surface_gives_every_pixel_its_own_focus():
    """A curved image plane: at each pixel's centre, what the thin lens of that pixel's focus sees."""
    lens = lens_of(image_offset=(0.0, 0.02, 0.11))
    truth = reference(cards(lens), CAMERA, lens, samples=256).image
    inverse_focus = lens.inverse_focus(CAMERA)
    for x, y in ((24, 18), (40, 30), (3, 3), (30, 4)):
        offset = pchip(lens.image_offset)(math.hypot(x - 23.5, y - 17.5) / math.hypot(24.0, 18.0))
        assert 1.0 / inverse_focus[y, x] == pytest.approx(1.0 / (0.5 - 1.0 / (1.0 / 0.45 + offset)), rel=1e-12)
        alone = reference(cards(lens), CAMERA, thin(inverse_focus[y, x]), samples=256).image
        np.testing.assert_allclose(truth[y, x], alone[y, x], atol=1e-6)  # roundings of rays, none at an edge


def test_a_surface_over_the_picture_keeps_planes():
    """Offsets that give an inverse distance that is linear over the picture: a tilted plane in focus."""
    inverse_focus = 0.05 + np.add.outer(np.linspace(-1, 1, 36) * 0.01, np.linspace(-1, 1, 48) * 0.02)
    offset = 1.0 / (0.5 - inverse_focus) - 1.0 / 0.45
    lens = lens_of(image_offset=offset)
    np.testing.assert_allclose(lens.inverse_focus(CAMERA), inverse_focus, rtol=1e-12)


def pchip(values):
    """SciPy's monotone cubic through values and their mirror, of places -1 .. 1."""
    places = np.linspace(-1.0, 1.0, 2 * len(values) - 1)
    return PchipInterpolator(places, [*values[:0:-1], *values])


def naive(lens, places, camera=CAMERA, count=256):
    """What pixels (x, y) see of `cards`: every ray by itself, on a grid of the aperture, colour by colour."""
    tangent = math.tan(math.radians(camera.fov_y / 2.0)) / (camera.height / 2.0)
    step = (np.arange(count) + 0.5) / count * 2.0 - 1.0
    vx, vy = (axis.ravel() for axis in np.meshgrid(step, step))
    vx, vy = vx[vx**2 + vy**2 < 1.0], vy[vx**2 + vy**2 < 1.0]
    r = np.hypot(vx, vy)
    weight = pchip(lens.ray_weights)(r)
    colors = []
    for x, y in places:
        across, up = (x + 0.5 - camera.width / 2) * tangent, (camera.height / 2 - y - 0.5) * tangent
        field = math.hypot(x + 0.5 - camera.width / 2, y + 0.5 - camera.height / 2)
        offset = pchip(lens.image_offset)(field / math.hypot(camera.width / 2, camera.height / 2))
        plane = 1.0 / (1.0 / FOCAL - 1.0 / FOCUS) + offset
        color = []
        for channel in range(3):
            power = pchip(lens.power)(r) * (lens.indices[channel] - 1.0) / (lens.indices[1] - 1.0) / FOCAL
            meet = 1.0 / (power - 1.0 / plane)
            seen = np.full(len(vx), np.nan)
            for x0, x1, y0, y1, depth, paint in CARDS:
                px = RADIUS * vx + (across * meet - RADIUS * vx) / meet * depth
                py = RADIUS * vy + (up * meet - RADIUS * vy) / meet * depth
                here = np.isnan(seen) & (px > x0) & (px < x1) & (py > y0) & (py < y1)
                seen[here] = paint[channel]
            color.append((seen * weight).sum() / weight.sum())
        colors.append(color)
    return np.array(colors)


ALL = {
    "power": (1.0, 0.995, 1.01, 1.03),
    "ray_weights": (0.1, 0.5, 4.0),
    "image_offset": (0.0, 0.03, 0.15),
    "indices": (1.495, 1.5, 1.51),
}


@pytest.mark.parametrize("control", [*ALL, "all"])
def test_every_control_does_what_a_tracer_of_single_rays_does(control):
    lens = lens_of(**(ALL if control == "all" else {control: ALL[control]}))
    places = [(24, 18), (20, 8), (28, 21), (31, 27), (6, 10), (41, 12), (32, 16)]
    wanted = naive(lens, places)
    truth = reference(cards(lens), CAMERA, lens, samples=4096)
    rows, columns = np.array([y for _, y in places]), np.array([x for x, _ in places])
    # The grid of 51 000 points knows an edge to 1e-3 of the contrast; the reference says how well it knows it.
    np.testing.assert_allclose(
        truth.image[rows, columns], wanted, atol=2e-3 + 5.0 * float(truth.standard_error[rows, columns].max())
    )
    assert truth.standard_error.max() < 0.005
    image = render("lensblur", cards(lens), CAMERA, lens, samples=1024, layers=0, footprint="rays").image
    assert metrics.rmse(truth.image, image) < 0.02  # half a pixel of edges, as with other lenses
    plain = reference(cards(lens), CAMERA, ThinLens(RADIUS, FOCUS), samples=256).image
    assert metrics.rmse(truth.image, plain) > 0.006  # the control does something


def test_ray_weights_are_the_profile_of_a_lamp():
    lens = ExpressiveLens(1.0, 20.0, 2.0, ray_weights=(1.0, 2.0, 4.0))
    camera = Camera(CAMERA.eye, CAMERA.target, fov_y=20.0, size=(41, 41))
    lamp = rectangle(-0.3, 0.3, -0.3, 0.3, 60.0, (100.0, 100.0, 100.0))
    row = reference(scene_of([lamp], camera, lens), camera, lens, samples=2**15).image[20, :, 1]
    circle = float(ThinLens(1.0, 20.0).coc_px(60.0, camera))
    assert 3.5 < circle < 4.5
    # A pixel sees the lamp through a square of the lens, half as large as the lamp, about its place in the disc.
    x, y = np.meshgrid(np.linspace(-0.15, 0.15, 65), np.linspace(-0.15, 0.15, 65))
    profile = np.array([pchip(lens.ray_weights)(np.hypot(k / circle + x, y)).mean() for k in range(4)])
    # The square holds 3 % of 32 768 points, 940: at its edges, sqrt(4 sqrt(940)) points are in doubt, 1 %.
    np.testing.assert_allclose(row[20:24] / row[20], profile / profile[0], rtol=0.03)


@pytest.mark.parametrize("method", ["reference", "lensblur"])
def test_an_even_scene_keeps_its_brightness(method):
    lens = lens_of(**ALL, aperture=Aperture.polygon(5))
    wall = scene_of([rectangle(-90.0, 90.0, -90.0, 90.0, 60.0, (0.2, 0.4, 0.8))], CAMERA, lens)
    if method == "reference":
        image, tolerance = (
            reference(wall, CAMERA, lens, samples=1024).image,
            0.02,
        )  # 256 points a net, weights of 0.05 to 2
    else:
        image, tolerance = render(method, wall, CAMERA, lens).image, 1e-6  # weights are divided by their own sum
    inner = image[6:-6, 6:-6]
    np.testing.assert_allclose(inner, np.broadcast_to([0.2, 0.4, 0.8], inner.shape), rtol=tolerance)
    np.testing.assert_allclose(inner.mean(axis=(0, 1)), [0.2, 0.4, 0.8], rtol=1e-3)


def test_the_same_bits_for_any_thread_count():
    lens, count = lens_of(**ALL), thread_count()
    both = []
    try:
        for threads in (1, 2):
            use_threads(threads)
            both.append((picture(lens, samples=64), picture(lens, "lensblur", 16)))
    finally:
        use_threads(count)
    np.testing.assert_array_equal(both[0][0], both[1][0])
    np.testing.assert_array_equal(both[0][1], both[1][1])


def test_filters_take_each_pixels_circle():
    lens = lens_of(image_offset=(0.0, 0.1, 0.6))
    stripes = [rectangle(k, k + 0.5, -9.0, 9.0, 20.0) for k in np.arange(-9.0, 9.0)]
    wall = scene_of([*stripes, rectangle(-9.0, 9.0, -9.0, 9.0, 20.01, (0.1, 0.1, 0.1))], CAMERA, lens)
    circles = lens.coc_px(np.full((36, 48), 20.0), CAMERA)
    assert circles[18, 24] == pytest.approx(0.0, abs=0.05)
    assert circles[0, 0] > 4.0
    assert float(lens.coc_px(20.0, CAMERA)) == circles[18, 24]
    truth = reference(wall, CAMERA, lens, samples=256).image
    for method in ("scatter", "singlepass", "cascaded"):
        changed, plain = (
            metrics.rmse(truth, render(method, wall, CAMERA, given).image) for given in (lens, ThinLens(RADIUS, FOCUS))
        )
        assert changed < 0.5 * plain, method
    middle, plain = (render("multiview", wall, CAMERA, given).image for given in (lens, ThinLens(RADIUS, FOCUS)))
    np.testing.assert_allclose(middle, plain, atol=0.02)  # the offset in the middle is 1e-3 of the image distance


def test_the_circle_of_confusion_is_the_mean_over_the_lens_and_colours():
    # Two values are 1 + 0.02 r^2: twice the integral of that times r over 0 .. 1 is 1.01.
    lens = lens_of(power=(1.0, 1.02), indices=(1.49, 1.50, 1.51))
    pixels = CAMERA.pixels_per_tangent * RADIUS
    wanted = pixels * (0.5 * 1.01 - 0.45 - 1.0 / 30.0)
    assert float(lens.coc_px(30.0, CAMERA)) == pytest.approx(wanted, rel=1e-3)  # a grid of 64 x 64 points
    largest = lens.largest_circle_px(np.array([30.0]), CAMERA)
    assert largest == pytest.approx(pixels * (0.51 * 1.02 - 0.45 - 1.0 / 30.0), rel=1e-9)
    assert lens.coc_px(np.array([np.inf]), CAMERA)[0] > 0.0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ({"power": (1.0,)}, "power: got 1 numbers; allowed are 2 to 64"),
        ({"power": (1.0, 0.0)}, "power: smallest value is 0; allowed are values >= 0.001"),
        ({"ray_weights": (0.0, 0.0)}, "ray_weights: all are 0; at least one must be above 0"),
        ({"ray_weights": (1.0, -1.0)}, "ray_weights: smallest value is -1; allowed are values >= 0"),
        ({"image_offset": (0.0, -3.0)}, "image_offset: smallest value is -3; allowed is more than -2.22222"),
        ({"image_offset": np.zeros((0, 2))}, "image_offset: got none"),
        ({"image_offset": "flat"}, "image_offset: "),
        ({"indices": (1.0, 1.5, 1.5)}, "indices: smallest value is 1; allowed are values above 1"),
        ({"indices": (1.5, 1.5)}, "indices: "),
    ],
)
def test_bad_controls_are_named(words, message):
    with pytest.raises(InputError) as told:
        lens_of(**words)
    assert str(told.value).startswith(message)


def test_a_focal_length_is_below_the_focus_distance():
    with pytest.raises(InputError, match="focal_length: got 3; allowed is less than the focus distance 2"):
        ExpressiveLens(0.1, 2.0, 3.0)


def test_a_table_says_what_the_lens_is():
    facts = lens_as_json(lens_of(**ALL, focal_surface=np.full((36, 48), math.inf)))["expressive"]
    assert facts["power"] == list(ALL["power"])
    assert facts["image_offset"] == list(ALL["image_offset"])
    assert facts["focal_surface"] == {"shape": [36, 48], "from": "inf", "to": "inf"}
    assert facts["aperture_scale"] == {"shape": [1, 1], "from": 1.0, "to": 1.0}

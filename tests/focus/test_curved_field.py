"""Curvature of field and the aperture's spline, by focus points: closed forms of thin lenses and of spots."""

import numpy as np
import pytest

from refdof import Camera, InputError, Material, Part, Scene, ThinLens, View, reference
from refdof.focus.aperture_spline import aperture_spline
from refdof.focus.focus_lens import Focus, focus_lens
from refdof.focus.point import FocusPoint, placed
from tests.flat_scene import rectangle, scene_of

CAMERA = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=40.0, size=(60, 40))
LENS = ThinLens(0.05, 4.0)
FOCAL, DEPTH = 0.25, 5.0
CARDS = (
    (-1.5, -0.5, 0.2, 1.0, DEPTH, (0.9, 0.5, 0.1)),
    (0.8, 2.0, -0.4, 0.9, DEPTH, (0.1, 0.9, 0.3)),
    (-0.9, 0.7, -1.3, -0.7, DEPTH, (0.3, 0.3, 0.9)),
    (-20.0, 20.0, -20.0, 20.0, 12.0, (0.2, 0.4, 0.8)),
)
NEARER, FARTHER = 0.02, -0.01  # image planes farther from the lens are those of nearer things


def cards():
    return View(scene_of([rectangle(*card) for card in CARDS], CAMERA, LENS), CAMERA, LENS)


def points(*offsets, **words):
    """A point in the middle of each of the first cards."""
    return tuple(
        FocusPoint(2 * k, (1.0, 0.0, 1.0), image_offset=offset, **words) for k, offset in enumerate(offsets)
    )  # between opposite corners


def image_distance(focus):
    return 1.0 / (1.0 / FOCAL - 1.0 / focus)


def distance_of(image):
    """What is in focus on an image plane so far behind the lens."""
    return 1.0 / (1.0 / FOCAL - 1.0 / image)


@pytest.mark.parametrize("kind", ["distance", "plane", "surface"])
@pytest.mark.parametrize("offset", [NEARER, FARTHER])
def test_one_even_offset_is_the_thin_lens_of_another_focus(kind, offset):
    """u = 1 / (4 - 0.2) moves to u + offset."""
    view = cards()
    lens = focus_lens(Focus(points(offset), kind, FOCAL), view)
    thin = ThinLens(LENS.radius, distance_of(1.0 / 3.8 + offset))
    assert (thin.focus_distance < DEPTH) == (offset > 0.0)
    np.testing.assert_allclose(lens.inverse_focus(CAMERA), 1.0 / thin.focus_distance, rtol=1e-12)
    image, wanted = (reference(view.scene, CAMERA, one, samples=64).image for one in (lens, thin))
    np.testing.assert_allclose(image, wanted, atol=1e-5)  # roundings of rays
    np.testing.assert_allclose(lens.coc_px(np.full((40, 60), 12.0), CAMERA), thin.coc_px(12.0, CAMERA), rtol=1e-9)


def offsets_of(lens):
    """The image plane's offset at every pixel, from what is in focus there, if even focus is `DEPTH`."""
    return 1.0 / (1.0 / FOCAL - lens.inverse_focus(CAMERA)) - image_distance(DEPTH)


def test_the_surface_of_offsets_is_the_plane_through_three_points():
    """Offsets a + b x + c y [px] of the points' places, kind `distance`."""
    view = cards()
    x, y = placed(list(points(0.0, 0.0, 0.0)), view).places.T
    plane = 0.004 + 2e-4 * x - 3e-4 * y
    lens = focus_lens(Focus(points(*plane), "distance", FOCAL), view)
    rows, columns = np.mgrid[:40, :60] + 0.5
    # Of 1e-10, three points' systems and the offset back out of 1 / d take the rest.
    np.testing.assert_allclose(offsets_of(lens), 0.004 + 2e-4 * columns - 3e-4 * rows, atol=1e-10)


@pytest.mark.parametrize("kind", ["distance", "plane", "surface"])
def test_each_point_has_its_own_offset_and_their_order_changes_no_bit(kind):
    view = cards()
    given = points(NEARER, FARTHER, 0.005, falloff=3.0)
    lens = focus_lens(Focus(given, kind, FOCAL), view)
    for (x, y), offset in zip(placed(list(given), view).places, (NEARER, FARTHER, 0.005), strict=True):
        found = offsets_of(lens)[int(y), int(x)]
        # The nearest pixel's centre is at most 0.7 px away, and the surface changes by 0.03 in 25 px.
        assert found == pytest.approx(offset, abs=1.5e-3)
    other = focus_lens(Focus((given[2], given[0], given[1]), kind, FOCAL), view)
    np.testing.assert_array_equal(lens.image_offset, other.image_offset)


def test_offsets_go_on_from_a_bent_and_from_a_tilted_plane():
    """At every pixel: the image plane of what is in focus without them, displaced."""
    view = cards()
    for kind in ("plane", "surface"):
        sharp = [FocusPoint(2 * k, (1.0, 0.0, 1.0), offset=further) for k, further in enumerate((0.0, 3.0, -1.0))]
        bent = [
            FocusPoint(2 * k, (1.0, 0.0, 1.0), offset=further, image_offset=0.01)
            for k, further in enumerate((0.0, 3.0, -1.0))
        ]
        before = focus_lens(Focus(tuple(sharp), kind, FOCAL), view).inverse_focus(CAMERA)
        after = focus_lens(Focus(tuple(bent), kind, FOCAL), view).inverse_focus(CAMERA)
        assert np.ptp(before) > 0.05
        plane = 1.0 / (1.0 / FOCAL - before)
        np.testing.assert_allclose(after, 1.0 / FOCAL - 1.0 / (plane + 0.01), rtol=1e-9)


def test_offsets_have_keyframes():
    view = cards()
    given = Focus(points(((0, 0.0), (10, 0.02))), "distance", FOCAL)
    for frame, offset in ((0, 0.0), (5, 0.01), (10, 0.02)):  # between two keys a cubic is half way in the middle
        inverse = focus_lens(given, view, frame).inverse_focus(CAMERA)
        np.testing.assert_allclose(inverse, 1.0 / distance_of(image_distance(DEPTH) + offset), rtol=1e-12)


def test_an_offset_before_the_lens_is_refused():
    with pytest.raises(InputError, match=r"image_offset: smallest value is -0\.3; allowed is more than -0\.263158"):
        focus_lens(Focus(points(-0.3), "distance", FOCAL), cards())


def test_splines_are_straight_in_the_square_of_the_radius_and_met_at_controls():
    radii = np.arange(61) / 60
    np.testing.assert_allclose(aperture_spline(((0.0, 1.0), (1.0, 1.02)), 1e-3), 1.0 + 0.02 * radii**2, rtol=1e-12)
    np.testing.assert_allclose(aperture_spline(((0.5, 3.0),), 0.0), 3.0, rtol=1e-12)
    bumpy = aperture_spline(((0.0, 1.0), (0.25, 2.0), (0.4, 0.5), (0.9, 1.5), (1.0, 0.0)), 0.0)
    found = [bumpy[round(60 * r)] for r in (0.0, 0.25, 0.4, 0.9, 1.0)]
    np.testing.assert_allclose(found, (1.0, 2.0, 0.5, 1.5, 0.0), atol=1e-12)
    assert min(bumpy) >= 0.0
    assert aperture_spline((), 0.0) == (1.0, 1.0)


# A lamp before the plane in focus, seen through a lens of spherical aberration and uneven bokeh.
LAMP = 1.5  # half of its side [px]
SPOT_RADIUS = 0.5  # of the lens
BEND, WEIGH = -0.01, 2.0  # power is 1 + BEND r^2, weights are 1 + WEIGH r^2


def test_the_spot_of_a_lamp_is_that_of_third_order_aberration():
    """A ray through r of the radius R from the lamp at z meets the picture q = P R r (1/d(r) - 1/z) from its middle.

    Its mean square is the integral of r w(r) q(r)^2 over that of r w(r), and of each axis half of this and the lamp's
    own (2 h)^2 / 12.
    """
    camera = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=20.0, size=(64, 64))
    pixels, depth, focus = camera.pixels_per_tangent, 4.0, 5.0
    half = LAMP * depth / pixels
    square = np.array([[-half, -half, -depth], [half, -half, -depth], [half, half, -depth], [-half, half, -depth]])
    glow = Material("unlit", base_color=(0.0, 0.0, 0.0), emission=(9.0, 9.0, 9.0))
    scene = Scene.from_parts("lamp", [Part(square, [[0, 1, 2], [0, 2, 3]], glow)], camera, LENS)
    view = View(scene, camera, ThinLens(SPOT_RADIUS, focus))
    spot = Focus(
        (FocusPoint(0, (1.0, 0.0, 1.0), offset=focus - depth),),
        "distance",
        FOCAL,
        power=((0.0, 1.0), (1.0, 1.0 + BEND)),
        ray_weights=((0.0, 1.0), (1.0, 1.0 + WEIGH)),
    )
    image = reference(scene, camera, focus_lens(spot, view), samples=1024).image[..., 1].astype(float)
    r = (np.arange(100_000) + 0.5) / 100_000
    weight = r * (1.0 + WEIGH * r**2)
    bent = pixels * SPOT_RADIUS * r * (1.0 / focus + BEND * r**2 / FOCAL - 1.0 / depth)
    wanted = 0.5 * (weight * bent**2).sum() / weight.sum() + (2.0 * LAMP) ** 2 / 12.0
    y, x = np.mgrid[:64, :64] - 31.5
    found = [(image * axis**2).sum() / image.sum() for axis in (x, y)]
    plain = 0.25 * (pixels * SPOT_RADIUS * (1.0 / focus - 1.0 / depth)) ** 2  # of an even disc, for scale
    assert wanted / plain > 2.0
    np.testing.assert_allclose(found, wanted, rtol=0.03)  # some 10 000 rays meet the lamp: 1 % of noise

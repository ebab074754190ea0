"""Focus points and the lens that follows them: places, visibility, keyframes, planes, surfaces, renders."""

import math
from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest

from refdof import Camera, InputError, Part, Scene, ThinLens, View, metrics, reference, render
from refdof.focus.focal_plane import focal_plane
from refdof.focus.focus_lens import Focus, focus_lens
from refdof.focus.point import FocusPoint, Placed, pick, placed
from tests.flat_scene import paint, rectangle, scene_of

CAMERA = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=40.0, size=(60, 40))
LENS = ThinLens(0.05, 4.0)
LEFT, RIGHT = 0, 2  # triangles of the two cards


def two_cards():
    """A near card to the left, a far one to the right, a wall behind."""
    parts = [
        rectangle(-1.0, -0.2, -0.6, 0.6, 3.0, (0.9, 0.5, 0.1)),
        rectangle(0.4, 2.0, -1.0, 1.0, 6.0, (0.1, 0.9, 0.3)),
        rectangle(-20.0, 20.0, -20.0, 20.0, 12.0, (0.2, 0.4, 0.8)),
    ]
    return View(scene_of(parts, CAMERA, LENS), CAMERA, LENS)


def point(triangle, **words):
    return FocusPoint(triangle, (1.0, 1.0, 1.0), **words)


def test_pick_finds_the_place_under_a_pixel():
    view = two_cards()
    for x, y in ((14, 20), (45, 12), (3, 3)):
        found = placed([pick(view, (x, y))], view)
        np.testing.assert_allclose(found.places[0], [x + 0.5, y + 0.5], atol=1e-9)
        assert found.depth[0] == pytest.approx(view.pinhole().depth[y, x], rel=1e-6)  # depth is float32
    with pytest.raises(InputError, match="pixel: got 60,0; allowed is 0,0 to 59,39"):
        pick(view, (60, 0))
    empty = View(scene_of([rectangle(-0.1, 0.1, -0.1, 0.1, 3.0)], CAMERA, LENS), CAMERA, LENS)
    with pytest.raises(InputError, match="pixel: got 0,0, which shows the background"):
        pick(empty, (0, 0))


def test_points_follow_their_triangle():
    view = two_cards()
    farther = replace(view.scene, vertices=view.scene.vertices + np.array([0.0, 0.0, -0.5]))
    found = placed([point(LEFT)], View(farther, CAMERA, LENS))
    assert found.depth[0] == pytest.approx(3.5)


def weight_of(one, view):
    """The weight of a single point; 0 if it does not count."""
    with suppress(InputError):
        return placed([one], view).weight[0]
    return 0.0


def moved(part, x):
    return Part(part.vertices + np.array([x, 0.0, 0.0]), part.faces, part.material)


def test_hidden_and_outside_points_fade_out():
    near = rectangle(-1.0, 0.0, -5.0, 5.0, 2.0)
    far = Part(np.array([[-0.02, -0.01, -4.0], [0.0, 0.01, -4.0], [0.02, -0.01, -4.0]]), [[0, 1, 2]], paint((1, 1, 1)))
    weights = []
    for x in (-0.4, -0.05, 0.0, 0.05, 0.4):  # from behind the card out into the open
        parts = [near, moved(far, x)]
        view = View(scene_of(parts, CAMERA, LENS), CAMERA, LENS)
        weights.append(weight_of(point(2), view))
    assert weights[0] == 0.0
    with pytest.raises(InputError, match="points: none of them is in the picture"):
        placed([point(0, weight=0.0)], view)
    assert weights == sorted(weights)
    assert 0.0 < weights[2] < 1.0
    assert weights[4] == 1.0
    # 0.1 of the height beyond the right border, at depth 4: P = 20 / tan 20 deg; 34 px are 2.475 units, 32 px are 2.33.
    scale = 4.0 * math.tan(math.radians(20.0)) / 20.0
    shares = []
    for pixels in (30.0, 32.0, 34.1):
        view = View(
            scene_of([moved(far, pixels * scale)], CAMERA),
            CAMERA,
            LENS,
        )
        shares.append(weight_of(point(0), view))
    np.testing.assert_allclose(shares, [1.0, 0.5, 0.0], atol=0.01)
    assert placed([point(0, keep=True)], view).weight[0] == 1.0


def test_keyframes_are_smooth_and_constant_beyond():
    moving = point(LEFT, offset=((0, 0.0), (10, 1.0), (20, 0.5)))
    frames = np.linspace(-5.0, 25.0, 6001)
    values = np.array([moving.value("offset", frame) for frame in frames])
    assert values[0] == 0.0
    assert values[-1] == 0.5
    assert moving.value("offset", 10) == 1.0
    slopes = np.diff(values) / np.diff(frames)
    assert np.abs(np.diff(slopes)).max() < 2e-3  # C1: steps of 0.005 times a second derivative of at most 0.06 or so
    assert point(LEFT, offset=[[3, 0.25]]).value("offset", 100) == 0.25


def placed_at(places, focus, weight=None):
    count = len(focus)
    focus = np.asarray(focus, dtype=float)
    return Placed(
        np.asarray(places, dtype=float), focus, focus, np.ones(count), np.ones(count) if weight is None else weight,
        np.full(count, 3.0), np.zeros(count), np.ones(count),
    )  # fmt: skip


def test_the_plane_goes_through_three_points():
    found = placed_at([[10.0, 5.0], [50.0, 9.0], [30.0, 35.0]], [3.0, 6.0, 4.0])
    inverse = focal_plane(found, CAMERA).inverse_focus(CAMERA)
    for (x, y), depth in zip(found.places, found.focus, strict=True):
        assert 1.0 / inverse[int(y), int(x)] == pytest.approx(depth, rel=0.05)  # half a pixel beside
    plane = focal_plane(found, CAMERA)
    slopes = (found.places - [30.0, 20.0]) * [1.0, -1.0] / CAMERA.pixels_per_tangent
    points = np.column_stack([found.focus, found.focus[:, None] * slopes])
    np.testing.assert_allclose(points @ plane.coefficients, 1.0, rtol=1e-9)


def test_one_point_gives_an_upright_plane_and_two_the_least_tilted():
    one = focal_plane(placed_at([[12.0, 30.0]], [5.0]), CAMERA)
    np.testing.assert_allclose(one.coefficients, [0.2, 0.0, 0.0], atol=1e-15)
    two = focal_plane(placed_at([[10.0, 20.0], [50.0, 20.0]], [4.0, 5.0]), CAMERA)
    assert two.coefficients[2] == pytest.approx(0.0, abs=1e-12)
    assert two.coefficients[0] == pytest.approx((0.25 + 0.2) / 2.0)


def test_the_tilt_is_limited():
    """Points that all but lie on one view vector: 1 unit away on one pixel, 1000 on the next."""
    plane = focal_plane(placed_at([[30.0, 20.0], [31.0, 20.0]], [1.0, 1000.0]), CAMERA)
    assert plane.coefficients[1] == pytest.approx(-10.0)  # not the -55 that the points ask for
    slope = 0.5 / CAMERA.pixels_per_tangent  # it turns about the points' middle
    assert plane.coefficients[0] + plane.coefficients[1] * slope == pytest.approx((1.0 + 0.001) / 2.0)


def test_scheimpflug_and_hinge_rule():
    """Merklinger's rules by hand: F 50 mm, a lens 1.5 m above a ground that shall be sharp: sin(tilt) = F / J.

    The ground meets the plane of the lens 1.5 m below it. A view camera tilts its lens by asin(0.05 / J), where J is
    the hinge's distance in the direction of the image plane.
    """
    focal_length, height = 0.05, 1.5
    places = np.array([[10.0, 30.0], [50.0, 30.0], [30.0, 39.0]])
    ground = focal_plane(placed_at(places, height * CAMERA.pixels_per_tangent / (places[:, 1] - 20.0)), CAMERA)
    np.testing.assert_allclose(ground.coefficients, [0.0, 0.0, -1.0 / height], atol=1e-12)
    distance, about_x, about_y = ground.image_plane(focal_length)
    assert distance == pytest.approx(
        focal_length, rel=1e-9
    )  # the horizon is sharp where the axis meets the image plane
    assert math.degrees(math.atan(focal_length / height)) == pytest.approx(about_x, rel=1e-9)
    assert about_y == pytest.approx(0.0, abs=1e-9)
    tilted = focal_plane(placed_at([[10.0, 5.0], [50.0, 9.0], [30.0, 35.0]], [3.0, 6.0, 4.0]), CAMERA)
    a, b, c = tilted.coefficients
    distance, about_x, about_y = tilted.image_plane(focal_length)
    # Scheimpflug: where the image plane u = distance + tan(t_x) y' + tan(t_y) x' has u = 0, B x + C y = 1 holds.
    for x in (-0.3, 0.2):
        y = -(distance + math.tan(math.radians(about_y)) * x) / math.tan(math.radians(about_x))
        assert b * x + c * y == pytest.approx(1.0, rel=1e-9)
    # Hinge: points (F, x, y) before the lens that lie on the plane are F / sin(tilt) from the lens's centre.
    size = math.hypot(b, c)
    along = (1.0 - a * focal_length) / size
    tilt = math.atan(math.hypot(math.tan(math.radians(about_x)), math.tan(math.radians(about_y))))
    assert math.hypot(along, focal_length) == pytest.approx(focal_length / math.sin(tilt), rel=1e-9)


def test_a_plane_in_the_tilted_focal_plane_is_sharp():
    """A tilted striped wall: with the lens of three of its points, the reference is the pinhole's picture."""
    corners = np.array([[-3.0, -2.0, -3.0], [3.0, -2.0, -5.0], [3.0, 2.0, -8.0], [-3.0, 2.0, -6.0]])
    parts = []
    for k in range(12):
        low, high = corners[0] + (corners[1] - corners[0]) * k / 12, corners[3] + (corners[2] - corners[3]) * k / 12
        low2, high2 = (
            corners[0] + (corners[1] - corners[0]) * (k + 1) / 12, corners[3] + (corners[2] - corners[3]) * (k + 1) / 12
        )  # fmt: skip
        parts.append(Part(np.array([low, low2, high2, high]), [[0, 1, 2], [0, 2, 3]], paint((k % 2, 0.5, 1.0 - k % 2))))
    view = View(scene_of(parts, CAMERA, ThinLens(0.3, 5.0), (0.5, 0.5, 0.5)), CAMERA, ThinLens(0.3, 5.0))
    points = tuple(pick(view, pixel) for pixel in ((12, 30), (45, 28), (32, 12)))
    lens = focus_lens(Focus(points, "plane"), view)
    pinhole = view.pinhole().color
    truth = reference(view.scene, CAMERA, lens, samples=64)
    inside = (slice(2, -2), slice(2, -2))
    np.testing.assert_allclose(truth.image[inside], pinhole[inside], atol=1e-6)
    blurred = reference(view.scene, CAMERA, view.lens, samples=64)
    assert metrics.rmse(blurred.image[inside], pinhole[inside]) > 0.05
    sharp = render("lensblur", view.scene, CAMERA, lens, samples=64).image
    assert metrics.rmse(sharp[inside], pinhole[inside]) < 0.01


def test_a_free_surface_makes_two_depths_sharp_and_the_middle_not():
    view = two_cards()
    lens = focus_lens(Focus((point(LEFT), point(RIGHT), point(4, weight=0.2, offset=-8.0))), view)
    inverse = lens.inverse_focus(CAMERA)
    found = placed([point(LEFT), point(RIGHT)], view)
    for (x, y), depth in zip(found.places, found.depth, strict=True):
        assert 1.0 / inverse[int(y), int(x)] == pytest.approx(depth, rel=0.1)
    even = focus_lens(Focus((point(LEFT),)), view)
    np.testing.assert_allclose(1.0 / even.inverse_focus(CAMERA), 3.0, rtol=1e-12)
    assert isinstance(lens, ThinLens)


def test_kinds_of_one_point_are_one_lens():
    view = two_cards()
    images = [
        reference(view.scene, CAMERA, focus_lens(Focus((point(RIGHT),), kind), view), samples=64).image
        for kind in ("distance", "plane", "surface")
    ]
    thin = reference(view.scene, CAMERA, ThinLens(LENS.radius, 6.0), samples=64).image
    for image in images:
        np.testing.assert_allclose(image, thin, atol=1e-5)


def test_aperture_scale_is_a_smaller_lens():
    view = two_cards()
    half = focus_lens(Focus((point(LEFT, aperture=0.5),), "distance"), view)
    wanted = reference(view.scene, CAMERA, ThinLens(LENS.radius / 2.0, 3.0), samples=64).image
    np.testing.assert_allclose(reference(view.scene, CAMERA, half, samples=64).image, wanted, atol=1e-5)
    circle = half.coc_px(np.full((40, 60), 12.0), CAMERA)
    np.testing.assert_allclose(circle, float(ThinLens(LENS.radius / 2.0, 3.0).coc_px(12.0, CAMERA)), rtol=1e-9)


def test_with_size_shares_triangles_and_makes_all_else_anew():
    view = two_cards()
    view.layers(1)
    tracer = view.tracer()
    other, fresh = view.with_size((37, 21)), View(view.scene, CAMERA.with_size((37, 21)), LENS)
    assert other.tracer() is tracer
    assert other.camera == fresh.camera
    for mine, its in zip(other.layers(None), fresh.layers(None), strict=True):
        np.testing.assert_array_equal(mine, its)


def test_with_lens_shares_what_a_lens_does_not_change():
    view = two_cards()
    render("lensblur", view.scene, CAMERA, view.lens, samples=4)
    first, _ = view.layers(1), view.pinhole()
    other = view.with_lens(ThinLens(LENS.radius, 9.0))
    assert other.layers(1) is first
    assert other.pinhole() is view.pinhole()
    umbra = view.umbra_layers(4, 2)
    assert view.with_lens(ThinLens(LENS.radius, 9.0)).umbra_layers(4, 2) is umbra
    assert view.with_lens(ThinLens(LENS.radius * 2.0, 9.0)).umbra_layers(4, 2) is not umbra


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: point(-1), "triangle: got -1"),
        (lambda: FocusPoint(0, (0.0, 0.0, 0.0)), "barycentrics: all are 0"),
        (lambda: point(0, aperture=1.5), "aperture: got 1.5"),
        (lambda: point(0, weight=[[0, 1.0], [0, 2.0]]), "weight: frames of keyframes do not grow"),
        (lambda: point(0, falloff=0.5), "falloff: got 0.5"),
        (lambda: Focus(()), "points: got 0; allowed are 1 to 256"),
        (lambda: Focus((point(0),), "tilt"), "kind: got 'tilt'"),
        (lambda: focus_lens(Focus((point(99),)), two_cards()), "triangle: got 99; the scene has 6"),
        (lambda: focus_lens(Focus((point(0, offset=-3.0),)), two_cards()), "offset: puts the focus at 0"),
        (lambda: focus_lens(Focus((point(0),), focal_length=3.5), two_cards()), "focal_length: got 3.5"),
    ],
)
def test_bad_points_are_named(make, message):
    with pytest.raises(InputError) as told:
        make()
    assert str(told.value).startswith(message)


def test_a_scene_without_surfaces_has_no_points():
    view = View(Scene.from_parts("empty", [], CAMERA, LENS), CAMERA, LENS)
    with pytest.raises(InputError, match="triangle: got 0; the scene has 0"):
        placed([point(0)], view)

"""Apertures: shape, orientation and uniformity, against geometry built here and closed forms."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import chisquare
from shapely import Polygon, affinity, box

from refdof import Camera, ThinLens
from refdof._check import InputError
from refdof.optics.aperture import Aperture
from refdof.optics.lens_maps import concentric_disc
from refdof.raster.rays.umbra import umbra_step

pytestmark = pytest.mark.fast


def midpoints(n):
    """(n * n, 2) centres of a grid of the unit square."""
    u, v = np.meshgrid((np.arange(n) + 0.5) / n, (np.arange(n) + 0.5) / n)
    return np.stack([u.ravel(), v.ravel()], axis=1)


def outline(blades, rotation, curvature, ratio=1.0):
    """The aperture as a dense polygon: arcs through corners on the unit circle, with 2000 chords each."""
    half = math.pi / blades
    height = curvature * (1.0 - math.cos(half))
    points = []
    for k in range(blades):
        angle = 2.0 * half * k + half + math.radians(rotation)
        across = np.linspace(math.sin(half), -math.sin(half), 2001)[:-1]
        if height > 0.0:
            radius = (math.sin(half) ** 2 + height**2) / (2.0 * height)
            rise = np.sqrt(np.maximum(radius**2 - across**2, 0.0)) - (radius - height)
        else:
            rise = np.zeros_like(across)
        x, y = math.cos(half) + rise, -across
        points.append(np.stack([x * math.cos(angle) - y * math.sin(angle), x * math.sin(angle) + y * math.cos(angle)]))
    shape = Polygon(np.concatenate(points, axis=1).T)
    return affinity.scale(shape, min(1.0, ratio), min(1.0, 1.0 / ratio), origin=(0, 0))


def area(boundary):
    return Polygon(boundary).area


def circle_from_square(u, v):
    """Shirley and Chiu's map with the mathematics library's sine and cosine."""
    a, b = 2 * u - 1, 2 * v - 1
    if a == 0 and b == 0:
        return 0.0, 0.0
    if a * a > b * b:
        r, phi = a, math.pi / 4 * b / a
    else:
        r, phi = b, math.pi / 2 - math.pi / 4 * a / b
    return r * math.cos(phi), r * math.sin(phi)


unit = st.floats(0.0, 1.0)


@given(u=unit, v=unit)
@settings(max_examples=300, deadline=None)
def test_concentric_map_agrees_with_the_mathematics_library(u, v):
    # Angle and product are rounded a few times, half an ulp (1.1e-16) each.
    np.testing.assert_allclose(concentric_disc(u, v), circle_from_square(u, v), rtol=0, atol=1e-15)


def test_concentric_map_fixes_the_middles_of_the_sides():
    sides = [(1.0, 0.5), (0.5, 1.0), (0.0, 0.5), (0.5, 0.0), (0.5, 0.5)]
    # Right, top, left, bottom, centre; all exact.
    assert [concentric_disc(u, v) for u, v in sides] == [(1, 0), (0, 1), (-1, 0), (0, -1), (0, 0)]


shapes = st.one_of(
    st.builds(Aperture.disc, st.floats(0.1, 10.0)),
    st.builds(Aperture.polygon, st.integers(3, 64), st.floats(-720, 720), unit, st.floats(0.1, 10.0)),
)


@given(aperture=shapes, square=st.lists(st.tuples(unit, unit), min_size=1, max_size=8))
@settings(max_examples=150, deadline=None)
def test_no_point_leaves_the_lens(aperture, square):
    points = aperture.from_square(np.array(square))
    assert points.shape == (len(square), 2)
    assert np.hypot(points[:, 0], points[:, 1]).max() <= 1.0 + 1e-15  # a few roundings of 1.1e-16
    assert (aperture.transmission(points) == 1.0).all()


@pytest.mark.parametrize(
    ("blades", "rotation", "curvature", "ratio"),
    [(3, 0, 0, 1), (5, 18, 0, 1), (6, 10, 0.5, 1), (4, 45, 1, 1), (9, 0, 0.3, 2), (64, 3, 0, 0.5)],
)
def test_polygons_are_uniform(blades, rotation, curvature, ratio):
    count = 40_000
    points = Aperture.polygon(blades, rotation, curvature, ratio).from_square(
        np.random.default_rng(blades).random((count, 2))
    )
    shape = outline(blades, rotation, curvature, ratio)
    edges = np.linspace(-1.0, 1.0, 13)
    found, _, _ = np.histogram2d(points[:, 0], points[:, 1], bins=[edges, edges])
    expected = np.array(
        [[shape.intersection(box(x, y, x + 1 / 6, y + 1 / 6)).area for y in edges[:-1]] for x in edges[:-1]]
    )
    expected *= count / shape.area
    rare = expected < 10.0  # too few for the chi-square law: added to the least of the others
    least = np.unravel_index(np.argmin(np.where(rare, np.inf, expected)), expected.shape)
    for table in (found, expected):
        table[least] += table[rare].sum()
    # Six cases share a false alarm rate of 1e-3 (Sidak); points and seed are fixed.
    alarm = 1.0 - (1.0 - 1e-3) ** (1.0 / 6.0)
    wanted = expected[~rare] * (count / expected[~rare].sum())  # the same but for roundings
    assert chisquare(found[~rare], wanted).pvalue > alarm


def test_disc_is_uniform():
    count = 40_000
    x, y = Aperture.disc().from_square(np.random.default_rng(7).random((count, 2))).T
    ring = np.minimum((x * x + y * y) * 8, 7).astype(int)  # equal areas: r^2 is uniform
    sector = np.minimum((np.arctan2(y, x) / (2 * np.pi) % 1.0) * 16, 15).astype(int)
    assert chisquare(np.bincount(ring * 16 + sector, minlength=128)).pvalue > 1e-3  # false alarm rate


@pytest.mark.parametrize("blades", [3, 4, 6, 64])
def test_straight_blades_have_the_area_of_the_polygon(blades):
    closed_form = blades / 2.0 * math.sin(2.0 * math.pi / blades)
    assert area(Aperture.polygon(blades, rotation=11.0).boundary) == pytest.approx(closed_form, rel=1e-13)  # roundings


@pytest.mark.parametrize("blades", [3, 4, 6, 64])
def test_full_curvature_is_the_disc(blades):
    boundary = Aperture.polygon(blades, curvature=1.0).boundary
    np.testing.assert_allclose(np.hypot(*boundary.T), 1.0, atol=1e-12)  # roundings, magnified by the arc's centre
    # 64 chords per blade: each loses theta^2 / 6 of its sector, 1.8e-4 with three blades; next comes theta^4 / 120.
    loss = (2 * math.pi / 64 / blades) ** 2 / 6
    assert 1 - area(boundary) / math.pi == pytest.approx(loss, rel=1e-3)
    assert round(1e4 * (2 * math.pi / 64 / 3) ** 2 / 6, 1) == 1.8


@pytest.mark.parametrize("curvature", [0.1, 0.5, 0.9])
def test_curved_blades_have_the_area_of_polygon_and_segments(curvature):
    half = math.pi / 5
    height = curvature * (1 - math.cos(half))
    radius = (math.sin(half) ** 2 + height**2) / (2 * height)
    swing = 2 * math.asin(math.sin(half) / radius)
    closed_form = 2.5 * math.sin(2 * half) + 5 * radius**2 / 2 * (swing - math.sin(swing))
    # The chords lose less than those of the full circle, (2 pi / 320)^2 / 6 < 7e-5.
    assert area(Aperture.polygon(5, curvature=curvature).boundary) == pytest.approx(closed_form, rel=7e-5)


@pytest.mark.parametrize(("blades", "curvature"), [(3, 0.0), (6, 0.4), (3, 0.8), (7, 1.0)])
def test_all_sectors_have_the_same_area(blades, curvature):
    a = Aperture.polygon(blades, 20.0, curvature).boundary
    b = np.roll(a, -1, axis=0)
    sectors = (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2.0
    assert (sectors > 0).all()  # counter-clockwise
    # Cuts are interpolated on 4096 steps (relative error 1e-7); a chord's loss, 2e-4 at most, differs along
    # an arc that is not round the centre by less than itself.
    np.testing.assert_allclose(sectors, sectors.mean(), rtol=2e-4)


def test_rotation_is_counter_clockwise_from_the_right():
    triangle = Aperture.polygon(3).boundary
    half, tall = 0.5, math.sqrt(3.0) / 2.0
    np.testing.assert_allclose(triangle, [[1, 0], [-half, tall], [-half, -tall]], atol=1e-15)
    turned = Aperture.polygon(3, rotation=90.0).boundary
    np.testing.assert_allclose(turned, [[0, 1], [-tall, -half], [tall, -half]], atol=1e-15)


@pytest.mark.parametrize(("ratio", "width", "height"), [(0.5, 0.5, 1.0), (1.0, 1.0, 1.0), (4.0, 1.0, 0.25)])
def test_anamorphic_discs_have_the_moments_of_an_ellipse(ratio, width, height):
    x, y = Aperture.disc(ratio).from_square(midpoints(64)).T
    # Half-axes a and b: mean x^2 = a^2 / 4, mean y^2 = b^2 / 4. The midpoint rule is off by order 1 / 64^2.
    assert np.mean(x * x) == pytest.approx(width**2 / 4, rel=1e-3)
    assert np.mean(y * y) == pytest.approx(height**2 / 4, rel=1e-3)
    np.testing.assert_allclose([x.mean(), y.mean(), np.mean(x * y)], 0.0, atol=1e-15 * 64)  # mirrored pairs cancel


def test_an_image_has_its_first_row_at_the_top():
    bright = np.zeros((8, 8))
    bright[0, 3:5] = 1.0
    aperture = Aperture.image(bright)
    assert aperture.is_image
    assert aperture.transmission([[0.0, 0.9], [0.0, -0.9], [0.9, 0.0], [-0.9, 0.0]]).tolist() == [1, 0, 0, 0]
    bright = np.zeros((4, 4))
    bright[1:3, 3] = 1.0  # the last column is on the right
    assert Aperture.image(bright).transmission([[0.9, 0.0], [-0.9, 0.0]]).tolist() == [1, 0]


def test_an_image_gets_points_in_proportion_to_its_light():
    weights = np.zeros((8, 8))
    weights[3:5, 3:5] = [[1.0, 0.5], [0.25, 0.0]]
    aperture = Aperture.image(weights)
    x, y = aperture.from_square(midpoints(64)).T
    found = np.zeros((8, 8))
    np.add.at(found, (np.floor((1 - y) * 4).astype(int), np.floor((x + 1) * 4).astype(int)), 1 / 64**2)
    # Rows get 6/7 and 1/7 of the 64 rows of points, to within one; the first row's texels 2/3 and 1/3 of its points.
    np.testing.assert_allclose(found, weights / 1.75, atol=1 / 64)
    assert (aperture.transmission(np.stack([x, y], axis=1)) > 0).all()


@pytest.mark.parametrize("corner", [0.0, 1.0])
def test_no_rounding_takes_a_point_to_an_opaque_texel(corner):
    weights = np.zeros((7, 7))
    weights[2, 3], weights[5, 1] = 1.0, 3.0
    aperture = Aperture.image(weights)
    ends = np.array([[u, v] for u in (corner, 0.5) for v in (0.0, 0.25, np.nextafter(0.25, 0), 1.0)])
    assert (aperture.transmission(aperture.from_square(ends)) > 0).all()


def test_reach_is_the_farthest_corner_of_a_clear_texel():
    assert Aperture.disc().reach == Aperture.polygon(3).reach == Aperture.gaussian().reach == 1.0
    assert Aperture.image(np.ones((1, 1))).reach == pytest.approx(math.sqrt(2), rel=1e-15)
    assert Aperture.image(np.ones((5, 5))).reach == pytest.approx(math.hypot(1.0, 0.6), rel=1e-15)
    small = np.zeros((5, 5))
    small[2, 2] = 1.0
    assert Aperture.image(small).reach == 1.0
    shot = Camera.look_at((0, 0, 0), (0, 0, -1), size=(8, 6))
    wide, disc = (umbra_step(shot, ThinLens(0.5, 2.0, a)) for a in (Aperture.image(np.ones((1, 1))), Aperture.disc()))
    assert wide == pytest.approx(disc / math.sqrt(2), rel=1e-14)  # a wider aperture sees past more


def test_an_image_is_opaque_outside_the_disc_and_scaled_to_one():
    aperture = Aperture.image(np.full((5, 5), 3.0))
    assert aperture.weights.max() == 1.0
    # Texel centres are at 0, +-0.4, +-0.8: only those at (+-0.8, +-0.8) lie outside, 0.64 + 0.64 > 1.
    assert aperture.weights.sum() == 21.0
    assert aperture.weights[[0, 0, -1, -1], [0, -1, 0, -1]].tolist() == [0, 0, 0, 0]


def test_an_image_is_squeezed_with_its_disc():
    bright = np.zeros((4, 4))
    bright[1:3, 3] = 1.0
    points = [[0.4, 0.0], [0.9, 0.0], [0.2, 0.0]]
    # At half the width the last column covers x in 0.25 .. 0.5; points beyond are outside the aperture.
    assert Aperture.image(bright, ratio=0.5).transmission(points)[[0, 2]].tolist() == [1, 0]


def test_the_given_image_is_not_changed():
    weights = np.full((4, 4), 2.0)
    Aperture.image(weights)
    assert (weights == 2.0).all()


BAD = [
    (lambda: Aperture.polygon(2), "blades"),
    (lambda: Aperture.polygon(65), "blades"),
    (lambda: Aperture.polygon(5.5), "blades"),
    (lambda: Aperture.polygon(5, rotation=math.nan), "rotation"),
    (lambda: Aperture.polygon(5, curvature=-0.1), "curvature"),
    (lambda: Aperture.polygon(5, curvature=1.1), "curvature"),
    (lambda: Aperture.polygon(5, ratio=0.0), "ratio"),
    (lambda: Aperture.disc(math.inf), "ratio"),
    (lambda: Aperture.disc(-1.0), "ratio"),
    (lambda: Aperture.image(np.zeros((4, 4))), "weights"),
    (lambda: Aperture.image(np.zeros((0, 0))), "weights"),
    (lambda: Aperture.image(np.full((4, 4), -1.0)), "weights"),
    (lambda: Aperture.image(np.full((4, 4), math.nan)), "weights"),
    (lambda: Aperture.image(np.ones((4, 4, 3))), "weights"),
    (lambda: Aperture.disc().from_square([[0.5, math.nan]]), "square"),
    (lambda: Aperture.disc().from_square([[-0.1, 0.5]]), "square"),
    (lambda: Aperture.disc().from_square([0.5, 0.5]), "square"),
    (lambda: Aperture.disc().transmission([[0.5, 0.5, 0.5]]), "points"),
]


@pytest.mark.parametrize(("call", "name"), BAD)
def test_bad_arguments_are_named(call, name):
    with pytest.raises(InputError, match=f"^{name}: "):
        call()

"""The reference against closed forms: points, edges, slits, holes, slanted planes and waves."""

import numpy as np
import pytest

import refdof
from refdof import Part, ThinLens
from tests import flat_scene
from tests.closed_forms import circle_of_confusion, half_disc, jinc, mean_reciprocal, two_discs

# Pixels are held against their own error bars, which 16 replicates make steady enough.
# Seeds are fixed, so that a test passes or fails for good. One value in 2000 of Student's t with 15 degrees of
# freedom is beyond 4.4; sums over many pixels are nearly normal, and there 4 means one in 15000.
T, Z = 6.0, 4.0
ROUNDING = 2e-7  # pictures are float32: relative 6e-8, and as much for colours


def unseen(samples):
    """A share of the lens that all samples may have missed: above it, but for one case in e^10."""
    return 10.0 / samples


def assert_close(result, truth, bias=0.0):
    """Assert that a picture is the grey `truth` (H, W) within its error bars and a known bias."""
    error = np.abs(result.image - truth[..., None])
    room = T * result.standard_error + unseen(result.samples)[..., None] + bias + ROUNDING
    assert (error <= room).all(), (error / room).max()
    # Not only within: as many hits and misses as error bars say. Student's t has a variance of 15 / 13.
    spread = result.standard_error[..., 0] > 1e-5
    if spread.sum() >= 30 and bias == 0.0:
        z = (error / np.where(result.standard_error > 0, result.standard_error, 1.0))[..., 0][spread]
        assert np.sqrt(np.mean(np.minimum(z, T) ** 2)) < 1.6


@pytest.mark.parametrize(("depth", "focus"), [(2.0, 1.0), (0.8, 1.5), (3.0, np.inf)])
def test_a_small_lamp_becomes_an_even_disc(depth, focus):
    p, side, size = 20.0, 1.0, 25
    lens = ThinLens(7.0 / (p * abs(1.0 / focus - 1.0 / depth)), focus)  # a disc of 7 pixels
    half = 0.5 * side * depth / p
    lamp = flat_scene.rectangle(-half, half, -half, half, depth, (100.0, 50.0, 0.0))
    shot = flat_scene.camera(size, size, p)
    result = refdof.reference(
        flat_scene.scene_of([lamp], shot), shot, lens, samples=1024, replicates=16, pixel_filter="box"
    )
    red = result.image[..., 0].astype(float)
    error = np.sqrt((result.standard_error[..., 0].astype(float) ** 2).sum())
    # A lamp of one square pixel and radiance 100 sends flux 100. Every pixel has a pattern of its own.
    assert red.sum() == pytest.approx(100.0, abs=Z * error)
    np.testing.assert_allclose(result.image[..., 1], result.image[..., 0] / 2, rtol=1e-6)  # float32
    assert (result.image[..., 2] == 0.0).all()

    x, y = np.meshgrid(np.arange(size) - size // 2, np.arange(size) - size // 2)
    distance = np.hypot(x, y)
    # Lamp and pixel are squares of one pixel, at most sqrt(2) from centre to centre together.
    assert (red[distance > 7.0 + np.sqrt(2)] == 0.0).all()
    inside = distance < 7.0 - np.sqrt(2)
    flat = 100.0 / (np.pi * 49.0)
    assert (np.abs(red - flat)[inside] <= T * result.standard_error[..., 0][inside]).all()
    assert red[inside].mean() == pytest.approx(flat, abs=Z * error / inside.sum())
    # Variance of a disc r^2 / 4, of the lamp and of the pixel side^2 / 12 each; weights bounded by (r + sqrt 2)^2.
    variance = 49.0 / 4.0 + 2.0 / 12.0
    for offset in (x, y):
        assert (red * offset).sum() == pytest.approx(0.0, abs=Z * error * 8.5)
        assert (red * offset**2).sum() / 100.0 == pytest.approx(variance, abs=Z * error * 8.5**2 / 100.0)


EDGES = [(1.0, 2.0, 0.2), (2.0, 1.0, 0.2), (1.5, np.inf, 0.1), (4.0, 0.5, 0.05), (1.9, 2.0, 0.5)]


@pytest.mark.parametrize(("depth", "focus", "radius"), EDGES)
@pytest.mark.parametrize("background", [0.25, 3.0])
def test_half_plane(depth, focus, radius, background):
    p, edge = 32.0, 0.3
    shot, lens = flat_scene.camera(32, 4, p), ThinLens(radius, focus)
    near = flat_scene.rectangle(-50.0, edge * depth / p, -50.0, 50.0, depth)  # its edge is at 0.3 px in every view
    scene = flat_scene.scene_of([near], shot, background=(background,) * 3)
    coc = abs(p * radius * (1 / focus - 1 / depth))
    share = half_disc((edge - flat_scene.tangents(32, 4, p)[0] * p) / coc)
    assert_close(refdof.reference(scene, shot, lens, samples=1024, replicates=16), share + background * (1.0 - share))


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize("beyond", [0.0, 0.7])
def test_an_edge_hides_what_the_same_part_of_the_lens_would_see(side, beyond):
    # One pixel on the axis, P = 1. Through lens point v it sees position -coc v. Of what lies beyond the edge,
    # the lens part v < -0.4 sees white and the rest grey; the edge itself is black for v > 0.2.
    lens, shot = ThinLens(0.25, 4.0 if side < 0 else 0.5), flat_scene.camera(1, 1, 1.0)
    depths = (1.0, 2.0)
    c1, c2 = (0.25 * (1 / lens.focus_distance - 1 / d) for d in depths)
    e1, e2 = -c1 * 0.2 * depths[0], -c2 * -0.4 * depths[1]
    far = side * 50.0
    black = flat_scene.rectangle(*sorted([e1, -far]), -50, 50, depths[0], (beyond,) * 3)
    white = flat_scene.rectangle(*sorted([e2, far]), -50, 50, depths[1], (1.0,) * 3)
    grey = flat_scene.rectangle(*sorted([e2, -far]), -50, 50, depths[1], (0.5,) * 3)
    result = refdof.reference(
        flat_scene.scene_of([black, white, grey], shot), shot, lens, samples=1 << 18, replicates=16
    )
    # By hand: G(-0.4) = 0.25232, G(0.2) = 0.62647; 0.25232 + 0.5 (0.62647 - 0.25232) = 0.43939.
    truth = 0.43939 + beyond * (1.0 - 0.62647)
    assert np.abs(result.image - truth).max() <= T * result.standard_error.max() + 1e-5  # five printed digits
    # What independent coverages would make of it: 0.62647 (0.25232 + 0.5 0.74768) = 0.39227.
    blended = 0.39227 + beyond * (1.0 - 0.62647)
    assert np.abs(result.image - blended).min() > 20.0 * result.standard_error.max()


@pytest.mark.parametrize(("depth", "focus"), [(1.0, 2.0), (3.0, 1.0)])
def test_slit(depth, focus):
    p, radius, left, right = 24.0, 0.4, -1.2, 2.5
    shot, lens = flat_scene.camera(24, 3, p), ThinLens(radius, focus)
    walls = [
        flat_scene.rectangle(-50, left * depth / p, -50, 50, depth, (0.0,) * 3),
        flat_scene.rectangle(right * depth / p, 50, -50, 50, depth, (0.0,) * 3),
    ]
    coc = abs(circle_of_confusion(p, radius, focus, depth))
    x = flat_scene.tangents(24, 3, p)[0] * p
    share = half_disc((right - x) / coc) - half_disc((left - x) / coc)
    scene = flat_scene.scene_of(walls, shot, background=(1.0,) * 3)
    assert_close(refdof.reference(scene, shot, lens, samples=1024, replicates=16), share)


@pytest.mark.parametrize(("depth", "focus"), [(1.0, 1.6), (2.5, 1.0)])
@pytest.mark.parametrize("hole", [1.5, 5.0])
def test_round_hole(depth, focus, hole):
    p, radius, sides = 20.0, 0.5, 720
    shot, lens = flat_scene.camera(20, 20, p), ThinLens(radius, focus)
    angle = 2.0 * np.pi * np.arange(sides) / sides
    ring = np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1)
    equal = np.sqrt(np.pi / (sides / 2.0 * np.sin(2.0 * np.pi / sides)))  # a polygon of the circle's area
    inner, outer = ring * (hole * equal * depth / p), ring * 50.0
    k = np.arange(sides)
    following = (k + 1) % sides
    quads = [[k, k + sides, following + sides], [k, following + sides, following]]
    faces = np.concatenate([np.stack(q, axis=1) for q in quads])
    wall = Part(np.concatenate([inner, outer]) - [0, 0, depth], faces, flat_scene.paint((0.0,) * 3))
    scene = flat_scene.scene_of([wall], shot, background=(1.0,) * 3)

    coc = abs(circle_of_confusion(p, radius, focus, depth))
    x, y = flat_scene.tangents(20, 20, p)
    share = np.vectorize(two_discs)(np.hypot(x, y) * p, coc, hole) / (np.pi * coc * coc)
    # The polygon leaves its circle by less than (pi / n)^2 / 2 = 1e-5 of the radius, and only for the sides that the
    # lens disc cuts does it not even out: 2 of 720 sides. Circles that touch along their whole length are left out.
    assert_close(refdof.reference(scene, shot, lens, samples=1024, replicates=16), share)


def slanted(slope, radius, focus):
    """Pixel 0 of P = 1 before a plane 1 / depth = 1 + slope x: x and depth of points along it."""
    x = np.linspace(max(-0.8 / slope, -1.0), max(1.0, 9.0 * radius), 3001)
    return x, 1.0 / (1.0 + slope * x)


@pytest.mark.parametrize(("radius", "slope", "focus"), [(0.1, 0.5, 2.0), (0.5, 1.0, 2.0), (0.5, 0.8, 1.4)])
@pytest.mark.parametrize("mirrored", [1.0, -1.0])
def test_a_slanted_plane_that_shows_its_depth(radius, slope, focus, mirrored):
    # Along the ray through lens point v, 1 / depth = (1 - k v / focus) / (1 - k v) with k = radius slope, so
    # depth = focus (1 + (1 - focus) / (focus - k v)). Depth is affine in space: vertex colours hold it exactly.
    k = radius * slope
    truth = focus * (1.0 + (1.0 - focus) / focus * mean_reciprocal(k / focus))
    x, depth = slanted(slope, radius, focus)
    plane = flat_scene.strips(mirrored * (x * depth)[[0, -1]], depth[[0, -1]], -50.0, 50.0, depth[[0, -1]])
    shot = flat_scene.camera(1, 1, 1.0)
    scene = flat_scene.scene_of([plane], shot, background=(1e6,) * 3)  # a ray that misses would be seen
    result = refdof.reference(scene, shot, ThinLens(radius, focus), samples=4096, replicates=16)
    # The integrand is smooth: the error bar is small enough to tell the mean from the pinhole's 1.
    assert np.abs(result.image - truth).max() <= T * result.standard_error.max() + 1e-6  # float32
    assert 20.0 * result.standard_error.max() < abs(truth - 1.0)


@pytest.mark.parametrize(("k", "mean"), [(0.1, 0.025126), (0.5, 0.143594), (0.9, 0.436516)])
def test_a_slanted_plane_with_a_ramp_in_the_picture(k, mean):
    # A colour equal to the picture's x is seen at coc v / (1 - k v), whose mean is -+ coc m(k), six digits of m given.
    radius, focus = 0.5, 4.0
    slope = k / radius
    x, depth = slanted(slope, radius, focus)
    plane = flat_scene.strips(x * depth, depth, -50.0, 50.0, x + 10.0)
    shot = flat_scene.camera(1, 1, 1.0)
    result = refdof.reference(
        flat_scene.scene_of([plane], shot, background=(1e6,) * 3), shot, ThinLens(radius, focus), 4096
    )
    truth = radius * (1.0 - 1.0 / focus) * mean
    # x(depth) = (1 / depth - 1) / slope is interpolated linearly: off by step^2 / 8 of its second derivative.
    bend = (np.diff(depth) ** 2 / 8 * 2 / slope / depth[1:] ** 3)[(x[1:] > -0.5) & (x[1:] < 4.0)].max()
    room = T * result.standard_error.max() + bend + 1e-6 + 1e-6  # float32 near 10; the last digit of m
    assert np.abs(result.image - 10.0 - truth).max() <= room
    assert room < 0.05 * truth


def wave(frequency, p, depth):
    """A cosine of the picture's x, as vertex colours on 1024 strips per period over +-24 px."""
    x = np.arange(-24.0, 24.0, 2.0 * np.pi / frequency / 1024)
    return flat_scene.strips(x * depth / p, np.full(len(x), depth), -50.0, 50.0, 0.5 + 0.5 * np.cos(frequency * x))


@pytest.mark.parametrize("turns", [0.5, 2.0, 3.0, 3.8317, 5.1356, 8.0])  # frequency * coc; J1 is 0 at 3.8317
def test_contrast_of_a_wave(turns):
    p, depth, focus, radius = 16.0, 2.0, 1.0, 0.5
    coc = circle_of_confusion(p, radius, focus, depth)
    frequency = turns / coc
    shot, lens = flat_scene.camera(16, 1, p), ThinLens(radius, focus)
    truth = 0.5 + 0.5 * jinc(turns) * np.cos(frequency * flat_scene.tangents(16, 1, p)[0] * p)
    result = refdof.reference(
        flat_scene.scene_of([wave(frequency, p, depth)], shot), shot, lens, samples=4096, replicates=16
    )
    # Linear between 1024 points of a period: off by (2 pi / 1024)^2 / 8 of the amplitude. Smooth: no share unseen.
    error = np.abs(result.image - truth[..., None])
    assert (error <= T * result.standard_error + (2 * np.pi / 1024) ** 2 / 16 + 1e-6).all()
    assert result.standard_error.max() < 0.002


@pytest.mark.parametrize("turns", [1.0, 5.1356])
def test_contrast_of_a_painted_wave(turns):
    p, depth, focus, radius, texels = 16.0, 0.5, 1.0, 0.5, 512
    coc = abs(circle_of_confusion(p, radius, focus, depth))
    period = 2.0 * np.pi * coc / turns
    column = 2.0 * np.pi * (np.arange(texels) + 0.5) / texels  # texel k is the colour at (k + 1/2) / width
    texture = np.repeat((0.5 + 0.5 * np.sin(column))[None, :, None], 3, axis=2)
    half = 48.0 * depth / p
    corners = np.array([[-half, -half], [half, -half], [half, half], [-half, half]])
    u = corners[:, 0] * p / depth / period
    material = refdof.Material("unlit", texture=texture.astype(np.float32))
    wall = Part(
        np.column_stack([corners, np.full(4, -depth)]),
        [[0, 1, 2], [0, 2, 3]],
        material,
        np.stack([u, 0 * u], axis=1),
    )
    shot = flat_scene.camera(16, 1, p)
    result = refdof.reference(
        flat_scene.scene_of([wall], shot), shot, ThinLens(radius, focus), samples=4096, replicates=16
    )
    truth = 0.5 + 0.5 * jinc(turns) * np.sin(2 * np.pi / period * flat_scene.tangents(16, 1, p)[0] * p)
    # Bilinear between 512 texels; texture coordinates in float32 are off by 1e-7 of a few periods.
    error = np.abs(result.image - truth[..., None])
    assert (error <= T * result.standard_error + (2 * np.pi / texels) ** 2 / 16 + 1e-5).all()
    assert result.standard_error.max() < 0.002

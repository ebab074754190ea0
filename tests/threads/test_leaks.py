"""Bug threads about leaks, silhouettes and occlusion: docs/threads.md, part 6."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy import ndimage

from refdof import ThinLens, View, render
from refdof.methods import singlepass
from refdof.methods.mipmap.method import _last_level
from refdof.methods.poisson.coding import shrink
from refdof.methods.singlepass.walk import sizes_of
from refdof.optics.lens_samples import lens_samples
from refdof.raster.filters.n_buffer import n_buffer, query
from tests import flat_scene
from tests.closed_forms import half_disc
from tests.threads.pictures import CAMERA, FILTERS, LENS, even, filtered, noise, point, wall

pytestmark = pytest.mark.fast
EACH = pytest.mark.parametrize("name", FILTERS)
WIDE = flat_scene.camera(24, 3, 100.0)
NEAR_LENS = ThinLens(0.1, 4.0)  # a card at depth 2 has circles of 10 (1/4 - 1/2) = -2.5 px
X = np.arange(24) + 0.5
# Share of the lens that a near card left of x = 12 hides from each column: all beyond 2.5 px to the left, none right.
HIDDEN = half_disc((12.0 - X) / 2.5)
RED, GREEN, BLUE = np.eye(3)


def card_over(behind, color=(0.0, 0.0, 0.0), background=(0.0, 0.0, 0.0)):
    """A card at depth 2 left of x = 12, over parts."""
    return flat_scene.scene_of([wall(2.0, color, -9.0, 0.0), *behind], WIDE, NEAR_LENS, background=background)


@pytest.fixture(scope="module")
def black_over_white():
    """A black card before a white wall in the focal plane, by the methods that see past edges: the middle row."""
    scene = card_over([wall(4.0, (1.0, 1.0, 1.0))])
    few = {"accumulation": {"samples": 64}, "multiview": {"samples": 64, "cones": "none"}, "lensblur": {"samples": 64}}
    return {name: render(name, scene, WIDE, NEAR_LENS, **p).image[1, :, 0] for name, p in few.items()}


# 64 lens points in an even pattern: along one axis their counts are off by at most 3 of 64.
POINTS = 3.0 / 64.0


def test_pbrt_v4_458_a_black_card_darkens_what_is_beside_it(black_over_white):
    assert_allclose(black_over_white["accumulation"], 1.0 - HIDDEN, atol=POINTS)
    assert_allclose(black_over_white["accumulation"][[9, 14]], 1.0 - HIDDEN[[9, 14]], atol=POINTS)
    assert black_over_white["accumulation"][12] == pytest.approx(1.0 - half_disc(-0.2), abs=POINTS)
    assert 0.3 < black_over_white["accumulation"][11] < 0.45  # averaged as 0, not left out


@EACH
def test_godot_50987_near_blur_reaches_over_what_is_in_focus(name):
    # A white card with circles of 3 px over a black wall in focus. What gathers over the pixel's own circle alone
    # cannot carry it across the edge; all others do.
    depth = np.where(np.arange(24) < 12, 2.0, 4.0) * np.ones((9, 1))
    color = np.repeat((depth == 2.0)[..., None], 3, axis=-1).astype(float)
    image = filtered(name, color, depth, np.where(depth == 2.0, -3.0, 0.0))[4, :, 0]
    if name in ("poisson", "separable"):
        assert_array_equal(image[12:], np.zeros(12))
    else:
        assert 0.1 < image[12] < 0.9
        assert image[23] == 0.0


@pytest.mark.parametrize("name", ["singlepass", "separable", "mipmap"])
def test_godot_65322_far_blur_stays_off_what_is_in_focus(name):
    # In focus on the left, white with circles of 3 px behind on the right: no light crosses to the left.
    depth = np.where(np.arange(24) < 12, 4.0, 16.0) * np.ones((9, 1))
    color = np.repeat((depth == 16.0)[..., None], 3, axis=-1).astype(float)
    image = filtered(name, color, depth, np.where(depth == 16.0, 3.0, 0.0))
    if name == "mipmap":  # its first level's nine points lie a pixel around
        assert_array_equal(image[:, :8], np.zeros((9, 8, 3)))
    assert_allclose(image[:, :11], 0.0, atol=1e-15)


@pytest.mark.parametrize("name", ["multiview", "lensblur"])
def test_godot_88463_the_error_falls_with_quality(name):
    scene, errors = card_over([wall(4.0, (1.0, 1.0, 1.0))]), []
    more = {"cones": "none"} if name == "multiview" else {}
    for samples in (4, 16, 64):
        image = render(name, scene, WIDE, NEAR_LENS, samples=samples, **more).image[1, :, 0]
        errors.append(float(np.sqrt(np.mean((image - (1.0 - HIDDEN)) ** 2))))
    assert errors[2] < 0.6 * errors[0]  # lensblur's extended silhouettes stay
    assert errors[2] <= errors[1]


@pytest.mark.parametrize("radius", [pytest.param(2.0, id="65116"), pytest.param(5.0, id="69460")])
def test_godot_the_radius_is_the_circle_of_confusion(radius):
    # The light of a disc's rim: the farthest pixel reached is radius + 1/2 px away, the tap's feather, and 1 px of
    # bilinear taps, at both densities.
    for step in (0.5, 1.0):
        depth, coc = even((17, 17), circle=radius)
        image = filtered("singlepass", point((17, 17)), depth, coc, rad_scale=step, max_blur_size=8.0)
        reach = np.hypot(*(np.argwhere(image[..., 0] > 0.0) - 8).T).max()
        assert radius - 1.0 <= reach <= radius + 1.5


def test_godot_61165_near_blur_by_hand():
    # Areas of pixels in a disc of 1.5 px: the centre, its neighbours and the corners, over pi 1.5^2.
    image = filtered("scatter", point((9, 9)), *even((9, 9), depth=1.0, circle=-1.5))[..., 0]
    whole = 1.0 / (math.pi * 2.25)
    assert image[4, 4] == pytest.approx(whole, rel=1e-12)
    strip = lambda a, b: (b * math.sqrt(2.25 - b * b) + 2.25 * math.asin(b / 1.5)) / 2.0 - (  # noqa: E731
        a * math.sqrt(2.25 - a * a) + 2.25 * math.asin(a / 1.5)
    ) / 2.0
    side = strip(-0.5, 0.5) - 0.5  # under the arc above the centre's row, less the half of the centre itself
    assert image[4, 5] == pytest.approx(whole * side, rel=1e-12)
    assert image[5, 4] == image[4, 5] == image[4, 3]


def test_pmndrs_postprocessing_176_the_edge_of_a_near_card_is_a_ramp(black_over_white):
    for name in ("multiview", "lensblur"):
        profile = 1.0 - black_over_white[name]
        assert (np.diff(profile) <= 1e-6).all()
        # lensblur extends silhouettes by up to a pixel, 0.3 of the ramp at its steepest, 2 / (pi 2.5) a pixel
        assert_allclose(profile, HIDDEN, atol=POINTS if name == "multiview" else POINTS + 2.0 / (math.pi * 2.5))


@pytest.mark.parametrize("seed", [pytest.param(188, id="188"), pytest.param(195, id="195")])
@EACH
def test_pmndrs_postprocessing_one_colour_has_no_halo(name, seed):
    random, color = np.random.default_rng(seed), [0.2, 0.5, 0.9]
    depth = random.choice([1.0, 2.0, 4.0, np.inf], (9, 12))
    coc = 6.0 * (0.5 - 1.0 / depth)
    assert_allclose(filtered(name, np.full((9, 12, 3), color), depth, coc), np.full((9, 12, 3), color), rtol=1e-12)


def test_unity_postprocessing_40_cutout_edges_show_a_blurred_background():
    # A card in focus left of x = 12; behind it red and green halves, which meet at x = 14 and are blurred by
    # 10 (1/4 - 1/8) = 1.25 px: beside the card's edge the green that only some of the lens sees.
    scene = flat_scene.scene_of(
        [wall(4.0, BLUE, -9.0, 0.0), wall(8.0, RED, -9.0, 0.02), wall(8.0, GREEN, 0.02)], WIDE, NEAR_LENS
    )
    image = render("accumulation", scene, WIDE, NEAR_LENS, samples=64).image[1]
    assert_allclose(image[:12], np.tile(BLUE, (12, 1)), atol=1e-6)
    assert_allclose(image[12:, 1], half_disc((X[12:] - 14.0) / 1.25), atol=POINTS)
    assert_allclose(image[12:, 0], 1.0 - half_disc((X[12:] - 14.0) / 1.25), atol=POINTS)


@pytest.mark.parametrize("name", ["multiview", "lensblur", "cascaded"])
def test_unity_postprocessing_53_edges_have_no_dark_seam(name):
    # Two bright cards and a bright background: no pixel is darker than the darkest of them.
    scene = card_over([wall(4.0, (0.9, 0.6, 0.7), -9.0, 0.05)], (0.6, 0.8, 0.7), (0.7, 0.7, 0.9))
    image = render(name, scene, WIDE, NEAR_LENS).image
    assert image.min() >= 0.6 * (1.0 - 1e-5)  # roundings of float32 sums
    assert image.max() <= 0.9 * (1.0 + 1e-5)


@pytest.mark.parametrize("edge", [0.0, 0.25, 0.5, 0.75])
def test_filament_3221_an_edge_in_focus_stays_sharp_wherever_it_lies(edge):
    # A card in focus before a blurred wall: its pixels and the wall's are as the pinhole has them, at each sub-pixel.
    scene = flat_scene.scene_of([wall(4.0, RED, -9.0, (edge - 0.1) / 100.0), wall(8.0, GREEN)], WIDE, NEAR_LENS)
    image = render("multiview", scene, WIDE, NEAR_LENS, samples=16).image[1]
    inside = X < 12.0 + edge - 0.1
    assert_allclose(image[inside], np.tile(RED, (inside.sum(), 1)), atol=1e-6)
    assert image[~inside][1:, 0].max() < 1e-6


def three_depths(name, **params):
    """Red card at depth 2 left of x = 12, green wall in focus left of x = 18, blue background at infinity."""
    scene = card_over([wall(4.0, GREEN, -9.0, 0.06)], RED, BLUE)
    return render(name, scene, WIDE, NEAR_LENS, **params).image[1]


def test_filament_3729_what_a_near_card_hides_is_filled():
    # Over the card's blurred edge lies what is behind it there, the green wall, also where no pinhole ray meets it.
    image = three_depths("accumulation", samples=64)
    assert_allclose(image[8:15, 0], HIDDEN[8:15], atol=POINTS)
    assert_allclose(image[8:15, 1], 1.0 - HIDDEN[8:15], atol=POINTS)


@pytest.mark.parametrize("name", ["multiview", "lensblur"])
def test_filament_3918_no_halo_of_a_third_depth(name):
    image = three_depths(name, samples=32)
    assert_allclose(image[:15, 2], 0.0, atol=1e-6)  # no blue where the green wall lies behind the edge
    assert_allclose(image[:15].sum(axis=-1), 1.0, rtol=1e-5)


@pytest.mark.parametrize("name", [name for name in FILTERS if name != "poisson"])
def test_filament_3096_growing_circles_change_the_picture_smoothly(name):
    # An edge under one circle for all, 0 to 3 px in steps of 1/8: no step of the picture is a jump. A disc's edge
    # moves by 2 / pi of the contrast a pixel of radius at most, and half a pixel's area is gained at 1/2 px.
    color = np.repeat((np.arange(24) < 12)[None, :, None], 9, axis=0) * np.ones(3)
    depth, frames = np.full((9, 24), 4.0), []
    params = {"max_blur_size": 4.0} if name == "singlepass" else {}
    for circle in np.arange(0.0, 3.0, 0.125):
        frames.append(filtered(name, color, depth, np.full((9, 24), circle), **params)[4, :, 0])
    largest = np.abs(np.diff(frames, axis=0)).max()
    assert largest < 0.2
    assert np.abs(frames[-1] - frames[0]).max() > 0.1


def test_filament_2828_downsampling_is_centred():
    # A ramp shrunk to a quarter: texel i lies over pixels 4 i .. 4 i + 3, whose mean is 4 i + 1.5; a Gaussian of
    # 1, 2, 1 keeps a ramp but at the borders, which are repeated.
    ramp = np.tile(np.arange(24.0)[None, :, None], (16, 1, 4))
    assert_allclose(shrink(ramp)[1, 1:-1, 0], 4.0 * np.arange(1, 5) + 1.5, rtol=1e-15)
    assert_allclose(shrink(ramp)[1, 0, 0], 0.75 * 1.5 + 0.25 * 5.5, rtol=1e-15)
    assert_allclose(shrink(np.swapaxes(ramp, 0, 1)[:16])[1:-1, 1, 0], 4.0 * np.arange(1, 3) + 1.5, rtol=1e-15)


def test_filament_2849_mip_level():
    # The level of a blur of r px is 1 + log2(2 r / 3): 1, 2 and 3 for 1.5, 3 and 6 px, and none up to 0.75 px.
    color, depth = np.zeros((32, 32, 3)), np.full((32, 32), 4.0)
    color[::2] = 1.0  # stripes of one pixel: grey from the first level on
    for circle, level in ((0.75, 0), (1.5, 1), (3.0, 2), (6.0, 3)):
        assert _last_level(circle, 32, 32) == level
        levels = _levels(color, depth, np.full((32, 32), circle))
        assert_allclose(levels, level, atol=1e-12)
    assert_allclose(filtered("mipmap", color, depth, np.full((32, 32), 6.0))[13:19], 0.5, atol=1e-12)


def _levels(color, depth, coc):
    from refdof.methods.mipmap import method
    from refdof.stages import StageRecorder, as_stages

    recorder = StageRecorder(as_stages(True))
    method._blur(color, coc, method.Params(), recorder)
    return recorder.stages["level"]


def test_filament_2480_the_number_of_taps_is_one():
    # The listing's loop, walked here: radius += step / radius from the step to 20 px. What is counted is what runs.
    radius, count = 0.5, 0
    while radius < 20.0:
        count, radius = count + 1, radius + 0.5 / radius
    assert len(singlepass.spiral()) == count
    assert singlepass.METHOD.reads_per_pixel(640, 480) == 2.0 * count


def test_filament_5828_float32_places_are_those_of_float64():
    taps = [singlepass.spiral(singlepass.Params(precision=p)) for p in ("float32", "float64")]
    assert len(taps[0]) == len(taps[1])
    assert np.abs(taps[0] - taps[1]).max() < 0.0007  # px, as the method's page says


def test_reshade_shaders_114_a_tile_keeps_its_least():
    # By hand: tiles of 2 x 2, whose least are 1, -3, 0 and 2; a mean of leasts would be another number.
    circles = np.array([[4.0, 1.0, -3.0, 5.0], [2.0, 3.0, 7.0, 7.0], [0.0, 9.0, 2.0, 2.0], [9.0, 9.0, 2.0, 3.0]])
    tiles = n_buffer(circles, block=2)
    assert_array_equal(tiles.lowest[0], [[1.0, -3.0], [0.0, 2.0]])
    assert_array_equal(tiles.highest[0], [[4.0, 7.0], [9.0, 3.0]])


def test_reshade_shaders_125_circles_of_neighbours_are_not_averaged():
    # Circles of -4 beside +4: their mean is 0, as if the edge were sharp. Every pixel within 3.5 px of taps counts.
    coc = np.where(np.arange(16) < 8, -4.0, 4.0) * np.ones((9, 1))
    depth = np.where(coc < 0.0, 1.0, 9.0)
    color = (coc < 0.0)[..., None] * np.ones(3)
    params = singlepass.Params(max_blur_size=4.0)
    assert_array_equal(np.unique(sizes_of(coc, 4.0)), [4.0])
    constant = singlepass.blur(color, np.full_like(depth, 3.0), np.full_like(coc, 4.0), params)
    mixed = singlepass.blur(color, depth, coc, params)
    # Sizes are 4 on both sides and twice the pixel's own is 8: order in depth changes nothing here.
    assert_array_equal(mixed, constant)


def test_reshade_shaders_111_the_centre_counts_once():
    # Four taps in other texels, all covered: the pixel itself weighs one in five.
    params = singlepass.Params(rad_scale=1.5, max_taps=4, color_filter="nearest", max_blur_size=6.0)
    taps = np.rint(singlepass.spiral(params)[:, :2])
    assert np.hypot(*taps.T).min() >= 1.0
    image = singlepass.blur(point((17, 17)), *even((17, 17), circle=6.0), params)
    assert image[8, 8, 0] == pytest.approx(0.2, rel=1e-14)
    assert image.sum() == pytest.approx(3.0, rel=1e-13)


@pytest.mark.parametrize("shape", [(1, 1), (1, 5), (7, 13), (11, 3)])
@EACH
def test_reshade_shaders_204_odd_sizes(name, shape):
    picture, (depth, coc) = np.full((*shape, 3), 0.7), even(shape)
    assert_allclose(filtered(name, picture, depth, coc), 0.7, rtol=1e-12)
    color = noise(shape)
    assert_allclose(filtered(name, color, depth, 0.0 * coc), color, rtol=1e-12)


def test_fidelityfx_117_windows_hold_every_neighbour():
    circles = np.random.default_rng(117).random((13, 17))
    tree = n_buffer(circles)
    y, x = (i.ravel() for i in np.indices(circles.shape))
    for reach in (1, 2, 5, 12):
        x0, x1 = np.maximum(x - reach, 0), np.minimum(x + reach, 16)
        y0, y1 = np.maximum(y - reach, 0), np.minimum(y + reach, 12)
        found = query(tree, x0, y0, x1, y1, exact=True).highest.reshape(circles.shape)
        assert_array_equal(found, ndimage.maximum_filter(circles, 2 * reach + 1, mode="nearest"))


def test_unity_graphics_5050_depth_is_never_between_two_surfaces():
    scene = flat_scene.scene_of([_slanted(2.0), wall(6.0, (1.0, 1.0, 1.0))], CAMERA, LENS)
    depth = View(scene, CAMERA, LENS).pinhole().depth
    near = np.isclose(depth, 2.0, rtol=1e-12)
    assert 5 < near.sum() < 58
    assert_allclose(depth[~near], 6.0, rtol=1e-12)


def _slanted(depth):
    from refdof import Part

    corners = np.array([[-1.0, -1.0, -depth], [1.0, -1.0, -depth], [-1.0, 1.02, -depth]])
    return Part(corners, [[0, 1, 2]], flat_scene.paint((1.0, 0.0, 0.0)))


def test_unity_graphics_965_no_light_of_the_focal_plane_in_the_far_blur():
    # White in focus left of x = 12, a black far wall behind: right of the edge there is no white in the exact picture.
    scene = flat_scene.scene_of([wall(4.0, (1.0, 1.0, 1.0), -9.0, 0.0), wall(16.0, (0.0, 0.0, 0.0))], WIDE, NEAR_LENS)
    for name in ("accumulation", "multiview", "lensblur"):
        image = render(name, scene, WIDE, NEAR_LENS, samples=16).image[1, :, 0]
        assert_allclose(image, X < 12.0, atol=1e-6)
    image = render("singlepass", scene, WIDE, NEAR_LENS, max_blur_size=4.0).image[1, :, 0]
    assert_allclose(image[:11], 1.0, atol=1e-6)
    assert_array_equal(image[15:], np.zeros(9))  # circles of 1.9 px, and a texel of a bilinear tap


def test_unity_graphics_2353_near_blur_has_no_step(black_over_white):
    for profile in black_over_white.values():
        # The closed form's steepest step is 2 / (pi 2.5) = 0.25 a pixel; points add theirs on both sides.
        assert np.abs(np.diff(profile)).max() <= 2.0 / (math.pi * 2.5) + 2.0 * POINTS
        assert profile[8] < 0.05
        assert profile[15] > 0.95


def test_unity_graphics_3837_layers_agree_with_traced_rays(black_over_white):
    for name in ("multiview", "lensblur"):
        difference = black_over_white[name] - black_over_white["accumulation"]
        assert np.sqrt(np.mean(difference**2)) < 2.0 * POINTS


@pytest.mark.parametrize("name", ["singlepass", "poisson"])
def test_spartanengine_80_the_largest_circle_is_no_edge(name):
    params = {"max_blur_size": 3.0} if name == "singlepass" else {"code": "thin_lens", "max_radius": 3.0}
    color, depth, images = noise((9, 12)), np.full((9, 12), 4.0), []
    for circle in (2.99, 3.0, 3.01, 50.0):
        images.append(filtered(name, color, depth, np.full((9, 12), circle), **params))
    assert np.abs(images[1] - images[0]).max() < 0.02
    assert_allclose(images[2], images[1], rtol=1e-13)  # beyond the clamp nothing changes
    assert_allclose(images[3], images[1], rtol=1e-13)


def test_beyond_all_reason_855_a_sharp_object_keeps_its_edge():
    scene = flat_scene.scene_of([wall(4.0, RED, -0.04, 0.04), wall(16.0, GREEN)], WIDE, NEAR_LENS)
    for name in ("multiview", "lensblur", "accumulation"):
        image = render(name, scene, WIDE, NEAR_LENS, samples=16).image[1]
        assert_allclose(image[8:16], np.tile(RED, (8, 1)), atol=1e-5)
        assert_allclose(image[[5, 18]], np.tile(GREEN, (2, 1)), atol=1e-5)


def test_speck_50_enough_taps_for_the_circle():
    # One tap per pi px^2 by the listing: r^2 / (2 * 0.5) taps within r, so that none is farther than 2 px from a place.
    taps = singlepass.spiral()
    for radius in (4.0, 10.0, 18.0):
        assert (taps[:, 2] < radius).sum() == pytest.approx(radius**2, rel=0.1)
    grid = np.stack(np.meshgrid(np.arange(-13.0, 14.0), np.arange(-13.0, 14.0)), axis=-1).reshape(-1, 1, 2)
    assert np.hypot(*np.moveaxis(grid - taps[:, :2], -1, 0)).min(axis=1).max() < 2.0
    points = lens_samples(64, "vogel")[0]
    gap = np.hypot(*np.moveaxis(grid[:1] * 0.0 - points, -1, 0)).min()
    assert gap < 2.0 / math.sqrt(64.0)  # points of pi / 64 each



"""Bug threads about taps, tiles, mip levels and filters of one picture: docs/threads.md, part 6."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy import ndimage

from refdof.methods import singlepass
from refdof.methods.mipmap.method import _last_level
from refdof.methods.poisson.coding import shrink
from refdof.methods.singlepass.walk import sizes_of
from refdof.optics.lens_samples import lens_samples
from refdof.raster.filters.n_buffer import n_buffer, query
from tests.threads.pictures import FILTERS, even, filtered, noise, point

pytestmark = pytest.mark.fast
EACH = pytest.mark.parametrize("name", FILTERS)


@EACH
def test_godot_50987_near_blur_reaches_over_what_is_in_focus(name):
    # A white card with circles of 3 px over a black wall in focus. What gathers over the pixel's own circle alone
    # cannot carry it across the edge; all others do.
    depth = np.where(np.arange(24) < 12, 2.0, 4.0) * np.ones((9, 1))
    color = np.repeat((depth == 2.0)[..., None], 3, axis=-1).astype(float)
    image = filtered(name, color, depth, np.where(depth == 2.0, -3.0, 0.0))[4, :, 0]
    if name in ("circular", "hexagon", "poisson", "separable"):
        assert_array_equal(image[12:], np.zeros(12))
    else:
        # halfres counts its near picture by twice the share that 3 px have of its largest 16, of which half comes over.
        assert (0.05 if name == "halfres" else 0.1) < image[12] < 0.9
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

    def under(x):
        """Area under the arc from 0 to x."""
        return (x * math.sqrt(2.25 - x * x) + 2.25 * math.asin(x / 1.5)) / 2.0

    side = 2.0 * under(0.5) - 0.5  # under the arc above the centre's row, less the half of the centre itself
    assert image[4, 5] == pytest.approx(whole * side, rel=1e-12)
    assert image[5, 4] == image[4, 5] == image[4, 3]


@pytest.mark.parametrize("seed", [pytest.param(188, id="188"), pytest.param(195, id="195")])
@EACH
def test_pmndrs_postprocessing_one_colour_has_no_halo(name, seed):
    random, color = np.random.default_rng(seed), [0.2, 0.5, 0.9]
    depth = random.choice([1.0, 2.0, 4.0, np.inf], (9, 12))
    coc = 6.0 * (0.5 - 1.0 / depth)
    assert_allclose(filtered(name, np.full((9, 12, 3), color), depth, coc), np.full((9, 12, 3), color), rtol=1e-12)


@pytest.mark.parametrize("name", [name for name in FILTERS if name != "poisson"])
def test_filament_3096_growing_circles_change_the_picture_smoothly(name):
    # An edge under one circle for all, 0 to 3 px in steps of 1/8: no step of the picture is a jump. A disc's edge
    # moves by 2 / pi of the contrast a pixel of radius at most, and half a pixel's area is gained at 1/2 px.
    color = np.repeat((np.arange(24) < 12)[None, :, None], 9, axis=0) * np.ones(3)
    depth, frames = np.full((9, 24), 4.0), []
    params = {"max_blur_size": 4.0} if name == "singlepass" else {}
    for circle in np.arange(0.0, 3.0, 0.125):
        frames.append(filtered(name, color, depth, np.full((9, 24), circle), **params)[4, :, 0])
    # hexagon has whole steps: from one to the next, 1 - ((s + 1) / (s + 2))^2 of the weights move, 3/4 at most.
    largest = np.abs(np.diff(frames, axis=0)).max()
    assert largest < (0.75 if name == "hexagon" else 0.2)
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


@pytest.mark.parametrize("name", ["singlepass", "poisson"])
def test_spartanengine_80_the_largest_circle_is_no_edge(name):
    params = {"max_blur_size": 3.0} if name == "singlepass" else {"code": "thin_lens", "max_radius": 3.0}
    color, depth, images = noise((9, 12)), np.full((9, 12), 4.0), []
    for circle in (2.99, 3.0, 3.01, 50.0):
        images.append(filtered(name, color, depth, np.full((9, 12), circle), **params))
    assert np.abs(images[1] - images[0]).max() < 0.02
    assert_allclose(images[2], images[1], rtol=1e-13)  # beyond the clamp nothing changes
    assert_allclose(images[3], images[1], rtol=1e-13)


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

"""Cards with holes and transparent cards: exact areas on the lens, and light along rays by hand."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import refdof
from refdof import Material, ThinLens, View
from refdof._jit import thread_count, use_threads
from refdof.raster.gpu.depth_peeling import peel_raster
from refdof.raster.gpu.rasterize import rasterize
from tests import flat_scene
from tests.cards import lens_shares
from tests.cutouts import bilinear, cut_card, hole_material, solid_quads

WIDTH, HEIGHT, P = 12, 9, 12.0
BOX, UV = (-0.9, 0.8, -0.6, 0.7), (-0.6, 1.3, -0.4, 1.7)  # of the card with holes, at depth 2
COLORS = np.array([(0.9, 0.2, 0.1), (0.1, 0.7, 0.3), (0.2, 0.3, 0.8)])  # card, wall, background
WRAPS = [("repeat", "repeat"), ("clamp", "mirror"), ("mirror", "clamp")]
LENS = ThinLens(0.25, 2.6)


def texture(seed):
    return np.random.default_rng([seed, 31]).random((4, 5)).astype(np.float32)


def holed_scene(wrap, cutoff=0.55, scale=1.0, seed=1, size=(WIDTH, HEIGHT), p=P):
    """A card with holes before a wall that fills the left half."""
    card = cut_card(BOX, 2.0, UV, hole_material(texture(seed), cutoff, wrap, tuple(COLORS[0]), scale))
    wall = flat_scene.rectangle(-9.0, 0.1, -9.0, 9.0, 4.0, tuple(COLORS[1]))
    return flat_scene.scene_of([card, wall], flat_scene.camera(*size, p), LENS, tuple(COLORS[2]))


def truth_of(wrap, cutoff=0.55, scale=1.0, seed=1):
    """(H, W, 3): the card's solid parts cut out of the lens as polygons, then the wall."""
    quads = solid_quads(texture(seed), cutoff / scale, wrap, UV[0::2], UV[1::2])
    x0, x1, y0, y1 = BOX
    u = (quads[..., 0] - UV[0]) / (UV[1] - UV[0])
    v = (quads[..., 1] - UV[2]) / (UV[3] - UV[2])
    outlines = [*np.stack([x0 + u * (x1 - x0), y0 + v * (y1 - y0)], axis=-1)]
    outlines.append(np.array([(-9.0, -9.0), (0.1, -9.0), (0.1, 9.0), (-9.0, 9.0)]))
    depths = np.array([2.0] * len(quads) + [4.0])
    share = lens_shares(outlines, depths, flat_scene.tangents(WIDTH, HEIGHT, P), LENS.radius, LENS.focus_distance)
    return share @ np.concatenate([np.repeat(COLORS[:1], len(quads), axis=0), COLORS[1:]])


def close(image, truth):
    """256 independent points err by half a colour's step of 0.7 over 16; a net's by less than half of that."""
    assert np.sqrt(np.mean((image - truth) ** 2)) < 0.5 * 0.5 * 0.7 / 16


@pytest.mark.parametrize("wrap", WRAPS)
def test_the_reference_sees_polygons(wrap):
    truth = truth_of(wrap)
    assert np.ptp(truth[..., 0]) > 0.3  # there are holes, and solid parts
    found = refdof.reference(holed_scene(wrap), samples=256)
    # 95 % intervals hold the truth in 90 to 99 % of all cases; strips, cut at 1/16 of a texel, add less than 1e-3.
    off = np.maximum(np.maximum(truth - found.high, found.low - truth), 0.0)
    assert np.mean(off > 1e-3) < 0.1
    close(found.image, truth)


def test_a_factor_of_opacity_moves_the_cutoff():
    truth = truth_of(WRAPS[0], 0.3, 0.6)
    assert_allclose(truth, truth_of(WRAPS[0], 0.5), atol=1e-12)
    close(refdof.reference(holed_scene(WRAPS[0], 0.3, 0.6), samples=256).image, truth)


def solid_at_centres(wrap, size, p):
    """Where the card is solid at pixel centres: (H, W) bool, and how far its opacity is from the cutoff."""
    right, up = (tangent * 2.0 for tangent in flat_scene.tangents(*size, p))
    u = UV[0] + (right - BOX[0]) / (BOX[1] - BOX[0]) * (UV[1] - UV[0])
    v = UV[2] + (up - BOX[2]) / (BOX[3] - BOX[2]) * (UV[3] - UV[2])
    opacity = np.vectorize(lambda s, t: bilinear(texture(1).astype(float), s, t, wrap))(u, v)
    on_card = (right > BOX[0]) & (right < BOX[1]) & (up > BOX[2]) & (up < BOX[3])
    return on_card & (opacity >= 0.55), np.abs(opacity - 0.55)


@pytest.mark.fast
@pytest.mark.parametrize("wrap", WRAPS)
def test_layers_rasteriser_and_peeling_see_the_same_holes(wrap):
    size, p = (36, 27), 36.0
    scene = holed_scene(wrap, size=size, p=p)
    view = View(scene, scene.camera, LENS)
    solid, margin = solid_at_centres(wrap, size, p)
    assert margin.min() > 1e-6  # float32 coordinates and texels decide nothing
    assert 0.1 < solid.mean() < 0.4
    right, _ = flat_scene.tangents(*size, p)
    wall = right * 4.0 < 0.1
    front = np.where(solid, 2.0, np.where(wall, 4.0, np.inf))
    layers = view.layers()
    assert_allclose(layers.depth[0], front, rtol=1e-9)
    assert_allclose(layers.depth[1], np.where(solid & wall, 4.0, np.inf), rtol=1e-9)
    assert_array_equal(view.surface_counts(), solid.astype(int) + wall)
    seen = np.where(solid[..., None], COLORS[0], np.where(wall[..., None], COLORS[1], COLORS[2]))
    assert_allclose(view.pinhole().color, seen, atol=1e-6)
    cutouts = view.surfaces().cutouts
    assert_allclose(rasterize(*view.triangles(), view.camera, cutouts=cutouts).depth, front, rtol=1e-9)
    peeled = peel_raster(*view.triangles(), view.camera, cutouts=cutouts)
    assert_allclose(peeled.depth, layers.depth[: len(peeled.depth)], rtol=1e-9)


def glass(opacity, color):
    return Material("unlit", color, opacity=opacity)


def test_transparent_cards_are_composited_in_order_along_the_ray():
    cards = [
        cut_card((-9, 9, -9, 9), depth, (0, 1, 0, 1), glass(opacity, tuple(color)))
        for depth, opacity, color in zip((2.0, 3.0, 4.0), (0.25, 0.6, 1.0), COLORS, strict=True)
    ]
    scene = flat_scene.scene_of(cards[::-1], flat_scene.camera(6, 5, 6.0), ThinLens(0.1, 3.0), (5.0, 5.0, 5.0))
    layers = View(scene, scene.camera, scene.lens).layers()
    second = 0.6 * COLORS[1] + 0.4 * COLORS[2]
    wanted = [0.25 * COLORS[0] + 0.75 * second, second, COLORS[2]]
    assert_allclose(layers.color[:, 2, 3], wanted, atol=1e-6)
    assert_array_equal(layers.depth[:, 2, 3], [2.0, 3.0, 4.0])
    # Everything is one colour: the reference draws each card with a share of its rays. 4 standard errors of the sum of
    # all pixels' errors, each a binomial share of 1024 rays and a colour's step of at most 0.7.
    image = refdof.reference(scene, samples=1024).image
    assert_allclose(image.mean(axis=(0, 1)), wanted[0], atol=4 * 0.7 * 0.5 / np.sqrt(1024 * 30))
    assert np.std(image[..., 0]) > 1e-4  # by chance, not by rule


@pytest.mark.fast
def test_layers_beyond_an_umbra_keep_their_colours():
    """Of three windows before a wall, the second hides in the umbra of the first."""
    depths, colors = (2.0, 2.0001, 4.0, 9.0), np.array([*COLORS, (0.5, 0.5, 0.5)])
    cards = [
        cut_card((-99, 99, -99, 99), depth, (0, 1, 0, 1), glass(opacity, tuple(color)))
        for depth, opacity, color in zip(depths, (0.5, 0.5, 0.5, 1.0), colors, strict=True)
    ]
    scene = flat_scene.scene_of(cards, flat_scene.camera(6, 5, 600.0), ThinLens(0.1, 3.0))  # 2 hides up to 2.07
    view = View(scene, scene.camera, scene.lens)
    everything, kept = view.layers(), view.umbra_layers()
    assert_array_equal(kept.depth[:, 2, 3], [2.0, 4.0, 9.0])
    assert_array_equal(kept.color[:, 2, 3], everything.color[[0, 2, 3], 2, 3])
    assert_allclose(kept.color[1, 2, 3], 0.5 * COLORS[2] + 0.5 * colors[3], atol=1e-6)


@pytest.mark.fast
def test_a_window_fades_by_its_vertices_and_texture():
    """Opacity of vertices runs from 0 to 1 across the card, the texture halves it; the wall behind is black."""
    corners = np.array([0.0, 1.0, 1.0, 0.0])
    half = Material("unlit", (1.0, 1.0, 1.0), opacity_texture=np.full((1, 1), 0.5))
    card = cut_card((-1.0, 1.0, -9.0, 9.0), 2.0, (0, 1, 0, 1), half, corners)
    scene = flat_scene.scene_of([card], flat_scene.camera(16, 3, 16.0), ThinLens(0.0, 2.0))
    right, _ = flat_scene.tangents(16, 3, 16.0)
    opacity = 0.5 * (right * 2.0 + 1.0) / 2.0
    assert_allclose(View(scene, scene.camera, scene.lens).pinhole().color[..., 0], opacity, atol=1e-6)


@pytest.mark.fast
def test_what_is_fully_transparent_is_no_surface():
    clear = cut_card((-9, 9, -9, 9), 2.0, (0, 1, 0, 1), glass(0.0, (1, 1, 1)))
    scene = flat_scene.scene_of([clear], flat_scene.camera(6, 5, 6.0), ThinLens(0.1, 3.0), tuple(COLORS[2]))
    view = View(scene, scene.camera, scene.lens)
    assert (view.surface_counts() == 0).all()
    assert_allclose(refdof.reference(scene, samples=16).image, np.broadcast_to(COLORS[2], (5, 6, 3)), atol=1e-6)


@pytest.mark.fast
def test_many_holes_along_a_ray():
    """A ray passes through 40 fully cut cards, however they are ordered, and meets the wall."""
    cut = hole_material(np.zeros((1, 1)), 0.5)
    order = np.random.default_rng(3).permutation(40)
    cards = [cut_card((-9, 9, -9, 9), 2.0 + 0.05 * k, (0, 1, 0, 1), cut) for k in order]
    wall = flat_scene.rectangle(-99, 99, -99, 99, 9.0, tuple(COLORS[1]))
    scene = flat_scene.scene_of([*cards, wall], flat_scene.camera(6, 5, 6.0), ThinLens(0.3, 3.0))
    assert_allclose(refdof.reference(scene, samples=64).image, np.broadcast_to(COLORS[1], (5, 6, 3)), atol=1e-6)
    assert (View(scene, scene.camera, scene.lens).surface_counts() == 1).all()


def test_the_same_bits_for_any_number_of_threads():
    glassy = cut_card(BOX, 1.5, UV, glass(0.4, (0.3, 0.9, 0.9)))
    holed = holed_scene(WRAPS[1])
    wall = flat_scene.rectangle(-9, 9, -9, 9, 5.0)
    scene = flat_scene.scene_of([glassy, cut_card(BOX, 2.0, UV, holed.materials[0]), wall], holed.camera, LENS)
    pictures = []
    count = thread_count()
    for threads in (1, count):
        use_threads(threads)
        pictures.append(refdof.reference(scene, samples=64, pixel_filter="box").image)
    assert_array_equal(*pictures)


def test_a_lens_that_is_nearly_a_pinhole_draws_each_ray_anew():
    """Rays that float32 cannot tell apart meet the same glass; each still has a chance of its own."""
    scene = flat_scene.scene_of(
        [cut_card((-9, 9, -9, 9), 2.0, (0, 1, 0, 1), glass(0.5, (1, 1, 1)))], flat_scene.camera(6, 5, 6.0)
    )
    image = refdof.reference(scene, scene.camera, ThinLens(1e-12, 3.0), samples=1024).image
    assert_allclose(image[..., 0], 0.5, atol=5 * 0.5 / np.sqrt(1024))  # 5 standard errors of one pixel


@pytest.mark.fast
@pytest.mark.parametrize("cutoff", [0.1, 0.25, 0.5, 0.7, 0.9])
def test_an_opacity_that_is_the_cutoff_is_solid(cutoff):
    """By factor, by vertices, and by a texture, as float32 files hold them; a little less is a hole."""
    shot = flat_scene.camera(24, 18, 20.0)
    box = (-9.0, 9.0, -9.0, 9.0)
    for opacity, count in ((cutoff, 24 * 18), (0.999 * cutoff, 0)):
        of_factor = cut_card(box, 2.0, UV, Material("unlit", opacity=opacity, cutoff=cutoff))
        of_vertices = cut_card(box, 2.0, UV, Material("unlit", cutoff=cutoff), np.full(4, opacity, np.float32))
        of_texture = cut_card(box, 2.0, UV, hole_material(np.full((3, 5), opacity, np.float32), cutoff))
        for card in (of_factor, of_vertices, of_texture):
            scene = flat_scene.scene_of([card], shot)
            view = View(scene, shot, scene.lens)
            assert view.surface_counts().sum() == count
            drawn = rasterize(*view.triangles(), shot, cutouts=view.surfaces().cutouts)
            assert (drawn.triangle >= 0).sum() == count

"""What the paper says about multiview synthesis, held against exact cards and the reference; refutations included.

The paper's pictures have 800 x 600 pixels and spacings of 3 and 10 px; here they are 0.4 times as large, and so are
spacings: the same layers. The claims are held against the paper's rays, `RAYS`, among walls of 1 px; the last tests
against what measurement chose instead. Measured figures stand beside the thresholds, as PSNR [dB] / SSIM.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import refdof
from refdof import ThinLens, View
from refdof.methods.multiview import Params, cone_width
from refdof.methods.multiview.fields import Search, fields_of
from refdof.methods.multiview.gather import gather
from refdof.optics.pixel_samples import lens_point_sets
from refdof.rendering import render_view
from tests import flat_scene
from tests.cards import lens_shares

SIZE, SPACING = (320, 240), 1.2
RAYS = {
    "search": "false position",
    "offscreen": "discard",
    "jitter": "noise",
    "pattern": "poisson",
    "cones": "none",
}


@cache
def view(name):
    scene = refdof.load_scene(name)
    return View(scene, scene.camera.with_size(SIZE), scene.lens)


@cache
def truth(name):
    return refdof.reference(view(name).scene, view(name).camera, samples=256).image


@cache
def picture(name, method="multiview", **words):
    if method == "multiview":
        words = {"spacing_px": SPACING, **RAYS, **words}
    return render_view(method, view(name), **words).image


def score(name, image, wanted=None):
    wanted = truth(name) if wanted is None else wanted
    return np.array([refdof.metrics.psnr(wanted, image), refdof.metrics.ssim(wanted, image)])


# --- exact cards


def test_cards_in_layers_of_their_own_are_exact():
    size, p, focus, radius = (40, 30), 40.0, 2.0, 0.35
    shot = flat_scene.camera(*size, p)
    coc = np.array([-5.0, -2.0, 1.0, 4.0])
    depth = 1.0 / (1.0 / focus - coc / (p * radius))
    # Edges on borders of pixels: texels then are the cards themselves. [px from the middle]
    cards = np.array([(-9, -1, -8, 3), (-2, 7, -6, 9), (-14, 5, -11, 1), (-20, 20, -15, 15)])
    colors = np.random.default_rng(3).random((5, 3))
    parts = [
        flat_scene.rectangle(*(np.array(c) * d / p), d, tuple(rgb))
        for c, d, rgb in zip(cards, depth, colors, strict=False)
    ]
    scene = flat_scene.scene_of(parts, shot, ThinLens(radius, focus), tuple(colors[4]))
    words = {"layers": 4, "samples": 64, "cones": "none", "pattern": "sobol", "seed": 3}
    stages = refdof.render("multiview", scene, stages=True, **words).stages
    assert len(stages["layer_number"]) == 4
    image = refdof.render("multiview", scene, **words).image
    exact = refdof.render("multiview", scene, **words, wall_px=0.0, search="march").image

    # Cast the same rays: at circle of confusion c through pixel p - c v, y down.
    points = stages["lens_points"][0].astype(np.float32).astype(np.float64)
    y, x = np.mgrid[: size[1], : size[0]]
    seen = np.full((size[1], size[0], 64), 4)
    for k in (3, 2, 1, 0):
        u = x[..., None] + 0.5 - size[0] / 2 - coc[k] * points[:, 0]
        v = size[1] / 2 - y[..., None] - 0.5 - coc[k] * points[:, 1]
        left, right, low, high = cards[k]
        seen[(left <= u) & (u < right) & (low < v) & (v <= high)] = k
    inner = (slice(6, -6), slice(6, -6))
    # Means of 64 colours in float64, of colours and result in float32.
    np.testing.assert_allclose(exact[inner], colors[seen].mean(axis=2)[inner], rtol=1e-6)

    # So what is left is the noise of 64 points: against the exact areas, 64^-0.75 of the contrast at an edge (1 sigma).
    # By default walls count as surface, too, but these cards are flat and far apart.
    outline = [np.array([(a, c), (b, c), (b, e), (a, e)]) * d / p for (a, b, c, e), d in zip(cards, depth, strict=True)]
    share = lens_shares(outline, depth, flat_scene.tangents(*size, p), radius, focus)
    for shown in (exact, image):
        error = (shown - share @ colors)[inner]
        assert np.sqrt((error**2).mean()) < 64**-0.75
        assert abs(error.mean()) < 64**-0.75 / 10


# --- the scenes


@pytest.mark.parametrize("name", ["fence", "branches"])
def test_better_than_a_single_image(name):
    # fence: 36.5 / 0.971 against 27.8 / 0.864; branches: 38.9 / 0.989 against 30.7 / 0.956.
    gain = score(name, picture(name)) - score(name, picture(name, "singlepass"))
    assert gain[0] > 6.0
    assert gain[1] > 0.02


def test_the_branches_appear_as_far_apart_as_in_the_reference():
    # The two barks, in black before white, without screen, flowers and butterfly.
    scene = refdof.load_scene("branches")
    depth = -scene.camera.camera_from_world(scene.vertices)[scene.faces][..., 2].max(axis=1)
    kept = (depth < 1.5) & (scene.face_material < 2)
    black = replace(scene, faces=scene.faces[kept], face_material=scene.face_material[kept], background=(1.0,) * 3)
    black = replace(black, materials=tuple(replace(m, texture=None, base_color=(0.0,) * 3) for m in scene.materials))
    camera = scene.camera.with_size(SIZE)
    exact = refdof.reference(black, camera, samples=256).image[..., 0]
    image = refdof.render("multiview", black, camera, samples=256, spacing_px=SPACING).image[..., 0]
    pairs = [(gap(exact[:, x]), gap(image[:, x])) for x in range(SIZE[0] // 2 - 80, SIZE[0] // 2 - 10)]
    both = np.array([pair for pair in pairs if None not in pair])
    assert len(both) > 30
    assert (both[:, 0] > 2.0).sum() > 20
    assert np.abs(both[:, 0] - both[:, 1]).max() < 1.0  # px


def gap(column, level=0.7):
    """Length of the part of a column brighter than `level` between its first two dark runs [px]; None: no such part."""
    edge = np.flatnonzero((column[:-1] < level) != (column[1:] < level))
    if len(edge) < 4:
        return None
    at = edge + (level - column[edge]) / (column[edge + 1] - column[edge])
    return at[2] - at[1]


def test_shading_along_the_lens_ray_is_better_on_mirrors():
    # 30.9 / 0.9701 to 32.5 / 0.9742. The paper's own scene: 27.68 / 0.93 to 41.38 / 0.97.
    gain = score("mirrors", picture("mirrors", view_dependent=True)) - score("mirrors", picture("mirrors"))
    assert gain[0] > 1.0
    assert gain[1] > 0.002


@pytest.mark.parametrize("name", ["fence", "branches"])
@pytest.mark.parametrize("jitter", ["noise", "halton"])
def test_refuted_32_jittered_points_do_not_pass_64_unjittered(name, jitter):
    # fence: noise 35.7 / 0.957, halton 35.8 / 0.955 against 36.8 / 0.973; branches: 37.9 / 0.978, 38.5 / 0.983 against
    # 39.4 / 0.992. They approach it, and have no ghost edges, which neither score counts.
    loss = score(name, picture(name, samples=64, jitter="none")) - score(name, picture(name, samples=32, jitter=jitter))
    assert 0.5 < loss[0] < 3.0
    assert 0.005 < loss[1] < 0.03


@pytest.mark.parametrize("name", ["fence", "branches"])
@pytest.mark.parametrize("cones", ["paper", "text"])
def test_cones_approach_many_samples(name, cones):
    # 16 points. fence: 34.5 / 0.932 to 36.5 / 0.961 (paper) and 37.1 / 0.970 (text); branches: 36.4 / 0.956 to
    # 38.1 / 0.973 and 38.6 / 0.980. SSIM to the picture of 256 points: + 0.012 at least.
    plain, wide = picture(name, samples=16), picture(name, samples=16, cones=cones)
    gain = score(name, wide) - score(name, plain)
    assert gain[0] > 0.7
    assert gain[1] > 0.012
    many = picture(name, samples=256)
    assert (score(name, wide, many) - score(name, plain, many))[1] > 0.008


def test_lambda_is_the_papers():
    # Printed for 32 samples: 0.137, "a 4.4 pixel diameter (mipmap level of 2.1) for a 32-pixel COC radius". Sets of
    # darts differ by 0.003 (one sigma). Darts on the lens alone give 0.137; ours, which do not crowd at the rim, 0.134.
    darts = Params(samples=32, cones="paper", pattern="poisson")
    widths = [cone_width(view("branches"), replace(darts, seed=seed)) for seed in range(10)]
    assert np.mean(widths) == pytest.approx(0.137 * 0.98, abs=0.003)
    assert 32 * np.mean(widths) == pytest.approx(4.4 * 0.98, abs=0.1)
    assert np.log2(32 * np.mean(widths)) == pytest.approx(2.1, abs=0.05)
    text = cone_width(view("branches"), replace(darts, cones="text", seed=0))
    assert text == pytest.approx(2 * widths[0], rel=1e-12)


@pytest.mark.parametrize("name", ["mirrors", "fence"])
def test_one_layer_degrades_gently(name):
    # Figure 10. mirrors: 31.0 to 30.5, fence: 36.5 to 29.4; without blur 22.0 and 23.5; with objects as thick as the
    # layer, the text's reading, 30.2 and 25.3.
    flat = score(name, picture(name, layers=1))[0]
    assert flat > score(name, view(name).pinhole().color)[0] + 5.0
    assert flat > score(name, picture(name, layers=1, wall_px=np.inf))[0] + 0.2


@pytest.mark.parametrize("name", ["fence", "branches"])
def test_wider_spacing_costs_little(name):
    # 3 px to 10 px: fence 36.5 to 36.3, branches 39.0 to 39.0.
    assert abs(score(name, picture(name))[0] - score(name, picture(name, spacing_px=4.0))[0]) < 0.3


@pytest.mark.parametrize("name", ["fence", "branches"])
def test_three_iterations_are_enough(name):
    more = picture(name, steps=16, bisections=16)
    march = picture(name, search="march")
    middle = picture(name, start="middle")
    for image in (more, march, middle):
        assert abs(score(name, picture(name))[0] - score(name, image)[0]) < 0.1  # measured: 0.03


@pytest.mark.parametrize("name", ["fence", "branches"])
def test_layers_of_whole_triangles_are_nearly_as_good_as_exact_ones(name):
    # "In practice, the differences to an accurate method are small": 36.5 against 36.2, 39.1 against 38.5.
    exact = picture_from_exact_layers(name)
    assert abs(score(name, picture(name))[0] - score(name, exact)[0]) < 0.8


def picture_from_exact_layers(name):
    """The default picture, from layers that hold the nearest of all surfaces in their interval."""
    own, words = view(name), Params(spacing_px=SPACING, **RAYS)
    bounds = render_view("multiview", own, stages=True, spacing_px=SPACING, samples=1).stages["bounds"]
    low, high = bounds[:-1] - 0.1 * SPACING, bounds[1:] + 0.1 * SPACING
    layers = own.layers()
    coc = np.where(layers.triangle < 0, np.inf, own.lens.coc_px(layers.depth, own.camera)).astype(np.float32)
    heights, colors = [], []
    for a, b in zip(low, high, strict=True):
        inside = (coc >= a) & (coc <= b)
        if not inside.any():
            continue
        first = inside.argmax(axis=0)
        heights.append(np.where(inside.any(axis=0), np.take_along_axis(coc, first[None], 0)[0], np.float32(np.inf)))
        colors.append(np.take_along_axis(layers.color, first[None, ..., None], 0)[0])
    pattern = lens_point_sets(words.samples, own.lens.aperture, words.jitter, words.pattern, words.seed)
    search = Search(False, words.steps, words.bisections, words.wall_px, False, True, True)
    heights = np.stack(heights)
    low, high = heights.min(axis=(1, 2)), np.where(heights < np.inf, heights, -np.inf).max(axis=(1, 2))
    fields = fields_of(heights, low, high, 1.0)
    return gather(fields, np.stack(colors), pattern, search, own.projection(), own.surfaces(), own.scene.background)


@pytest.mark.parametrize("name", ["fence", "branches"])
def test_objects_as_thick_as_their_layer_are_worse(name):
    # The text's reading of d < d^ against walls of 1 px. The noise of 64 points is the same in both: the same rays.
    assert score(name, picture(name))[0] > score(name, picture(name, wall_px=np.inf))[0] + 0.05


@pytest.mark.parametrize("name", ["fence", "branches"])
def test_rays_that_leave_the_image_matter_at_its_border_only(name):
    dropped, clamped = picture(name), picture(name, offscreen="clamp")
    reach = int(np.ceil(np.abs(view(name).coc_px()).max() + SPACING)) + 2
    inner = (slice(reach, -reach), slice(reach, -reach))
    np.testing.assert_array_equal(dropped[inner], clamped[inner])
    # Clamped: + 0.8 dB on fence, + 0.5 on branches. "The degradation is hardly noticeable."
    assert 0.0 < score(name, clamped)[0] - score(name, dropped)[0] < 1.5


# --- what measurement chose


@pytest.mark.parametrize("name", ["fence", "branches"])
def test_cones_on_even_points_are_better_than_noise(name):
    # fence: 36.5 to 39.1 dB; branches: 39.0 to 41.3.
    best = render_view("multiview", view(name)).image
    assert score(name, best)[0] > score(name, picture(name))[0] + 1.5


@pytest.mark.parametrize("name", ["fence", "branches"])
def test_the_border_beats_dropped_rays(name):
    best, dropped = (render_view("multiview", view(name), offscreen=o).image for o in ("clamp", "discard"))
    assert score(name, best)[0] > score(name, dropped)[0]


@pytest.mark.parametrize("name", ["fence", "branches", "lights"])
def test_the_best_preset_is_better_than_the_papers_and_both_than_no_blur(name):
    best, paper = (render_view("multiview", view(name), preset=p).image for p in ("best", "paper"))
    assert score(name, best)[0] > score(name, paper)[0]
    assert score(name, paper)[0] > score(name, view(name).pinhole().color)[0]

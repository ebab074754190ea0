"""Masks of pictures whose masks are known, and the naive twin of all of them."""

import numpy as np
import pytest

from refdof import InputError
from refdof.metrics.artefacts import ArtefactMaps
from refdof.metrics.artefacts.reach import within
from tests.metrics.artefacts import naive

pytestmark = pytest.mark.fast

MASKS = ("in_focus", "in_front", "behind", "occlusion", "sharp", "continuous")


def bar(near=-3.0, far=0.0, width=30, height=12):
    """Columns 0 .. 9 are near, the others far: the edge is at x = 10."""
    depth, coc = np.full((height, width), 4.0), np.full((height, width), far)
    depth[:, :10], coc[:, :10] = 2.0, near
    return ArtefactMaps(depth, coc)


def columns(mask):
    assert (mask == mask[:1]).all()
    return np.flatnonzero(mask[0]).tolist()


def test_a_blurred_card_before_a_sharp_wall():
    maps = bar()
    assert columns(maps.in_front) == list(range(10))
    assert columns(maps.in_focus) == list(range(10, 30))
    assert not maps.behind.any()
    # Centres within 3 px of x = 10: from 7.5 to 12.5.
    assert columns(maps.occlusion) == [7, 8, 9, 10, 11, 12]
    # The last near pixel's centre is at 9.5; its disc and a pixel end at 13.5, where the next centre is.
    assert columns(maps.sharp) == list(range(13, 30))
    rows, across = maps.foreground
    assert not rows.any()
    assert columns(across.T) == [9]
    # Twice 3 px around the edge's pixels, 9 and 10: of the near ones 4 .. 9 are nearer than 6 to 9.
    assert columns(maps.continuous) == [0, 1, 2, 3]


def test_a_sharp_card_before_a_blurred_wall_has_no_band_and_no_foreground():
    maps = bar(near=0.25, far=4.0)
    assert not maps.occlusion.any()
    assert not any(edge.any() for edge in maps.foreground)
    assert columns(maps.sharp) == list(range(10))
    assert columns(maps.continuous) == list(range(10 + 8, 30))  # 8 px from the first far pixel, 10, on


def test_a_wide_circle_disturbs_beyond_its_edge():
    maps = bar(near=-6.0, far=-1.0)
    # Of the wall, what is nearer than twice 6 px to its first pixel, 10; of the card, nothing is 12 px away.
    assert columns(maps.continuous) == list(range(22, 30))
    assert columns(ArtefactMaps(maps.depth.T, maps.coc.T).continuous.T) == list(range(22, 30))


def test_a_blurred_card_behind_focus_has_a_band_but_is_no_foreground():
    maps = bar(near=2.0, far=6.0)
    assert columns(maps.occlusion) == [8, 9, 10, 11]
    assert not any(edge.any() for edge in maps.foreground)
    assert not maps.sharp.any()


@pytest.mark.parametrize("slope", [0.3, 0.7, 3.0, -3.0])
def test_a_steep_plane_has_no_edge(slope):
    coc = np.tile(slope * (np.arange(20) - 9.5), (5, 1))  # affine over the picture, as that of any plane
    maps = ArtefactMaps(np.full(coc.shape, 2.0), coc)
    assert not any(found.edge.any() for found in maps.edges)
    assert (maps.continuous == ~maps.in_focus).all()


@pytest.mark.parametrize(("jump", "edges"), [(0.49, 0), (0.51, 12)])
def test_a_jump_of_half_a_pixel_is_the_least_edge(jump, edges):
    found = bar(near=-1.0, far=jump - 1.0).edges
    assert sum(int(part.edge.sum()) for part in found) == edges


def test_a_bar_of_one_pixel_has_two_edges():
    coc = np.zeros((5, 9))
    coc[:, 4] = -2.0
    rows, across = ArtefactMaps(np.where(coc < 0, 1.0, 2.0), coc).edges
    assert not rows.edge.any()
    assert columns(across.edge.T) == [3, 4]


def test_noise_is_pooled():
    error = np.zeros((9, 9, 3))
    error[4, 4] = (0.3, 0.6, 0.9)  # mean 0.6, in 25 pixels: 0.6 / 5
    noise = ArtefactMaps(np.ones((9, 9)), np.zeros((9, 9)), standard_error=error).noise
    # Running sums of float64 of size 0.36 round by 1e-16 each; where there is nothing, the root of that is left, 1e-8.
    np.testing.assert_allclose(noise[2:7, 2:7], 0.12, rtol=1e-12)
    assert noise[0].max() < 1e-7


@pytest.mark.parametrize("seed", range(5))
def test_within_is_the_union_of_discs(seed):
    random = np.random.default_rng(seed)
    reach = np.where(random.random((13, 17)) < 0.1, random.uniform(-1.0, 6.0, (13, 17)), 0.0)
    y, x = np.indices(reach.shape)
    distance = np.hypot(y[..., None, None] - y, x[..., None, None] - x)
    np.testing.assert_array_equal(within(reach), (distance < reach).any(axis=(2, 3)))


def test_one_disc_may_hold_all():
    for corner in ((0, 0), (0, 8), (4, 0), (4, 8)):
        reach = np.zeros((5, 9))
        reach[corner] = 9.0  # the diagonal is sqrt(16 + 64) = 8.94
        assert within(reach).all()
        reach[corner] = 8.9
        assert within(reach).sum() == 44


def random_scene(seed, height=11, width=14):
    """Slanted cards before one another: depth, circles, pinhole picture, reference, image and error bars."""
    random = np.random.default_rng(seed)
    y, x = np.indices((height, width))
    depth = np.full((height, width), np.inf)
    for _ in range(4):
        plane = random.uniform(1.0, 6.0) + 0.02 * (random.normal() * x + random.normal() * y)
        angle, place = random.uniform(0.0, 2 * np.pi), random.uniform(2.0, 10.0)
        inside = np.cos(angle) * x + np.sin(angle) * y < place
        depth = np.where(inside, np.minimum(depth, np.maximum(plane, 0.5)), depth)
    coc = 4.0 * (1.0 / random.uniform(1.5, 4.0) - 1.0 / depth)
    color, reference = random.uniform(-0.5, 0.5, (2, height, width, 3))
    image = reference + random.normal(0.0, 0.5, color.shape)
    return depth, coc, color, 0.05 * random.random(color.shape), reference, image


@pytest.mark.parametrize("seed", range(12))
def test_masks_match_the_naive_twin(seed):
    depth, coc, *_ = random_scene(seed)
    maps = ArtefactMaps(depth, coc)
    for name, places in naive.masks(depth.tolist(), coc.tolist()).items():
        assert set(map(tuple, np.argwhere(getattr(maps, name)).tolist())) == places, name


def test_every_mask_is_met_by_the_twin():
    found = [naive.masks(*(part.tolist() for part in random_scene(seed)[:2])) for seed in range(12)]
    assert all(sum(len(one[name]) for one in found) > 10 for name in MASKS)


def test_bad_maps_are_named():
    depth, coc = np.ones((2, 3)), np.zeros((2, 3))
    for words, message in (
        ({"depth": depth.T}, r"depth: got shape \(3, 2\)"),
        ({"depth": 0 * depth}, "depth: smallest value is 0"),
        ({"coc": coc + np.inf}, "coc: has 6 infinite values"),
        ({"coc": np.zeros((0, 3))}, r"coc: got shape \(0, 3\); allowed is at least one pixel"),
        ({"color": np.zeros((2, 3))}, "color: got shape"),
        ({"standard_error": np.full((2, 3, 3), -1.0)}, "standard_error: smallest value is -1"),
    ):
        with pytest.raises(InputError, match=message):
            ArtefactMaps(**{"depth": depth, "coc": coc, **words})

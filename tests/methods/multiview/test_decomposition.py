"""Layers of depth by hand: which intervals hold a height, what happens at their ends, and which of two fragments wins.

Focus lies at infinity and P E is 12 px, so that a card at depth 12 / c has the circle of confusion -c [px], and float32
holds whole ones exactly. Each card has a column of pixels of its own.
"""

import numpy as np
import pytest

from refdof import Part, ThinLens, View
from refdof.methods.multiview.decomposition import Decomposition, copies, decompose, layer_bounds
from tests import flat_scene

pytestmark = pytest.mark.fast
LENS = ThinLens(1.0, np.inf)


def layers_of(circles, **words):
    """{layer: circles of the cards in it}, front to back; an empty layer would be a key with nothing."""
    width = len(circles)
    shot = flat_scene.camera(width, 2, 12.0)
    cards = []
    for k, c in enumerate(circles):
        depth = 12.0 / -c
        left, right = ((k + side - width / 2) * depth / 12.0 for side in (0, 1))
        cards.append(flat_scene.rectangle(left, right, -depth, depth, depth))
    view = View(flat_scene.scene_of(cards, shot, LENS), shot, LENS)
    layers, _ = decompose(*view.triangles(), shot, LENS, **words)
    found = {}
    for number, coc, triangle, near, far in zip(
        layers.layer.tolist(), layers.coc, layers.triangle, layers.near, layers.far, strict=True
    ):
        assert (coc[0] == coc[1]).all()
        held = {float(c) for c in coc[0] if c < np.inf}
        for k in np.flatnonzero(coc[0] < np.inf):
            assert coc[0, k] == circles[k]  # in its own column
            assert triangle[0, k] // 2 == k
        assert (near, far) == ((min(held), max(held)) if held else (np.inf, -np.inf))
        found[number] = held
    return found


# Layers of 2 px from -12 on, the last one cut at -1: bounds -12, -10, -8, -6, -4, -2, -1. With an overlap of a half
# they hold [-13, -9), [-11, -7), [-9, -5), [-7, -3), [-5, -1), [-3, 0): lower ends belong to a layer, upper ones not.
@pytest.mark.parametrize(
    ("circles", "overlap", "layers"),
    [
        ([-12, -6, -4, -3, -2, -1], 0.0, {0: {-12}, 3: {-6}, 4: {-4, -3}, 5: {-2, -1}}),
        ([-12, -6, -1], 0.5, {0: {-12}, 2: {-6}, 3: {-6}, 5: {-1}}),
        ([-12, -4, -1], 0.5, {0: {-12}, 3: {-4}, 4: {-4}, 5: {-1}}),
        ([-12, -3, -1], 0.5, {0: {-12}, 4: {-3}, 5: {-3, -1}}),
        ([-12, -9, -1], 0.5, {0: {-12}, 1: {-9}, 2: {-9}, 5: {-1}}),
        ([-12, -7, -1], 0.5, {0: {-12}, 2: {-7}, 3: {-7}, 5: {-1}}),
        ([-12, -6, -4, -3, -2, -1], 0.5, {0: {-12}, 2: {-6}, 3: {-6, -4}, 4: {-4, -3, -2}, 5: {-3, -2, -1}}),
        ([-12, -9.5, -6.5, -1], 0.25, {0: {-12}, 1: {-9.5}, 2: {-6.5}, 3: {-6.5}, 5: {-1}}),
    ],
)
def test_intervals_are_closed_in_front_and_open_behind(circles, overlap, layers):
    assert layers_of(circles, spacing=2.0, overlap=overlap) == layers


def test_the_overlap_of_counted_layers_is_a_share_of_their_spacing():
    # Five layers from -12 to -2: 2 px each, and 1 px of overlap. -5 is where the last begins.
    found = layers_of([-12, -5, -2], count=5, overlap=0.5)
    assert found == {0: {-12}, 3: {-5}, 4: {-5, -2}}


def test_a_fragment_that_a_rounding_puts_behind_the_last_vertex_is_kept():
    # The card at 49 is drawn at 1 / (1 / 49), a rounding farther. The lens makes its circle a number halfway between
    # two of float32: with 49 it becomes -2 px, and with that rounding the next one above -2.
    lens, beyond = ThinLens(49.0 * (2.0 - 2.0**-24) / 12.0, np.inf), 1.0 / (1.0 / 49.0)
    shot = flat_scene.camera(2, 2, 12.0)
    assert lens.coc_px(49.0, shot).astype(np.float32) == -2.0 < lens.coc_px(beyond, shot).astype(np.float32)
    cards = [flat_scene.rectangle(-99, 0, -99, 99, 7.0), flat_scene.rectangle(0, 99, -99, 99, 49.0)]
    layers, _ = decompose(*View(flat_scene.scene_of(cards, shot, lens), shot, lens).triangles(), shot, lens)
    assert layers.bounds[-1] == layers.far[-1] == -2.0
    np.testing.assert_array_equal(layers.coc[-1], [[np.inf, -2.0]] * 2)
    assert (layers.triangle[-1][:, 1] // 2 == 1).all()


def test_a_scene_at_one_depth_is_one_layer():
    # 1 / (1 / 48) is 48, and 1 / (1 / 49) is a rounding more than 49.
    for depth in (48.0, 49.0):
        shot = flat_scene.camera(2, 2, 12.0)
        view = View(flat_scene.scene_of([flat_scene.rectangle(-99, 99, -99, 99, depth)], shot, LENS), shot, LENS)
        layers, _ = decompose(*view.triangles(), shot, LENS)
        np.testing.assert_array_equal(layers.coc, np.full((1, 2, 2), np.float32(-12.0 / depth)))


def test_of_equally_near_fragments_the_one_from_the_nearest_layer_is_kept():
    # A card at depth 2, and a slanted triangle that meets it on the axis, drawn for the layer of its corner at depth 6.
    shot = flat_scene.camera(1, 1, 12.0)
    slanted = Part([[-1, -3, -1], [-1, 3, -1], [4, 0, -6]], [[0, 1, 2]], flat_scene.paint((1, 1, 1)))
    view = View(flat_scene.scene_of([slanted, flat_scene.rectangle(-1, 1, -1, 1, 2.0)], shot, LENS), shot, LENS)
    layers, sources = decompose(*view.triangles(), shot, LENS, 1.0, overlap=0.0)
    np.testing.assert_array_equal(sources.coc[:, 0, 0], [-6.0, -6.0])
    assert layers.coc.tolist() == [[[-6.0]]]
    assert layers.triangle[0, 0, 0] in (1, 2)  # one of the card's


def test_bounds_at_the_ends():
    # Three times 0.1 is a rounding above 0.3, which makes no fourth layer.
    np.testing.assert_array_equal(layer_bounds(0.0, 0.1 * 3, 0.1), np.float32([0.0, 0.1, 0.2, 0.3]))
    assert len(layer_bounds(0.0, 0.31, 0.1)) == 5
    # No span: one layer, whatever the count.
    np.testing.assert_array_equal(layer_bounds(-4.0, -4.0, 3.0), np.float32([-4, -4]))
    np.testing.assert_array_equal(layer_bounds(-4.0, -4.0, 3.0, 5), np.float32([-4, -4]))


def test_copies_are_the_same_fragment_in_neighbouring_layers():
    # Columns: the same fragment; another triangle at that height; another height; nothing twice; nothing before.
    coc = np.float32([[[1, 1, 1, np.inf, np.inf]], [[1, 1, 2, np.inf, 1]], [[1, 1, 2, np.inf, 1]]])
    triangle = np.int32([[[7, 7, 7, -1, -1]], [[7, 8, 7, -1, 7]], [[7, 8, 7, -1, 7]]])
    ends = np.zeros(3, np.float32)
    layers = Decomposition(coc, triangle, ends, ends, np.array([0, 1, 3]), np.zeros(5, np.float32))
    wanted = [[False] * 5, [True, False, False, False, False], [False] * 5]  # layer 3 does not follow on 1
    np.testing.assert_array_equal(copies(layers)[:, 0], wanted)

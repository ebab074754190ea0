"""How many lens samples a small light asks for, by hand: 8 hits of its share of the pixel's disc."""

import math

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from refdof import Part, ThinLens, View
from refdof.truth.emitters import first_samples
from tests import flat_scene

pytestmark = pytest.mark.fast

P, WIDTH, HEIGHT, DEPTH = 16.0, 32, 24, 2.0
LENS = ThinLens(1.0, 1.0)  # 16 * 1 * (1 / 1 - 1 / 2) = 8 px at depth 2
# A lamp of 2 x 2 px. Half of its area counts, as of a closed body: 2 of the 64 pi px^2 of the disc.
EIGHT_HITS = math.ceil(8 / (2 / (64 * math.pi)))  # 805


def lamp(color=(4.0, 1.0, 1.0), depth=DEPTH, x=0.3, y=-0.4, **part):
    """Two by two pixels around (W / 2 + x, H / 2 - y) at `depth`."""
    found = flat_scene.rectangle(*(np.array([x - 1, x + 1, y - 1, y + 1]) * depth / P), depth, color)
    return Part(found.vertices, part.get("faces", found.faces), found.material, color=part.get("vertex_color"))


def samples(parts, lens=LENS, tolerance=0.02):
    projection = flat_scene.camera(WIDTH, HEIGHT, P)
    return first_samples(View(flat_scene.scene_of(parts, projection, lens), projection, lens), tolerance)


def box(count, rows, columns):
    wanted = np.ones((HEIGHT, WIDTH), dtype=int)
    wanted[slice(*rows), slice(*columns)] = count
    return wanted


def test_the_lamp_and_its_disc_by_hand():
    assert EIGHT_HITS == 805
    # x from 15.3 to 17.3 px and y from 11.4 to 13.4 px, 8 px of disc and 1 px more on each side, in whole pixels.
    assert_array_equal(samples([lamp()]), box(805, (2, 23), (6, 27)))


def test_a_small_disc_asks_for_less():
    # 4 px: a quarter of the disc's area.
    count = math.ceil(8 / (2 / (16 * math.pi)))
    assert_array_equal(samples([lamp()], ThinLens(0.5, 1.0)), box(count, (6, 19), (10, 23)))


@pytest.mark.parametrize("lens", [ThinLens(0.05, 1.0), ThinLens(0.0, 1.0), ThinLens(1.0, DEPTH)])
def test_a_sharp_lamp_asks_for_nothing(lens):
    assert_array_equal(samples([lamp()], lens), 1)  # 0.4 px, 0 px and in focus


@pytest.mark.parametrize(("tolerance", "count"), [(0.039, 805), (0.041, 1)])
def test_a_lamp_below_the_tolerance_is_left_alone(tolerance, count):
    # Its share of 2 / (64 pi) = 0.00995, four times as bright as white: 0.0398 of the pixel.
    assert samples([lamp()], tolerance=tolerance).max() == count


@pytest.mark.parametrize(("value", "count"), [(1.5, 805), (1.0, 1)])
def test_a_light_is_what_is_brighter_than_white(value, count):
    assert samples([lamp((value, 0.0, 0.0))], tolerance=0.001).max() == count


def test_vertex_colours_dim_a_lamp():
    assert samples([lamp(vertex_color=np.full((4, 3), 0.2))], tolerance=0.001).max() == 1  # 0.8


def test_triangles_that_share_a_corner_are_one_lamp():
    # However their corners are numbered: the first corner of one is the last corner of the other.
    for faces in ([[0, 1, 2], [0, 2, 3]], [[0, 1, 2], [2, 3, 0]], [[1, 2, 0], [3, 0, 2]]):
        assert samples([lamp(faces=faces)]).max() == 805
    # Two lamps, each with its own half: one of them covers half as much.
    corners = np.concatenate([lamp().vertices, lamp(x=-9.0).vertices])
    halves = Part(corners, [[0, 1, 2], [4, 5, 6]], lamp().material)
    assert samples([halves], tolerance=0.01).max() == math.ceil(8 / (1 / (64 * math.pi)))


def test_the_largest_disc_of_a_deep_lamp_counts():
    # A lamp with its left corners at depth 2 and its right ones, on the same rays, at depth 4: 16 (1 - 1 / 4) = 12 px.
    flat = lamp()
    deep = Part(flat.vertices * np.array([1, 2, 2, 1])[:, None], flat.faces, flat.material)
    count = math.ceil(8 / (2 / (144 * math.pi)))
    assert_array_equal(samples([deep], tolerance=0.001), box(count, (0, 24), (2, 31)))


def test_two_lamps_ask_for_the_larger_number():
    # The second stands 6 px to the right and is half as wide.
    small = flat_scene.rectangle(*(np.array([5.8, 6.8, -1.4, 0.6]) * DEPTH / P), DEPTH, (4.0, 1.0, 1.0))
    both = np.maximum(box(805, (2, 23), (6, 27)), box(math.ceil(8 / (1 / (64 * math.pi))), (2, 23), (12, 32)))
    assert_array_equal(samples([lamp(), small], tolerance=0.01), both)

"""Parts of the diagnosis by hand: the search for a whole number, and the weights of one texel."""

from types import SimpleNamespace

import numpy as np
import pytest

from refdof.oracle.diagnosis.probes import _grid
from refdof.oracle.diagnosis.search import _best_whole

pytestmark = pytest.mark.fast


@pytest.mark.parametrize("best", [1, 37, 200, 256, 399])
def test_the_lowest_place_of_a_valley_is_found(best):
    """One within half of the range around the start."""
    assert _best_whole(lambda k: abs(k - best), 1, 180, 399) == best


def test_a_start_alone_in_its_range():
    assert _best_whole(lambda k: k, 5, 5, 5) == 5


@pytest.mark.parametrize(("x", "y"), [(0, 0), (3, 2), (2, 1)])
def test_weights_of_a_texel_up_to_the_corners_of_a_picture(x, y):
    shot = SimpleNamespace(color=np.zeros((3, 4, 3)), depth=np.ones((3, 4)))

    def right(picture, columns, rows):
        return picture[rows, columns]

    assert _grid(lambda picture: picture, right, x, y, shot) == []
    first, *lines = _grid(lambda picture: 0.5 * picture, right, x, y, shot)
    assert f"texel ({x}, {y})" in first
    middle = lines[len(lines) // 2].split("|")
    assert [float(half.split()[len(lines) // 2]) for half in middle] == [1000.0, 500.0]

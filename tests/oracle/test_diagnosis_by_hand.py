"""Parts of the diagnosis by hand: the search for a whole number, and the weights of one texel."""

from types import SimpleNamespace

import numpy as np
import pytest

from refdof.oracle.diagnosis.model import model_of
from refdof.oracle.diagnosis.probes import _grid
from refdof.oracle.diagnosis.search import _Bench, _best_whole
from refdof.oracle.diagnosis.shots import case_shot
from refdof.oracle.diagnosis.switches import _sizes
from refdof.oracle.diagnosis.tap_switches import _places, _spiral
from refdof.oracle.files import open_pack
from tests.oracle.small_pack import rewrite

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


def test_any_largest_size_is_fitted():
    """A port may have any number there, and may or may not scale its circles with it."""
    sizes = [switch for switch in _sizes() if switch.key == "max_blur_size"]
    assert len(sizes) == 3
    assert all(switch.fits for switch in sizes)


def test_pixels_as_wide_as_high_or_the_other_way_round():
    named = {}
    for switch in _places():
        if switch.key == "pixel_size" and not switch.fits:
            shot = SimpleNamespace(depth=np.ones((18, 24)))
            named |= {value: switch.words(shot, value)["words"] for value in switch.values}
    both = [f": its pixel size is that of {size}" for size in ("24 x 24", "18 x 18", "18 x 24")]
    assert [named[value] for value in ((0, 0), (1, 1), (1, 0))] == both


def test_without_device_depth_the_planes_are_those_of_the_picture(copied):
    rewrite(copied, "cases/cards/case.json", lambda about: about.pop("device_depth"))
    opened = open_pack(copied)
    _, shot = case_shot(opened, "cards", opened.description("cards"))
    depth = np.load(copied / "cases" / "cards" / "inputs" / "depth.npy")
    assert (shot.near, shot.far) == (depth.min(), depth.max())


def test_every_mistake_changes_the_model():
    right = model_of({"rad_scale": 0.5, "max_blur_size": 20.0}, "down")
    for switch in _spiral(right):
        assert any(switch.change(right, value) != right for value in switch.values), switch.key


def test_pixels_are_shared_among_pictures(pack):
    opened = open_pack(pack)
    _, shot = case_shot(opened, "cards", opened.description("cards"))
    shots = [shot._replace(off=np.arange(shot.depth.size, dtype=float).reshape(shot.depth.shape))] * 3
    bench = _Bench(shots, 30)
    assert len(bench.samples) == 3
    assert all(5 <= len(samples.x) <= 10 for samples in bench.samples)  # one that is drawn twice counts once

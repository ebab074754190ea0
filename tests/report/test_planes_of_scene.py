"""What `compare` and `filter_frame` give a report beside pictures: depth, circles, counts of surfaces, maps of FLIP."""

import numpy as np
import pytest
from typer.testing import CliRunner

from refdof import InputError, ThinLens
from refdof.cli import app
from refdof.compare import compare
from refdof.filtering import filter_frame
from refdof.frame.frame import Frame, frame_camera
from tests.studio import flat


@pytest.fixture(scope="module")
def compared():
    return compare(flat.scene(), ["scatter"], samples=4)


def test_planes_of_a_scene_by_hand(compared):
    """A card at 2 covers the left half of one at 8; in focus at 2, the far one's circle is 0.1 (1/2 - 1/8) 50 px."""
    np.testing.assert_allclose(compared.depth, flat.depth(), rtol=1e-12)
    left = np.arange(flat.WIDTH) < flat.WIDTH // 2
    np.testing.assert_array_equal(compared.surface_counts, np.where(left, 2, 1) * np.ones((flat.HEIGHT, 1)))
    np.testing.assert_allclose(compared.coc_px, np.where(left, 0.0, 1.875) * np.ones((flat.HEIGHT, 1)), atol=1e-9)


def test_the_map_of_flip_has_the_mean_that_the_table_has(compared):
    (row,) = compared.rows
    assert row.flip_map.shape == (flat.HEIGHT, flat.WIDTH)
    assert row.flip_map.mean(dtype=np.float64) == pytest.approx(row.scores["flip"], rel=1e-5)  # added in float32


@pytest.mark.parametrize("with_lens", [True, False])
def test_planes_of_a_frame(with_lens):
    depth = np.linspace(1.0, 9.0, 12 * 16).reshape(12, 16)
    depth[0, 0] = np.inf
    circles = None if with_lens else np.linspace(-3.0, 3.0, 12 * 16).reshape(12, 16)
    lens = ThinLens(0.05, 2.0) if with_lens else None
    frame = Frame(np.full((12, 16, 3), 0.5), depth, frame_camera(40.0, (16, 12)), lens, circles)
    found = filter_frame(frame, ["scatter"])
    np.testing.assert_array_equal(found.depth, depth)
    assert found.surface_counts is None
    assert found.rows[0].flip_map is None
    if with_lens:
        pitch = 12 / (2 * np.tan(np.radians(20.0)))  # px per unit tangent
        np.testing.assert_allclose(found.coc_px, 0.05 * (1 / 2.0 - 1 / depth) * pitch, rtol=1e-9)
    else:
        np.testing.assert_array_equal(found.coc_px, circles)


def test_a_crop_outside_the_picture_is_refused_before_anything_is_rendered(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = ["compare", "branches", "--size", "40x30", "--crop", "0,0,10,10", "--crop", "35,0,6,6"]
    done = CliRunner().invoke(app, words, standalone_mode=False)
    assert isinstance(done.exception, InputError)
    assert "crop: got '35,0,6,6'; allowed is X,Y,W,H in whole pixels, a window of the picture of 40x30" in str(
        done.exception
    )
    assert not (tmp_path / "out").exists()

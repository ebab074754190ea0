"""Frames of a slow move in a report: sizes by hand, pixels where they belong, the same bytes again."""

import base64
import io
import json
import re
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from refdof.comparison import Motion
from refdof.image.display import to_8_bit
from refdof.report import markdown_table, write_comparison
from refdof.report.motion_pictures import moving_png, strips_png
from refdof.report.page import report_page
from refdof.report.rows import command_of
from tests.fake_comparison import comparison

pytestmark = pytest.mark.fast


def motion(names=("reference", "multiview", "mipmap"), frames=4, size=(40, 30)):
    random = np.random.default_rng(3)
    linear = {name: random.random((frames, *size[::-1], 3)).astype(np.float32) for name in names}
    pictures = {name: np.stack([to_8_bit(frame) for frame in some]) for name, some in linear.items()}
    strips = {name: 0.1 * some[:, 7] for name, some in linear.items()}
    flicker = {name: 0.5**k for k, name in enumerate(names)}
    return Motion(1.0 / 16.0, 64, flicker, pictures, 7, strips)


def frames_of(data):
    with Image.open(io.BytesIO(data)) as file:
        frames = []
        for k in range(getattr(file, "n_frames", 1)):
            file.seek(k)
            frames.append(np.asarray(file.convert("RGB")))
        return frames


def test_a_moving_picture_has_all_frames():
    given = motion()
    data = moving_png(given)
    assert data == moving_png(given)
    frames = frames_of(data)
    assert len(frames) == 4
    # Four times 40 x 30, 16 px margins, 8 px between; 34 px for name and flicker.
    assert frames[0].shape == (2 * 16 + 34 + 120, 2 * 16 + 3 * 160 + 2 * 8, 3)
    for t, frame in enumerate(frames):
        for k, picture in enumerate(given.pictures.values()):
            x, y = 16 + k * 168, 16 + 34
            np.testing.assert_array_equal(frame[y + 2 : y + 120 : 4, x + 3 : x + 160 : 4], picture[t])
        words = frame[16:50]
        assert (words != 255).any()
        assert (words == frames[0][16:50]).all()


@pytest.mark.parametrize("count", [1, 8, 16])
def test_pictures_fit_in_1280_px(count):
    given = motion([f"a method of a very long name {k}" if k else "reference" for k in range(count)], 3, (160, 120))
    for data in (moving_png(given), strips_png(given)):
        assert frames_of(data)[0].shape[1] <= 1280
    # 7 columns fit at most: 16 pictures stand in three bands of six.
    bands, columns, zoom = {1: (1, 1, 4), 8: (2, 4, 1), 16: (3, 6, 1)}[count]
    height = 32 + bands * (34 + zoom * 120) + (bands - 1) * 8
    assert frames_of(moving_png(given))[0].shape == (height, 32 + columns * zoom * 160 + (columns - 1) * 8, 3)


def test_strips_show_a_row_over_time():
    given = motion()
    data = strips_png(given)
    assert data == strips_png(given)
    (sheet,) = frames_of(data)
    # 15 times 40 px twice; 16 px for each of 4 frames; 24 px of words above, and 16 px above and 8 px below a strip.
    assert sheet.shape == (2 * 16 + 24 + 3 * (16 + 64 + 8), 2 * 16 + 2 * 600 + 8, 3)
    for k, strip in enumerate(given.strips.values()):
        y, left, right = 16 + 24 + k * 88 + 16, 16, 16 + 600 + 8
        np.testing.assert_array_equal(sheet[y + 5 : y + 64 : 16, left + 7 : left + 600 : 15], to_8_bit(strip))
        change = np.abs(strip[:-2] - 2.0 * strip[1:-1] + strip[2:])
        shown = sheet[y + 16 + 5 : y + 48 : 16, right + 7 : right + 600 : 15].astype(float)
        # Half a level, and roundings of float32.
        np.testing.assert_allclose(shown, 255.0 * np.minimum(8.0 * change, 1.0), atol=0.501)
        # The first and the last frame have no neighbour.
        assert (sheet[y : y + 16, right:] == 255).all()
        assert (sheet[y + 48 : y + 64, right:] == 255).all()


def test_a_report_tells_of_the_move(tmp_path):
    given = comparison()
    assert "Flicker:" not in markdown_table([given])
    assert "<h2>Motion</h2>" not in report_page(given)
    assert "--motion" not in command_of(given)
    moved = replace(given, motion=motion())
    write_comparison(moved, tmp_path)
    assert (tmp_path / "motion.png").read_bytes() == moving_png(moved.motion)
    assert (tmp_path / "motion_strip.png").read_bytes() == strips_png(moved.motion)
    assert json.loads((tmp_path / "table.json").read_text())["motion"] == {
        "frames": 4,
        "size": [40, 30],
        "step_px": 0.0625,
        "samples": 64,
        "reference_flicker": 1.0,
        "strip_row": 7,
    }
    said = (
        "Flicker: 4 frames of 40 x 30 px, each moved on by 1/16 px of the focal plane; the reference's own, 1.00000, is"
    )
    assert said in (tmp_path / "table.md").read_text()
    page = (tmp_path / "report.html").read_text()
    assert said.replace("'", "&#39;") in page
    (shown,) = re.findall(r'<img src="data:image/png;base64,([^"]+)"', page)
    assert base64.b64decode(shown) == strips_png(moved.motion)
    assert "--motion 4" in command_of(moved)

"""The overview figure and the crops in it."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from refdof._check import InputError
from refdof.comparison import Box
from refdof.image.display import to_8_bit
from refdof.report.crops import boxes_of, choose_crops, placed
from refdof.report.overview import write_overview
from tests.fake_comparison import comparison


# Column and row sizes as laid out by hand: cell 480 px at most, 16 px margins, 12 px between cells; a band is
# 46 title + two pictures + 4 gap + crops + 22 label + 22 below; the header is 40.
@pytest.mark.parametrize(
    ("size", "count", "expected"),
    [
        # Cells of 480 x 360 with 238 px for a crop: a fifth of 40 px would fit 29.75 times; 7 x 5 px fit 34
        # times.
        ((40, 30), 1, (2 * 16 + 2 * 480 + 12, 40 + 46 + 2 * 360 + 4 + 34 * 5 + 22 + 22)),
        # Six columns of 251 x 188, two bands; 123 px for a crop: 8 x 6 px fit 15 times.
        ((40, 30), 10, (2 * 16 + 6 * 251 + 5 * 12, 40 + 2 * (46 + 2 * 188 + 4 + 15 * 6 + 22 + 22))),
    ],
)
def test_size_of_the_overview(tmp_path, size, count, expected):
    methods = [f"method {k}" for k in range(count)]
    write_overview(comparison(*size, methods=methods), tmp_path / "overview.png")
    with Image.open(tmp_path / "overview.png") as file:
        file.load()
        assert file.size == expected


def test_overview_shows_the_pictures_and_repeats_itself(tmp_path):
    given = comparison(methods=("$x^2$ is no formula",))
    shades = {"reference": (0.9, 0.1, 0.1), "method": (0.1, 0.9, 0.1)}
    given.reference[:] = shades["reference"]
    given.rows[0].image[:] = shades["method"]
    for name in ("a.png", "b.png"):
        write_overview(given, tmp_path / name)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    with Image.open(tmp_path / "a.png") as file:
        pixels = np.asarray(file.convert("RGB")).astype(int)
    # The centres of both pictures, 86 = 40 header + 46 title below the top. One level for rounding on each
    # side.
    for left, shade in ((16, "reference"), (16 + 480 + 12, "method")):
        level = to_8_bit(np.array([[shades[shade]]]))[0, 0].astype(int)
        assert np.abs(pixels[86 + 180, left + 240] - level).max() <= 1


def test_crops_lie_where_the_error_and_the_blur_are():
    given = comparison(40, 30, methods=("a", "b"))
    given.reference[:] = given.pinhole[:] = 0.5
    for row in given.rows:
        row.image[:] = 0.5
    given.rows[1].image[21:24, 4:9] = 0.9
    given.pinhole[2:6, 30:38] = 0.9
    error, blur = choose_crops(given, 8, 6)
    # Of all windows that hold the whole disturbance the first, top left one is taken.
    assert (error.x, error.y) == (9 - 8, 24 - 6)
    assert (blur.x, blur.y) == (30, 0)
    assert (error.width, error.height) == (blur.width, blur.height) == (8, 6)


@settings(max_examples=40, deadline=None)
@given(st.data(), st.integers(1, 12), st.integers(1, 12))
def test_crops_stay_inside_and_apart(data, width, height):
    crop = data.draw(st.integers(1, width)), data.draw(st.integers(1, height))
    crops = choose_crops(comparison(width, height, methods=("a",)), *crop)
    covered = np.zeros((height, width), dtype=int)
    for box in crops:
        assert box.of(covered).shape == (crop[1], crop[0])
        box.of(covered)[:] += 1
    assert covered.max() == 1
    # Two always fit beside or above each other where the first leaves room on one side.
    assert len(crops) == 2 or (width < 3 * crop[0] and height < 3 * crop[1])


def test_crops_of_the_command_line():
    assert boxes_of(["0,0,40,30", " 3,4,5,6 "], (40, 30)) == (Box(0, 0, 40, 30), Box(3, 4, 5, 6))
    for wrong in (
        "",
        "1,2,3",
        "1,2,3,4,5",
        "-1,2,3,4",
        "1.5,2,3,4",
        "36,0,5,5",
        "0,26,5,5",
        "0,0,0,5",
        "0,0,5,0",
        "a,b,c,d",
    ):
        with pytest.raises(InputError, match=r"crop: got '.*'; allowed is X,Y,W,H .* 40x30"):
            boxes_of([wrong], (40, 30))


def test_crops_are_placed_two_in_a_row_enlarged_by_whole_factors():
    # 100 px with a gap of 4 leave 48 for each: 4 times 10 px, 1 time 30 px, and 60 px made smaller to 48.
    crops = [Box(0, 0, 10, 5), Box(0, 0, 30, 40), Box(0, 0, 60, 30)]
    assert placed(crops, 100, 4) == ([(0, 0, 40, 20), (70, 0, 30, 40), (0, 44, 48, 24)], 68)
    assert placed([], 100, 4) == ([], 0)


def test_overview_shows_the_crops_that_are_asked_for(tmp_path):
    """Each has one colour, which no other part of the picture has."""
    colors = [(0.9, 0.1, 0.1), (0.1, 0.9, 0.1), (0.1, 0.1, 0.9)]
    boxes = tuple(Box(4 + 10 * k, 3 + 5 * k, 6 + k, 5) for k in range(3))
    given = comparison(methods=("a",))
    given.reference[:] = given.rows[0].image[:] = 0.5
    for box, color in zip(boxes, colors, strict=True):
        box.of(given.rows[0].image)[:] = color
    write_overview(replace(given, crops=boxes), tmp_path / "overview.png")
    with Image.open(tmp_path / "overview.png") as file:
        pixels = np.asarray(file.convert("RGB")).astype(int)
    for box, color in zip(boxes, colors, strict=True):
        level = to_8_bit(np.array([[color]]))[0, 0].astype(int)
        zoom = (480 - 4) // 2 // box.width
        count = (np.abs(pixels - level).max(axis=2) <= 1).sum()
        # The crop, less its frame of 2 px, and the same place of the picture at 12 times; smoothing blurs its rim.
        assert count > (zoom * box.width - 4) * (zoom * box.height - 4) + 100 * box.width * box.height

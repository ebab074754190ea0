"""The report of fake comparisons: the same numbers everywhere, strict JSON, an offline page, a figure."""

import base64
import csv
import io
import json
import math
import re
import zlib
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
from PIL import Image

from refdof._check import InputError
from refdof.image.display import to_8_bit
from refdof.image.file import load_image
from refdof.metrics import METRICS, Metric, scores
from refdof.report import (
    markdown_table,
    page,
    planes,
    rows_as_json,
    terminal_table,
    write_comparison,
    write_comparisons,
)
from tests.fake_comparison import ARTEFACTS, SCORES, comparison


def strict_json(text):
    def refuse(token):
        raise AssertionError(f"{token} is no JSON")

    return json.loads(text, parse_constant=refuse)


class Page(HTMLParser):
    """Every attribute that could load something, every script, every table cell."""

    def __init__(self, text):
        super().__init__()
        self.sources, self.scripts, self.cells, self.tags = [], {}, [], []
        self.current = None
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        self.tags.append(tag)
        self.sources += [value for key, value in attributes if key in ("src", "href", "srcset", "data")]
        if tag == "script":
            self.current = found.get("id")
        elif not (tag == "button" and self.current in ("td", "th")):  # a cell's words may be a button's
            self.current = tag

    def handle_data(self, data):
        if self.current == "td":
            self.cells.append(data.strip())
        elif self.current is not None:
            self.scripts[self.current] = self.scripts.get(self.current, "") + data

    def handle_endtag(self, tag):
        self.current = None


def test_json_has_the_promised_structure():
    found = strict_json(json.dumps(rows_as_json(comparison())))
    assert found["scene"] == "fence"
    assert found["camera"]["size"] == [40, 30]
    assert (found["lens"]["radius"], found["lens"]["focus_distance"]) == (0.25, 2.0)
    assert found["reference"] == {"samples": 1024.0, "seconds": 12.5, "kept": False, "noise_floor_psnr": 55.5}
    assert found["rows"][1] == {
        "method": "mipmap",
        "preset": "best",
        "params": {"samples": 65, "pattern": "halton"},
        **SCORES,
        "prepare_s": 0.5,
        "blur_s": 0.125,
        "spread_s": 0.0625,
        "runs": 3,
        "at_noise_floor": False,
        **ARTEFACTS,
    }
    for word in ("compare fence", "--size 40x30", "--methods multiview,mipmap", "--set mipmap.samples=65"):
        assert word in found["command"]


def test_both_presets_of_a_method_are_told_apart(tmp_path):
    given = comparison()
    first, other = given.rows
    paper = replace(other, method="multiview", preset="paper", params={**first.params, "samples": 32})
    given = replace(given, rows=(first, paper))
    write_comparison(given, tmp_path)
    found = strict_json((tmp_path / "table.json").read_text())
    assert [(row["method"], row["preset"]) for row in found["rows"]] == [("multiview", "best"), ("multiview", "paper")]
    assert {"multiview.png", "multiview-paper.png"} <= {file.name for file in tmp_path.iterdir()}
    assert "| multiview (paper) |" in (tmp_path / "table.md").read_text()
    assert "multiview (paper)" in Page((tmp_path / "report.html").read_text()).cells
    # What the presets decide is not set; what they share is.
    assert "--preset best,paper" in found["command"]
    assert "--set multiview.pattern=halton" in found["command"]
    assert "multiview.samples" not in found["command"]


def test_json_of_infinite_and_missing_numbers_is_strict(tmp_path):
    scores = {"psnr": np.float32(math.inf), "ssim": math.nan, "flip": np.float32(0.25)}
    write_comparison(comparison(scores=scores, focus=math.inf), tmp_path)
    found = strict_json((tmp_path / "table.json").read_text())
    assert found["lens"]["focus_distance"] == "inf"
    row = found["rows"][0]
    assert (row["psnr"], row["ssim"], row["flip"], row["rmse"]) == ("inf", None, 0.25, None)
    assert "| inf | - | - | 0.2500 | - |" in re.sub(" +", " ", (tmp_path / "table.md").read_text())


def test_every_file_of_one_scene(tmp_path):
    given = comparison()
    write_comparisons([given], tmp_path / "out", "refdof compare fence --seed 7")
    images = ["reference", "pinhole", "multiview", "mipmap"]
    expected = {f"{name}{suffix}" for name in images for suffix in (".png", ".npy")}
    expected |= {"table.md", "table.csv", "table.json", "overview.png", "report.html"}
    expected |= {"scores.png", "scores.svg", "table.tex"}
    assert {file.name for file in (tmp_path / "out").iterdir()} == expected
    arrays = [given.reference, given.pinhole, *(row.image for row in given.rows)]
    for name, image in zip(images, arrays, strict=True):
        np.testing.assert_array_equal(load_image(tmp_path / "out" / f"{name}.npy"), image)
        with Image.open(tmp_path / "out" / f"{name}.png") as file:
            np.testing.assert_array_equal(np.asarray(file), to_8_bit(image))
    assert strict_json((tmp_path / "out/table.json").read_text())["command"] == "refdof compare fence --seed 7"


def test_csv_has_the_numbers_of_the_json(tmp_path):
    scores = {key: value / 3.0 for key, value in SCORES.items()}  # digits that rounding would lose
    write_comparison(comparison(scores=scores), tmp_path)
    rows = list(csv.DictReader(io.StringIO((tmp_path / "table.csv").read_text())))
    found = strict_json((tmp_path / "table.json").read_text())["rows"]
    assert len(rows) == len(found) == 2
    for line, row in zip(rows, found, strict=True):
        assert (line["scene"], line["method"]) == ("fence", row["method"])
        assert strict_json(line["params"]) == row["params"]
        for key in [*SCORES, "prepare_s", "blur_s", "spread_s", *ARTEFACTS]:
            assert float(line[key]) == row[key]


def test_the_table_of_a_terminal_has_80_characters_and_the_same_numbers():
    long = replace(
        comparison(), rows=[replace(row, method="accumulation", preset="paper") for row in comparison().rows]
    )
    for shown in (comparison(), long):
        lines = terminal_table([shown, shown]).splitlines()
        assert max(map(len, lines)) <= 80
        cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("| ")]
        first = markdown_table([shown]).partition("Where the error lies:")[0]
        whole = [line.strip("|").split("|") for line in first.splitlines() if line.startswith("| ")]
        head = [cell.strip() for cell in whole[0]]
        assert cells[0] == ["method", "PSNR [dB]", "SSIM", "FLIP", "blur [s]", "note"]
        for narrow, wide in zip(cells[2 : 2 + len(shown.rows)], whole[2:], strict=True):
            values = dict(zip(head, (cell.strip() for cell in wide), strict=True))
            assert narrow[:-1] == [values[name] for name in cells[0][:-1]]


def test_headings_of_the_table():
    head = [cell.strip() for cell in markdown_table([comparison()]).splitlines()[2].strip("|").split("|")]
    assert head == [
        "method", "PSNR [dB]", "8-bit PSNR [dB]", "SSIM", "FLIP", "RMSE", "relMSE", "max", "prepare [s]", "blur [s]",
        "spread [s]", "note",
    ]  # fmt: skip


def second_table(text):
    """The rows of the table under "Where the error lies", the heading first."""
    lines = text.partition("\nWhere the error lies:\n")[2].strip().splitlines()
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("| ")]


def test_the_second_table_tells_where_the_error_lies():
    some = {"rmse_in_focus": 0.001234, "rmse_behind": math.nan, "leakage": -1e-7, "kernel_radius": 1.25}
    shown = comparison(artefacts=some)
    text = markdown_table([shown])
    assert second_table(text)[0] == ["method", "in focus", "leakage", "kernel radius / disc"]
    assert second_table(text)[2:] == [[name, "0.00123", "0.00000", "1.250"] for name in ("multiview", "mipmap")]
    assert "Where the error lies, of linear values" in text
    mixed = replace(shown, rows=[shown.rows[0], replace(shown.rows[1], artefacts={**some, "rmse_behind": 0.5})])
    assert [row[2] for row in second_table(markdown_table([mixed]))[2:]] == ["-", "0.50000"]
    # Strict JSON and CSV say nothing where there is nothing.
    row = rows_as_json(mixed)["rows"][0]
    assert (row["rmse_behind"], row["ringing"], row["kernel_radius"]) == (None, None, 1.25)
    # Without a reference there is no such table, and never one of 80 characters.
    assert "error lies" not in markdown_table([comparison(artefacts={})])
    assert "error lies" not in terminal_table([shown])


def test_a_metric_is_one_entry(tmp_path, monkeypatch):
    mean = Metric("mean", "%", "low", "linear", 1, "absolute error", lambda r, i: 100.0 * float(np.abs(i - r).mean()))
    monkeypatch.setitem(METRICS, "mean_abs", mean)
    black = np.zeros((16, 16, 3))
    assert scores(black, black + 0.25)["mean_abs"] == 25.0
    write_comparison(comparison(scores={**SCORES, "mean_abs": 12.5}), tmp_path)
    row = strict_json((tmp_path / "table.json").read_text())["rows"][0]
    assert list(row)[3:12] == [*SCORES, "mean_abs", "prepare_s"]
    assert row["mean_abs"] == 12.5
    lines = (tmp_path / "table.csv").read_text().splitlines()
    assert ",max_abs,mean_abs,prepare_s," in lines[0]
    assert ",0.5,12.5,0.5," in lines[1]
    table = (tmp_path / "table.md").read_text()
    assert "| mean [%] |" in table
    assert "|     12.5 |" in table
    assert "mean (lower is better, absolute error)." in table
    assert '<th data-sort="number">mean [%]</th>' in (tmp_path / "report.html").read_text()


def test_markdown_is_aligned_and_marks_the_noise_floor():
    near = comparison(scores={**SCORES, "psnr": 52.5})  # 3 dB below the floor of 55.5
    below = comparison(scores={**SCORES, "psnr": 52.4})
    text = markdown_table([near])
    for part in text.split("Where the error lies:"):
        table = [line for line in part.splitlines() if line.startswith("|")]
        assert len(table) == 4
        assert len({len(line) for line in table}) == 1
        assert len({tuple(k for k, c in enumerate(line) if c == "|") for line in table}) == 1
    assert text.count("| at the noise floor |") == 2
    assert "| at the noise floor |" not in markdown_table([below])
    for words in (
        "1024 samples per pixel",
        "noise floor 55.50 dB",
        "peak 1",
        "sRGB",
        "67.0206 pixels per degree",
    ):
        assert words in text
    assert "| 52.50 | 31.12 | 0.9375 | 0.0625 | 0.01562 |" in re.sub(" +", " ", text)


def test_several_scenes_get_a_folder_each(tmp_path):
    scenes = [comparison(scene="fence"), comparison(scene="../a b"), comparison(scene="Fence")]
    write_comparisons(scenes, tmp_path)
    folders = ["Fence-2", "a-b", "fence"]
    assert sorted(file.name for file in tmp_path.iterdir() if file.is_dir()) == folders
    assert all((tmp_path / name / "report.html").is_file() for name in folders)
    found = strict_json((tmp_path / "table.json").read_text())
    assert [entry["scene"] for entry in found] == ["fence", "../a b", "Fence"]
    assert len((tmp_path / "table.csv").read_text().splitlines()) == 1 + 3 * 2
    assert (tmp_path / "table.md").read_text() == markdown_table(scenes)
    links = [
        source for source in Page((tmp_path / "report.html").read_text()).sources if not source.startswith("data:")
    ]
    assert set(links) == {f"{name}/report.html" for name in folders}


def plane(page, number):
    """The float16 numbers of a plane."""
    split = np.frombuffer(zlib.decompress(base64.b64decode(page.scripts[f"plane-{number}"])), dtype=np.uint8)
    low, high = split.astype(np.uint16).reshape(2, -1)
    return (low | high << 8).view(np.float16)


@pytest.mark.parametrize("largest", [3e6, 65504.0, 2e-9, 0.0])
def test_planes_beside_the_pictures_keep_their_range(largest):
    """Depths beyond float16 are scaled by a power of two; infinity stays, and no plane is embedded twice."""
    given = comparison()
    depth = np.linspace(0.01, 1.0, 40 * 30).reshape(30, 40) * largest
    depth[3, 4] = np.inf
    flip_map = np.full((30, 40), 0.3, dtype=np.float32)
    given = replace(
        given,
        depth=depth,
        coc_px=-depth,
        surface_counts=np.full((30, 40), 7),
        rows=(replace(given.rows[0], flip_map=flip_map),),
    )
    found = Page(page.report_page(given))
    images = {image["name"]: image for image in strict_json(found.scripts["about"])["images"]}
    for name, sign in (("depth", 1.0), ("circle of confusion", -1.0)):
        told = images[name]
        assert math.frexp(told["scale"])[0] == 0.5  # a power of two
        values = sign * plane(found, told["plane"]).astype(float) * told["scale"]
        np.testing.assert_allclose(values, depth.ravel(), rtol=1 / 2048)  # float16
    assert images["layers"]["scale"] * plane(found, images["layers"]["plane"])[0] == 7
    assert abs(plane(found, images["multiview"]["flip"])[0] - 0.3) <= 1 / 512  # rounded to 1/256
    numbers = [image["plane"] for image in images.values()] + [images["multiview"]["flip"]]
    assert sorted(numbers) == list(range(len(numbers)))
    assert f"plane-{len(numbers)}" not in found.scripts


def test_page_is_offline_and_holds_every_image():
    given = comparison()
    text = page.report_page(given, "refdof compare <&> fence")
    assert "http" not in text
    found = Page(text)
    assert found.sources == []  # nothing is loaded, not even from beside the page
    assert not {"link", "iframe", "object", "img"} & set(found.tags)
    assert "refdof compare <&> fence" in found.scripts["pre"]
    about = strict_json(found.scripts["about"])
    names = [image["name"] for image in about["images"]]
    assert names == ["reference", "pinhole", "multiview", "mipmap", "standard error"]
    arrays = [given.reference, given.pinhole, *(row.image for row in given.rows), given.standard_error]
    for told, image in zip(about["images"], arrays, strict=True):
        np.testing.assert_array_equal(plane(found, told["plane"]), image.astype(np.float16).ravel())
    for cell in ("multiview", "31.25", "0.9375", "samples = 64, pattern = halton"):
        assert cell in found.cells


def test_page_of_a_large_picture_embeds_png(monkeypatch):
    given = comparison()
    monkeypatch.setattr(planes, "FLOAT_LIMIT_PX", 40 * 30 - 1)
    found = Page(page.report_page(given))
    assert strict_json(found.scripts["about"])["encoding"] == "png"
    with Image.open(io.BytesIO(base64.b64decode(found.scripts["plane-3"]))) as file:
        np.testing.assert_array_equal(np.asarray(file), to_8_bit(given.rows[1].image))
    assert "plane-4" not in found.scripts


def test_page_shows_names_as_text():
    text = page.report_page(comparison(scene="<script>alert(1)</script>", methods=("</script><b>",)))
    assert "<script>alert" not in text
    assert "<b>" not in text
    # An unclosed or doubled script would show up as a missing or extra one: 5 images, data, sorting, viewer.
    assert Page(text).tags.count("script") == 4 + 3


@pytest.mark.parametrize("size", [(1, 1), (2, 1), (17, 300), (300, 17), (1, 400)])
@pytest.mark.parametrize("count", [0, 1, 8])
def test_degenerate_pictures_get_a_report(tmp_path, size, count):
    given = comparison(*size, methods=[f"m{k}" for k in range(count)], scores={})
    write_comparison(given, tmp_path)
    with Image.open(tmp_path / "overview.png") as file:
        file.load()
        assert file.width <= 1600
    strict_json((tmp_path / "table.json").read_text())


def test_bad_calls_are_named(tmp_path):
    with pytest.raises(InputError, match="comparisons: got none"):
        write_comparisons([], tmp_path)
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="out: "):
        write_comparison(comparison(), tmp_path / "file")
    given = comparison()
    given.rows[0].image.resize((10, 40, 3), refcheck=False)
    with pytest.raises(InputError, match="multiview: got shape"):
        write_comparison(given, tmp_path / "new")


def test_the_page_tells_where_the_error_lies():
    """Columns that no picture has are left out, and the worst method comes first as in the table of scores."""
    given = comparison()
    first, second = given.rows
    rows = (
        replace(first, artefacts={"leakage": 0.25, "lamps": math.nan}, scores={**SCORES, "psnr": 40.0}),
        replace(second, artefacts={"leakage": 0.5}),
    )
    found = Page(page.report_page(replace(given, rows=rows)))
    start = found.cells.index("0.50000")
    assert found.cells[start - 1 : start + 3] == ["mipmap", "0.50000", "multiview", "0.25000"]
    assert "Where the error lies" in page.report_page(replace(given, rows=rows))
    without = tuple(replace(row, artefacts={}) for row in rows)
    assert "Where the error lies" not in page.report_page(replace(given, rows=without))
    assert "lamps" not in found.scripts["th"]

"""The page of a check: failing cases first, with pictures; whole in itself, and nothing of others is markup in it."""

import base64
import json
import os
from html.parser import HTMLParser
from io import BytesIO
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

from refdof.cli import app
from refdof.oracle import Plan, check_source
from refdof.oracle.expectation import Part
from refdof.oracle.goldens import Tolerance
from refdof.oracle.junit import junit
from refdof.oracle.outcomes import Outcome, Report
from refdof.oracle.page import Pictures, check_page, heat
from refdof.oracle.sources import of_function
from tests.oracle.small_pack import command, of_case, staged_port, stages_of

pytestmark = pytest.mark.fast


class Page(HTMLParser):
    """Tags with their attributes, and the text."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.text = [], ""
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))

    def handle_data(self, data):
        self.text += data

    def images(self):
        """{(case, part, kind): (height, width, 3) uint8}."""
        found = {}
        for tag, attributes in self.tags:
            if tag == "img":
                content = base64.b64decode(attributes["src"].removeprefix("data:image/png;base64,"))
                found[tuple(attributes["alt"].split(", "))] = np.asarray(Image.open(BytesIO(content)))
        return found


@pytest.fixture(scope="module")
def wrong(pack):
    """A report and its page: sizes are wrong in the case with stages down, one is not run, one is right."""

    def function(color, depth, coc, params):
        faults = {"size": lambda s: s / 2} if depth.shape == (18, 24) else {}
        return staged_port(color, depth, coc, params, faults)

    pictures = Pictures()
    source = of_function(of_case(function, stages_of))
    report = check_source(source, pack, plan=Plan(not_supported=("up",)), show=pictures.add)
    return report, check_page(report, pictures)


def test_failing_cases_are_first_and_open_with_their_parts(wrong):
    report, text = wrong
    page = Page(text)
    assert [page.text.index(word) for word in ("cards", "noise", "noise_up")] == sorted(
        page.text.index(word) for word in ("cards", "noise", "noise_up")
    )
    assert [("open" in attributes) for tag, attributes in page.tags if tag == "details"] == [True, False, False]
    assert report.outcomes[0].message in page.text
    for part in ("coc", "size", "limit", "mean_1", "mean_4", "image"):
        assert part in page.text
    assert page.text.count("inherited") >= 3


def test_pictures_of_what_is_off_and_of_nothing_else(wrong):
    images = Page(wrong[1]).images()
    assert {(case, part) for case, part, _ in images} == {("cards", part) for part in wrong[0].outcomes[0].causes}
    assert {kind for _, _, kind in images} == {"got", "expected", "difference"}
    assert {image.shape for image in images.values()} == {(18, 24, 3)}
    got, golden = images["cards", "size", "got"].astype(int), images["cards", "size", "expected"].astype(int)
    assert golden.max() == 255
    assert np.abs(2 * got - golden).max() <= 1  # half of each size, from 0


def test_the_page_is_whole_in_itself(wrong):
    for tag, attributes in Page(wrong[1]).tags:
        assert tag not in ("link", "script", "iframe", "a")
        assert all(value is None or "//" not in value or tag == "img" for value in attributes.values())
        assert attributes.get("src", "data:image/png;base64,").startswith("data:image/png;base64,")


def test_words_of_others_are_no_markup():
    evil = "<script>alert(1)</script><img src=x>"
    report = Report((Outcome("cards", "error", evil, 0.0),), (evil,))
    page = Page(check_page(report, Pictures()))
    assert page.text.count(evil) == 2
    assert not {"script", "img"} & {tag for tag, _ in page.tags}
    assert ElementTree.fromstring(junit(report)).find("testcase/error").get("message") == evil


def test_the_scale_of_differences():
    ratio = np.array([[0.0, 0.5, 1.0, 10.0, 1e4, 1e9, np.inf, np.nan]])
    colors = heat(ratio)[0]
    np.testing.assert_allclose(colors[0], 0.0)
    np.testing.assert_allclose(colors[1:3], [(0.1, 0.2, 0.5)] * 2)
    np.testing.assert_allclose(colors[3], (0.8, 0.2, 0.0), atol=1e-12)  # a quarter of the scale
    np.testing.assert_allclose(colors[4:7], 1.0)
    np.testing.assert_allclose(colors[7], (1.0, 0.0, 1.0))
    np.testing.assert_allclose(heat(np.array([[[0.0, 1e4, 2.0]]])), 1.0)  # the worst channel


def test_large_pictures_are_small_on_the_page_and_lose_no_difference(monkeypatch):
    monkeypatch.setattr("refdof.oracle.page._MOST_PARTS", 2)
    golden = np.full((400, 200, 3), 0.5, np.float32)
    values = golden.copy()
    values[399, 199, 1] = np.nan
    part = Part(golden, golden, golden, Tolerance(1e-3, 0.0, 1.0, 0.0, "by hand"))
    pictures = Pictures()
    for number in range(4):
        pictures.add(f"case_{number}", "image", values, part)
    assert pictures.left_out == 2
    made = pictures.of("case_0", "image")["images"]["difference"]
    shown = np.asarray(Image.open(BytesIO(base64.b64decode(made))))
    assert shown.shape == (134, 67, 3)
    assert tuple(shown[-1, -1]) == (255, 0, 255)
    assert (shown.reshape(-1, 3)[:-1] == 0).all()


@pytest.mark.skipif(os.name != "posix", reason="process groups are POSIX's")
def test_the_command_writes_all_reports(pack, tmp_path):
    (tmp_path / "waivers.toml").write_text(
        '[[waiver]]\ncase = "none"\nreason = "why"\nurl = "https://example.org"\nexpires = 2999-01-01\n'
    )
    files = {kind: tmp_path / f"report.{kind}" for kind in ("html", "json", "junit")}
    right = command(tmp_path, "(out / 'image.f32').write_bytes((case / 'expected' / 'image.f32').read_bytes())")
    words = ["check", "--pack", str(pack), "--impl", right, "--not-supported", "up", "--shard", "1/2"]
    words += ["--waivers", str(tmp_path / "waivers.toml")]
    for kind, file in files.items():
        words += [f"--{kind}", str(file)]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.output
    assert "warning: waiver of none: matches no case of the pack" in done.stderr
    assert done.stdout.splitlines()[-1] == "1 pass, 1 not supported"
    assert "Passed" in files["html"].read_text()
    cases = json.loads(files["json"].read_text())["cases"]
    assert [case["case"] for case in cases] == ["cards", "noise_up"]
    suite = ElementTree.fromstring(files["junit"].read_text())
    assert (suite.get("tests"), suite.get("skipped"), suite.get("failures")) == ("2", "1", "0")
    assert "image: cumulative pass, isolated pass" in suite.find("testcase/system-out").text
    assert "matches no case" in suite.find("system-err").text
    wrong = command(tmp_path, "(out / 'image.f32').write_bytes((case / 'inputs' / 'color.f32').read_bytes())")
    assert CliRunner().invoke(app, ["check", "--pack", str(pack), "--impl", wrong, "--only", "cards"]).exit_code == 1

"""The command `refdof sweep`: its table, its answers, and one line for bad input."""

import csv
import json
import re
import shlex

import numpy as np
import pytest
from typer.testing import CliRunner

from refdof import InputError
from refdof.cli import app
from refdof.image.file import load_image

SMALL = ("--method", "mipmap,pyramidal", "--size", "24x16", "--samples", "64")


def sweep(*words):
    done = CliRunner().invoke(app, ["sweep", *map(str, words)])
    assert done.exit_code == 0, done.exception
    return done.stdout


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    """A folder with the results of a small sweep, and what was printed."""
    folder = tmp_path_factory.mktemp("sweep") / "out"
    return folder, sweep("fence", "town", *SMALL, "--quality", "15dB", "--budget", "2s", "--out", folder)


def test_what_is_printed(swept):
    folder, printed = swept
    assert printed.count("### ") == 2
    assert "### fence, 24 x 16" in printed
    assert f"16 points, 0 of them from earlier runs. Report: {folder / 'report.html'}" in printed
    for scene in ("fence", "town"):
        assert re.search(
            rf"{scene}, 24 x 16: the fastest with at least 15 dB is \w+ with \w+=\d+: \d\d\.\d\d dB", printed
        )
        assert f"{scene}, 24 x 16: the nearest to the reference in 2.00 s is" in printed


def test_the_command_of_a_point_renders_its_picture(swept, tmp_path, monkeypatch):
    folder, _ = swept
    with (folder / "sweep.csv").open(newline="") as file:
        row = next(row for row in csv.DictReader(file) if row["scene"] == "town" and row["method"] == "pyramidal")
    words = shlex.split(row["command"])
    assert words[:2] == ["refdof", "render"]
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, [*words[1:-1], "a.npy"])
    assert done.exit_code == 0, done.exception
    from refdof import load_scene, render

    scene = load_scene("town")
    wanted = render("pyramidal", scene, scene.camera.with_size((24, 16)), largest_side=1).image
    np.testing.assert_array_equal(load_image("a.npy"), wanted)


def test_files(swept):
    folder, _ = swept
    names = {path.name for path in folder.iterdir()}
    assert names == {
        *("sweep.duckdb", "sweep.csv", "sweep.parquet", "report.html", "fronts.tex"),
        *(f"front-{scene}-24-x-16.{kind}" for scene in ("fence", "town") for kind in ("svg", "png")),
    }
    page = (folder / "report.html").read_text()
    assert not re.search(r"(?:src|href)=[\"']?https?:", page)
    assert page.count("<svg") == 2
    latex = (folder / "fronts.tex").read_text()
    assert r"largest\_side=" in latex or r"foreground\_points=" in latex
    assert latex.count(r"\midrule") == 2


def test_again_nothing_is_measured(swept):
    folder, _ = swept
    again = json.loads(sweep("fence", "town", *SMALL, "--out", folder, "--quality", "99dB", "--json"))
    assert len(again["points"]) == 16
    with (folder / "sweep.csv").open(newline="") as file:
        before = {row["measured_at"] for row in csv.DictReader(file)}
    assert {point["measured_at"] for point in again["points"]} == before
    assert [answer["quality_db"] for answer in again["answers"]] == [99.0, 99.0]
    assert re.search(
        r"99 dB lies above the reference's noise floor of \d\d\.\d dB: more --samples are needed; the best is",
        again["answers"][0]["words"],
    )
    keys = {point["key"] for point in again["points"]}
    assert all(set(front) <= keys and front for front in again["fronts"].values())
    assert "16 points, 16 of them from earlier runs" in sweep("fence", "town", *SMALL, "--out", folder)


def test_predictions(tmp_path):
    words = ("--method", "pyramidal", "--vary", "size=24x16,48x32,96x64", "--vary", "largest_side=2,4,8")
    found = json.loads(sweep("fence", *words, "--samples", "64", "--predict", "192x128", "--out", tmp_path, "--json"))
    (cost,) = found["costs"]
    assert set(cost["exponents"]) == {"pixels", "largest_side"}
    (predicted,) = found["predictions"]
    assert (predicted["method"], predicted["size"]) == ("pyramidal", "192x128")
    assert 0.0 < predicted["seconds"] < 10.0
    # Of what answers a quality, and a line for what cannot be predicted.
    words = ("--method", "mipmap", "--vary", "delta=0.25,0.5", "--quality", "1dB", "--budget", "9s")
    printed = sweep("fence", *words, *SMALL[2:], "--predict", "192x128", "--out", tmp_path)
    assert re.search(r"^mipmap: nothing is predicted; with delta varied, at least 4 points", printed, re.MULTILINE)


@pytest.mark.fast
@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["fence", "--method", "mipmat"], "method: got 'mipmat'; did you mean 'mipmap'?"),
        (["fence", "--method", "mipmap", "--vary", "delt=1,2"], "did you mean 'delta'?"),
        (["fence", "--vary", "samples="], "vary: got 'samples='; allowed is KEY=VALUE,VALUE,..."),
        (["fence", "--vary", "size=1,2"], "vary: size: got '1'; allowed is WIDTHxHEIGHT"),
        (["fence", "--budget", "50"], "budget: got '50'; allowed is NUMBERms or NUMBERs"),
        (["fence", "--budget", "-5ms"], "budget: got '-5ms'; allowed is NUMBERms or NUMBERs or NUMBERus, above 0"),
        (["fence", "--budget", "1e3.5ms"], "budget: got '1e3.5ms'"),
        (["fence", "--quality", "much"], "quality: got 'much'; allowed is NUMBERdB"),
        (["fence", "--quality", "32ms"], "quality: got '32ms'"),
        (["fence", "--predict", "big"], "predict: got 'big'"),
        (["fence", "--preset", "best"], "preset: got 'best'; allowed are tradeoff"),
        (["fenc", "--size", "24x16"], "did you mean 'fence'?"),
        (["fence", "no.obj", "--size", "24x16"], "scene: got 'no.obj': there is no such file"),
        (["fence", "--set", "mipmap.delta=1", "--vary", "delta=1,2"], "set: got mipmap.delta, which --vary names"),
        (["fence", "--size", "8x8"], "size: got 8x8; allowed for scores is at least 11x11"),
    ],
)
def test_bad_input_is_one_line(tmp_path, monkeypatch, words, says):
    monkeypatch.chdir(tmp_path)
    error = CliRunner().invoke(app, ["sweep", *words], standalone_mode=False).exception
    assert isinstance(error, InputError)
    assert says in str(error)
    assert "\n" not in str(error)
    assert not list(tmp_path.iterdir())

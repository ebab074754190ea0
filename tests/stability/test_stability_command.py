"""The command `refdof stability`: its text, its JSON, its page, its exit status, and one line for bad input."""

import json
from contextlib import contextmanager

import pytest
from typer.testing import CliRunner

from refdof import stability_cli
from refdof.cli import app
from refdof.stability import CASES
from refdof.stability.verdict import Cell, Figure
from tests.one_line import refused

pytestmark = pytest.mark.fast

CHEAP = ["--only", "depth-zero,size-1x1", "--methods", "separable,accumulation"]


def stability(*words, status=0):
    done = CliRunner().invoke(app, ["stability", *words])
    assert done.exit_code == status, done.exception
    return done.stdout


def test_a_table_in_words():
    text = stability(*CHEAP).splitlines()
    assert text[0].split() == ["separable", "accumulation"]
    assert text[1].split() == ["depth-zero", "refused", "refused"]
    assert text[2].split() == ["size-1x1", "pass", "pass"]
    assert text[-1] == "2 pass, 2 refused, 0 degraded, 0 broken of 4 cells"


def test_json_has_every_figure():
    told = json.loads(stability(*CHEAP, "--json"))
    assert told["summary"] == {"pass": 4, "degraded": 0, "broken": 0, "-": 0}
    assert [(cell["case"], cell["method"]) for cell in told["cells"]] == [
        (case, method) for case in ("depth-zero", "size-1x1") for method in ("separable", "accumulation")
    ]
    refused, _, filtered, traced = told["cells"]
    assert refused["note"].startswith("refused: depth: smallest value is 0")
    assert refused["figures"] == []
    assert [figure["name"] for figure in filtered["figures"]] == [
        "non-finite",
        "float32",
        "circles",
        "convexity",
        "symmetry",
    ]
    assert traced["error_ulp"] is None
    assert {figure["kept_below"] for figure in filtered["figures"]} == {None}  # nothing is documented of it
    assert filtered["error_ulp"] < 168


def broken(*_):
    figure = Figure("constant", float("nan"), 1.0, "ulp", "a | reason")
    return [Cell("size-1x1", "separable", "broken", "constant: <nan>", (figure,), float("nan"), 3, "across")]


def test_broken_cells_are_told_and_fail(monkeypatch, tmp_path):
    monkeypatch.setattr(stability_cli, "matrix", broken)
    text = stability("--only", "size-1x1", "--html", str(tmp_path / "page.html"), status=1)
    said = "constant no number ulp, at most 1. constant: <nan> (float32 errs first in the stage 'across')"
    assert f"broken: size-1x1, separable: {said}" in text
    page = (tmp_path / "page.html").read_text()
    assert "constant: &lt;nan&gt;" in page
    assert "no number" in page
    assert 'First in the stage "across". 3 pixels are not finite.' in page
    assert [file.name for file in tmp_path.iterdir()] == ["page.html"]
    told = json.loads(stability("--only", "size-1x1", "--json", status=1))
    assert told["cells"][0]["error_ulp"] is told["cells"][0]["figures"][0]["value"] is None


def test_each_cell_is_told_and_what_it_waits_for(monkeypatch):
    told = []

    @contextmanager
    def line(_):
        yield lambda *words: told.append(words)

    monkeypatch.setattr(stability_cli, "progress_line", line)
    monkeypatch.setattr(stability_cli, "is_warm", lambda jobs: jobs[0].startswith("accumulation "))
    stability(*CHEAP)
    assert told == [
        ("depth-zero, separable: compiling", 0, 4),
        ("depth-zero, accumulation", 1, 4),
        ("size-1x1, separable", 2, 4),
        ("size-1x1, accumulation", 3, 4),
    ]


def degraded(*_):
    figure = Figure("pinhole", 2.0**22, 168.0, "ulp", "a reason")
    return [Cell("circle-denormal", "poisson", "degraded", "why", (figure,))]


def test_the_wider_bound_is_told_everywhere(monkeypatch, tmp_path):
    monkeypatch.setattr(stability_cli, "matrix", degraded)
    text = stability("--only", "circle-denormal", "--html", str(tmp_path / "page.html"))
    assert "pinhole 4.2e+06 ulp, at most 1.7e+02, kept below 8.4e+06. why" in text
    told = json.loads(stability("--only", "circle-denormal", "--json"))
    assert told["cells"][0]["figures"][0]["kept_below"] == 2.0**23
    page = (tmp_path / "page.html").read_text()
    assert "<td>4.2e+06</td><td>1.7e+02</td><td>8.4e+06</td>" in page
    assert "<th>kept below</th>" in page


def test_the_page_needs_nothing_else(tmp_path):
    stability(*CHEAP, "--html", str(tmp_path / "page.html"))
    page = (tmp_path / "page.html").read_text()
    assert page.count("<tr>") > 4
    assert "http" not in page.replace("http-equiv", "")
    assert "src=" not in page


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--methods", "separabel"], "methods: got 'separabel'; did you mean 'separable'?"),
        (["--methods", "separable,separable"], "methods: got 'separable' twice; allowed is once"),
        (["--methods", ""], "methods: got ''"),
        (["--only", "depth-zer"], "only: got 'depth-zer'; did you mean 'depth-zero'? allowed are " + CASES[0].name),
        (["--only", "depth-zero,"], "only: got ''; allowed are " + CASES[0].name),
        (["--threads", "0"], "threads: got 0"),
        (["--html", "."], "html: got '.', which is not a regular file"),
        (["--html", "/dev/null/page.html"], "html: "),
    ],
)
def test_bad_input_is_one_line(monkeypatch, capsys, words, message):
    assert message in refused(monkeypatch, capsys, "stability", *words)


def test_help(monkeypatch):
    text = CliRunner().invoke(app, ["stability", "--help"], env={"COLUMNS": "120"}).stdout
    for option in ("--methods", "--only", "--html", "--json", "--threads"):
        assert option in text
    assert "Run every method at the numerical extremes" in CliRunner().invoke(app, ["--help"]).stdout

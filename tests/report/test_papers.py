"""Plots and tables for papers: the same bytes again, points where the numbers say, and LaTeX that prints any name."""

import re
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given as drawn
from hypothesis import settings
from hypothesis import strategies as st
from PIL import Image

from refdof.report.latex import escaped, latex_table
from refdof.report.plots import write_scatter
from tests.fake_comparison import SCORES, comparison

ODD = [
    "50% & more",
    "a_b^c",
    "$x$ #1",
    "~{\\textbf}",
    "[1] *",
    "x--y---z",
    "``quoted'' \"x\"",
    "<|>",
    "line\nfeed",
    "fi?`!`",
]

# What LaTeX prints for each command, written down from its manuals: `textcomp` and T1 for the rest of ASCII.
PRINTED = {
    r"\textbackslash{}": "\\", r"\textasciitilde{}": "~", r"\textasciicircum{}": "^", r"\textless{}": "<",
    r"\textgreater{}": ">", r"\textbar{}": "|", r"\textquotedbl{}": '"', r"\textquotesingle{}": "'",
    r"\textasciigrave{}": "`", r"\{": "{", r"\}": "}", r"\#": "#", r"\$": "$", r"\%": "%", r"\&": "&", r"\_": "_",
    "{-}": "-",
}  # fmt: skip


def printed(text):
    """What LaTeX prints: known commands, and letters that mean nothing else."""
    token = re.compile("|".join(re.escape(command) for command in PRINTED) + r"|[^\\{}$&#^_~%<>|\"'`\-\n]")
    result, at = "", 0
    while at < len(text):
        found = token.match(text, at)
        assert found, f"{text[at:]!r} would not be printed as it is"
        result += PRINTED.get(found[0], found[0])
        at = found.end()
    return result


@settings(max_examples=200)
@drawn(st.text(st.characters(min_codepoint=32, max_codepoint=126), max_size=40))
def test_latex_prints_any_text(text):
    assert printed(escaped(text)) == " ".join(text.split())


def body_of(table):
    """Cells of each row, and the lines between."""
    lines = table.splitlines()
    return [
        [cell.strip() for cell in re.split(r"(?<!\\)&", line.removesuffix(r" \\"))]
        for line in lines
        if line.endswith(r"\\")
    ]


def test_a_table_has_every_method_and_the_best_in_bold():
    given = comparison(methods=ODD)
    scores = [{**SCORES, "psnr": 20.0 + k, "flip": 0.5 - k / 100, "ssim": 0.5} for k in range(len(ODD))]
    scores[4] = {}
    given = replace(
        given,
        rows=tuple(
            replace(r, scores=s, blur_s=0.1 * (1 + k)) for k, (r, s) in enumerate(zip(given.rows, scores, strict=True))
        ),
    )
    table = latex_table([given])
    lines = table.splitlines()
    assert lines[1] == r"\begin{tabular}{lrrrrr}"
    assert [line for line in lines if line.endswith("rule")] == [r"\toprule", r"\midrule", r"\bottomrule"]
    head, *rows = body_of(table)
    assert head[1] == r"PSNR [dB] $\uparrow$"
    assert head[3] == r"FLIP $\downarrow$"
    assert [printed(row[0][1:-1]) for row in rows] == [" ".join(name.split()) for name in ODD]
    assert all(row[0][0] + row[0][-1] == "{}" for row in rows)  # "\\ [1]" would be a distance
    assert [[text.startswith(r"\textbf{") for text in row[1:]] for row in (rows[0], rows[-1])] == [
        [False, True, False, True, True],
        [True, True, True, True, False],
    ]  # PSNR, SSIM (all alike), FLIP, RMSE (all alike), blur
    assert rows[4][1:5] == ["--"] * 4
    assert rows[-1][1] == r"\textbf{29.00}"


def test_tables_of_special_values_and_several_scenes():
    one = comparison(methods=("a", "b"), scores={**SCORES, "psnr": np.inf}, scene="50%_{}")
    two = comparison(methods=("a",), scores={**SCORES, "psnr": -3.25})
    rows = body_of(latex_table([one, two]))
    assert rows[1] == [r"\multicolumn{6}{l}{\emph{50\%\_\{\}}}"]
    assert rows[2][1] == r"\textbf{$\infty$}"
    assert rows[5][1] == "$-3.25$"  # a single method is not the best


def write(given, folder, name="scores"):
    paths = [folder / f"{name}.png", folder / f"{name}.svg"]
    write_scatter(given, paths)
    return [path.read_bytes() for path in paths]


def test_plots_are_the_same_bytes_again(tmp_path):
    given = comparison(methods=ODD)
    first = write(given, tmp_path)
    assert write(given, tmp_path, "again") == first
    assert b"date" not in first[1].lower()
    ET.fromstring(first[1])  # well-formed
    with Image.open(tmp_path / "scores.png") as file:
        file.load()
    assert {path.name for path in tmp_path.iterdir()} == {"scores.png", "scores.svg", "again.png", "again.svg"}


def test_points_stand_where_the_numbers_say(tmp_path):
    """Equal ratios of times and of errors are equal distances; a method without a score is named instead."""
    given = comparison(methods=("a", "b", "c", "d"))
    rows = [replace(r, blur_s=10.0**k, scores={"rmse": 10.0 ** (-2 * k)}) for k, r in enumerate(given.rows[:3])]
    write(replace(given, rows=(*rows, replace(given.rows[3], scores={}))), tmp_path)
    drawing = ET.parse(tmp_path / "scores.svg").getroot()
    space = {"svg": drawing.tag[1:].split("}")[0]}
    uses = [
        group.findall(".//svg:use", space)
        for group in drawing.iterfind(".//svg:g[@id]", space)
        if group.get("id").startswith("line2d")
    ]
    points = np.array(
        [
            (float(one[0].get("x")), float(one[0].get("y")))
            for one in uses
            if len(one) == 1 and "c75b00" in one[0].get("style", "")
        ]
    )
    assert len(points) == 3
    steps = np.diff(points, axis=0)
    np.testing.assert_allclose(steps[0], steps[1], atol=2e-3)  # coordinates have six digits
    assert steps[0][0] > 0.0  # slower is further right
    assert steps[0][1] > 0.0  # a smaller error is lower, where y is larger


@pytest.mark.parametrize("count", [0, 1])
def test_plots_of_few_methods(tmp_path, count):
    assert all(write(comparison(methods=ODD[:count], scores={}), tmp_path))

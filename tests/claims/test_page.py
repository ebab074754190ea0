"""docs/claims.md is current: its text, every figure that can be measured anew, and every verdict."""

import json
import math
import os
from collections.abc import Mapping
from pathlib import Path

import pytest

from refdof.claims import Rule, claims, kind_of, markdown_page, row_of, scorecard, summary_rows, terminal_text
from refdof.claims.verdict import REPRODUCED, VERDICTS

ROOT = next(folder for folder in Path(__file__).parents if (folder / "pyproject.toml").exists())
PAGE = (ROOT / "docs" / "claims.md").read_text(encoding="utf-8")
KEPT = json.loads((ROOT / "docs" / "claims.json").read_text(encoding="utf-8"))
CLAIMS = claims()
ROWS = [row_of(claim, KEPT["figures"].get(claim.name)) for claim in CLAIMS]
ANEW = "the figure has changed: run `python benchmarks/claims.py --keep-times`, and look at what its verdict says"


def differing(kind):
    """Claims whose figures or verdicts are not those that the page shows."""
    shown = {row.claim.name: row for row in ROWS}
    rows = scorecard([claim for claim in CLAIMS if kind_of(claim) == kind])
    return {
        row.claim.name: (row.figure, shown[row.claim.name].figure)
        for row in rows
        if row.verdict != shown[row.claim.name].verdict or not alike(row, shown[row.claim.name])
    }


def alike(row, other):
    """Whether two figures are within a unit of the last digit shown: processors round rays differently."""
    first, second = (r.figure if isinstance(r.figure, Mapping) else {"": r.figure} for r in (row, other))
    assert first.keys() == second.keys()
    units = {name: last_digit(value, row.claim.digits) for name, value in second.items()}
    return all(abs(first[name] - second[name]) <= 1.001 * units[name] for name in units)


def last_digit(value, digits):
    """What the last of so many significant digits of a number is worth."""
    return 10.0 ** (math.floor(math.log10(abs(value))) - digits + 1) if value else 0.0


@pytest.mark.fast
def test_the_page_is_what_its_figures_make():
    assert markdown_page(ROWS, KEPT["machine"]) == PAGE, "run `python benchmarks/claims.py --keep-times`"


@pytest.mark.fast
def test_every_claim_that_is_measured_has_a_figure_and_no_other():
    assert set(KEPT["figures"]) == {claim.name for claim in CLAIMS if claim.measure}
    assert KEPT["machine"]


@pytest.mark.fast
def test_every_verdict_has_its_sentence():
    for row in ROWS:
        assert row.verdict in row.claim.why or row.claim.rule.not_testable, row.claim.name


@pytest.mark.fast
def test_formulas_have_the_figures_of_the_page():
    assert not differing("formula"), ANEW


@pytest.mark.slow
@pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="takes hours without compiling")
def test_pictures_have_the_figures_of_the_page():
    assert not differing("picture"), ANEW


@pytest.mark.fast
def test_figures_are_alike_to_a_unit_of_the_last_digit_shown():
    claim = next(row.claim for row in ROWS if row.claim.name == "mipmap-moderate-blur")
    assert (claim.digits, last_digit(-0.37, 3), last_digit(33.4, 4), last_digit(1e-7, 2)) == (3, 1e-3, 1e-2, 1e-8)
    assert alike(row_of(claim, -0.3694), row_of(claim, -0.3696))
    assert not alike(row_of(claim, -0.3694), row_of(claim, -0.372))
    assert not alike(row_of(claim, 1e-9), row_of(claim, 0.0))


@pytest.mark.fast
def test_a_changed_figure_shows():
    name = "mipmap-reads"
    changed = [row if row.claim.name != name else row_of(row.claim, 21.98) for row in ROWS]
    assert next(row for row in changed if row.claim.name == name).verdict == "refuted"
    assert markdown_page(changed, KEPT["machine"]) != PAGE


@pytest.mark.fast
def test_counts_add_up():
    head, *body, total = summary_rows(ROWS)
    assert head == ["source", *VERDICTS, "claims"]
    numbers = [[int(cell) for cell in row[1:]] for row in body]
    assert [sum(column) for column in zip(*numbers, strict=True)] == [int(cell) for cell in total[1:]]
    assert all(sum(row[:-1]) == row[-1] for row in numbers)
    assert int(total[-1]) == len(CLAIMS) >= 50


@pytest.mark.fast
def test_the_page_and_the_terminal_show_every_row():
    text = terminal_text(ROWS)
    for row in ROWS:
        assert f"`{row.claim.name}`" in PAGE
        assert f"{row.verdict.upper()}  {row.claim.name}  (" in text
        assert row.why.replace("|", "\\|") in PAGE
    assert "](claims.md)" in (ROOT / "docs" / "index.md").read_text(encoding="utf-8")


@pytest.mark.fast
def test_a_row_as_json():
    row = row_of(CLAIMS[0], 1.23456e-12)
    told = row.as_json()
    assert told["verdict"] == REPRODUCED
    assert told["ours"] == 1.23e-12
    assert json.loads(json.dumps(told)) == told
    assert Rule(**{"within": CLAIMS[0].rule.within}).in_words() == told["rule"]

"""docs/stability.md has the verdicts of the matrix; nothing is broken, and what is degraded is explained."""

import os
from pathlib import Path

import pytest

from refdof.methods import METHODS
from refdof.stability import CASES, markdown_section, matrix
from refdof.stability.cases import GROUPS
from refdof.stability.degraded import DEGRADED
from refdof.stability.page import word_of
from refdof.stability.verdict import Cell, Figure

ROOT = next(folder for folder in Path(__file__).parents if (folder / "pyproject.toml").exists())
PAGE = (ROOT / "docs" / "stability.md").read_text(encoding="utf-8")
SECTION = PAGE.partition("<!-- matrix -->\n")[2].partition("<!-- /matrix -->")[0]
ANEW = "run `python benchmarks/stability.py`, and look at what has changed"
# No picture, or of a few pixels: seconds, even where nothing is compiled.
CHEAP = [case for case in CASES if case.refused or case.name in ("size-1x1", "size-2x2")]


def verdicts(section):
    """The words of the section's first tables, by case and method."""
    found = {}
    for line in section.partition("### Degraded")[0].splitlines():
        cells = [cell.strip() for cell in line.strip("| ").split(" | ")]
        if line.startswith("| case "):
            methods = cells[1:]
        elif line.startswith("| `"):
            name = cells[0].split("`")[1]
            found |= {(name, method): word.strip("*") for method, word in zip(methods, cells[1:], strict=True)}
    return found


SHOWN = verdicts(SECTION)


@pytest.mark.fast
def test_the_page_has_every_cell_and_none_is_broken():
    assert set(SHOWN) == {(case.name, method) for case in CASES for method in METHODS}, ANEW
    assert set(SHOWN.values()) <= {"pass", "refused", "degraded", "-"}


@pytest.mark.fast
def test_what_is_degraded_is_explained_and_nothing_else():
    assert {place for place, word in SHOWN.items() if word == "degraded"} == set(DEGRADED), ANEW
    for (case, _), documented in DEGRADED.items():
        assert documented.why.endswith(".")
        assert documented.why in SECTION
        assert f"in `{case}` (" in SECTION.partition("### Degraded")[2]


@pytest.mark.fast
def test_cheap_cases_have_the_verdicts_of_the_page():
    cells = matrix(cases=CHEAP)
    assert len(cells) > 80
    assert {(cell.case, cell.method): word_of(cell) for cell in cells} == {
        (case.name, method): SHOWN[case.name, method] for case in CHEAP for method in METHODS
    }


@pytest.mark.slow
@pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="takes hours without compiling")
def test_every_case_has_the_verdicts_of_the_page():
    cells = matrix()
    off = {
        (cell.case, cell.method): (word_of(cell), SHOWN[cell.case, cell.method], cell.note)
        for cell in cells
        if word_of(cell) != SHOWN[cell.case, cell.method]
    }
    assert not off, ANEW


@pytest.mark.fast
def test_names_and_groups():
    names = [case.name for case in CASES]
    assert len(set(names)) == len(names) >= 60
    assert list(dict.fromkeys(case.group for case in CASES)) == list(GROUPS)
    assert {method for case in CASES for method in (*case.params, *case.skip)} <= set(METHODS)


@pytest.mark.fast
def test_a_section_by_hand():
    wrong = Figure("sharpness", 3.0, 1.0, "of the room", "a reason")
    far = Figure("contamination", 5.0, 2.0, "px", "far | wide")
    cells = [
        Cell("radius-small", "poisson", "degraded", "why", (wrong,), 2.25, 0, ""),
        Cell("depth-zero", "poisson", "pass", "refused: depth: smallest value is 0"),
        Cell("nan-inside", "poisson", "broken", "", (far,), None, 9, ""),
        Cell("size-1x1", "poisson", "pass", "", (), 512.0, 0, "image"),
    ]
    section = markdown_section(cells)
    assert verdicts(section) == {
        ("depth-zero", "poisson"): "refused",
        ("radius-small", "poisson"): "degraded",
        ("nan-inside", "poisson"): "broken",
        ("size-1x1", "poisson"): "pass",
    }
    assert "1 pass, 1 refused, 1 degraded, 1 broken of 4 cells" in section
    assert "`poisson` in `radius-small` (sharpness 3 of the room, kept below 1e+05)" in section
    assert "| `size-1x1` | 5.1e+02<br>`image` |" in section
    assert "| `nan-inside` | 5 |" in section
    assert r"| `nan-inside` | contamination | 2 px | far \| wide |" in section

"""docs/stability.md, formulas: figures are those of a fresh evaluation, and forms keep their bounds."""

import json
import sys
from pathlib import Path

import mpmath
import numpy as np
import pytest

ROOT = next(folder for folder in Path(__file__).parents if (folder / "pyproject.toml").exists())
sys.path.append(str(ROOT / "benchmarks"))

import cancellation  # noqa: E402

FIGURES = json.loads((ROOT / "docs" / "cancellation.json").read_text(encoding="utf-8"))
PAGE = (ROOT / "docs" / "stability.md").read_text(encoding="utf-8")
ANEW = "run `python benchmarks/cancellation.py`"
UNIT = 2.0**-23
EACH = pytest.mark.parametrize("formula", cancellation.FORMULAS, ids=lambda formula: formula.name)
# The naive form loses nothing there, and the page says so.
HARMLESS = {"reversed_depth", "mip_level"}

pytestmark = pytest.mark.fast


def test_the_section_is_what_its_figures_make():
    assert cancellation.with_section(PAGE, FIGURES) == PAGE, ANEW
    assert list(FIGURES) == [formula.name for formula in cancellation.FORMULAS]


@EACH
def test_figures_are_those_of_a_fresh_evaluation(formula):
    # Logarithms of the drawn inputs, and exp and log in some forms, differ by a rounding between processors: the worst
    # of 1000 may be another input then, whose error is alike.
    fresh = cancellation.measure(formula)
    assert fresh.keys() == FIGURES[formula.name].keys()
    for name, figures in FIGURES[formula.name].items():
        for which in ("worst", "median"):
            assert fresh[name][which] == pytest.approx(figures[which], rel=0.5, abs=2.0**-50), (name, which, ANEW)
        assert fresh[name]["not finite"] == figures["not finite"]


@EACH
def test_the_worst_inputs_are_as_bad_as_stated(formula):
    # The naive form at the one input, against digits that are counted here.
    values = [np.float32([value]) for value in FIGURES[formula.name]["naive"]["at"]]
    with mpmath.workdps(60):
        true = formula.naive(*(mpmath.mpf(float(value[0])) for value in values))
        share = abs(true) if formula.unit is None else mpmath.mpf(1)
        error = float(abs(mpmath.mpf(float(formula.naive(*values)[0])) - true) / share)
    assert error == pytest.approx(FIGURES[formula.name]["naive"]["worst"], rel=0.5)


@EACH
def test_refdofs_forms_keep_their_bounds(formula):
    figures = FIGURES[formula.name]
    assert figures["ours"]["not finite"] == 0
    assert figures["ours"]["worst"] <= formula.bound * UNIT
    assert (figures["naive"]["worst"] > 100.0 * formula.bound * UNIT) == (formula.name not in HARMLESS)
    # refdof's own functions: float64, or rounded once to float32. `lensblur` subtracts float32, as its record says; the
    # area of a thin rim is right to 1e-15 of the whole disc's.
    if "code" in figures:
        limit = {"parallax": 1.0, "cap": 1e-4, "mip_level": 4.0 * UNIT}.get(formula.name, 0.5 * UNIT)
        assert figures["code"]["worst"] <= limit


def test_product_plus_rounds_once():
    # (1 + 2^-23)(1 - 2^-23) - 1 = -2^-46, which a product that is rounded first takes for 0.
    a, b = np.float32([1.0 + 2.0**-23]), np.float32([1.0 - 2.0**-23])
    assert cancellation.formulas_lens.product_plus(a, b, np.float32([-1.0]))[0] == -(2.0**-46)
    assert (a * b)[0] - np.float32(1.0) == 0.0


def test_circles_by_hand():
    (circle,) = (formula for formula in cancellation.FORMULAS if formula.name == "circle")
    given = np.float32([8.0]), np.float32([2.0]), np.float32([4.0])
    assert circle.ours(*given)[0] == circle.naive(*given)[0] == 2.0  # 8 (1/2 - 1/4)
    assert circle.ours(*given[:2], np.float32([np.inf]))[0] == 4.0
    # One rounding behind focus: 1/2 - 1/(2 + 2^-22) = 2^-24 but for its last digits.
    assert circle.ours(*given[:2], np.float32([2.0 + 2.0**-22]))[0] == pytest.approx(8.0 * 2.0**-24, rel=2.0**-22)

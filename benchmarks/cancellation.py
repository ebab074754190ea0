"""Cancellation: how many digits formulas of depth of field lose, as they are printed and as refdof writes them.

1. draw inputs for each formula, even over the logarithm, from one seed      `Formula.draw`
2. take both forms in float32, and refdof's own function                     `measure`
3. compare with the naive form in 50 digits                                  `measure`
4. write the figures, and the section of the page that they make             docs/cancellation.json, docs/stability.md

From the root of the repository: ``python benchmarks/cancellation.py``. It takes seconds.
"""

import json
import re
from pathlib import Path
from typing import Any, NamedTuple

import formulas_depth
import formulas_layers
import formulas_lens
import formulas_weights
import numpy as np
from cancellation_page import section
from formula import Formula, exactly, wide

FORMULAS: list[Formula] = [
    *formulas_lens.FORMULAS, *formulas_depth.FORMULAS, *formulas_layers.FORMULAS, *formulas_weights.FORMULAS
]  # fmt: skip
GLSL_HELPERS = formulas_weights.GLSL_HELPERS
SEED, COUNT = 20, 1000
BEGIN, END = "<!-- formulas -->", "<!-- /formulas -->"
DOCS = Path(__file__).resolve().parents[1] / "docs"


class Inputs(NamedTuple):
    """Arguments, float32 arrays (N,), the true values and what errors are shares of, float64 (N,)."""

    arguments: tuple[Any, ...]
    true: Any
    share: Any


def inputs_of(formula: Formula, count: int = COUNT) -> Inputs:
    """Inputs whose true value is not 0, from the one seed."""
    arguments = formula.draw(np.random.default_rng([SEED, *formula.name.encode()]), count)
    true = exactly(formula.naive, arguments)
    kept = np.flatnonzero(true)
    arguments, true = tuple(array[kept] for array in arguments), true[kept]
    share = np.abs(true) if formula.unit is None else wide(formula.unit(*arguments))
    return Inputs(arguments, true, share)


def errors(inputs: Inputs, found: Any) -> Any:
    """Errors (N,) as shares; inf where a result is not finite."""
    found = wide(found)
    with np.errstate(invalid="ignore", over="ignore"):
        return np.where(np.isfinite(found), np.abs(found - inputs.true) / inputs.share, np.inf)


def measure(formula: Formula, count: int = COUNT) -> dict[str, Any]:
    """Of "naive", "ours" and "code": worst and median error, where the worst is, and how often none is finite."""
    inputs = inputs_of(formula, count)
    figures = {}
    for name in ("naive", "ours", "code"):
        function = getattr(formula, name)
        if function is None:
            continue
        with np.errstate(all="ignore"):
            found = errors(inputs, function(*inputs.arguments))
        finite = np.where(np.isfinite(found), found, -1.0)
        worst = int(finite.argmax())
        figures[name] = {
            "worst": _digits(finite[worst], 3),
            "median": _digits(np.median(found), 3),
            "not finite": int((finite < 0).sum()),
            "at": [_digits(array[worst], 9) for array in inputs.arguments],  # 9 digits are a float32
        }
    return figures


def _digits(value: Any, count: int) -> float:
    return float(f"{float(value):.{count}g}")


def with_section(page: str, figures: dict[str, Any]) -> str:
    """The page with the section that these figures make."""
    made = f"{BEGIN}\n\n{section(FORMULAS, figures, GLSL_HELPERS, COUNT)}\n\n{END}"
    return re.sub(f"{BEGIN}.*{END}", lambda _: made, page, flags=re.DOTALL)


def main() -> None:
    """Write docs/cancellation.json and the section of docs/stability.md."""
    figures = {formula.name: measure(formula) for formula in FORMULAS}
    (DOCS / "cancellation.json").write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")
    page = DOCS / "stability.md"
    page.write_text(with_section(page.read_text(encoding="utf-8"), figures), encoding="utf-8")


if __name__ == "__main__":
    main()

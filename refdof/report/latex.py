"""LaTeX: the main scores of comparisons as a table for a paper."""

import math
from collections.abc import Sequence

from refdof.comparison import Comparison
from refdof.metrics import METRICS
from refdof.report.table import Column, columns, texts
from refdof.report.text import one_line

__all__ = ["escaped", "latex_table"]

_SHOWN = ("psnr", "ssim", "flip", "rmse", "blur_s")
_SPECIAL = {
    "\\": r"\textbackslash{}",
    "{": r"\{",
    "}": r"\}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    '"': r"\textquotedbl{}",
    "'": r"\textquotesingle{}",
    "`": r"\textasciigrave{}",
    "-": "{-}",  # two would become a dash
    **{letter: f"\\{letter}" for letter in "#$%&_"},
}


def escaped(text: str) -> str:
    """Text that LaTeX prints as it is, in one line."""
    return "".join(_SPECIAL.get(letter, letter) for letter in one_line(text))


def latex_table(comparisons: Sequence[Comparison]) -> str:
    """One table for all scenes, with the best value of each scene in bold; ends with a line feed.

    What is printed alike is best alike. It needs booktabs; with pdfLaTeX also textcomp, and fontenc with T1.
    """
    shown = [column for column in columns() if column.key in _SHOWN]
    lines = [
        r"% \usepackage[T1]{fontenc}, \usepackage{textcomp}, \usepackage{booktabs}",
        rf"\begin{{tabular}}{{l{'r' * len(shown)}}}",
        r"\toprule",
        " & ".join(["method", *(_heading(column) for column in shown)]) + r" \\",
    ]
    for comparison in comparisons:
        lines.append(r"\midrule")
        if len(comparisons) > 1:
            lines += [rf"\multicolumn{{{1 + len(shown)}}}{{l}}{{\emph{{{escaped(comparison.scene)}}}}} \\"]
        lines += _rows(comparison, shown)
    return "\n".join([*lines, r"\bottomrule", r"\end{tabular}"]) + "\n"


def _heading(column: Column) -> str:
    """With an arrow towards better."""
    better = METRICS[column.key].better if column.key in METRICS else "low"
    return f"{escaped(column.heading)} ${chr(92)}{'uparrow' if better == 'high' else 'downarrow'}$"


def _rows(comparison: Comparison, shown: Sequence[Column]) -> list[str]:
    cells = [texts(row) for row in comparison.rows]
    best = {column.key: _best(column.key, [one[column.key] for one in cells]) for column in shown}
    lines = []
    for row, one in zip(comparison.rows, cells, strict=True):
        values = []
        for column in shown:
            text = one[column.key]
            said = {"-": "--", "inf": r"$\infty$"}.get(text, f"${text}$" if text.startswith("-") else text)
            values.append(rf"\textbf{{{said}}}" if text == best[column.key] else said)
        # In braces: a row that begins with a bracket or an asterisk would be read as part of the \\ before it.
        lines.append(" & ".join([f"{{{escaped(row.name)}}}", *values]) + r" \\")
    return lines


def _best(key: str, texts: Sequence[str]) -> str | None:
    """The best of printed numbers; None where there are not two to choose from."""
    numbers = [text for text in texts if text != "-" and not math.isnan(float(text))]
    if len(texts) < 2 or not numbers:
        return None
    high = key in METRICS and METRICS[key].better == "high"
    return max(numbers, key=float) if high else min(numbers, key=float)

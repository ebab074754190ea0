"""The matrix as text: for a terminal, as a section of docs/stability.md, as one HTML file, and as plain values."""

import math
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from refdof.stability.cases import CASES, GROUPS
from refdof.stability.cases.case import Case
from refdof.stability.degraded import reasons, wider_bound
from refdof.stability.run import ROOM
from refdof.stability.verdict import BROKEN, DEGRADED, NOT_APPLICABLE, PASS, VERDICTS, Cell, Figure

__all__ = ["as_json", "counts_of", "html_page", "markdown_section", "terminal_text", "word_of"]

_MEASURED = ("contamination", "half", "picture")  # figures of which the page shows every value
_INTRO = """\
`refdof stability` runs every method on {cases} extreme inputs:
{counts}.

A cell is *pass* where all figures are within their bounds, or where the input is *refused* with one clear line;
**degraded** where a figure is above its bound for a reason that lies in the method, with the wider bound that it keeps;
*broken* otherwise. `-`: the case says nothing about the method. `--json` and `--html FILE` show every figure.
"""
_ERRORS = """\
Worst error of float32 against float64 of the same kernels on the same inputs, in units in the last place of the
brightest value; up to {room:.0f} units are roundings of sums. `accumulation` has no float32 of its own. Above that the
stage where the error first appears stands beside the number.
"""
_MEASURES = """\
How far a pixel that is no number spreads [px], which is a port's radius of contamination where it checks nothing; and
what half floats and depth buffers change [of the brightest value], of which 1/255 = 0.0039 is a step of a display.
"""


def word_of(cell: Cell) -> str:
    """The verdict in a word; what is refused as it should be is "refused"."""
    return "refused" if cell.verdict == PASS and cell.note.startswith("refused: ") else cell.verdict


def counts_of(cells: Sequence[Cell]) -> dict[str, int]:
    """How many cells have each verdict."""
    counts = Counter(cell.verdict for cell in cells)
    return {verdict: counts[verdict] for verdict in VERDICTS}


def terminal_text(cells: Sequence[Cell]) -> str:
    """A table of words, then a line for each cell that is degraded or broken, and the counts."""
    methods, rows = _by_case(cells)
    width = max(len(case.name) for case, _ in rows)
    lines = [" ".join(["".ljust(width), *(name.rjust(12) for name in methods)])]
    for case, row in rows:
        lines.append(" ".join([case.name.ljust(width), *(word_of(cell).rjust(12) for cell in row)]))
    lines.append("")
    for cell in cells:
        if cell.verdict in (DEGRADED, BROKEN):
            stage = f" (float32 errs first in the stage {cell.first_stage!r})" if cell.first_stage else ""
            lines.append(f"{cell.verdict}: {cell.case}, {cell.method}: {_above(cell)}{cell.note}{stage}")
    lines.append(_counted(cells))
    return "\n".join(lines)


def _above(cell: Cell) -> str:
    """The figures that are above their bounds."""
    figures = [figure for figure in cell.figures if not figure.holds]
    told = [
        f"{one.name} {_shown(one.value)} {one.unit}, at most {_shown(one.bound)}{_kept(cell, one)}" for one in figures
    ]
    return "".join(f"{text}. " for text in told)


def _kept(cell: Cell, figure: Figure) -> str:
    wider = wider_bound(cell.case, cell.method, figure.name)
    return "" if wider is None else f", kept below {_shown(wider)}"


def as_json(cells: Sequence[Cell]) -> dict[str, Any]:
    """All findings as plain values; what is no number is null."""
    return {
        "cells": [
            {
                "case": cell.case,
                "method": cell.method,
                "verdict": cell.verdict,
                "word": word_of(cell),
                "note": cell.note,
                "error_ulp": _number(cell.error),
                "non_finite": cell.non_finite,
                "first_stage": cell.first_stage,
                "figures": [
                    {
                        "name": figure.name,
                        "value": _number(figure.value),
                        "bound": figure.bound,
                        "kept_below": wider_bound(cell.case, cell.method, figure.name),
                        "unit": figure.unit,
                        "reason": figure.reason,
                    }
                    for figure in cell.figures
                ],
            }
            for cell in cells
        ],
        "summary": counts_of(cells),
    }


def markdown_section(cells: Sequence[Cell]) -> str:
    """The section of docs/stability.md. Ends with a line feed."""
    methods, rows = _by_case(cells)
    parts = [_INTRO.format(cases=len(rows), counts=_counted(cells)), "### Verdicts\n"]
    parts += _tables(methods, rows, _verdict_cell)
    parts += ["### Degraded\n", _degraded(cells)]
    parts += ["### Errors of float32\n", _ERRORS.format(room=ROOM)]
    tested = [(case, row) for case, row in rows if any(cell.error is not None for cell in row)]
    parts.append(_table(["case", *methods], [[f"`{case.name}`", *map(_error_cell, row)] for case, row in tested]))
    parts += ["### Contamination and storage\n", _MEASURES]
    measured = [(case, row) for case, row in rows if any(_measured(cell) for cell in row)]
    parts.append(_table(["case", *methods], [[f"`{case.name}`", *map(_measured_cell, row)] for case, row in measured]))
    parts += ["### What must hold\n", _table(["case", "figure", "at most", "since"], _expectations(rows))]
    return "\n".join(parts)


def html_page(cells: Sequence[Cell]) -> str:
    """One self-contained page: the table of verdicts, and every figure of every cell."""
    from refdof.report.page import rendered  # templates are slow to import

    methods, rows = _by_case(cells)
    groups = [
        {
            "title": title,
            "rows": [
                {"case": case, "cells": [{"word": word_of(cell), "cell": cell} for cell in row]}
                for case, row in rows
                if case.group == group
            ],
        }
        for group, title in GROUPS.items()
    ]
    return rendered(
        "stability.html",
        Path(__file__).parent,
        methods=methods,
        groups=[group for group in groups if group["rows"]],
        counted=_counted(cells),
        shown=_shown,
        wider=wider_bound,
    )


def _by_case(cells: Sequence[Cell]) -> tuple[list[str], list[tuple[Case, list[Cell]]]]:
    """Methods, and cases with a cell of each, in the order of both."""
    methods = list(dict.fromkeys(cell.method for cell in cells))
    rows = {case.name: case for case in CASES}
    names = list(dict.fromkeys(cell.case for cell in cells))
    return methods, [(rows[name], [cell for cell in cells if cell.case == name]) for name in names]


def _counted(cells: Sequence[Cell]) -> str:
    words = Counter(word_of(cell) for cell in cells)
    order = (PASS, "refused", DEGRADED, BROKEN)
    return ", ".join(f"{words[word]} {word}" for word in order) + f" of {len(cells) - words[NOT_APPLICABLE]} cells"


def _tables(methods: Sequence[str], rows: Sequence[tuple[Case, list[Cell]]], cell: Any) -> list[str]:
    """A table for each group of cases."""
    parts = []
    for group, title in GROUPS.items():
        mine = [(case, row) for case, row in rows if case.group == group]
        if mine:
            body = [[f"`{case.name}`<br>{case.says}", *map(cell, row)] for case, row in mine]
            parts.append(f"{title}:\n\n" + _table(["case", *methods], body))
    return parts


def _verdict_cell(cell: Cell) -> str:
    word = word_of(cell)
    return f"**{word}**" if word in (DEGRADED, BROKEN) else word


def _error_cell(cell: Cell) -> str:
    if cell.error is None:
        return "-"
    return _shown(cell.error) + (f"<br>`{cell.first_stage}`" if cell.first_stage else "")


def _measured(cell: Cell) -> Figure | None:
    found = [figure for figure in cell.figures if figure.name in _MEASURED]
    return found[0] if found else None


def _measured_cell(cell: Cell) -> str:
    figure = _measured(cell)
    return "-" if figure is None else _shown(figure.value)


def _degraded(cells: Sequence[Cell]) -> str:
    """Each reason once, with the cells that have it and how far they go."""
    lines = []
    for why, places in reasons().items():
        found = [cell for cell in cells if (cell.case, cell.method) in places and cell.verdict == DEGRADED]
        if found:
            where = "; ".join(
                f"`{cell.method}` in `{cell.case}` ("
                + ", ".join(
                    f"{figure.name} {_shown(figure.value)} {figure.unit}, kept below "
                    f"{_shown(places[cell.case, cell.method][figure.name])}"
                    for figure in cell.figures
                    if not figure.holds
                )
                + ")"
                for cell in found
            )
            lines.append(f"- {why} {where}.")
    return "\n".join(lines) + "\n"


def _expectations(rows: Sequence[tuple[Case, list[Cell]]]) -> list[list[str]]:
    """Every figure once, with its bound, or the range of bounds, and the cases that have it."""
    found: dict[tuple[str, str, str], tuple[list[float], list[str], list[str]]] = {}
    methods = list(dict.fromkeys(cell.method for _, row in rows for cell in row))
    for case, row in rows:
        for cell in row:
            for figure in cell.figures:
                bounds, names, whose = found.setdefault((figure.name, figure.unit, figure.reason), ([], [], []))
                bounds.append(figure.bound)
                if case.name not in names:
                    names.append(case.name)
                if cell.method not in whose:
                    whose.append(cell.method)
    table = []
    for (name, unit, reason), (bounds, names, whose) in found.items():
        least, most = _shown(min(bounds)), _shown(max(bounds))
        where = "all that run" if len(names) > len(rows) / 2 else ", ".join(f"`{one}`" for one in names)
        if len(whose) <= len(methods) / 2:
            where += f" ({', '.join(whose)})"
        table.append([where, name, f"{least if least == most else f'{least} .. {most}'} {unit}".rstrip(), reason])
    return table


def _shown(value: float) -> str:
    return "no number" if math.isnan(value) else f"{value:.2g}"


def _number(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else value


def _table(head: Sequence[str], body: Sequence[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *([cell.replace("|", r"\|") for cell in cells] for cells in body)]
    return "".join("| " + " | ".join(cells) + " |\n" for cells in lines)

"""Table: an explanation as text for people, and as CSV."""

import csv
import io
from collections.abc import Sequence

import numpy as np

from refdof._check import Float
from refdof.explain.explanation import COLOR, Explanation

__all__ = ["MOST_ROWS", "csv_of", "text_of"]

MOST_ROWS = 40
_MOST_PART_ROWS = 24
_COUNTS = ("tap", "ray", "layer", "level", "levels", "column", "row", "surface", "sub_image", "triangle")


def text_of(explanation: Explanation) -> str:
    """The value, the table, its sum and how far that is from the value. At most `MOST_ROWS` rows, of most weight."""
    x, y = explanation.pixel
    what = "the method's picture" if explanation.stage == "image" else f"stage {explanation.stage}"
    lines = [
        f"{explanation.method}, pixel {x},{y} of {explanation.size[0]} x {explanation.size[1]}, {what}",
        explanation.what,
        *explanation.notes,
        "",
    ]
    if explanation.is_sum:
        lines += [*_contributions(explanation), ""]
    for part in explanation.parts:
        lines += [part.title, *_columns(part.columns, part.rows[:_MOST_PART_ROWS])]
        if len(part.rows) > _MOST_PART_ROWS:
            lines.append(f"... and {len(part.rows) - _MOST_PART_ROWS} more")
        lines.append("")
    if not explanation.is_sum:
        return "\n".join([*lines, f"{what}: {_words(explanation.value)}"])
    agrees = "within" if explanation.agrees else "BEYOND"
    return "\n".join(
        [
            *lines,
            f"sum of the table:     {_words(explanation.sum)}",
            f"{what + ':':22}{_words(explanation.value)}",
            f"difference:           {_words(explanation.difference)}, {agrees} roundings of "
            f"{_words(explanation.tolerance)}",
        ]
    )


def csv_of(explanation: Explanation) -> str:
    """All rows, with the running sum; numbers are written in full, and what does not apply is empty."""
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    if explanation.is_sum:
        writer.writerow([*explanation.columns, *(f"running_{name}" for name in COLOR)])
        for row in np.column_stack([explanation.rows, explanation.running]):
            writer.writerow(["" if np.isnan(value) else repr(float(value)) for value in row])
    else:
        writer.writerow(["value"])
        writer.writerows([[repr(float(value))] for value in explanation.value])
    return file.getvalue()


def _contributions(explanation: Explanation) -> list[str]:
    weight = explanation.column("weight")
    largest = np.sort(np.argsort(-np.abs(weight), kind="stable")[:MOST_ROWS])
    shown = np.column_stack([explanation.rows, explanation.running])[largest]
    lines = _columns((*explanation.columns, "sum_r", "sum_g", "sum_b"), shown)
    rest = np.setdiff1d(np.arange(len(weight)), largest)
    if len(rest):
        adds = _words(explanation.terms[rest].sum(axis=0))
        lines.append(f"... and {len(rest)} rows of less weight, {weight[rest].sum():.6g} in all: they add {adds}")
    return lines


def _columns(names: Sequence[str], rows: Float) -> list[str]:
    """Names and numbers in columns."""
    cells = [list(names)]
    for row in rows:
        cells.append([_cell(name, value) for name, value in zip(names, row, strict=True)])
    widths = [max(len(row[k]) for row in cells) for k in range(len(names))]
    return ["  ".join(text.rjust(width) for text, width in zip(row, widths, strict=True)) for row in cells]


def _cell(name: str, value: float) -> str:
    if np.isnan(value):
        return "-"
    return str(int(value)) if name in _COUNTS and value == int(value) else f"{value:.5g}"


def _words(values: Float) -> str:
    return " ".join(f"{value:.9g}" for value in values)

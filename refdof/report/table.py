"""Tables: the rows of comparisons as aligned Markdown and as CSV."""

import csv
import io
import json
import math
import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from refdof.comparison import Comparison, Motion, Row
from refdof.metrics import METRICS
from refdof.metrics.artefacts import LOCATED
from refdof.report.rows import DISPLAY, at_noise_floor, is_at_floor, plain

__all__ = [
    "Column",
    "aligned",
    "artefact_columns",
    "artefact_texts",
    "columns",
    "csv_table",
    "files_line",
    "footnote",
    "footnote_of_metrics",
    "markdown_table",
    "motion_line",
    "noise_in_words",
    "reference_line",
    "scores_table",
    "terminal_table",
    "texts",
]

NARROW = ("psnr", "ssim", "flip", "blur_s")
_TERMINAL = 80  # characters a line
_NAME = 20  # of a picture's name


class Column(NamedTuple):
    """A number of every row: its key in JSON and CSV, its heading, and its digits after the point in a table."""

    key: str
    heading: str
    decimals: int


def columns() -> list[Column]:
    """Every metric, then the times."""
    metrics = [Column(name, metric.heading, metric.decimals) for name, metric in METRICS.items()]
    times = {"prepare_s": "prepare [s]", "blur_s": "blur [s]", "spread_s": "spread [s]"}
    return [*metrics, *(Column(key, heading, 3) for key, heading in times.items())]


def artefact_columns() -> list[Column]:
    """Every artefact metric, then what a small light shows, and a slow move."""
    return [Column(name, one.heading, one.decimals) for name, one in LOCATED.items()]


def markdown_table(comparisons: Sequence[Comparison]) -> str:
    """One aligned table for each scene, and beneath it what its scores rest on. Ends with a line feed.

    Where there is a reference, a second table tells where the error lies.
    """
    blocks, located = [], False
    for comparison in comparisons:
        blocks += [_heading(comparison), _rows(comparison, columns(), "at the noise floor"), reference_line(comparison)]
        if any(row.artefacts for row in comparison.rows):
            blocks += ["Where the error lies:", _artefact_rows(comparison)]
            blocks += [motion_line(comparison.motion)] if comparison.motion is not None else []
            located = True
    return "\n\n".join([*blocks, footnote(), *([footnote_of_artefacts()] if located else [])]) + "\n"


def terminal_table(comparisons: Sequence[Comparison]) -> str:
    """The columns that most people look at first, in 80 characters: `markdown_table` has all."""
    shown = [column for column in columns() if column.key in NARROW]
    blocks = []
    for comparison in comparisons:
        worth = textwrap.fill(reference_line(comparison), _TERMINAL)
        blocks += [_heading(comparison), _rows(comparison, shown, "noise floor"), worth]
    return "\n\n".join(blocks) + "\n"


def scores_table(names: Sequence[str], scores: Sequence[Mapping[str, float]], floor: float, wide: bool = False) -> str:
    """Scores of pictures made elsewhere, in 80 characters unless it is `wide`; `floor`: noise, NaN if unknown."""
    shown = [column for column in columns() if column.key in METRICS and (wide or column.key in (*NARROW, "rmse"))]
    head, body = ["image", *(column.heading for column in shown), "note"], []
    for name, found in zip(names, scores, strict=True):
        noted = "noise floor" if is_at_floor(found, floor) else ""
        told = name if wide or len(name) <= _NAME else f"...{name[3 - _NAME :]}"
        body.append([told, *(f"{found[c.key]:.{c.decimals}f}" for c in shown), noted])
    return aligned(head, body)


def _heading(comparison: Comparison) -> str:
    width, height = comparison.camera.size
    return f"### {comparison.scene}, {width} x {height}"


def _rows(comparison: Comparison, shown: Sequence[Column], note: str) -> str:
    head, body = ["method", *(column.heading for column in shown), "note"], []
    for row in comparison.rows:
        values = texts(row)
        noted = note if at_noise_floor(row, comparison) else ""
        body.append([row.name, *(values[column.key] for column in shown), noted])
    return aligned(head, body)


def _artefact_rows(comparison: Comparison) -> str:
    """Artefacts of each method."""
    headings, cells = artefact_texts(comparison.rows)
    body = [[row.name, *values] for row, values in zip(comparison.rows, cells, strict=True)]
    return aligned(["method", *headings], body, last_is_text=False)


def artefact_texts(rows: Sequence[Row]) -> tuple[list[str], list[list[str]]]:
    """Headings, and the values of each row as text, without the columns that no picture of this scene has."""
    shown = [c for c in artefact_columns() if any(_has(row.artefacts.get(c.key)) for row in rows)]
    cells = [[_text(row.artefacts.get(c.key), c.decimals) for c in shown] for row in rows]
    return [column.heading for column in shown], cells


def texts(row: Row) -> dict[str, str]:
    """The scores and times of one row as text by key, in the order of `columns`; "-" where there is none."""
    return {column.key: _text(_value(row, column.key), column.decimals) for column in columns()}


def _text(value: float | None, decimals: int) -> str:
    if value is None or not _has(value):
        return "-"
    text = f"{value:.{decimals}f}"
    return text.removeprefix("-") if float(text) == 0.0 else text  # no negative zeros


def _has(value: float | None) -> bool:
    return value is not None and not math.isnan(value)


def reference_line(comparison: Comparison) -> str:
    """What the reference is worth, in a sentence."""
    if comparison.reference is None:
        return "No reference: methods have no scores."
    noise = noise_in_words(comparison.noise_floor_psnr)
    if any(at_noise_floor(row, comparison) for row in comparison.rows):
        noise += "; a method within 3 dB of it is at the noise floor: more samples would raise its score"
    if math.isnan(comparison.samples):
        return f"Reference: made elsewhere, {noise}."
    samples = f"{comparison.samples:.1f}".removesuffix(".0")
    seconds = f"{comparison.seconds:.1f} s" + (" in an earlier run" if comparison.kept else "")
    return f"Reference: {samples} samples per pixel, {seconds}, {noise}."


def motion_line(motion: Motion) -> str:
    """How flicker was measured, in a sentence."""
    width, height = motion.size
    own = _text(motion.flicker["reference"], LOCATED["flicker"].decimals)
    return (
        f"Flicker: {motion.frames} frames of {width} x {height} px, each moved on by 1/{1.0 / motion.step_px:g} px of "
        f"the focal plane; the reference's own, {own}, is taken off."
    )


def noise_in_words(floor: float) -> str:
    """The noise of a reference, NaN: unknown."""
    if math.isnan(floor):
        return "noise unknown"
    return f"noise floor {floor:.2f} dB" if math.isfinite(floor) else "no noise"


def footnote() -> str:
    """What the columns mean: metrics of the display image, metrics of linear values, times."""
    times = (
        "Times exclude compilation. Short methods run three times: blur is the median, spread the longest minus the "
        "shortest. Others run once."
    )
    return f"{footnote_of_metrics()}\n{times}"


def footnote_of_metrics() -> str:
    """What the metrics mean: those of the display image, and those of linear values."""
    images = {"display": f"the display image, {DISPLAY['tone_map']}", "linear": "linear values"}
    lines = []
    for values, image in images.items():
        told = [
            f"{metric.title} ({', '.join(filter(None, (f'{metric.better}er is better', metric.note)))})"
            for metric in METRICS.values()
            if metric.values == values
        ]
        if told:
            lines.append(f"Of {image}: {', '.join(told)}.")
    return "\n".join(lines)


def footnote_of_artefacts() -> str:
    """What the columns of the second table mean."""
    told = ", ".join(f"{one.heading.partition(' [')[0]} ({one.note})" for one in LOCATED.values())
    return f"Where the error lies, of linear values, without the reference's noise where that is known: {told}."


def csv_table(comparisons: Sequence[Comparison]) -> str:
    """The same rows with every digit; one line for each scene and method, `params` as JSON."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    first = ["scene", "method", *(column.key for column in columns()), "at_noise_floor", "params", "preset"]
    writer.writerow([*first, *(column.key for column in artefact_columns())])
    for comparison in comparisons:
        for row in comparison.rows:
            values = [_value(row, column.key) for column in columns()]
            noise = str(at_noise_floor(row, comparison)).lower()
            params = json.dumps(plain(row.params), allow_nan=False)
            located = [plain(row.artefacts.get(column.key)) for column in artefact_columns()]
            scored = [comparison.scene, row.method, *(plain(v) for v in values), noise, params, row.preset]
            writer.writerow([*scored, *located])
    return stream.getvalue()


def _value(row: Row, key: str) -> Any:
    """A score, None where there is none, or a time."""
    return row.scores.get(key) if key in METRICS else getattr(row, key)


def aligned(head: list[str], body: list[list[str]], last_is_text: bool = True) -> str:
    """A Markdown table: first column, and the last if it is text, to the left, numbers to the right."""
    body = [[_escape(cell) for cell in line] for line in body]
    widths = [max(3, *(len(line[k]) for line in [head, *body])) for k in range(len(head))]
    ends = (0, len(head) - 1) if last_is_text else (0,)

    def line(texts: list[str]) -> str:
        padded = [t.ljust(w) if k in ends else t.rjust(w) for k, (t, w) in enumerate(zip(texts, widths, strict=True))]
        return "| " + " | ".join(padded) + " |"

    rule = ["-" * w if k in ends else "-" * (w - 1) + ":" for k, w in enumerate(widths)]
    return "\n".join([line(head), line(rule), *(line(texts) for texts in body)])


def _escape(text: str) -> str:
    return " ".join(text.replace("|", "\\|").split())


def files_line(folder: Path, wide: bool) -> str:
    """Where the report is, and the columns that a narrow table leaves out."""
    table = f"table: {folder / 'table.md'}" if wide else f"all columns: {folder / 'table.md'}, or --wide"
    return f"Report: {folder / 'report.html'}; {table}"

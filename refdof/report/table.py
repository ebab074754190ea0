"""Tables: the rows of comparisons as aligned Markdown and as CSV."""

import csv
import io
import json
import math
from collections.abc import Sequence
from typing import Any

from refdof.comparison import Comparison, Row
from refdof.report.rows import DISPLAY, SCORES, at_noise_floor, plain

__all__ = ["COLUMNS", "cells", "csv_table", "footnote", "markdown_table", "reference_line"]

# Key, heading, format: enough decimals to rank methods, no more.
COLUMNS = (
    ("psnr", "PSNR [dB]", "{:.2f}"),
    ("psnr_8bit", "8-bit PSNR [dB]", "{:.2f}"),
    ("ssim", "SSIM", "{:.4f}"),
    ("flip", "FLIP", "{:.4f}"),
    ("rmse", "RMSE", "{:.5f}"),
    ("rel_mse", "relMSE", "{:.5f}"),
    ("max_abs", "max", "{:.3f}"),
    ("prepare_s", "prepare [s]", "{:.3f}"),
    ("blur_s", "blur [s]", "{:.3f}"),
)


def markdown_table(comparisons: Sequence[Comparison]) -> str:
    """One aligned table for each scene, and beneath it what its scores rest on. Ends with a line feed."""
    blocks = []
    for comparison in comparisons:
        head = ["method", *(title for _, title, _ in COLUMNS), "note"]
        body = [
            [row.name, *cells(row), "at the noise floor" if at_noise_floor(row, comparison) else ""]
            for row in comparison.rows
        ]
        width, height = comparison.camera.size
        blocks.append(f"### {comparison.scene}, {width} x {height}")
        blocks.append(_aligned(head, body))
        blocks.append(reference_line(comparison))
    return "\n\n".join([*blocks, footnote()]) + "\n"


def cells(row: Row) -> list[str]:
    """The scores and times of one row as text, in the order of `COLUMNS`; "-" where there is none."""
    texts = []
    for key, _, form in COLUMNS:
        value = row.scores.get(key, math.nan) if key in SCORES else getattr(row, key)
        texts.append("-" if math.isnan(value) else form.format(value))
    return texts


def reference_line(comparison: Comparison) -> str:
    """What the reference is worth, in a sentence."""
    floor = comparison.noise_floor_psnr
    noise = f"noise floor {floor:.2f} dB" if math.isfinite(floor) else "no noise"
    if any(at_noise_floor(row, comparison) for row in comparison.rows):
        noise += "; a method within 3 dB of it is at the noise floor: more samples would raise its score"
    samples = f"{comparison.samples:.1f}".removesuffix(".0")
    return f"Reference: {samples} samples per pixel, {comparison.seconds:.1f} s, {noise}."


def footnote() -> str:
    """What the columns mean."""
    return (
        f"PSNR, SSIM and FLIP are of the display image ({DISPLAY['tone_map']}): PSNR with peak "
        f"{DISPLAY['peak']:g}, FLIP at {DISPLAY['flip_ppd']} pixels per degree. 8-bit PSNR, with peak 255, rounds both "
        "images first, as papers do.\n"
        "RMSE, relMSE = d^2 / (r^2 + 0.01) and the largest absolute error (max) are of linear values."
    )


def csv_table(comparisons: Sequence[Comparison]) -> str:
    """The same rows with every digit; one line for each scene and method, `params` as JSON."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(["scene", "method", *(key for key, _, _ in COLUMNS), "at_noise_floor", "params", "preset"])
    for comparison in comparisons:
        for row in comparison.rows:
            values: list[Any] = [row.scores.get(k) if k in SCORES else getattr(row, k) for k, _, _ in COLUMNS]
            noise = str(at_noise_floor(row, comparison)).lower()
            params = json.dumps(plain(row.params), allow_nan=False)
            writer.writerow([comparison.scene, row.method, *(plain(v) for v in values), noise, params, row.preset])
    return stream.getvalue()


def _aligned(head: list[str], body: list[list[str]]) -> str:
    """A Markdown table: first and last column to the left, numbers to the right."""
    body = [[_escape(cell) for cell in line] for line in body]
    widths = [max(3, *(len(line[k]) for line in [head, *body])) for k in range(len(head))]
    ends = (0, len(head) - 1)

    def line(texts: list[str]) -> str:
        padded = [t.ljust(w) if k in ends else t.rjust(w) for k, (t, w) in enumerate(zip(texts, widths, strict=True))]
        return "| " + " | ".join(padded) + " |"

    rule = ["-" * w if k in ends else "-" * (w - 1) + ":" for k, w in enumerate(widths)]
    return "\n".join([line(head), line(rule), *(line(texts) for texts in body)])


def _escape(text: str) -> str:
    return " ".join(text.replace("|", "\\|").split())

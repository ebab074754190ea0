"""Write: the report of a sweep. Each file is replaced in one step.

============================  ==================================================================
report.html                   one offline page: fronts, answers to budgets, all points
front-<shot>.svg, .png        the plots, for papers
fronts.tex                    the fronts as a LaTeX table
sweep.csv, sweep.parquet      every point, all columns
============================  ==================================================================
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from refdof.image.atomic import atomic_path, write_text
from refdof.report.latex import escaped
from refdof.report.page import rendered
from refdof.report.rows import plain
from refdof.report.write import distinct_names
from refdof.sweep.cost import CostModel
from refdof.sweep.front import front
from refdof.sweep.measured import Measured
from refdof.sweep.plots import front_plot
from refdof.sweep.results import Results
from refdof.sweep.words import by_shot, memory_in_words, setting, time_in_words

__all__ = ["write_report"]


def write_report(
    points: Sequence[Measured], models: Sequence[CostModel], results: Results, folder: Path, command: str
) -> None:
    """Write all files of a sweep's report.

    Parameters
    ----------
    points : at least one
        Those of this sweep; sweep.csv and sweep.parquet have all that the results hold.
    models : of each method where enough was varied
    folder : path
    command : str
        What makes the report again.

    Raises
    ------
    InputError
        If the folder cannot be written.
    """
    shots = by_shot(points)
    names = distinct_names([f"front-{name}" for name in shots])
    pages = []
    for file, (name, own) in zip(names, shots.items(), strict=True):
        drawings = {kind: front_plot(own, kind) for kind in ("svg", "png")}
        for kind, data in drawings.items():
            with atomic_path(folder / f"{file}.{kind}") as temporary:
                temporary.write_bytes(data)
        drawing = drawings["svg"].decode()
        pages.append({"name": name, "svg": drawing[drawing.index("<svg") :], "points": _rows(own)})
    results.export(folder)
    write_text(folder / "fronts.tex", _latex(shots))
    machines = sorted({f"{point.machine}, {point.threads} threads" for point in points})
    about = {"machines": machines, "command": command, "models": [str(model) for model in models]}
    page = rendered("sweep.html", Path(__file__).parent, shots=pages, about=about)
    write_text(folder / "report.html", page)


def _rows(points: Sequence[Measured]) -> list[dict[str, Any]]:
    """Points as the page has them, from fast to slow."""
    best = {point.key for point in front(points)}
    return [
        {
            "method": point.method,
            "setting": setting(point),
            "seconds": point.time_s,
            "time": time_in_words(point.time_s),
            "psnr": plain(point.scores["psnr"]),
            "quality": plain(point.quality),
            "cells": [
                time_in_words(point.time_s),
                "-" if point.runs < 2 else time_in_words(point.spread_s),
                time_in_words(point.prepare_s),
                *(f"{point.scores[name]:.{digits}f}" for name, digits in _SCORES.items()),
                memory_in_words(point.peak_bytes),
            ],
            "front": point.key in best,
            "floor": point.scores["psnr"] > point.quality,
            "noise_floor": plain(point.noise_floor_psnr),
            "command": point.command,
        }
        for point in sorted(points, key=lambda point: (point.time_s, point.key))
    ]


_SCORES = {"psnr": 2, "ssim": 4, "flip": 4, "rmse": 5}


def _latex(shots: dict[str, list[Measured]]) -> str:
    """The fronts as a table for LaTeX's booktabs."""
    lines = [r"\begin{tabular}{lllrrr}", r"\toprule", r"scene & method & setting & time & PSNR [dB] & FLIP \\"]
    for name, points in shots.items():
        lines.append(r"\midrule")
        for k, point in enumerate(front(points)):
            numbers = [time_in_words(point.time_s), f"{point.scores['psnr']:.2f}", f"{point.scores['flip']:.3f}"]
            cells = [name if k == 0 else "", point.method, setting(point), *numbers]
            lines.append(" & ".join(escaped(cell) for cell in cells) + r" \\")
    return "\n".join([*lines, r"\bottomrule", r"\end{tabular}"]) + "\n"

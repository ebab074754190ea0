"""Plots: error over time of every method, for papers. The same comparison gives the same bytes."""

import math
import os
from collections.abc import Sequence
from typing import Any

import matplotlib
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from refdof.comparison import Comparison
from refdof.image.atomic import atomic_path
from refdof.metrics import METRICS
from refdof.report.log_ticks import name_ticks, second_in_words
from refdof.report.point_names import write_names
from refdof.report.text import one_line

__all__ = ["write_scatter"]

_KEY = "rmse"
_DPI = 200
_METADATA: dict[str, dict[str, Any]] = {".png": {"Software": None}, ".svg": {"Date": None, "Creator": None}}
_SETTINGS: dict[Any, Any] = {"svg.hashsalt": "refdof", "svg.fonttype": "path", "path.simplify": False}
_POINT = "#c75b00"
_MARKER = 5.0  # of a point [pt]


def write_scatter(comparison: Comparison, paths: Sequence[str | os.PathLike[str]]) -> None:
    """Draw time against error, both on logarithmic axes, into .png and .svg files.

    Methods without a finite error above zero, or without a time, have no place on such axes; they are named below.
    """
    figure = _figure(comparison)
    with matplotlib.rc_context(_SETTINGS):
        for path in paths:
            with atomic_path(path) as temporary:
                suffix = os.path.splitext(path)[1]
                figure.savefig(temporary, format=suffix[1:], dpi=_DPI, metadata=_METADATA[suffix])


def _figure(comparison: Comparison) -> Figure:
    figure = Figure(figsize=(5.0, 3.6), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    points = [(row.blur_s, row.scores.get(_KEY, math.nan), row.name) for row in comparison.rows]
    placed = [point for point in points if all(math.isfinite(value) and value > 0.0 for value in point[:2])]
    axes.set_xscale("log")
    axes.set_yscale("log")
    for seconds, error, _ in placed:
        axes.plot([seconds], [error], "o", color=_POINT, markersize=_MARKER, markeredgewidth=0.0)
    axes.margins(0.16, 0.16)
    name_ticks(axes.xaxis, second_in_words)
    name_ticks(axes.yaxis, lambda error: f"{error:.5g}")
    left_out = [name for name in (point[2] for point in points if point not in placed)]
    label = axes.set_xlabel("\n".join(["blur", *([f"not shown: {', '.join(left_out)}"] if left_out else [])]))
    label.set_parse_math(False)
    axes.set_ylabel(f"{METRICS[_KEY].heading}, {METRICS[_KEY].values} values")
    title = axes.set_title(one_line(comparison.scene), fontsize=10)
    title.set_parse_math(False)
    axes.grid(which="major", color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    write_names(figure, axes, sorted(placed), _MARKER)
    return figure

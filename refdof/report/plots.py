"""Plots: error over time of every method, for papers. The same comparison gives the same bytes."""

import math
import os
from collections.abc import Sequence
from typing import Any

import matplotlib
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from refdof.comparison import Comparison
from refdof.image.atomic import atomic_path
from refdof.metrics import METRICS
from refdof.report.text import one_line

__all__ = ["write_scatter"]

_KEY = "rmse"
_DPI = 200
_METADATA: dict[str, dict[str, Any]] = {".png": {"Software": None}, ".svg": {"Date": None, "Creator": None}}
_SETTINGS: dict[Any, Any] = {"svg.hashsalt": "refdof", "svg.fonttype": "path", "path.simplify": False}
_INK, _POINT = "#222222", "#c75b00"
_MARKER = 5.0  # of a point [pt]
_SIDES = (  # where a name may stand: offset from its point [pt], and which end of it is there
    (0.0, 5.0, "center", "bottom"),
    (0.0, -5.0, "center", "top"),
    (6.0, 0.0, "left", "center"),
    (-6.0, 0.0, "right", "center"),
    (4.0, 5.0, "left", "bottom"),
    (-4.0, 5.0, "right", "bottom"),
    (4.0, -5.0, "left", "top"),
    (-4.0, -5.0, "right", "top"),
)


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
    left_out = [name for name in (point[2] for point in points if point not in placed)]
    label = axes.set_xlabel("\n".join(["blur [s]", *([f"not shown: {', '.join(left_out)}"] if left_out else [])]))
    label.set_parse_math(False)
    axes.set_ylabel(f"{METRICS[_KEY].heading}, {METRICS[_KEY].values} values")
    title = axes.set_title(one_line(comparison.scene), fontsize=10)
    title.set_parse_math(False)
    axes.grid(which="major", color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    _write_names(figure, axes, sorted(placed))
    return figure


def _write_names(figure: Figure, axes: Any, points: Sequence[tuple[float, float, str]]) -> None:
    """Each name beside its point, on the side where it covers least of the points and names before it."""
    figure.draw_without_rendering()  # fixes the axes, on which distances depend
    taken = []
    for seconds, error, _ in points:
        x, y = axes.transData.transform((seconds, error))
        half = 0.5 * _MARKER * figure.dpi / 72.0
        taken.append(Bbox.from_extents(x - half, y - half, x + half, y + half))
    for seconds, error, name in points:
        text = axes.annotate(
            one_line(name),
            (seconds, error),
            xytext=(0.0, 0.0),
            textcoords="offset points",
            fontsize=8,
            color=_INK,
            parse_math=False,
        )
        covered = []
        for place in _SIDES:
            _put(text, place)
            box = text.get_window_extent()
            areas = [Bbox.intersection(box, other) for other in taken]
            covered.append(sum(area.width * area.height for area in areas if area is not None))
        _put(text, _SIDES[covered.index(min(covered))])
        taken.append(text.get_window_extent())


def _put(text: Any, place: tuple[float, float, str, str]) -> None:
    x, y, horizontal, vertical = place
    text.set_position((x, y))
    text.set(horizontalalignment=horizontal, verticalalignment=vertical)

"""Plots: time against quality, for pages and papers. The only file of sweeps that imports matplotlib."""

import io
from collections.abc import Sequence
from typing import Any

from refdof.report.log_ticks import name_ticks, second_in_words
from refdof.sweep.front import front
from refdof.sweep.measured import Measured
from refdof.sweep.words import setting, shot_name

__all__ = ["front_plot"]

_MARKS = "osD^v<>Pph*X8"
_PLAIN: Any = {"font.size": 9, "svg.hashsalt": "refdof", "svg.fonttype": "none", "axes.spines.top": False}


def front_plot(points: Sequence[Measured], kind: str) -> bytes:
    """The points of one shot, and the line of its front, as "svg" or "png". Equal points give equal bytes."""
    import matplotlib
    from matplotlib.figure import Figure

    with matplotlib.rc_context({**_PLAIN, "axes.spines.right": False}):
        figure = Figure(figsize=(6.8, 4.2), layout="constrained")
        axes = figure.add_subplot()
        methods = sorted({point.method for point in points})
        colors = matplotlib.color_sequences["tab20"]
        for k, method in enumerate(methods):
            own = [point for point in points if point.method == method]
            axes.plot(
                [point.time_s for point in own],
                [point.scores["psnr"] for point in own],
                marker=_MARKS[k % len(_MARKS)],
                color=colors[(2 * k + k // 10) % 20],
                linewidth=0.6,
                markersize=4.5,
                label=method,
            )
        _draw_front(axes, front(points))
        floor = points[0].noise_floor_psnr
        if floor < axes.get_ylim()[1] + 3.0:
            axes.axhspan(floor - 3.0, max(floor, axes.get_ylim()[1]), color="0.9", zorder=0)
            axes.text(
                0.01, floor - 2.8, "noise floor of the reference", transform=axes.get_yaxis_transform(), color="0.4"
            )
        axes.set_xscale("log")
        name_ticks(axes.xaxis, second_in_words)
        axes.set(xlabel="layers and method, warm", ylabel="PSNR [dB]", title=shot_name(points[0]))
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
        return _bytes(figure, kind)


def _draw_front(axes: Any, best: Sequence[Measured]) -> None:
    """A staircase, and the settings beside its corners."""
    times, qualities = [point.time_s for point in best], [point.scores["psnr"] for point in best]
    axes.step(times, qualities, where="post", color="0.2", linewidth=1.2, zorder=1)
    for point in best:
        axes.annotate(
            setting(point).rpartition("=")[2],
            (point.time_s, point.scores["psnr"]),
            xytext=(3, 4),
            textcoords="offset points",
            fontsize=7,
            color="0.3",
        )


def _bytes(figure: Any, kind: str) -> bytes:
    stream = io.BytesIO()
    figure.savefig(stream, format=kind, dpi=150, metadata={"Date": None} if kind == "svg" else {"Software": None})
    return stream.getvalue()

"""Picture: where the contributions to a pixel lie, drawn over the neighbourhood, as large as their weights.

The only file of this room that imports matplotlib, when it draws.
"""

import os
from typing import Any

import numpy as np

from refdof.explain.explanation import Explanation
from refdof.image.atomic import atomic_path
from refdof.image.display import display

__all__ = ["save_picture"]

_MARGIN = 2.0  # px around what is shown
_LEAST_REACH = 4.0  # px
_LARGEST_DOT, _LEAST_DOT = 260.0, 3.0  # points^2
_SHARE = 0.999  # of the weight lies in what is shown


def save_picture(path: str | os.PathLike[str], explanation: Explanation) -> None:
    """Write a PNG.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # slow to import
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 6.4), dpi=100, layout="constrained")
    _draw(figure.add_subplot(), explanation)
    with atomic_path(path) as temporary:
        FigureCanvasAgg(figure).print_png(temporary, metadata={"Software": None})


def _draw(axes: Any, explanation: Explanation) -> None:
    (x, y), (width, height) = explanation.pixel, explanation.size
    if explanation.picture is not None:
        shown = display(explanation.picture.astype(np.float32))
        axes.imshow(shown, extent=(0, width, height, 0), interpolation="nearest", alpha=0.55)
    reach = _LEAST_REACH
    if explanation.is_sum and "x" in explanation.columns:
        places = np.stack([explanation.column("x"), explanation.column("y")], axis=1)
        weight = np.where(np.isfinite(places).all(axis=1), explanation.column("weight"), 0.0)
        drawn = weight > 0.0
        color = np.clip(np.stack([explanation.column(name) for name in ("red", "green", "blue")], axis=1), 0.0, None)
        color = display(color[None].astype(np.float32))[0]
        if drawn.any():
            distance = np.abs(places[drawn] - [x + 0.5, y + 0.5]).max(axis=1)
            order = np.argsort(distance)
            inside = np.cumsum(weight[drawn][order]) <= _SHARE * weight.sum()
            reach = max(reach, float(distance[order][inside].max(initial=0.0)))
            size = np.maximum(_LARGEST_DOT * weight[drawn] / weight.max(), _LEAST_DOT)
            axes.scatter(*places[drawn].T, s=size, c=color[drawn], edgecolors="black", linewidths=0.5, zorder=3)
    axes.add_patch(_square(x, y))
    reach += _MARGIN
    axes.set_xlim(x + 0.5 - reach, x + 0.5 + reach)
    axes.set_ylim(y + 0.5 + reach, y + 0.5 - reach)
    axes.set_aspect("equal")
    axes.set_xlabel("x [px]")
    axes.set_ylabel("y [px], down")
    value = ", ".join(f"{v:.5g}" for v in explanation.value[:8])
    count = f"\n{len(explanation.rows)} contributions; area is weight" if explanation.is_sum else ""
    axes.set_title(f"{explanation.method}, {explanation.stage}, pixel {x},{y}: {value}{count}", fontsize=10)


def _square(x: int, y: int) -> Any:
    from matplotlib.patches import Rectangle

    return Rectangle((x, y), 1.0, 1.0, fill=False, edgecolor="red", linewidth=1.5, zorder=4)

"""Page: the offline HTML report, made from the templates beside this file and the scripts in `viewer/`.

The only file that imports jinja2. Scripts and styles are files of their own and go into the page as they are.
"""

import base64
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from refdof._check import Float
from refdof.comparison import Chart, Comparison, Motion, Row
from refdof.report.planes import Planes, png_text
from refdof.report.rows import at_noise_floor, plain, rows_as_json
from refdof.report.table import (
    artefact_texts,
    columns,
    footnote,
    footnote_of_artefacts,
    motion_line,
    reference_line,
    texts,
)

__all__ = ["index_page", "rendered", "report_page"]

_HERE = Path(__file__).parent
_SCRIPTS = ("planes", "fields", "colors", "stage", "histogram", "profile", "readout", "crops", "bar", "main")
_THUMBNAIL_PX = 240


def report_page(comparison: Comparison, command: str = "", position: int = 0) -> str:
    """One self-contained page: viewer, table, parameters and command. No link, no outside resource.

    Parameters
    ----------
    comparison : Comparison
    command : str
        What reproduces it; empty: the nearest `refdof compare` line.
    position : int
        Which of several scenes of the command.
    """
    values = rows_as_json(comparison, command)
    planes = Planes(comparison, values["command"], position)
    return rendered(
        "report.html",
        values=values,
        table=_table(comparison),
        located=_located(comparison),
        viewer=planes.about,
        scripts=_SCRIPTS,
        chart=None if comparison.chart is None else _strips(comparison.chart),
        motion=None if comparison.motion is None else _motion(comparison.motion),
        kinds=planes.kinds,
        payloads=planes.payloads,
    )


def _strips(chart: Chart) -> dict[str, Any]:
    """A lens chart: its caption, and pictures as PNG."""
    pictures = [{"name": name, "png": png_text(image)} for name, image in chart.pictures.items()]
    return {"caption": chart.caption, "pictures": pictures}


def _motion(motion: Motion) -> dict[str, str]:
    """How flicker was measured, and strips as PNG."""
    from refdof.report.motion_pictures import strips_png  # matplotlib is slow to import

    return {"about": motion_line(motion), "png": base64.b64encode(strips_png(motion)).decode("ascii")}


def index_page(comparisons: Sequence[Comparison], folders: Sequence[str], command: str = "") -> str:
    """A page above several reports: a picture, the table and the way to each."""
    scenes = [
        {"name": c.scene, "folder": folder, "thumbnail": png_text(_smaller(c.standard[1])), "table": _table(c)}
        for c, folder in zip(comparisons, folders, strict=True)
    ]
    return rendered("index.html", scenes=scenes, command=command)


def rendered(name: str, folder: Path | None = None, **values: Any) -> str:
    """A template of this folder, or of another one that may include this one's, filled in."""
    loader = FileSystemLoader([_HERE, *([] if folder is None else [folder])])
    templates = Environment(
        loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    templates.globals["inlined"] = _inlined
    return str(templates.get_template(name).render(values))


def _inlined(name: str) -> str:
    """A script or a style of `viewer/` as it is."""
    return (_HERE / "viewer" / name).read_text(encoding="utf-8")


def _table(comparison: Comparison) -> dict[str, Any]:
    """The table as text and as numbers to sort by: rows without a score first, then the lowest PSNR."""
    return {
        "columns": [column.heading for column in columns()],
        "sorted_by": [column.key for column in columns()].index("psnr") if comparison.reference is not None else None,
        "rows": [
            {
                "method": row.name,
                "number": number,
                "cells": list(texts(row).values()),
                "note": "at the noise floor" if at_noise_floor(row, comparison) else "",
                "params": ", ".join(f"{key} = {plain(value)}" for key, value in row.params.items()),
            }
            for number, row in _worst_first(comparison)
        ],
        "reference": reference_line(comparison),
        "footnote": footnote(),
    }


def _located(comparison: Comparison) -> dict[str, Any] | None:
    """The table of artefact metrics, in the order of `_table`; None where there are none."""
    if not any(row.artefacts for row in comparison.rows):
        return None
    rows = _worst_first(comparison)
    columns, cells = artefact_texts([row for _, row in rows])
    named = zip(rows, cells, strict=True)
    return {
        "columns": columns,
        "sorted_by": None,
        "rows": [{"method": row.name, "number": number, "cells": texts} for (number, row), texts in named],
        "reference": "",
        "footnote": footnote_of_artefacts(),
    }


def _worst_first(comparison: Comparison) -> list[tuple[int, Row]]:
    """Number and row: without a score first, then the lowest PSNR."""

    def quality(one: tuple[int, Row]) -> float:
        score = one[1].scores.get("psnr", math.nan)
        return -math.inf if math.isnan(score) else float(score)

    return sorted(enumerate(comparison.rows), key=quality)


def _smaller(image: Float) -> Float:
    """Every n-th pixel's block averaged, so that the longer side has at most 240 pixels."""
    step = -(-max(image.shape[:2]) // _THUMBNAIL_PX)
    height, width = (max(1, side // step) for side in image.shape[:2])
    step_y, step_x = min(step, image.shape[0]), min(step, image.shape[1])
    blocks = image[: height * step_y, : width * step_x].reshape(height, step_y, width, step_x, 3)
    return np.asarray(blocks.mean(axis=(1, 3)))

"""Page: the offline HTML report, made from the templates beside this file.

The only file that imports jinja2. Linear images are embedded as float16, the low and the high bytes apart,
deflated and in base64: half the size of plain base64, and exposure works on real values. Values above 65504,
the largest float16, are clipped to it. Larger pictures are embedded as 8-bit PNG.
"""

import base64
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from refdof._check import Float
from refdof.comparison import Chart, Comparison
from refdof.image.file import png_bytes
from refdof.report.rows import at_noise_floor, plain, rows_as_json
from refdof.report.table import columns, footnote, reference_line, texts

__all__ = ["FLOAT_LIMIT_PX", "index_page", "rendered", "report_page"]

FLOAT_LIMIT_PX = 1_500_000  # pictures with more pixels are embedded as PNG

_FLOAT16_MAX = 65504.0
_THUMBNAIL_PX = 320


def report_page(comparison: Comparison, command: str = "") -> str:
    """One self-contained page: viewer, table, parameters and command. No link, no outside resource."""
    standard, first = comparison.standard
    height, width = first.shape[:2]
    encoding = "float16" if width * height <= FLOAT_LIMIT_PX else "png"
    images = [(standard, first), *([("pinhole", comparison.pinhole)] if standard != "pinhole" else [])]
    images += [(row.name, row.image) for row in comparison.rows]
    if encoding == "float16" and comparison.standard_error is not None:
        images.append(("standard error", comparison.standard_error))
    values = rows_as_json(comparison, command)
    return rendered(
        "report.html",
        values=values,
        table=_table(comparison),
        viewer={
            "width": width,
            "height": height,
            "encoding": encoding,
            "names": [name for name, _ in images],
        },
        chart=None if comparison.chart is None else _strips(comparison.chart),
        payloads=[_float16(image) if encoding == "float16" else _png(image) for _, image in images],
    )


def _strips(chart: Chart) -> dict[str, Any]:
    """A lens chart: its caption, and pictures as PNG."""
    pictures = [{"name": name, "png": _png(image)} for name, image in chart.pictures.items()]
    return {"caption": chart.caption, "pictures": pictures}


def index_page(comparisons: Sequence[Comparison], folders: Sequence[str], command: str = "") -> str:
    """A page above several reports: a picture, the table and the way to each."""
    scenes = [
        {"name": c.scene, "folder": folder, "thumbnail": _png(_smaller(c.standard[1])), "table": _table(c)}
        for c, folder in zip(comparisons, folders, strict=True)
    ]
    return rendered("index.html", scenes=scenes, command=command)


def rendered(name: str, folder: Path | None = None, **values: Any) -> str:
    """A template of this folder, or of another one that may include this one's, filled in."""
    loader = FileSystemLoader([Path(__file__).parent, *([] if folder is None else [folder])])
    templates = Environment(
        loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    return str(templates.get_template(name).render(values))


def _table(comparison: Comparison) -> dict[str, Any]:
    """The table as text and as numbers to sort by."""
    return {
        "columns": [column.heading for column in columns()],
        "rows": [
            {
                "method": row.name,
                "cells": list(texts(row).values()),
                "note": "at the noise floor" if at_noise_floor(row, comparison) else "",
                "params": ", ".join(f"{key} = {plain(value)}" for key, value in row.params.items()),
            }
            for row in comparison.rows
        ],
        "reference": reference_line(comparison),
        "footnote": footnote(),
    }


def _float16(image: Float) -> str:
    half = np.clip(image, -_FLOAT16_MAX, _FLOAT16_MAX).astype("<f2")
    split = half.view(np.uint8).reshape(-1, 2).T  # low bytes first, then high bytes: those repeat and deflate well
    return base64.b64encode(zlib.compress(split.tobytes(), 4)).decode("ascii")


def _png(image: Float) -> str:
    return base64.b64encode(png_bytes(image)).decode("ascii")


def _smaller(image: Float) -> Float:
    """Every n-th pixel's block averaged, so that the longer side has at most 320 pixels."""
    step = -(-max(image.shape[:2]) // _THUMBNAIL_PX)
    height, width = (max(1, side // step) for side in image.shape[:2])
    step_y, step_x = min(step, image.shape[0]), min(step, image.shape[1])
    blocks = image[: height * step_y, : width * step_x].reshape(height, step_y, width, step_x, 3)
    return np.asarray(blocks.mean(axis=(1, 3)))

"""Write: the files of a report. Each is replaced in one step; other files in the folder are left alone."""

import json
import os
import re
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from refdof._check import Float, InputError
from refdof._jit import run_tasks
from refdof.comparison import Comparison
from refdof.image.atomic import write_bytes, write_text
from refdof.image.file import save_image
from refdof.report.latex import latex_table
from refdof.report.page import index_page, report_page
from refdof.report.rows import rows_as_json
from refdof.report.table import csv_table, markdown_table

__all__ = ["distinct_names", "write_comparison", "write_comparisons"]


def write_comparison(
    comparison: Comparison, folder: str | os.PathLike[str], command: str = "", position: int = 0
) -> None:
    """Write one scene's report.

    ============================  ==================================================================
    table.md, table.csv           the scores, rounded for reading and in full
    table.json                    the same with camera, lens and reference; see `rows_as_json`
    <name>.png, <name>.npy        display image and linear float32 of "reference", "pinhole" and
                                  every method
    overview.png                  every method beside the reference, with crops and errors
    scores.png, scores.svg        error over time of every method
    table.tex                     the main scores for LaTeX, with the package booktabs
    report.html                   one offline page to flip the images in place
    motion.png, motion_strip.png  where there are frames of a slow move: an animated PNG, and one row of
                                  pixels over time
    ============================  ==================================================================

    Parameters
    ----------
    comparison : Comparison
    folder : path
        Made if missing.
    command : str
        What reproduces the report; shown in it. Empty: the nearest `refdof compare` line.
    position : int
        Which of several scenes of the command.

    Raises
    ------
    InputError
        If the folder cannot be written, or an image is not finite or not of the reference's shape.
    """
    from refdof.report.motion_pictures import moving_png, strips_png
    from refdof.report.overview import write_overview  # matplotlib is slow to import
    from refdof.report.plots import write_scatter

    target = Path(folder)
    images = _images(comparison)

    def save(name: str, image: Float) -> None:
        save_image(target / f"{name}.png", image)
        save_image(target / f"{name}.npy", image.astype("float32"))

    def drawings() -> None:  # one after the other: matplotlib's settings are global
        write_overview(comparison, target / "overview.png")
        if comparison.reference is not None:
            write_scatter(comparison, [target / "scores.png", target / "scores.svg"])

    def motion_pictures() -> None:
        if comparison.motion is not None:
            write_bytes(target / "motion.png", moving_png(comparison.motion))
            write_bytes(target / "motion_strip.png", strips_png(comparison.motion))

    # Those that take longest come first.
    jobs: list[Callable[[], Any]] = [
        motion_pictures,
        drawings,
        lambda: report_page(comparison, command, position),
        *(partial(save, *image) for image in images),
    ]
    _, _, page, *_ = run_tasks(lambda job: job(), jobs)
    _write_tables([comparison], target, rows_as_json(comparison, command))
    write_text(target / "report.html", page)


def write_comparisons(comparisons: Sequence[Comparison], folder: str | os.PathLike[str], command: str = "") -> None:
    """Write the reports of one or more scenes.

    One scene goes directly into `folder`. Several go into a folder each, named by the scene; above them
    stand the joined tables (``table.json`` is then a list) and an index page.

    Raises
    ------
    InputError
        As `write_comparison`; also if there is no comparison.
    """
    if not comparisons:
        raise InputError("comparisons: got none; allowed is at least one")
    if len(comparisons) == 1:
        write_comparison(comparisons[0], folder, command)
        return
    target = Path(folder)
    names = distinct_names([comparison.scene for comparison in comparisons])
    for position, (name, comparison) in enumerate(zip(names, comparisons, strict=True)):
        write_comparison(comparison, target / name, command, position)
    _write_tables(comparisons, target, [rows_as_json(comparison, command) for comparison in comparisons])
    write_text(target / "report.html", index_page(comparisons, names, command))


def _write_tables(comparisons: Sequence[Comparison], folder: Path, content: Any) -> None:
    write_text(folder / "table.md", markdown_table(comparisons))
    write_text(folder / "table.csv", csv_table(comparisons))
    if any(comparison.reference is not None for comparison in comparisons):
        write_text(folder / "table.tex", latex_table(comparisons))
    write_text(folder / "table.json", json.dumps(content, indent=2, allow_nan=False, ensure_ascii=False) + "\n")


def _images(comparison: Comparison) -> list[tuple[str, Float]]:
    """File name without suffix, and image, of everything that gets a picture."""
    (standard, first), pinhole = comparison.standard, [("pinhole", comparison.pinhole)]
    shown = [(standard, first), *(pinhole if standard != "pinhole" else [])]
    names = distinct_names([*(name for name, _ in shown), *(row.name for row in comparison.rows)])
    images = [*(image for _, image in shown), *(row.image for row in comparison.rows)]
    for name, image in zip(names, images, strict=True):
        if image.shape != first.shape:
            raise InputError(f"{name}: got shape {image.shape}; allowed is the {standard}'s {first.shape}")
    return list(zip(names, images, strict=True))


def distinct_names(names: Sequence[str]) -> list[str]:
    """Names that are safe and different as file names, in any letter case."""
    taken: set[str] = set()
    result = []
    for name in names:
        safe = re.sub(r"[^A-Za-z0-9._-]+", "-", name).strip(".-") or "unnamed"
        candidate, number = safe, 2
        while candidate.lower() in taken:
            candidate, number = f"{safe}-{number}", number + 1
        taken.add(candidate.lower())
        result.append(candidate)
    return result

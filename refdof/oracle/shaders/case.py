"""A case's numbers and pictures, by the names that expressions use.

color (H, W, 3) is linear RGB; depth and planar are planar depth; coc is the signed radius of the circle of confusion
[px]. Of depth, with the case's near and far: device is a z-buffer 0 .. 1, reversed is 1 .. 0, and reversed_infinite is
near / depth.
"""

import ast
from pathlib import Path
from typing import NamedTuple

import numpy as np

from refdof._check import Float
from refdof.oracle.files import FileFault
from refdof.oracle.shaders.expressions import names_in
from refdof.oracle.sources import NotSupported, Task

__all__ = ["PICTURES", "CaseValues", "case_values", "filter_of"]

PICTURES = ("color", "depth", "planar", "coc", "device", "reversed", "reversed_infinite")
_DEVICE = {"device", "reversed", "reversed_infinite", "coc"}  # linear in 1 / depth
_PLANAR = {"depth", "planar"}


class CaseValues(NamedTuple):
    """Numbers and words of `params.txt`, and pictures, float64, rows in the order of texture rows."""

    numbers: dict[str, float]
    words: dict[str, str]
    pictures: dict[str, Float]


def case_values(task: Task, mirrored: bool) -> CaseValues:
    """Read a case; `mirrored`: with its rows the other way round.

    Raises
    ------
    FileFault
        If `params.txt` lacks a number.
    """
    numbers, words = _params(task.folder / "params.txt")
    for key in ("near", "far", "focus", "coc_scale"):
        if key not in numbers:
            raise FileFault(f"params.txt: lacks {key}")
    color, depth, coc = (image[::-1] if mirrored else image for image in task.images)
    planar = depth.astype(np.float64)
    height, width = depth.shape
    near, far = numbers["near"], numbers["far"]
    with np.errstate(all="ignore"):
        span = planar * (far - near)
        device = np.where(span > 0.0, far * (planar - near) / span, 0.0)
        flipped = np.where(span > 0.0, near * (far - planar) / span, 1.0)
        infinite = near / planar
    numbers = {**numbers, "width": float(width), "height": float(height)}
    pictures = (color.astype(np.float64), planar, planar, coc.astype(np.float64), device, flipped, infinite)
    return CaseValues(numbers, words, dict(zip(PICTURES, pictures, strict=True)))


def filter_of(name: str, tree: ast.expr, case: CaseValues) -> str:
    """How a texture of an expression is read: as the case reads colour, or depth.

    Raises
    ------
    NotSupported
        If a linear filter of it gives another blend of depths than the case has.
    """
    pictures = names_in(tree) & set(PICTURES)
    if "color" in pictures:
        return "nearest" if case.words.get("color_filter") == "nearest" else "linear"
    wanted = case.words.get("depth_filter", "nearest")
    if wanted == "nearest":
        return "nearest"
    if pictures <= {"bilinear": _DEVICE, "bilinear_depth": _PLANAR}.get(wanted, set()):
        return "linear"
    raise NotSupported(f"{name}: a filtered texture of it gives other depths than depth_filter {wanted}")


def _params(path: Path) -> tuple[dict[str, float], dict[str, str]]:
    """Lines "key value": numbers and words."""
    numbers, words = {}, {}
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, ValueError) as error:
        raise FileFault(f"params.txt: cannot be read ({error})") from None
    for line in lines:
        key, _, value = line.partition(" ")
        try:
            numbers[key] = float(value)
        except ValueError:
            words[key] = value
    return numbers, words

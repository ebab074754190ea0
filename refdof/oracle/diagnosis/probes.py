"""Probes: run a port on pictures made to show its taps, at the depths of a case.

At fixed depth the single pass is linear in colour, so that a few pictures tell much of a pixel's taps without a model:

1. Black, and twice the light: whether the port is linear at all      `_light`
2. One white texel: its weight in each pixel around it                `_grid`
3. Places, and their squares, as colours: sum, middle and spread      `_moments`

Expected values are those of a right port, from the emulation. Only colour is another than the case's.
"""

import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from refdof._check import Float
from refdof.oracle.diagnosis.emulate import emulator
from refdof.oracle.diagnosis.samples import Shot, samples_of
from refdof.oracle.files import FileFault
from refdof.oracle.sources import NotSupported, Source, Task

__all__ = ["probe"]

_REACH = 2  # px: the grid shows a pixel and so many to each side
_CLOSE = 1e-3  # of the light
_LINEAR = "  linear in colour, and black stays black"

_Paint = Callable[[Float], Float]


def probe(source: Source, task: Task, shot: Shot) -> list[str]:
    """Lines that show a port's taps beside those expected; none if it cannot be run on other pictures, or all is alike.

    task, shot : the case whose depths are taken, with what the port gave
    """

    def painted(color: Float) -> Float:
        return _run(source, task, color.astype(np.float32))

    def right(color: Float, x: np.ndarray, y: np.ndarray) -> Float:
        return emulator(samples_of(shot._replace(color=color), x, y))(shot.right)

    try:
        black = painted(np.zeros_like(shot.color))
        if np.array_equal(black, shot.got) and shot.got.any():
            return []  # files made elsewhere
        twice = painted(2.0 * shot.color)
        said = _light(black, twice, shot)
        lines = [f"probes at the depths of {shot.name}, expected beside got:", *(said or [_LINEAR])]
        if said:
            return lines
        for x, y in _pixels(shot):
            shown = [*_moments(painted, right, x, y, shot), *_grid(painted, right, x, y, shot)]
            if shown:
                return [*lines, *shown]
    except (FileFault, NotSupported) as fault:
        return [f"probes: {fault}"]
    return []


def _pixels(shot: Shot) -> list[tuple[int, int]]:
    """x and y of the middle, whose taps are in the picture, and of the worst pixel."""
    height, width = shot.depth.shape
    row, column = np.unravel_index(np.argmax(shot.off), shot.off.shape)
    return [(width // 2, height // 2), (int(column), int(row))]


def _run(source: Source, task: Task, color: Float) -> Float:
    """The port's picture of the case with another colour, in a folder as the pack's own."""
    with tempfile.TemporaryDirectory(prefix="refdof-probe-") as temporary:
        folder = Path(temporary) / task.name
        shutil.copytree(task.folder, folder, ignore=shutil.ignore_patterns("expected"))
        np.save(folder / "inputs" / "color.npy", color.astype("<f4"))
        (folder / "inputs" / "color.f32").write_bytes(color.astype("<f4").tobytes())
        _, depth, coc = task.images
        return np.asarray(source(task._replace(folder=folder, images=(color, depth, coc)))["image"], dtype=np.float64)


def _light(black: Float, twice: Float, shot: Shot) -> list[str]:
    """How the port is not linear in colour, if so."""
    lines, scale = [], float(np.abs(shot.got).max()) or 1.0
    with np.errstate(invalid="ignore"):
        if not bool((np.abs(black) <= _CLOSE * scale).all()):
            lines.append(f"  black gives up to {float(np.nanmax(np.abs(black))):.3g}; expected is 0")
        off = np.nan_to_num(np.abs(twice - 2.0 * shot.got), nan=np.inf)
        if not bool((off <= 2 * _CLOSE * scale).all()):
            worst = np.unravel_index(np.argmax(off), off.shape)
            lines.append(f"  twice the light gives {twice[worst]:.6g}; expected is {2.0 * shot.got[worst]:.6g}")
    return [*lines, "  it is not linear in colour, so that its taps cannot be seen one by one"] if lines else []


def _moments(painted: _Paint, right: Callable[..., Float], x: int, y: int, shot: Shot) -> list[str]:
    """Sum of weights, their middle and their spread at a pixel, of places and squares as colours."""
    height, width = shot.depth.shape
    row, column = np.indices(shot.depth.shape)
    across, along, one = (column - x) / width, (row - y) / height, np.ones(shot.depth.shape)
    pictures = np.stack([across, along, one], axis=-1), np.stack([across**2, along**2, one], axis=-1)
    expected, got = [], []
    for picture in pictures:
        # Nothing below 0, which a port may cut.
        shifted = picture + 1.0
        expected.append(right(shifted, np.array([x]), np.array([y]))[0])
        got.append(painted(shifted)[y, x])
    said = []
    for first, second in (expected, got):
        total = float(first[2]) / 2.0
        with np.errstate(all="ignore"):
            middle = (first[:2] / total - 1.0) * (width, height)
            spread = np.sqrt(np.maximum((second[:2] / total - 1.0) * (width**2, height**2) - middle**2, 0.0))
        said.append(
            f"weights sum to {total:.4f}, their middle is {_rounded(middle[0]):+.2f} px in x and "
            f"{_rounded(middle[1]):+.2f} in y, their spread {spread[0]:.2f} and {spread[1]:.2f}"
        )
    if said[0] == said[1]:
        return []
    return [f"  taps of pixel ({x}, {y}):", f"  expected: {said[0]}", f"  got:      {said[1]}"]


def _grid(painted: _Paint, right: Callable[..., Float], x: int, y: int, shot: Shot) -> list[str]:
    """The weights of one white texel in the pixels around it, in thousandths."""
    picture = np.zeros(shot.color.shape)
    picture[y, x] = 1.0
    around = np.arange(-_REACH, _REACH + 1)
    columns, rows = (part.ravel() for part in np.meshgrid(x + around, y + around))
    height, width = shot.depth.shape
    columns, rows = np.clip(columns, 0, width - 1), np.clip(rows, 0, height - 1)
    side = len(around)
    expected = right(picture, columns, rows)[:, 1].reshape(side, side)
    got = painted(picture)[rows, columns, 1].reshape(side, side)
    wanted, found = ([" ".join(f"{_rounded(1e3 * v):7.2f}" for v in row) for row in half] for half in (expected, got))
    if wanted == found:
        return []
    lines = [f"  {first}   |{second}" for first, second in zip(wanted, found, strict=True)]
    return [f"  weight of texel ({x}, {y}) in the pixels around it, in thousandths:", *lines]


def _rounded(value: float) -> float:
    """As it is printed, with one zero instead of two."""
    return round(float(value), 2) + 0.0

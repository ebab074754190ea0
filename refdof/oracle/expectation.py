"""Expectation: a case of a pack in memory: its inputs, and its parts with their bounds and tolerances.

All of it is read, and compared with its digests, before an implementation runs, which may write where it likes.
"""

import math
import re
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float
from refdof.oracle.files import FileFault, Pack, read_json
from refdof.oracle.goldens import Tolerance
from refdof.oracle.sources import Task

__all__ = ["Expectation", "Part", "expectation_of", "words_of"]

_NAME = re.compile(r"[a-z0-9_]{1,80}")
_LARGEST_SIDE = 16384
_MOST_CHANNELS = 4


class Part(NamedTuple):
    """A stage or the image: (h, w) or (h, w, C) each, and the tolerance. A stage may have another size."""

    values: Float
    low: Float
    high: Float
    tolerance: Tolerance


class Expectation(NamedTuple):
    """A case: what case.json says, what an implementation gets, and its parts in the order of making, image last."""

    about: dict[str, Any]
    task: Task
    parts: dict[str, Part]


def expectation_of(pack: Pack, name: str) -> Expectation:
    """Read a case.

    Raises
    ------
    FileFault
        If a file is not as it was written, or the description lacks something or says what cannot be.
    """
    about = pack.description(name)
    try:
        width, height = about["size"]
        expected = {**about["expected"]["stages"], "image": about["expected"]["image"]}
        paths = [about["inputs"][part]["npy"] for part in ("color", "depth", "coc")]
        params, tags = dict(about["params"]), about["tags"]
        sides = all(_is_whole(side) and 1 <= side <= _LARGEST_SIDE for side in (width, height))
        words = all(isinstance(word, str) for word in (about["method"], about["rows"], *tags))
        if not sides or not words or not all(_NAME.fullmatch(part) for part in expected):
            raise ValueError("size, method, rows, tags or a stage's name")
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise FileFault(f"case.json: lacks or garbles {str(error)[:200]}") from None
    sizes = ((height, width, 3), (height, width), (height, width))
    color, depth, coc = (pack.array(name, path, size) for path, size in zip(paths, sizes, strict=True))
    parts = {part: _part(pack, name, part, entry, (height, width)) for part, entry in expected.items()}
    shapes = {part: one.values.shape for part, one in parts.items()}
    return Expectation(about, Task(name, pack.folder / "cases" / name, (color, depth, coc), params, shapes), parts)


def words_of(pack: Pack) -> tuple[set[str], set[str]]:
    """The tags and the stages of all cases that can be read: what a plan may name."""
    tags: set[str] = set()
    stages: set[str] = set()
    for case in pack.cases:
        try:
            about = read_json(pack.folder / "cases" / case / "case.json")
            tags |= {tag for tag in about["tags"] if isinstance(tag, str)}
            stages |= set(about["expected"]["stages"])
        except (FileFault, KeyError, TypeError):
            continue  # told when its turn comes
    return tags, stages


def _part(pack: Pack, case: str, part: str, entry: Any, size: tuple[int, int]) -> Part:
    try:
        shape = tuple(entry["shape"])
        fits = len(shape) in (2, 3) and all(_is_whole(side) and 1 <= side <= _LARGEST_SIDE for side in shape)
        if not fits or max(shape[2:], default=1) > _MOST_CHANNELS or (part == "image" and shape != (*size, 3)):
            raise ValueError("the shape")
        paths = (entry["npy"], entry.get("low", entry["npy"]), entry.get("high", entry["npy"]))
        tolerance = _tolerance(entry["tolerance"])
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise FileFault(f"case.json: {part} lacks or garbles {str(error)[:200]}") from None
    values, low, high = (pack.array(case, path, shape) for path in paths)
    if (low > high).any():
        raise FileFault(f"case.json: {part} has bounds the wrong way round")
    return Part(values, low, high, tolerance)


def _tolerance(entry: Mapping[str, Any]) -> Tolerance:
    tolerance = Tolerance(**entry)
    numbers = [tolerance.max_abs, tolerance.max_rel, tolerance.hard_factor, tolerance.max_failing_fraction]
    numbers += [] if tolerance.max_rms is None else [tolerance.max_rms]
    for number in numbers:
        if isinstance(number, bool) or not isinstance(number, (int, float)) or not 0.0 <= number < math.inf:
            raise ValueError("a number of the tolerance")
    if tolerance.nan not in ("forbid", "match"):
        raise ValueError("nan of the tolerance")
    return tolerance


def _is_whole(number: Any) -> bool:
    return isinstance(number, (int, np.integer)) and not isinstance(number, bool)

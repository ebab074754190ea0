"""Shots: run a port on cases of a pack, and choose those that tell most.

1. Run the plain cases; if all of those pass, also the others    `shots_of`
2. Keep failing ones of many kinds, and some that pass           `telling`
"""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np

from refdof.oracle.diagnosis.model import Model, model_of
from refdof.oracle.diagnosis.samples import Shot
from refdof.oracle.files import FileFault, Pack
from refdof.oracle.sources import NotSupported, Source, Task

__all__ = ["METHOD", "case_shot", "probed", "shots_of", "telling"]

METHOD = "singlepass"
_INPUTS = ("cards", "noise", "hdr", "scene", "bar", "ramp", "impulses", "constant")  # by how much they tell
_MOST_OF_AN_INPUT, _FAILING, _PASSING = 3, 6, 2
_EXTREME = "extreme"  # a tag
_SLOW = 20000  # pixels: of larger pictures, one an input is run


def shots_of(pack: Pack, source: Source, case: str | None) -> tuple[list[Shot], list[str]]:
    """What the port made of cases, or of one, and why others were not run: a line each."""
    about: dict[str, dict[str, Any]] = {}
    faults: list[str] = []
    for name in pack.cases:
        try:
            about[name] = pack.description(name)
        except FileFault as fault:
            faults.append(f"{name}: {fault}")
    ours = [name for name, one in about.items() if one.get("method") == METHOD and case in (None, name)]
    plain = [name for name in ours if case or (_is_plain(about[name]) and not _is_mirrored(about[name]))]
    shots = _run(pack, source, _few(plain, about), about, faults)
    if not any(_fails(shot) for shot in shots):
        few = {shot.name for shot in shots}
        shots += _run(pack, source, [name for name in plain if name not in few], about, faults)
    others = [name for name in ours if name not in plain]
    mirrored = [name for name in others if _is_mirrored(about[name])]
    for names in ([name for name in others if name not in mirrored], mirrored):
        if not any(_fails(shot) for shot in shots):
            shots += _run(pack, source, names, about, faults)
    return shots, faults


def probed(pack: Pack, shots: list[Shot]) -> tuple[Task, Shot] | None:
    """The shot whose depths show taps best, of one depth, wrong and with large circles, and its task."""
    flat = [shot for shot in shots if np.ptp(shot.depth) == 0.0 and np.isfinite(shot.got).all()]
    shot = max(flat, key=lambda shot: (_fails(shot), float(np.abs(shot.coc).max())), default=None)
    return None if shot is None else (case_shot(pack, shot.name, pack.description(shot.name))[0], shot)


def telling(shots: list[Shot]) -> list[Shot]:
    """Failing shots, one of each input before others, and some that pass."""
    order = {name: place for place, name in enumerate(_INPUTS)}

    def kind(shot: Shot) -> int:
        return next((place for name, place in order.items() if name in shot.name), len(order))

    seen: dict[int, int] = {}
    ranked = []
    for shot in sorted(shots, key=kind):
        seen[kind(shot)] = seen.get(kind(shot), 0) + 1
        ranked.append((seen[kind(shot)], kind(shot), shot))
    ranked.sort(key=lambda entry: entry[:2])
    failing = [shot for _, _, shot in ranked if _fails(shot)][:_FAILING]
    return failing + [shot for _, _, shot in ranked if not _fails(shot)][:_PASSING]


def _is_plain(about: dict[str, Any]) -> bool:
    """Whether a case has the listing's own constants and no input of another range."""
    right = _right(about)
    return right is not None and replace(right, row_step=1) == Model() and _EXTREME not in (about.get("tags") or ())


def _is_mirrored(about: dict[str, Any]) -> bool:
    """Whether a case has the spiral that many ports rightly do not have."""
    right = _right(about)
    return right is not None and right.row_step == -1


def _right(about: dict[str, Any]) -> Model | None:
    try:
        return model_of(about["params"], str(about["rows"]))
    except (KeyError, TypeError, ValueError, AttributeError):
        return None


def _fails(shot: Shot) -> bool:
    return not bool((shot.off <= 1.0).all())


def _few(names: list[str], about: dict[str, dict[str, Any]]) -> list[str]:
    """The smallest cases of every input."""
    pixels = {name: int(np.prod(about[name].get("size") or (0,))) for name in names}
    kept: dict[str, int] = {}
    chosen = []
    for name in sorted(names, key=lambda name: pixels[name]):
        entry = str(about[name].get("input"))
        if kept.get(entry, 0) < (_MOST_OF_AN_INPUT if pixels[name] <= _SLOW else 1):
            kept[entry] = kept.get(entry, 0) + 1
            chosen.append(name)
    return [name for name in names if name in chosen]


def _run(
    pack: Pack, source: Source, names: Iterable[str], about: dict[str, dict[str, Any]], faults: list[str]
) -> list[Shot]:
    shots = []
    for name in names:
        try:
            task, shot = case_shot(pack, name, about[name])
            got = source(task)["image"]
            shots.append(_with_results(shot, pack, name, about[name], got))
        except NotSupported:
            continue
        except FileFault as fault:
            faults.append(f"{name}: {fault}")
    return shots


def case_shot(pack: Pack, name: str, about: dict[str, Any]) -> tuple[Task, Shot]:
    """A case as an implementation gets it, and as a shot without results.

    Raises
    ------
    FileFault
        If its description or a file is not what it has to be.
    """
    try:
        width, height = (int(side) for side in about["size"])
        paths = [about["inputs"][part]["npy"] for part in ("color", "depth", "coc")]
        expected = {"image": about["expected"]["image"], **about["expected"]["stages"]}
        shapes = {part: tuple(int(side) for side in entry["shape"]) for part, entry in expected.items()}
        lens = float(about["lens"]["coc_scale"]), float(about["lens"]["focus"])
        allowed = float(about["expected"]["image"]["tolerance"]["max_abs"])
        planes = about.get("device_depth") or {}
        near_far = [planes.get(name) for name in ("near", "far")]
        params, right = dict(about["params"]), model_of(about["params"], str(about["rows"]))
        values = about["expected"]["image"]["npy"]
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise FileFault(f"case.json: lacks or garbles {error}") from None
    sizes = ((height, width, 3), (height, width), (height, width))
    color, depth, coc = (pack.array(name, path, size) for path, size in zip(paths, sizes, strict=True))
    wanted = pack.array(name, values, sizes[0])
    task = Task(name, pack.folder / "cases" / name, (color, depth, coc), params, shapes)
    near, far = (float(given or least) for given, least in zip(near_far, (depth.min(), depth.max()), strict=True))
    nothing = np.zeros((height, width))
    return task, Shot(name, color, depth, coc, *lens, near, far, wanted, wanted, allowed, nothing, right)


def _with_results(shot: Shot, pack: Pack, name: str, about: dict[str, Any], got: np.ndarray) -> Shot:
    entry = about["expected"]["image"]
    low, high = (pack.array(name, entry.get(part, entry["npy"]), shot.color.shape) for part in ("low", "high"))
    with np.errstate(invalid="ignore"):
        got = got.astype(np.float64)
        off = np.maximum(low - got, got - high).max(axis=-1) / shot.tolerance
    return shot._replace(got=got, off=np.maximum(np.nan_to_num(off, nan=np.inf), 0.0))

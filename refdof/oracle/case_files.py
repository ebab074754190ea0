"""Files of a case: inputs, expected results, and what describes them, for programs and for people.

1. Inputs, each as NPY and as raw numbers                      `_inputs`
2. Depth as depth buffers hold it, raw                         `_device_depths`
3. The picture and stages as both, their bounds as NPY          `_write_expected`
4. `case.json`, `params.txt` and a preview                     `write_case`

What a port may want is there as raw numbers; what only a check reads, as NPY: so the core pack is small enough.
"""

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from refdof._check import Float
from refdof.image.exr import save_channels
from refdof.methods import METHODS
from refdof.oracle.case import Case
from refdof.oracle.cases import module_of
from refdof.oracle.device_depth import DEVICE_DEPTHS, Planes, circle_error, device_depth, planes_of
from refdof.oracle.goldens import Expected, Golden, Tolerance
from refdof.oracle.inputs import INPUTS, ORIGINS
from refdof.oracle.pictures import Picture
from refdof.oracle.preview import preview_of
from refdof.report.rows import plain

__all__ = ["CASE_SCHEMA", "ENOUGH", "write_case", "write_json", "write_plain"]

CASE_SCHEMA = "refdof-case-1"
ENOUGH = 1e-5
"""Circles this far off [px] move a picture by less than its tolerance of 2e-5: the rim of a tap has a slope of 1.5."""


def write_case(folder: Path, case: Case, golden: Golden, exr: bool = False) -> None:
    """Write all files of a case into a new folder."""
    picture, expected = golden.picture, golden.expected
    planes = planes_of(picture.depth)
    inputs = _inputs(folder, picture, exr)
    image = _write_expected(folder, "image", expected["image"], exr)
    stages = {name: _write_expected(folder, name, one) for name, one in expected.items() if name != "image"}
    params = plain(asdict(golden.params))
    numbers = module_of(case.method).numbers(golden.params, case.rows)
    capabilities = _capabilities(case, golden.params)
    about = {
        "schema": CASE_SCHEMA,
        "name": case.name,
        "method": case.method,
        "source": METHODS[case.method].METHOD.source,
        "input": case.input,
        "notes": " ".join((INPUTS[case.input].__doc__ or "").split()),
        "origin": case.origin or ORIGINS.get(case.input, "numbers at the ends of float32"),
        "size": list(case.size),
        "rows": case.rows,
        "params": params,
        "lens": {"coc_scale": picture.coc_scale, "focus": picture.focus},
        "inputs": inputs,
        "device_depth": _device_depths(folder, picture, planes, params.get("max_blur_size", np.inf)),
        "expected": {"image": image, "stages": stages},
        "tags": list(dict.fromkeys([case.method, case.input, *case.tags, *capabilities])),
        "capabilities": capabilities,
    }
    write_json(folder / "case.json", about)
    lines = {
        "method": case.method,
        "width": case.size[0],
        "height": case.size[1],
        "rows": case.rows,
        "near": planes.near,
        "far": planes.far,
        "focus": picture.focus,
        "coc_scale": picture.coc_scale,
        **params,
        **numbers,
    }
    write_plain(folder / "params.txt", "".join(_lines(lines)))
    shown = expected["image"].values
    (folder / "preview.png").write_bytes(preview_of(shown[::-1] if case.rows == "up" else shown))


def write_json(path: Path, content: Mapping[str, Any]) -> None:
    """Write JSON that is the same bytes everywhere."""
    write_plain(path, json.dumps(content, indent=2, allow_nan=False, ensure_ascii=False) + "\n")


def write_plain(path: Path, text: str) -> None:
    """Write text as UTF-8 with line feeds."""
    path.write_text(text, encoding="utf-8", newline="\n")


def _capabilities(case: Case, params: Any) -> list[str]:
    """What a port must be able to do: parameters that differ from the defaults, and the tags of the case."""
    defaults = METHODS[case.method].METHOD.defaults()
    changed = [name for name, value in asdict(params).items() if value != defaults[name] and name != "row_order"]
    return [*changed, *(tag for tag in case.tags if tag != "params" and tag not in changed)]


def _lines(values: Mapping[str, Any]) -> list[str]:
    """Lines "key value"; what is None is left out, and a table has a line for each number."""
    found = []
    for key, value in values.items():
        if isinstance(value, (list, tuple)):
            found += _lines({f"{key}_{k}": part for k, part in enumerate(value)})
        elif value is not None:
            found.append(f"{key} {value}\n")
    return found


def _inputs(folder: Path, picture: Picture, exr: bool) -> dict[str, Any]:
    return {name: _write_both(folder, f"inputs/{name}", getattr(picture, name), exr) for name in picture._fields[:3]}


def _device_depths(folder: Path, picture: Picture, planes: Planes, largest: float) -> dict[str, Any]:
    """Depth as buffers hold it, and what that leaves of circles up to the largest that count."""
    entries: dict[str, Any] = {"near": planes.near, "far": planes.far}
    for name, formula in DEVICE_DEPTHS.items():
        values, error = device_depth(name, picture.depth, planes), circle_error(name, picture, planes, largest)
        _write_raw(folder / f"inputs/{name}.f32", values)
        # Two digits are enough, and do not depend on the last bits of a subtraction.
        entries[name] = {
            "raw": f"inputs/{name}.f32",
            "shape": list(values.shape),
            "formula": formula,
            "circle_error_px": float(f"{error:.2g}"),
            "enough": error <= ENOUGH,
        }
    return entries


def _write_expected(folder: Path, name: str, one: Expected, exr: bool = False) -> dict[str, Any]:
    """An array, and its bounds where they are not the array itself. Returns its entry in case.json."""
    place, start = ("expected/image", "expected/") if name == "image" else (f"expected/stages/{name}",) * 2
    entry = _write_both(folder, place, one.values, exr)
    parts = {part: f"{start}{'' if name == 'image' else '_'}{part}.npy" for part in ("low", "high", "ambiguity")}
    if not (np.array_equal(one.low, one.values) and np.array_equal(one.high, one.values)):
        for part in ("low", "high"):
            entry[part] = parts[part]
            _save(folder / parts[part], getattr(one, part))
    if one.ambiguity.any():
        entry["ambiguity"] = parts["ambiguity"]
        _save(folder / parts["ambiguity"], one.ambiguity)
    wide = one.high.astype(np.float64) - one.low > one.tolerance.max_abs
    tied = one.ambiguity & wide.reshape(*one.ambiguity.shape, -1).any(axis=-1)
    shares = {
        f"{word}_share": float(f"{part.mean():.4g}") for word, part in (("ambiguous", one.ambiguity), ("wide", tied))
    }
    return {**entry, **shares, "meaning": one.meaning, "tolerance": _limits(one.tolerance)}


def _limits(tolerance: Tolerance) -> dict[str, Any]:
    """The tolerance, but for limits that it does not have."""
    without = {"max_rms": None, "nan": "forbid"}
    return {key: value for key, value in asdict(tolerance).items() if key not in without or value != without[key]}


def _write_both(folder: Path, name: str, values: Float, exr: bool) -> dict[str, Any]:
    entry = {**_write_npy(folder, name, values), "raw": f"{name}.f32"}
    _write_raw(folder / f"{name}.f32", values)
    if exr:
        entry["exr"] = f"{name}.exr"
        save_channels(folder / f"{name}.exr", {"RGB": values} if values.ndim == 3 else {"Y": values})
    return entry


def _write_npy(folder: Path, name: str, values: np.ndarray) -> dict[str, Any]:
    _save(folder / f"{name}.npy", values)
    return {"npy": f"{name}.npy", "shape": list(values.shape)}


def _write_raw(path: Path, values: Float) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(values.astype("<f4").tobytes())


def _save(path: Path, values: np.ndarray) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    kind = np.dtype("<f4") if values.dtype.kind == "f" else values.dtype
    np.save(path, np.ascontiguousarray(values, dtype=kind), allow_pickle=False)

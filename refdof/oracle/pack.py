"""Pack: a folder with which an implementation is checked, in any language and without refdof.

1. Make every case                                        `refdof.oracle.goldens.golden_of`
2. Write its inputs, its results and what describes them  `_write_case`
3. Write the guide, the conventions and the manifest      `write_pack`

No time, no machine and no path is written: the same code writes the same bytes.
"""

import hashlib
import json
import os
import shutil
from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

import refdof
from refdof._check import InputError, as_path
from refdof.image.atomic import atomic_folder, check_folder
from refdof.oracle.cases import Case, cases_of
from refdof.oracle.goldens import Expected, Golden, golden_of
from refdof.oracle.guide import PACK_CONVENTIONS, README
from refdof.report.rows import plain

__all__ = ["CASE_SCHEMA", "MANIFEST", "PACK_SCHEMA", "sha256_of", "write_pack"]

MANIFEST = "manifest.json"
PACK_SCHEMA = "refdof-pack-1"
CASE_SCHEMA = "refdof-case-1"


def write_pack(
    folder: str | os.PathLike[str],
    level: str = "core",
    methods: list[str] | None = None,
    tell: Callable[[str, int, int], None] = lambda what, done, count: None,
) -> list[str]:
    """Write a pack and return the names of its cases.

    Parameters
    ----------
    folder : path
        New, empty, or an earlier pack, which is replaced.
    level : one of `refdof.oracle.cases.LEVELS`
    methods : names, or None for all that have cases
    tell : callable
        Is told what is done, how much of it, and of how much.

    Raises
    ------
    InputError
        If the level or a method is not known, or the folder cannot be written or holds other things.
    """
    cases = cases_of(level, methods)
    _check_target(folder)
    with atomic_folder(folder) as temporary:
        for done, case in enumerate(cases):
            tell(case.name, done, len(cases))
            _write_case(temporary / "cases" / case.name, case, golden_of(case))
        _write_json(temporary / "conventions.json", PACK_CONVENTIONS)
        _write_text(temporary / "README.md", README)
        shutil.copytree(Path(__file__).parent / "schemas", temporary / "schemas")
        files = sorted(path for path in temporary.rglob("*") if path.is_file())
        _write_json(
            temporary / MANIFEST,
            {
                "schema": PACK_SCHEMA,
                "refdof": refdof.__version__,
                "level": level,
                "cases": [case.name for case in cases],
                "files": {path.relative_to(temporary).as_posix(): sha256_of(path.read_bytes()) for path in files},
            },
        )
    return [case.name for case in cases]


def sha256_of(data: bytes) -> str:
    """The digest of a file's bytes, as manifests have it."""
    return hashlib.sha256(data).hexdigest()


def _write_case(folder: Path, case: Case, golden: Golden) -> None:
    picture, expected = golden.picture, golden.expected
    inputs = {
        name: _write_array(folder, f"inputs/{name}", getattr(picture, name)) for name in ("color", "depth", "coc")
    }
    image = _write_expected(folder, "expected/", "image", expected["image"])
    stages = {
        name: _write_expected(folder, f"expected/stages/{name}_", name, one)
        for name, one in expected.items()
        if name != "image"
    }
    params = plain(asdict(golden.params))
    about = {
        "schema": CASE_SCHEMA,
        "name": case.name,
        "method": case.method,
        "input": case.input,
        "size": list(case.size),
        "rows": case.rows,
        "params": params,
        "lens": {"coc_scale": picture.coc_scale, "focus": picture.focus},
        "inputs": inputs,
        "expected": {"image": image, "stages": stages},
        "tags": [case.method, case.input, *case.tags],
    }
    _write_json(folder / "case.json", about)
    _write_text(folder / "params.txt", _flat(_numbers(case, golden, params)))


def _numbers(case: Case, golden: Golden, params: Mapping[str, Any]) -> dict[str, Any]:
    """What `params.txt` holds: every parameter as a loop uses it, and the picture's own numbers."""
    picture = golden.picture
    own = {name: getattr(golden.params, name) for name in ("bound", "first_radius") if hasattr(golden.params, name)}
    resolved = {"loop_bound": own.get("bound"), "radius_start": own.get("first_radius")}
    return {
        "width": case.size[0],
        "height": case.size[1],
        "rows": case.rows,
        "row_step": 1 if params.get("row_order", "down") == case.rows else -1,
        "near": float(picture.depth.min()),
        "far": float(picture.depth.max()),
        "focus": picture.focus,
        "coc_scale": picture.coc_scale,
        **{name: resolved.get(name) if value is None else value for name, value in params.items()},
    }


def _flat(values: Mapping[str, Any]) -> str:
    """Lines "key value"; what is None is left out."""
    return "".join(f"{key} {value}\n" for key, value in values.items() if value is not None)


def _write_expected(folder: Path, place: str, name: str, one: Expected) -> dict[str, Any]:
    """An array, and its bounds where they are not the array itself. Returns its entry in case.json."""
    path = f"expected/{name}" if name == "image" else f"expected/stages/{name}"
    entry = _write_array(folder, path, one.values)
    if not (np.array_equal(one.low, one.values) and np.array_equal(one.high, one.values)):
        for part in ("low", "high", "ambiguity"):
            entry[part] = f"{place}{part}.npy"
            _save(folder / entry[part], getattr(one, part))
    return {**entry, "meaning": one.meaning, "tolerance": asdict(one.tolerance)}


def _write_array(folder: Path, name: str, values: np.ndarray) -> dict[str, Any]:
    _save(folder / f"{name}.npy", values)
    (folder / f"{name}.f32").write_bytes(values.astype("<f4").tobytes())
    return {"npy": f"{name}.npy", "raw": f"{name}.f32", "shape": list(values.shape)}


def _save(path: Path, values: np.ndarray) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    kind = np.dtype("<f4") if values.dtype.kind == "f" else values.dtype
    np.save(path, np.ascontiguousarray(values, dtype=kind), allow_pickle=False)


def _write_json(path: Path, content: Mapping[str, Any]) -> None:
    _write_text(path, json.dumps(content, indent=2, allow_nan=False, ensure_ascii=False) + "\n")


def _write_text(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8", newline="\n")


def _check_target(folder: str | os.PathLike[str]) -> None:
    """Raise before a long run if the folder cannot be made, or holds other things than an earlier pack."""
    target = as_path("out", folder).resolve()
    check_folder(target.parent)
    if not target.exists():
        return
    check_folder(target)
    if any(target.iterdir()) and not _is_earlier(target):
        raise InputError(
            f"out: got {str(folder)!r}, which holds other files; allowed is a new or empty folder, or an earlier pack"
        )


def _is_earlier(folder: Path) -> bool:
    try:
        return bool(json.loads((folder / MANIFEST).read_text(encoding="utf-8"))["schema"] == PACK_SCHEMA)
    except (OSError, ValueError, KeyError, TypeError):
        return False

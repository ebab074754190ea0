"""Folders of arrays: each as NPY and as raw little-endian numbers, and one JSON with shapes and meanings.

A folder appears whole or not at all: it is written under another name beside its place and renamed. An earlier one of
the same kind is replaced; a folder with anything else in it is not touched.
"""

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from refdof._check import InputError, as_path
from refdof.image.atomic import atomic_folder, check_folder

__all__ = ["INDEX", "SCHEMA", "Described", "check_arrays_folder", "save_arrays"]

INDEX = "arrays.json"
SCHEMA = "refdof-arrays-1"


class Described(NamedTuple):
    """An array, and what its readers must know: names of its axes, unit, meaning, names of the last axis' entries."""

    values: np.ndarray
    axes: str
    unit: str = ""
    meaning: str = ""
    columns: tuple[str, ...] = ()
    comparison: str = ""


def check_arrays_folder(folder: str | os.PathLike[str], argument: str = "out") -> None:
    """Raise before a long run if `save_arrays` could not write there.

    Raises
    ------
    InputError
        If the folder cannot be made, or holds other things than an earlier export.
    """
    target = as_path(argument, folder).resolve()
    check_folder(folder, argument, beside=True)
    if target.exists() and any(target.iterdir()) and not _is_earlier(target):
        raise InputError(
            f"{argument}: got {str(folder)!r}, which holds other files; allowed is a new or empty folder, or an "
            "earlier export"
        )


def save_arrays(
    folder: str | os.PathLike[str], arrays: Mapping[str, Described], about: Mapping[str, Any], argument: str = "out"
) -> None:
    """Write all arrays and `arrays.json`.

    Parameters
    ----------
    folder : path
        New, empty, or an earlier export, which is replaced.
    arrays : {name: Described}
        A name may have folders, such as "singlepass/coc". NAME.npy holds the array as it is; NAME.f32 its numbers as
        float32, or NAME.i32 as int32 where it holds whole numbers or truth values: little-endian, rows first.
    about : mapping
        Further entries of the JSON, of JSON's own types.

    Raises
    ------
    InputError
        If the folder cannot be written, or holds other things.
    """
    check_arrays_folder(folder, argument)
    entries = {}
    with atomic_folder(folder, argument) as temporary:
        for name, array in arrays.items():
            values = np.ascontiguousarray(array.values)
            raw, kind = ("f32", "<f4") if values.dtype.kind == "f" else ("i32", "<i4")
            path = temporary / f"{name}.npy"
            path.parent.mkdir(parents=True, exist_ok=True)
            np.save(path, values, allow_pickle=False)
            with np.errstate(over="ignore"):
                path.with_suffix(f".{raw}").write_bytes(values.astype(kind).tobytes())
            entries[name] = {
                "npy": f"{name}.npy",
                "raw": f"{name}.{raw}",
                "raw_type": {"f32": "float32", "i32": "int32"}[raw],
                "dtype": str(values.dtype),
                "shape": list(values.shape),
                **{key: value for key, value in array._asdict().items() if key != "values" and value},
            }
        content = {"schema": SCHEMA, **about, "arrays": entries}
        text = json.dumps(content, indent=2, allow_nan=False, ensure_ascii=False) + "\n"
        (temporary / INDEX).write_text(text, encoding="utf-8", newline="\n")


def _is_earlier(folder: Path) -> bool:
    try:
        return bool(json.loads((folder / INDEX).read_text(encoding="utf-8"))["schema"] == SCHEMA)
    except (OSError, ValueError, KeyError, TypeError):
        return False

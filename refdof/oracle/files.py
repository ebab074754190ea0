"""Files of packs and of results, which may be anyone's: nothing is unpickled, followed out of its folder or trusted.

1. Compare a pack with its manifest: names, then every digest   `open_pack`
2. Read a case's description, and where its files are           `Pack.description`
3. Read an array, whose size is known before it is read         `read_array`
"""

import json
import math
import os
import re
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np

from refdof._check import Float, InputError, as_path
from refdof.oracle.pack import CASE_SCHEMA, MANIFEST, PACK_SCHEMA, sha256_of

__all__ = ["FileFault", "Pack", "open_pack", "read_array"]

_NAME = re.compile(r"[a-z0-9_]{1,80}")


class FileFault(Exception):
    """A file is not what it has to be: one line that names it. Makes its case an error, and no other."""


@dataclass(frozen=True)
class Pack:
    """A pack whose names are as its manifest has them.

    cases: names; faults: {case: the first fault of its files}; its files by path below the pack.
    """

    folder: Path
    cases: tuple[str, ...]
    files: frozenset[str]
    faults: dict[str, str] = field(default_factory=dict)

    def description(self, case: str) -> dict[str, Any]:
        """What `case.json` says.

        Raises
        ------
        FileFault
            If files of the case are not as in the manifest, or its description is not one.
        """
        if case in self.faults:
            raise FileFault(self.faults[case])
        try:
            about = json.loads((self.folder / "cases" / case / "case.json").read_text(encoding="utf-8"))
        except (OSError, ValueError, RecursionError) as error:
            raise FileFault(f"case.json: cannot be read ({error})") from None
        if not isinstance(about, dict) or about.get("schema") != CASE_SCHEMA or about.get("name") != case:
            raise FileFault(f"case.json: is not the description of {case}; its schema has to be {CASE_SCHEMA}")
        return about

    def array(self, case: str, path: Any, shape: tuple[int, ...], kind: str = "f4") -> np.ndarray:
        """An array that the description names.

        Raises
        ------
        FileFault
            If the path is not one of the case's own files, or the file holds anything else.
        """
        if not isinstance(path, str) or not _is_safe(path) or f"cases/{case}/{path}" not in self.files:
            raise FileFault(f"case.json: names {str(path)[:80]!r}, which is no file of the case")
        return read_array(self.folder / "cases" / case / path, shape, (kind,))


def open_pack(folder: str | os.PathLike[str]) -> Pack:
    """Open a pack and compare every file with its digest.

    Raises
    ------
    InputError
        If it is no pack, or a file outside of its cases is not as the manifest has it.
    """
    root = as_path("pack", folder)
    try:
        manifest = json.loads((root / MANIFEST).read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        raise InputError(f"pack: got {str(folder)!r}; allowed is a folder with a {MANIFEST}") from None
    if not isinstance(manifest, dict) or manifest.get("schema") != PACK_SCHEMA:
        raise InputError(f"pack: {MANIFEST} is of another kind; allowed is the schema {PACK_SCHEMA}")
    digests, cases = manifest.get("files"), manifest.get("cases")
    if not isinstance(digests, dict) or not isinstance(cases, list):
        raise InputError(f"pack: {MANIFEST} lacks its files or its cases")
    for name in (*cases, *digests):
        safe = isinstance(name, str) and (_NAME.fullmatch(name) if name in cases else _is_safe(name))
        if not safe:
            raise InputError(f"pack: {MANIFEST} names {str(name)[:80]!r}; allowed are names below the pack")
    if len(set(cases)) != len(cases):
        raise InputError(f"pack: {MANIFEST} names a case twice")
    faults: dict[str, str] = {}
    for name, said in _faults_of(root, digests):
        parts = name.split("/")
        if len(parts) < 3 or parts[0] != "cases" or parts[1] not in cases:
            raise InputError(f"pack: {name} {said}")
        faults.setdefault(parts[1], f"{'/'.join(parts[2:])}: {said}")
    return Pack(root, tuple(cases), frozenset(digests), faults)


def _faults_of(root: Path, digests: dict[str, Any]) -> list[tuple[str, str]]:
    """Files that are not as the manifest has them, and how."""
    found, faults = {}, []
    for path in sorted(root.rglob("*")):
        name = path.relative_to(root).as_posix()
        if path.is_symlink():
            faults.append((name, "is a link; packs hold none"))
        elif not path.is_dir() and name != MANIFEST:
            found[name] = path
    for name, path in found.items():
        if name not in digests:
            faults.append((name, "is not in the manifest"))
        elif not path.is_file() or path.stat().st_size == 0:
            faults.append((name, "is empty"))
        elif sha256_of(path.read_bytes()) != digests[name]:
            faults.append((name, "is not as it was written: its sha256 is another"))
    return faults + [(name, "is missing") for name in digests if name not in found]


def _is_safe(name: str) -> bool:
    parts = PurePosixPath(name).parts
    return bool(parts) and not name.startswith("/") and ".." not in parts and "\\" not in name and "\0" not in name


def read_array(path: Path, shape: tuple[int, ...], kinds: tuple[str, ...] = ("f4", "f8")) -> Float:
    """Read NAME.npy or NAME.f32 of this shape.

    Raises
    ------
    FileFault
        If it is no such array. Its header and its size are compared before anything is read.
    """
    if path.is_symlink() or not path.is_file():
        raise FileFault(f"{path.name}: is {'missing' if not path.exists() else 'no regular file'}")
    count, size = math.prod(shape), path.stat().st_size
    if size == 0:
        raise FileFault(f"{path.name}: is empty")
    if path.suffix != ".npy":
        if size != 4 * count:
            raise FileFault(f"{path.name}: has {size} bytes; {_words(shape)} float32 are {4 * count}")
        return np.fromfile(path, dtype="<f4").reshape(shape)
    with path.open("rb") as file:
        try:
            version = np.lib.format.read_magic(file)
            read = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}[version]
            found, fortran, dtype = read(file)
        except (ValueError, KeyError, EOFError, OSError, SyntaxError, TypeError, RecursionError, MemoryError):
            raise FileFault(f"{path.name}: has no header of an NPY file that is allowed here") from None
        if dtype.hasobject or dtype.str[1:] not in kinds or dtype.byteorder == ">":
            raise FileFault(f"{path.name}: holds {dtype}; allowed is little-endian {' or '.join(kinds)}")
        if tuple(found) != shape:
            raise FileFault(f"{path.name}: has shape {_words(found)}; the case's is {_words(shape)}")
        if fortran:
            raise FileFault(f"{path.name}: is in Fortran's order; allowed is C's")
        if size - file.tell() != count * dtype.itemsize:
            raise FileFault(f"{path.name}: has {size - file.tell()} bytes of numbers, not {count * dtype.itemsize}")
        return np.fromfile(file, dtype=dtype).reshape(shape)


def _words(shape: tuple[int, ...]) -> str:
    return " x ".join(str(side)[:20] for side in shape)

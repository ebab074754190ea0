"""Files of packs and of results, which may be anyone's: nothing is unpickled, followed out of its folder or trusted.

1. Compare a pack's names with its manifest                  `open_pack`
2. Compare a case's files with their digests, before use      `Pack.fault`
3. Read a case's description, and where its files are         `Pack.description`
4. Read an array, whose size is known before it is read       `read_array`
"""

import hashlib
import json
import math
import os
import re
import warnings
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any, BinaryIO

import numpy as np

from refdof._check import Float, InputError, as_path
from refdof.oracle.pack import CASE_SCHEMA, MANIFEST, PACK_SCHEMA

__all__ = ["FileFault", "Pack", "open_pack", "read_array", "read_json"]

_NAME = re.compile(r"[a-z0-9_]{1,80}")
_LARGEST_JSON = 1 << 26  # bytes


class FileFault(Exception):
    """A file is not what it has to be: one line that names it. Makes its case an error, and no other."""


@dataclass(frozen=True)
class Pack:
    """A pack whose names are as its manifest has them; its files are compared when they are needed.

    cases: names; files: {path below the pack: sha256}.
    """

    folder: Path
    cases: tuple[str, ...]
    files: Mapping[str, str]

    def fault(self, case: str) -> str | None:
        """The first file of a case that is not as the manifest has it, and how; None if all are."""
        root, within = self.folder / "cases" / case, f"cases/{case}/"
        digests = {name.removeprefix(within): self.files[name] for name in self.files if name.startswith(within)}
        return next((f"{name}: {said}" for name, said in _faults_of(root, digests)), None)

    def description(self, case: str) -> dict[str, Any]:
        """What `case.json` says.

        Raises
        ------
        FileFault
            If files of the case are not as in the manifest, or its description is not one.
        """
        fault = self.fault(case)
        if fault is not None:
            raise FileFault(fault)
        about = read_json(self.folder / "cases" / case / "case.json")
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
    """Open a pack, and compare its names and the files outside of its cases with the manifest.

    Raises
    ------
    InputError
        If it is no pack, or a file outside of its cases is not as the manifest has it.
    """
    root = as_path("pack", folder)
    try:
        manifest = read_json(root / MANIFEST)
    except FileFault as fault:
        raise InputError(f"pack: got {str(folder)!r} ({fault}); allowed is a folder with a {MANIFEST}") from None
    if not isinstance(manifest, dict) or manifest.get("schema") != PACK_SCHEMA:
        raise InputError(f"pack: {MANIFEST} is of another kind; allowed is the schema {PACK_SCHEMA}")
    digests, cases = manifest.get("files"), manifest.get("cases")
    if not isinstance(digests, dict) or not isinstance(cases, list):
        raise InputError(f"pack: {MANIFEST} lacks its files or its cases")
    for name in cases:
        if not isinstance(name, str) or not _NAME.fullmatch(name):
            raise InputError(f"pack: {MANIFEST} names the case {str(name)[:80]!r}; allowed are a-z, 0-9 and _")
    for name in digests:
        if not _is_safe(name):
            raise InputError(f"pack: {MANIFEST} names {name[:80]!r}; allowed are names below the pack")
    if len(set(cases)) != len(cases):
        raise InputError(f"pack: {MANIFEST} names a case twice")
    outside = {name: digest for name, digest in digests.items() if _case_of(name) not in cases}
    for name, said in _faults_of(root, outside, {MANIFEST, *(f"cases/{case}" for case in cases)}):
        raise InputError(f"pack: {name[:200]!r} {said}")
    return Pack(root, tuple(cases), digests)


def read_json(path: Path) -> Any:
    """Read JSON as it is meant: each key once, and no NaN.

    Raises
    ------
    FileFault
        If the file is missing or too large, or holds anything else.
    """
    try:
        if path.is_symlink() or not path.is_file() or path.stat().st_size > _LARGEST_JSON:
            raise FileFault(f"{path.name}: is missing, no regular file or too large")
        text = path.read_text(encoding="utf-8")
        return json.loads(text, object_pairs_hook=_each_once, parse_constant=_no_number)
    except (OSError, ValueError, RecursionError) as error:
        raise FileFault(f"{path.name}: cannot be read ({str(error)[:200]})") from None


def _each_once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) != len(pairs):
        names = [name for name, _ in pairs]
        raise ValueError(f"the key {next(name for name in names if names.count(name) > 1)[:80]!r} is there twice")
    return found


def _no_number(word: str) -> float:
    raise ValueError(f"{word} is no JSON")


def _case_of(name: str) -> str | None:
    """The case that a file of a pack belongs to."""
    parts = name.split("/")
    return parts[1] if len(parts) > 2 and parts[0] == "cases" else None


def _faults_of(root: Path, digests: Mapping[str, Any], but: Collection[str] = ()) -> Iterator[tuple[str, str]]:
    """Files below a folder, but for some names, that are not as they were written, and how."""
    found = dict(_below(root, but))
    for name, path in found.items():
        if path.is_symlink():
            yield name, "is a link; packs hold none"
        elif name not in digests:
            yield name, "is not in the manifest"
        elif not path.is_file():
            yield name, "is no regular file"
        elif path.stat().st_size == 0:
            yield name, "is empty"
        else:
            with path.open("rb") as file:
                if hashlib.file_digest(file, "sha256").hexdigest() != digests[name]:
                    yield name, "is not as it was written: its sha256 is another"
    yield from ((name, "is missing") for name in digests if name not in found)


def _below(root: Path, but: Collection[str]) -> Iterator[tuple[str, Path]]:
    """Names and paths of all that is no folder, links included; nothing behind a link."""
    for folder, folders, files in os.walk(root):
        names = {name: (Path(folder) / name).relative_to(root).as_posix() for name in sorted([*folders, *files])}
        links = {name for name in folders if (Path(folder) / name).is_symlink()}
        for name in sorted([*links, *files]):
            if names[name] not in but or name in links:
                yield names[name], Path(folder) / name
        folders[:] = [name for name in sorted(folders) if names[name] not in but]


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
    try:
        return _array_of(path, shape, kinds)
    except OSError as error:
        raise FileFault(f"{path.name}: cannot be read ({error.strerror})") from None


def _array_of(path: Path, shape: tuple[int, ...], kinds: tuple[str, ...]) -> Float:
    """`read_array` of a regular file."""
    dtype, count = np.dtype("<f4"), math.prod(shape)
    with path.open("rb") as file:
        size = os.fstat(file.fileno()).st_size
        if size == 0:
            raise FileFault(f"{path.name}: is empty")
        if path.suffix == ".npy":
            dtype = _type_of(file, path.name, shape, kinds)
        here = size - file.tell()
        if here != count * dtype.itemsize:
            raise FileFault(f"{path.name}: has {here} bytes; {_words(shape)} {dtype} are {count * dtype.itemsize}")
        values = np.fromfile(file, dtype=dtype, count=count)
    if values.size != count:
        raise FileFault(f"{path.name}: was cut short while it was read")
    return values.reshape(shape)


def _type_of(file: BinaryIO, name: str, shape: tuple[int, ...], kinds: tuple[str, ...]) -> np.dtype[Any]:
    """Read an NPY file's header, and compare all that it says."""
    try:
        version = np.lib.format.read_magic(file)
        read = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}[version]
        with warnings.catch_warnings():  # headers of Python 2
            warnings.simplefilter("ignore")
            found, fortran, dtype = read(file)
    except Exception:  # whatever Python's parser raises, which reads the header
        raise FileFault(f"{name}: has no header of an NPY file that is allowed here") from None
    if dtype.hasobject or dtype.str[1:] not in kinds or dtype.byteorder == ">":
        raise FileFault(f"{name}: holds {str(dtype)[:80]}; allowed is little-endian {' or '.join(kinds)}")
    if tuple(found) != shape:
        raise FileFault(f"{name}: has shape {_words(found)}; the case's is {_words(shape)}")
    if fortran:
        raise FileFault(f"{name}: is in Fortran's order; allowed is C's")
    return dtype


def _words(shape: tuple[int, ...]) -> str:
    return " x ".join(str(side)[:20] for side in shape[:8])

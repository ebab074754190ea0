"""Pack: a folder with which an implementation is checked, in any language and without refdof.

1. Make every case                                        `refdof.oracle.goldens.golden_of`
2. Write its inputs, its results and what describes them  `refdof.oracle.case_files.write_case`
3. Write the guide, the conventions and the manifest      `write_pack`
4. Take the place of an earlier pack of other content only where that is asked for

No time, no machine and no path is written: the same code writes the same bytes.
"""

import hashlib
import json
import os
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import refdof
from refdof._check import InputError, as_path
from refdof.image.atomic import atomic_folder, check_folder
from refdof.oracle.case_files import CASE_SCHEMA, write_case, write_json, write_plain
from refdof.oracle.cases import cases_of
from refdof.oracle.goldens import golden_of
from refdof.oracle.guide import PACK_CONVENTIONS, guide_of

__all__ = ["CASE_SCHEMA", "MANIFEST", "PACK_SCHEMA", "goldens_digest", "sha256_of", "write_pack"]

MANIFEST = "manifest.json"
PACK_SCHEMA = "refdof-pack-1"
_MADE_OF = ("schema", "refdof", "level", "exr", "cases")  # what is known before anything is made


def write_pack(
    folder: str | os.PathLike[str],
    level: str = "core",
    methods: list[str] | None = None,
    tell: Callable[[str, int, int], None] = lambda what, done, count: None,
    update: bool = False,
    exr: bool = False,
) -> list[str]:
    """Write a pack and return the names of its cases.

    Parameters
    ----------
    folder : path
        New, empty, or an earlier pack. One with the same content stays as it is.
    level : one of `refdof.oracle.cases.LEVELS`
    methods : names, or None for all that have cases
    tell : callable
        Is told what is done, how much of it, and of how much.
    update : bool
        An earlier pack of other content is replaced.
    exr : bool
        Inputs and pictures as EXR, too. Their bytes are OpenEXR's, which other versions of it may pack otherwise.

    Raises
    ------
    InputError
        If the level or a method is not known, or the folder cannot be written, holds other things, or is a pack of
        other content and `update` is False.
    """
    cases = cases_of(level, methods)
    names = [case.name for case in cases]
    about = {"schema": PACK_SCHEMA, "refdof": refdof.__version__, "level": level, "exr": exr, "cases": names}
    earlier = _earlier(folder)
    if earlier and not update:
        _check_same(folder, earlier, about, _MADE_OF)
    with atomic_folder(folder) as temporary:
        for done, case in enumerate(cases):
            tell(case.name, done, len(cases))
            write_case(temporary / "cases" / case.name, case, golden_of(case), exr)
        write_json(temporary / "conventions.json", PACK_CONVENTIONS)
        write_plain(temporary / "README.md", guide_of(list(dict.fromkeys(case.method for case in cases))))
        (temporary / "schemas").mkdir()
        for schema in (Path(__file__).parent / "schemas").glob("*.json"):
            shutil.copyfile(schema, temporary / "schemas" / schema.name)
        paths = sorted(path.relative_to(temporary).as_posix() for path in temporary.rglob("*") if path.is_file())
        files = {path: sha256_of((temporary / path).read_bytes()) for path in paths}
        manifest = {**about, "goldens": goldens_digest(files), "files": files}
        write_json(temporary / MANIFEST, manifest)
        if earlier and not update:
            _check_same(folder, earlier, manifest, ("files",))
    return names


def sha256_of(data: bytes) -> str:
    """The digest of a file's bytes, as manifests have it."""
    return hashlib.sha256(data).hexdigest()


def goldens_digest(files: Mapping[str, str]) -> str:
    """One digest of all cases: of lines as `sha256sum` writes them, by path. The guide does not count."""
    lines = [f"{digest}  {path}\n" for path, digest in sorted(files.items()) if path.startswith("cases/")]
    return sha256_of("".join(lines).encode())


def _earlier(folder: str | os.PathLike[str]) -> dict[str, Any]:
    """The manifest of an earlier pack, or nothing.

    Raises
    ------
    InputError
        Before a long run, if the folder cannot be made, or holds other things.
    """
    target = as_path("out", folder).resolve()
    check_folder(folder, beside=True)
    if not target.exists() or not any(target.iterdir()):
        return {}
    try:
        manifest = json.loads((target / MANIFEST).read_text(encoding="utf-8"))
        if manifest["schema"] == PACK_SCHEMA:
            return dict(manifest)
    except (OSError, ValueError, KeyError, TypeError):
        pass
    raise InputError(
        f"out: got {str(folder)!r}, which holds other files; allowed is a new or empty folder, or an earlier pack"
    )


def _check_same(
    folder: str | os.PathLike[str], earlier: Mapping[str, Any], new: Mapping[str, Any], keys: tuple[str, ...]
) -> None:
    for key in keys:
        if earlier.get(key) != new[key]:
            raise InputError(
                f"out: got {str(folder)!r}, a pack whose {key} differ; allowed is one of the same content, or --update"
            )

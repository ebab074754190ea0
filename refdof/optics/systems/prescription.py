"""Prescriptions: lenses by name, from data/lenses, and from files of three formats.

================  =================================  ==========================
suffix            format                             read by
================  =================================  ==========================
.toml             lens.toml, the project's own       `refdof.optics.systems.lens_toml`
.dat              pbrt's lens files                  `refdof.optics.systems.pbrt_file`
.zmx              Zemax, sequential                  `refdof.optics.systems.zemax_file`
================  =================================  ==========================
"""

import codecs
import difflib
import os
import re
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

from refdof._check import InputError, as_instance, as_path
from refdof._files import as_plain_file
from refdof.image.atomic import write_text
from refdof.optics.systems.lens_toml import lens_text, parse_toml
from refdof.optics.systems.pbrt_file import parse_pbrt
from refdof.optics.systems.system import LensSystem
from refdof.optics.systems.zemax_file import parse_zemax

__all__ = ["LENSES", "MOST_BYTES", "load_lens", "save_lens"]

MOST_BYTES = 1_000_000  # of a file; one of a hundred surfaces has less than 100 000
_SUFFIXES = (".toml", ".dat", ".zmx")
_CONTROL = re.compile("[\x00-\x08\x0e-\x1f\x7f-\x84\x86-\x9f]")  # none of them is in a text


def load_lens(name: Any) -> LensSystem:
    """A lens of data/lenses, or any .toml, .dat or .zmx file.

    Parameters
    ----------
    name : str or Path
        One of `LENSES`, or a path.

    Raises
    ------
    InputError
        If there is neither such a lens nor such a file, or the file is not as its format has it.
    """
    if isinstance(name, str) and name in LENSES:
        return parse_toml(f"{name}.toml", _folder().joinpath(f"{name}.toml").read_text(encoding="utf-8"))
    path = as_path("lens", name)
    suffix = path.suffix.lower()
    if suffix not in _SUFFIXES:
        near = difflib.get_close_matches(str(name), LENSES, n=1, cutoff=0.6)
        hint = f"did you mean {near[0]!r}? " if near else ""
        known = ", ".join(LENSES)
        raise InputError(f"lens: got {str(name)!r}; {hint}allowed are {known}, or a file {', '.join(_SUFFIXES)}")
    file, text = path.name, _text(path)
    if suffix == ".toml":
        return parse_toml(file, text)
    return (parse_pbrt if suffix == ".dat" else parse_zemax)(file, text, path.stem)


def save_lens(path: str | os.PathLike[str], system: LensSystem) -> None:
    """Write a lens.toml.

    Raises
    ------
    InputError
        If the suffix is another, the file cannot be written, or a glass has no form in the file.
    """
    target = as_path("path", path)
    as_instance("system", system, LensSystem)
    if target.suffix.lower() != ".toml":
        raise InputError(f"path: got {str(target)!r}; allowed is a name that ends in .toml")
    write_text(target, lens_text(system), "path")


def _text(path: Path) -> str:
    """The text of a file: UTF-8 or UTF-16; of .zmx also Latin-1, which some makers of lenses write."""
    try:
        size = as_plain_file("lens", path).stat().st_size
        if size > MOST_BYTES:
            raise InputError(f"lens: {path.name} has {size} bytes; allowed are at most {MOST_BYTES}")
        with path.open("rb") as file:
            data = file.read(MOST_BYTES)
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(f"lens: cannot read {str(path)!r} ({reason}); allowed is a file that can be read") from None
    wide = data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    for encoding in (
        ("utf-16",) if wide else ("utf-8-sig", "latin-1") if path.suffix.lower() == ".zmx" else ("utf-8-sig",)
    ):
        try:
            text = data.decode(encoding)
        except UnicodeDecodeError:
            continue
        if not _CONTROL.search(text):
            return text
    raise InputError(f"lens: {path.name} holds no text in UTF-8 or UTF-16; allowed is a text file")


def _folder() -> Traversable:
    """The folder of the lenses: that of a checkout, if this is one, or the installed one."""
    root = Path(__file__).parents[3]
    if (root / "pyproject.toml").is_file():
        return root / "data" / "lenses"
    return resources.files("refdof.data.lenses")


def _found() -> tuple[str, ...]:
    return tuple(sorted(file.name.removesuffix(".toml") for file in _folder().iterdir() if file.name.endswith(".toml")))


LENSES: tuple[str, ...] = _found()

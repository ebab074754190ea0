"""Folder: the files that a page may open and write, all of them below one folder.

Names come from a page, so nobody trusts them: no absolute path, no way up, no link that leads out, plain files only.
"""

import os
from pathlib import Path
from typing import Any

from refdof._check import InputError
from refdof.focus.focus_file import load_focus
from refdof.focus.focus_lens import Focus
from refdof.optics.systems.prescription import LENSES, LensSystem, load_lens
from refdof.scene.builtin import SCENES
from refdof.scene.load import load_scene
from refdof.scene.scene import Scene

__all__ = ["Folder"]

MESHES = (".glb", ".gltf", ".obj", ".ply", ".stl", ".off")
_PRESCRIPTIONS = (".toml", ".dat", ".zmx")
_MOST_LISTED, _MOST_LOOKED_AT, _DEEPEST = 200, 5000, 3
_LONGEST_NAME = 200
_HEAD = 1 << 16  # bytes of a TOML file that tell what it is


class Folder:
    """The files below `root`, and those dropped on the page, which lie in a folder of their own."""

    def __init__(self, root: Path, dropped: Path | None = None) -> None:
        self.root = root.resolve()
        self._dropped = None if dropped is None else dropped.resolve()

    def listing(self) -> dict[str, list[str]]:
        """Names of scenes, lenses and focus files, by their suffixes."""
        found: dict[str, list[str]] = {"scenes": [], "lenses": [], "focus": []}
        looked = 0
        for where, folders, files in os.walk(self.root):
            depth = len(Path(where).relative_to(self.root).parts)
            folders[:] = sorted(name for name in folders if not name.startswith(".")) if depth < _DEEPEST else []
            for name in sorted(files):
                looked += 1
                kind = _kind(Path(where) / name)
                if kind and len(found[kind]) < _MOST_LISTED and not name.startswith("."):
                    found[kind].append(str((Path(where) / name).relative_to(self.root)))
            if looked > _MOST_LOOKED_AT:
                break
        return found

    def existing(self, name: Any) -> Path:
        """The file of a name.

        Raises
        ------
        InputError
            If it is outside the folder, or no plain file.
        """
        for root in (self.root, self._dropped):
            if root is not None and (path := _below(root, name)).is_file():
                return path
        raise InputError(f"name: got {_shown(name)}; allowed is a file below the folder that the studio was started in")

    def new(self, name: Any, suffixes: tuple[str, ...]) -> Path:
        """Where a file of a name may be written.

        Raises
        ------
        InputError
            If that is outside the folder, or the name has another suffix.
        """
        path = _below(self.root, name)
        if path.suffix not in suffixes or not path.stem or path.name.startswith("."):
            raise InputError(f"name: got {_shown(name)}; allowed are names that end in {', '.join(suffixes)}")
        if path.exists() and not path.is_file():
            raise InputError(f"name: got {_shown(name)}, which is no plain file; allowed is another name")
        return path

    def name_of(self, path: Path) -> str:
        """The name of a file below the folder."""
        return path.relative_to(self.root).as_posix()

    def drop(self, name: Any, content: bytes) -> str:
        """Keep a file dropped on the page, for as long as the studio runs; returns its name."""
        if self._dropped is None:
            raise InputError("drop: got a file; allowed is none here")
        path = _below(self._dropped, name)
        if path.parent != self._dropped or path.suffix.lower() not in (*MESHES, *_PRESCRIPTIONS):
            allowed = ", ".join((*MESHES, *_PRESCRIPTIONS))
            raise InputError(f"name: got {_shown(name)}; allowed are file names that end in {allowed}")
        path.write_bytes(content)
        return path.name

    def open(self, name: Any) -> Scene | LensSystem | Focus:
        """What a name stands for: a scene, a lens or focus points.

        Raises
        ------
        InputError
            If there is no such file, or it is not as it should be.
        """
        if name in SCENES:
            return load_scene(name)
        if name in LENSES:
            return load_lens(name)
        path = self.existing(name)
        kind = _kind(path)
        if kind == "focus":
            return load_focus(path, "name")
        return load_lens(path) if kind == "lenses" else load_scene(path)

    def lens(self, name: str) -> LensSystem:
        """The lens of a name, of data/lenses or of the folder."""
        return load_lens(name) if name in LENSES else load_lens(self.existing(name))


def _below(root: Path, name: Any) -> Path:
    if not isinstance(name, str) or not 0 < len(name) <= _LONGEST_NAME or not name.isprintable() or "\\" in name:
        raise InputError(f"name: got {_shown(name)}; allowed is the name of a file")
    try:
        path = (root / name).resolve()
    except (OSError, RuntimeError, ValueError):
        raise InputError(f"name: got {_shown(name)}; allowed is the name of a file") from None
    if Path(name).is_absolute() or ".." in Path(name).parts or not path.is_relative_to(root) or path == root:
        raise InputError(f"name: got {_shown(name)}; allowed are files below the folder that the studio was started in")
    return path


def _shown(name: Any) -> str:
    return repr(name[:80]) if isinstance(name, str) else f"a {type(name).__name__}"


def _kind(path: Path) -> str:
    """What a file is by its name, and a TOML file by its head; "" is something else."""
    suffix = path.suffix.lower()
    if suffix in MESHES:
        return "scenes"
    if suffix not in _PRESCRIPTIONS:
        return ""
    if suffix != ".toml":
        return "lenses"
    try:
        if not path.is_file():
            return ""
        with path.open("rb") as file:
            head = file.read(_HEAD)
    except OSError:
        return ""
    if b"[[point]]" in head:
        return "focus"
    return "lenses" if b"[[surface]]" in head else ""

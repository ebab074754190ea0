"""Files that a mesh file names, such as textures: plain ones in its folder or below, as any system writes names."""

import urllib.parse
from pathlib import Path

from refdof.scene.limits import Meter

__all__ = ["FilesBeside"]


class FilesBeside:
    """The files beside the mesh file `path`; `missing` has those that are left out, with the reason."""

    def __init__(self, path: Path, meter: Meter) -> None:
        self._root, self._meter = path.parent.resolve(), meter
        self.missing: dict[str, str] = {}

    def get(self, name: str, folder: str = "") -> bytes:
        """The bytes of a file by its name, which may be a URI, with slashes of any system.

        It is looked for in `folder`, then beside the mesh. Of a path that leads nowhere, such as one of another
        machine, the last part is looked for.
        """
        path = self.find(name, folder)
        self._meter.bytes(name, path.stat().st_size)
        return path.read_bytes()

    def find(self, name: str, folder: str = "") -> Path:
        """Where the file is; a FileNotFoundError if it is nowhere, and it is told as missing."""
        written = name.strip().replace("\\", "/")
        reasons = []
        for text in dict.fromkeys((written, urllib.parse.unquote(written), written.rpartition("/")[2])):
            relative = "://" not in text and not text.startswith("/")
            for place in dict.fromkeys((folder, "")):
                try:
                    path = _in_any_case(self._root, f"{place}/{text}" if place and relative else text)
                except (OSError, ValueError) as error:
                    reasons.append(str(error))
                    continue
                self.missing.pop(name, None)
                return path
        self.missing[name] = reasons[0]
        raise FileNotFoundError(f"{name}: {reasons[0]}")

    def folder_of(self, path: Path) -> str:
        """The folder of a found file, below the mesh's."""
        return path.parent.relative_to(self._root).as_posix()


def _in_any_case(root: Path, name: str) -> Path:
    """The plain file of a name below `root`; of names that differ in letter case only, the first."""
    if "://" in name:
        raise ValueError("it is on another machine; allowed are files beside the mesh")
    path = root
    for part in Path(name).parts:
        found = path / part
        if not found.exists() and path.is_dir():
            alike = sorted(other.name for other in path.iterdir() if other.name.lower() == part.lower())
            found = path / alike[0] if alike else found
        path = found
    path = path.resolve()
    if not path.is_relative_to(root):
        raise ValueError("it is outside of the mesh file's folder")
    if not path.is_file():
        raise ValueError("it is no plain file" if path.exists() else "there is no such file")
    return path

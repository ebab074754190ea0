"""Files that a mesh file names, such as textures: plain ones in its folder or below, as any system writes names."""

import urllib.parse
from pathlib import Path

__all__ = ["FilesBeside"]

_MOST_BYTES = 1 << 30  # of a file


class FilesBeside:
    """The files beside the mesh file `path`; `missing` has those that are left out, with the reason."""

    def __init__(self, path: Path) -> None:
        self._root = path.parent.resolve()
        self.missing: dict[str, str] = {}

    def get(self, name: str) -> bytes:
        """The bytes of a file by its name, which may be a URI, with slashes of any system.

        Of a path that leads nowhere, such as one of another machine, the last part is looked for beside the mesh.
        """
        written = name.strip().replace("\\", "/")
        reasons = []
        for text in dict.fromkeys((written, urllib.parse.unquote(written), written.rpartition("/")[2])):
            try:
                path = _in_any_case(self._root, text)
                if path.stat().st_size > _MOST_BYTES:
                    raise ValueError(f"it has {path.stat().st_size} bytes; allowed are at most {_MOST_BYTES}")
            except (OSError, ValueError) as error:
                reasons.append(str(error))
                continue
            self.missing.pop(name, None)
            return path.read_bytes()
        self.missing[name] = reasons[0]
        raise FileNotFoundError(f"{name}: {reasons[0]}")


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

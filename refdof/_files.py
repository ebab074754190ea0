"""Files that a user names: plain ones. A pipe or a terminal would be waited for without end."""

import os
from pathlib import Path
from typing import Any

from refdof._check import InputError, as_path

__all__ = ["as_plain_file"]


def as_plain_file(name: str, path: Any) -> Path:
    """Return the path of a file that is there.

    Raises
    ------
    InputError
        If there is none, or it is a folder, a pipe, a terminal or another device.
    """
    file = as_path(name, path)
    if not os.path.lexists(file) or not file.exists():
        stdin = "; stdin is not read" if str(path) == "-" else ""
        raise InputError(f"{name}: got {str(path)!r}: there is no such file{stdin}; allowed is a file")
    if not file.is_file():
        what = "a folder" if file.is_dir() else "a pipe or a device"
        raise InputError(f"{name}: got {str(path)!r}, which is {what}; allowed is a plain file")
    return file

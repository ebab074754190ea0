"""Runs of wrong and right ports: a small pack, programs of changed texts, and the check of what they make.

1. Write a pack of small cases         `write_small_pack`
2. Make a source of a changed text     `source_of`
3. Run it over the pack, and check     `checked`
"""

import subprocess
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np

from refdof.oracle import write_pack
from refdof.oracle.cases import Case
from refdof.oracle.checking import Report, _check
from refdof.oracle.files import FileFault, open_pack
from refdof.oracle.sources import Source, Task, of_command, of_folder
from tests.oracle.mutations.row import TEXTS

__all__ = ["CASES", "checked", "source_of", "write_small_pack"]

_UP = {"row_order": "up"}

# Sizes with ties and without, both orders of rows, and three sets of constants.
CASES = [
    Case("cards", "singlepass", "cards", (52, 38)),
    Case("cards_up", "singlepass", "cards", (52, 38), _UP, "up"),
    Case("noise", "singlepass", "noise", (61, 47)),
    Case("ramp", "singlepass", "ramp", (52, 38)),
    Case("hdr", "singlepass", "hdr", (52, 38)),
    Case("hdr_smaller", "singlepass", "hdr", (48, 36), {"max_blur_size": 6.0}),
    Case("noise_coarser", "singlepass", "noise", (48, 36), {"rad_scale": 1.0, "behind_factor": 1.0}),
]
TIMEOUT_S = 20.0


def write_small_pack(folder: Path) -> Path:
    """Write a pack of `CASES`."""
    with mock.patch("refdof.oracle.pack.cases_of", return_value=CASES):
        write_pack(folder)
    return folder


def source_of(port: str, text: str, folder: Path, context: Any = None) -> Source:
    """What a port with this text makes of cases; `folder` is new, `context` is OpenGL's."""
    if port == "c":
        return of_command(f"{_built(text, folder)} --case {{case}} --out {{out}}", TIMEOUT_S)
    host = text if port == "host" else TEXTS["host"].read_text(encoding="utf-8")
    shader = text if port == "glsl" else TEXTS["glsl"].read_text(encoding="utf-8")
    names: dict[str, Any] = {}
    exec(compile(host, "host.py", "exec"), names)
    return _of_host(names["run"], shader, context)


def checked(source: Source, pack: Path) -> Report:
    """Check what a source makes of every case of a pack."""
    return _check(open_pack(pack), source, None)


def _built(text: str, folder: Path) -> Path:
    """Compile a C port."""
    program = folder / "port"
    (folder / "port.c").write_text(text, encoding="utf-8")
    command = ["cc", "-std=c99", "-O1", "-o", str(program), str(folder / "port.c"), "-lm"]
    subprocess.run(command, check=True, capture_output=True, timeout=60)
    return program


def _of_host(run: Callable[..., None], shader: str, context: Any) -> Source:
    """Let a host draw a shader, and read what it has written."""

    def results(task: Task) -> Mapping[str, np.ndarray]:
        with tempfile.TemporaryDirectory(prefix="refdof-") as out:
            place = Path(out) / task.name
            place.mkdir()
            try:
                run(context, shader, task.folder, place)
            except Exception as error:  # whatever a wrong host or shader leads to
                raise FileFault(f"the host raised {type(error).__name__}: {error}") from None
            return of_folder(Path(out))(task)

    return results

"""Runs of wrong and right ports: a small pack, programs of changed texts, and the check of what they make.

1. Write a pack of small cases                    `write_small_pack`
2. Make a source of results of a changed text     `Bench.source_of`
3. Check what it makes, and have it explained     `Bench.result_of`, `results_of`
"""

import os
import subprocess
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from functools import cache, partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from refdof.oracle import diagnose
from refdof.oracle.cases import Case
from refdof.oracle.checking import STATUSES, Report, check_source
from refdof.oracle.files import FileFault
from refdof.oracle.shaders import of_shader
from refdof.oracle.sources import Source, Task, of_command, of_folder
from tests.gl.shader import open_context
from tests.oracle.mutations.row import TEXTS, Row
from tests.oracle.mutations.table import Result
from tests.packs import pack_of

__all__ = ["CASES", "Bench", "results_of", "write_small_pack"]

_UP = {"row_order": "up"}

# Sizes with ties and without, both orders of rows, and three sets of constants.
CASES = [
    Case("cards", "singlepass", "cards", (40, 30)),
    Case("cards_up", "singlepass", "cards", (40, 30), _UP, "up"),
    Case("noise", "singlepass", "noise", (45, 35)),
    Case("ramp", "singlepass", "ramp", (40, 30)),
    Case("hdr", "singlepass", "hdr", (40, 30)),
    Case("hdr_smaller", "singlepass", "hdr", (36, 27), {"max_blur_size": 6.0}),
    Case("noise_coarser", "singlepass", "noise", (36, 27), {"rad_scale": 1.0, "behind_factor": 1.0}),
]
TIMEOUT_S = 20.0


def write_small_pack(folder: Path) -> Path:
    """Write a pack of `CASES`."""
    return pack_of(CASES, folder)


class Bench:
    """A folder for programs, and the OpenGL context that draws; `close` removes the folder."""

    def __init__(self, pack: Path) -> None:
        self._context = open_context()
        self._folder = tempfile.TemporaryDirectory(prefix="refdof-")
        self._pack = pack

    def close(self) -> None:
        """Remove the folder."""
        self._folder.cleanup()

    @contextmanager
    def source_of(self, port: str, text: str) -> Iterator[Source]:
        """What a port with this text makes of cases."""
        if port == "c":
            yield of_command(f"{self._built(text)} --case {{case}} --out {{out}}", TIMEOUT_S)
            return
        if port == "wgsl":
            file = Path(tempfile.mkdtemp(dir=self._folder.name)) / "singlepass.wgsl"
            file.write_text(text, encoding="utf-8")
            with of_shader(file, None, TIMEOUT_S) as drawn:
                yield drawn
            return
        host = text if port == "host" else TEXTS["host"].read_text(encoding="utf-8")
        shader = text if port == "glsl" else TEXTS["glsl"].read_text(encoding="utf-8")
        names: dict[str, Any] = {}
        exec(compile(host, "host.py", "exec"), names)
        yield _of_host(names["run"], shader, self._context)

    def report_of(self, port: str, text: str) -> Report:
        """The check of a port with this text."""
        with self.source_of(port, text) as source:
            return check_source(source, self._pack)

    def status_of(self, row: Row) -> str:
        """The worst status of a wrong port."""
        return _worst(self.report_of(row.port, row.text))

    def result_of(self, row: Row) -> Result:
        """The check of a wrong port, and what is named as its cause."""
        began = _cpu_seconds()
        with self.source_of(row.port, row.text) as source:
            status = _worst(check_source(source, self._pack))
            named = diagnose(source, self._pack).causes[0] if status == "fail" else None
        stage, cause = (named.stage, named.key) if named else ("", "")
        return Result(row, status, stage, cause, _cpu_seconds() - began)

    def _built(self, text: str) -> Path:
        """Compile a C port."""
        folder = Path(tempfile.mkdtemp(dir=self._folder.name))
        (folder / "port.c").write_text(text, encoding="utf-8")
        command = ["cc", "-std=c99", "-O2", "-o", folder / "port", folder / "port.c", "-lm"]
        subprocess.run(command, check=True, capture_output=True, timeout=60)
        return folder / "port"


def results_of(rows: Sequence[Row]) -> Iterator[Result]:
    """`Bench.result_of` of rows, in their order, by as many processes as there are processors."""
    with tempfile.TemporaryDirectory(prefix="refdof-") as folder:
        pack = write_small_pack(Path(folder) / "pack")
        with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
            yield from pool.map(partial(_result_of, pack), rows)


@cache
def _bench(pack: Path) -> Bench:
    """This process's own; its folder goes when the process ends."""
    return Bench(pack)


def _result_of(pack: Path, row: Row) -> Result:
    return _bench(pack).result_of(row)


def _cpu_seconds() -> float:
    """Of this process and those that it has waited for."""
    return sum(os.times()[:4])


def _worst(report: Report) -> str:
    return max((outcome.status for outcome in report.outcomes), key=STATUSES.index)


def _of_host(run: Callable[..., None], shader: str, context: Any) -> Source:
    """Let a host draw a shader, and read what it has written."""

    def results(task: Task) -> Mapping[str, np.ndarray]:
        with tempfile.TemporaryDirectory(prefix="refdof-") as out:
            place = Path(out) / task.name
            place.mkdir()
            try:
                with context:  # another library may have made its own the current one
                    run(context, shader, task.folder, place)
            except Exception as error:  # whatever a wrong host or shader leads to
                raise FileFault(f"the host raised {type(error).__name__}: {error}") from None
            return of_folder(Path(out))(task)

    return results

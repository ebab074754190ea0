"""Sources of results: a Python function, a command, or a folder of files made elsewhere."""

import contextlib
import copy
import os
import re
import shlex
import shutil
import signal
import subprocess
import tempfile
import threading
import uuid
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float, InputError
from refdof.oracle.files import FileFault, read_array

__all__ = ["NOT_SUPPORTED_STATUS", "NotSupported", "Source", "Task", "of_command", "of_folder", "of_function"]

NOT_SUPPORTED_STATUS = 77
"""The status with which a command says that it does not do a case; as in Automake's tests."""

_MARK = re.compile(r"\{case\}|\{out\}")
_KEPT = 2000  # bytes of what a command says
_LAST_WORDS_S = 0.5
_SWEEPS = 20
_NOT_SUPPORTED = "not_supported.txt"


class NotSupported(Exception):
    """The implementation says that it does not do this case."""


class Task(NamedTuple):
    """A case as an implementation gets it: folder, inputs, parameters, and the shapes of what may come out.

    given: {stage: array}, which it takes instead of making them itself.
    """

    name: str
    folder: Path
    images: tuple[Float, Float, Float]
    params: dict[str, Any]
    shapes: dict[str, tuple[int, ...]]
    given: Mapping[str, Float] = MappingProxyType({})


Source = Callable[[Task], Mapping[str, Float]]


def of_function(function: Callable[..., Any]) -> Source:
    """Call `function(color, depth, coc, params)`, which returns the picture, or {"image": ..., stage: ...}.

    params["given"] holds the given stages, if there are any.
    """

    def results(task: Task) -> Mapping[str, Float]:
        params = copy.deepcopy(task.params)
        if task.given:
            params["given"] = {name: values.copy() for name, values in task.given.items()}
        try:
            given = function(*(image.copy() for image in task.images), params)
        except NotImplementedError as error:
            raise NotSupported(str(error)) from None
        except (Exception, SystemExit) as error:  # whatever the caller's function raises
            raise FileFault(f"the function raised {type(error).__name__}: {error}") from None
        shown = given if isinstance(given, Mapping) else {"image": given}
        found = {name: _as_result(task, name, values) for name, values in shown.items()}
        if "image" not in found:
            raise FileFault("image: is missing among the results")
        return found

    return results


def _as_result(task: Task, name: Any, values: Any) -> Float:
    try:
        array = np.asarray(values)
    except Exception as error:  # whatever the caller's object raises
        raise FileFault(f"{name}: is no array ({type(error).__name__})") from None
    shape = task.shapes.get(name) if isinstance(name, str) else None
    if shape is None:
        raise FileFault(f"{str(name)[:80]}: is no result of this case; they are {', '.join(task.shapes)}")
    if array.dtype.kind != "f" or array.shape != shape:
        raise FileFault(f"{name}: is {array.dtype} of shape {array.shape}; allowed are floats of shape {shape}")
    return array


def of_folder(folder: Path) -> Source:
    """Read FOLDER/CASE/image.f32 or image.npy, and stages by their names.

    A case that the implementation does not do has not_supported.txt alone; its first line is the reason.
    """
    if not folder.is_dir():
        raise InputError(f"results: got {str(folder)!r}; allowed is a folder with one folder a case")

    def results(task: Task) -> Mapping[str, Float]:
        place = folder / task.name
        if not place.is_symlink() and place.is_dir() and [path.name for path in place.iterdir()] == [_NOT_SUPPORTED]:
            raise NotSupported(_first_line(place / _NOT_SUPPORTED))
        return _read_results(place, task)

    return results


def of_command(command: str, timeout: float) -> Source:
    """Run a command, with {case} and {out} in it, without a shell.

    What it leaves behind is ended with it: its process group, and on Linux also what has left that and has not cleared
    its environment. Elsewhere a child with a session of its own lives on.

    Raises
    ------
    InputError
        If the command is not one.
    """
    try:
        words = shlex.split(command)
    except ValueError as error:
        raise InputError(f"impl: got {command!r} ({error}); allowed is a command line") from None
    if not words or not all(any(mark in word for word in words) for mark in ("{case}", "{out}")):
        raise InputError(f"impl: got {command!r}; allowed is a command with {{case}} and {{out}} in it")

    def results(task: Task) -> Mapping[str, Float]:
        with tempfile.TemporaryDirectory(prefix="refdof-", ignore_cleanup_errors=True) as temporary:
            case, out = task.folder.resolve(), Path(temporary) / "out"
            if task.given:
                case = _with_given(task, Path(temporary) / "case")
            out.mkdir()
            marks = {"{case}": str(case), "{out}": str(out)}
            _run([_MARK.sub(lambda mark: marks[mark[0]], word) for word in words], timeout)
            return _read_results(out, task)

    return results


def _with_given(task: Task, folder: Path) -> Path:
    """A copy of the case without its results, with the given stages among its inputs, named in params.txt."""
    shutil.copytree(task.folder, folder, ignore=shutil.ignore_patterns("expected"))
    for name, values in task.given.items():
        np.save(folder / "inputs" / f"{name}.npy", values.astype("<f4"))
        (folder / "inputs" / f"{name}.f32").write_bytes(values.astype("<f4").tobytes())
    with (folder / "params.txt").open("a", encoding="utf-8", newline="\n") as file:
        file.writelines(f"given {name}\n" for name in task.given)
    return folder


def _run(words: list[str], timeout: float) -> None:
    """Run to the end, or end it; and end what it has started and left behind."""
    mark = f"REFDOF_RUN_{uuid.uuid4().hex}"
    try:
        process = subprocess.Popen(
            words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True,
            env={**os.environ, mark: "1"},
        )  # fmt: skip
    except (OSError, ValueError) as error:
        raise FileFault(f"the command cannot be started: {error}") from None
    said = bytearray()
    reader = threading.Thread(target=_keep_end, args=(process.stderr, said), daemon=True)
    reader.start()
    try:
        status = process.wait(timeout)
    except subprocess.TimeoutExpired:
        raise FileFault(f"the command ran for more than {timeout:g} s and was ended") from None
    finally:
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        _end_marked(mark.encode())
        reader.join(_LAST_WORDS_S)  # what lives on may keep the pipe open
    lines = bytes(said).decode("utf-8", "replace").strip().splitlines()
    if status == NOT_SUPPORTED_STATUS:
        raise NotSupported(lines[-1] if lines else f"the command ended with status {status}: it does not do this case")
    if status != 0:
        raise FileFault(f"the command ended with status {status}: {lines[-1] if lines else 'nothing on stderr'}")


def _end_marked(mark: bytes) -> None:
    """End processes that have left the group: as all that a command starts, they have its mark in their environment.

    They are looked for again, as one may start another meanwhile. Only Linux shows environments as files.
    """
    for _ in range(_SWEEPS):
        found = []
        for place in Path("/proc").glob("[0-9]*/environ"):
            with contextlib.suppress(OSError):  # it has ended, or is another user's
                if mark in place.read_bytes():
                    found.append(int(place.parent.name))
                    os.kill(found[-1], signal.SIGKILL)
        if not found:
            return


def _keep_end(pipe: Any, said: bytearray) -> None:
    """Read all that a command says, and keep the end of it."""
    with pipe:
        while chunk := pipe.read1(65536):
            said[:] = (said + chunk)[-_KEPT:]


def _first_line(path: Path) -> str:
    """At most 400 bytes of a text, which may be anyone's."""
    if path.is_symlink() or not path.is_file():
        raise FileFault(f"{path.name}: is no regular file")
    with path.open("rb") as file:
        lines = file.read(400).decode("utf-8", "replace").splitlines()
    return lines[0].strip() if lines else ""


def _read_results(folder: Path, task: Task) -> Mapping[str, Float]:
    if folder.is_symlink() or not folder.is_dir():
        raise FileFault(f"no folder {task.name} among the results")
    found = {}
    for path in sorted(path for path in folder.iterdir() if not path.name.startswith(".")):  # as .DS_Store
        if path.suffix not in (".npy", ".f32") or path.stem not in task.shapes:
            names = ", ".join(task.shapes)
            raise FileFault(f"{path.name[:80]}: is no result of this case; they are {names}, .f32 or .npy")
        if path.stem in found:
            raise FileFault(f"{path.name}: is there as .f32 and as .npy; allowed is one of the two")
        found[path.stem] = read_array(path, task.shapes[path.stem])
    if "image" not in found:
        raise FileFault("image.f32: is missing, and image.npy")
    return found

"""Sources of results: a Python function, a command, or a folder of files made elsewhere."""

import os
import shlex
import signal
import subprocess
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float, InputError
from refdof.oracle.files import FileFault, read_array

__all__ = ["NOT_SUPPORTED_STATUS", "NotSupported", "Source", "Task", "of_command", "of_folder", "of_function"]

NOT_SUPPORTED_STATUS = 77
"""The status with which a command says that it does not do a case; as in Automake's tests."""

_NOT_SUPPORTED = "not_supported.txt"


class NotSupported(Exception):
    """The implementation says that it does not do this case."""


class Task(NamedTuple):
    """A case as an implementation gets it: folder, inputs, parameters, and the shapes of what may come out."""

    name: str
    folder: Path
    images: tuple[Float, Float, Float]
    params: dict[str, Any]
    shapes: dict[str, tuple[int, ...]]


Source = Callable[[Task], Mapping[str, Float]]


def of_function(function: Callable[..., Any]) -> Source:
    """Call `function(color, depth, coc, params)`, which returns the picture, or {"image": ..., stage: ...}."""

    def results(task: Task) -> Mapping[str, Float]:
        try:
            given = function(*(image.copy() for image in task.images), dict(task.params))
        except NotImplementedError as error:
            raise NotSupported(str(error)) from None
        except Exception as error:  # whatever the caller's function raises
            raise FileFault(f"the function raised {type(error).__name__}: {error}") from None
        found = {}
        for name, values in (given if isinstance(given, Mapping) else {"image": given}).items():
            array = np.asarray(values)
            if name not in task.shapes or array.dtype.kind != "f" or array.shape != task.shapes[name]:
                allowed = f"floats of shape {task.shapes.get(name, tuple(task.shapes))}"
                raise FileFault(f"{name}: is {array.dtype} of shape {array.shape}; allowed are {allowed}")
            found[name] = array
        return found

    return results


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
        with tempfile.TemporaryDirectory(prefix="refdof-") as out:
            case = str(task.folder.resolve())
            _run([word.replace("{case}", case).replace("{out}", out) for word in words], timeout)
            return _read_results(Path(out), task)

    return results


def _run(words: list[str], timeout: float) -> None:
    """Run to the end, or end it and all that it started."""
    with tempfile.TemporaryFile() as errors:
        try:
            process = subprocess.Popen(
                words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=errors, start_new_session=True
            )
        except (OSError, ValueError) as error:
            raise FileFault(f"the command cannot be started: {error}") from None
        try:
            status = process.wait(timeout)
        except subprocess.TimeoutExpired:
            raise FileFault(f"the command ran for more than {timeout:g} s and was ended") from None
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
        errors.seek(max(0, errors.seek(0, os.SEEK_END) - 400))
        said = errors.read().decode("utf-8", "replace").strip().splitlines()
    last = said[-1] if said else "nothing on stderr"
    if status == NOT_SUPPORTED_STATUS:
        raise NotSupported(last)
    if status != 0:
        raise FileFault(f"the command ended with status {status}: {last}")


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
    for path in sorted(folder.iterdir()):
        if path.suffix not in (".npy", ".f32") or path.stem not in task.shapes:
            raise FileFault(f"{path.name}: is no result of this case; they are {', '.join(task.shapes)}, .f32 or .npy")
        if path.stem in found:
            raise FileFault(f"{path.name}: is there as .f32 and as .npy; allowed is one of the two")
        found[path.stem] = read_array(path, task.shapes[path.stem])
    if "image" not in found:
        raise FileFault("image.f32: is missing, and image.npy")
    return found

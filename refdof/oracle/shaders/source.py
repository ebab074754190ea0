"""Shader: the results of a fragment shader, drawn in a process of its own.

1. Read and compile the shader, once                       `ShaderSource`
2. Bind what it reads, by a file or by the usual names      `refdof.oracle.shaders.bindings`
3. Draw every case that it has the parameters for           `ShaderSource.__call__`
"""

import importlib.util
import json
import os
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from refdof._check import Float, InputError, as_number, as_path
from refdof._files import as_plain_file
from refdof.methods import METHODS
from refdof.oracle.files import FileFault
from refdof.oracle.shaders.bindings import Meanings, meanings_of, read_bindings
from refdof.oracle.shaders.case import case_values
from refdof.oracle.shaders.drawing.slots import Slot
from refdof.oracle.shaders.process import Ended, Process
from refdof.oracle.sources import NotSupported, Task
from refdof.report.rows import plain

__all__ = ["SUFFIXES", "ShaderSource", "of_shader"]

SUFFIXES = {".frag": "glsl", ".glsl": "glsl", ".fs": "glsl", ".wgsl": "wgsl"}
_PACKAGES = {"glsl": "moderngl", "wgsl": "wgpu"}
_LARGEST_FILE = 2**20
_START_S = 60.0  # to start a process and compile; a compiler is not a shader
_LONGEST_S = 1e6
_BY_HOST = {"depth_filter", "color_filter", "row_order", "precision"}  # what the host of a shader decides


def of_shader(
    file: str | os.PathLike[str], bindings: str | os.PathLike[str] | None = None, timeout: float = 60.0
) -> "ShaderSource":
    """Draw with a shader: GLSL (.frag, .glsl, .fs) or WGSL (.wgsl).

    Parameters
    ----------
    file : path
        Its method is the one that its name begins with, else "singlepass".
    bindings : path, optional
        TOML, lines such as `uDepth = "device"`; names that it does not have are bound by their usual meaning.
    timeout : float
        Of one case [s].

    Raises
    ------
    InputError
        If the shader does not compile, or what it needs is not installed.
    """
    return ShaderSource(file, bindings, timeout)


class ShaderSource:
    """A source of results. Use it in a `with`, or `close` it: it holds a process."""

    def __init__(self, file: str | os.PathLike[str], bindings: str | os.PathLike[str] | None, timeout: float) -> None:
        path = as_path("shader", file)
        self._timeout = as_number("timeout", timeout, above=0.0, maximum=_LONGEST_S)
        self._name, self._text, self._language = path.name, _text(path), _language(path)
        self._method = next((name for name in METHODS if path.stem.lower().startswith(name)), "singlepass")
        self._given = {} if bindings is None else read_bindings(bindings)
        self._process: Process | None = None
        self._meanings: Meanings | None = None
        self._slots = self._start()

    def __enter__(self) -> "ShaderSource":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.stop()
            self._process = None

    def __call__(self, task: Task) -> Mapping[str, Float]:
        """Draw a case.

        Raises
        ------
        NotSupported
            If it is of another method, or has parameters that the shader has no uniform for.
        FileFault
            If the shader never ends, or the driver fails.
        InputError
            If a name in the shader has no meaning.
        """
        method = _method_of(task)
        if method != self._method:
            raise NotSupported(f"{self._name} is taken for {self._method}, by its name; this is {method}")
        case = case_values(task, mirrored=False)
        keys = {*case.numbers, *(key for key, value in task.params.items() if not isinstance(value, str))}
        if self._meanings is None:
            self._meanings = meanings_of(self._slots, self._given, keys)
        owned = self._meanings.parameters()
        _check_parameters(task, method, owned)
        mirrored = case.numbers.get("row_step", 1.0) < 0.0 and "row_step" not in owned
        if mirrored:
            case = case_values(task, mirrored)
        given = self._meanings.values(case)
        height, width = case.pictures["depth"].shape
        message = {"do": "draw", "size": [width, height], "uniforms": given.uniforms, "filters": given.filters}
        image = self._draw(message, given.textures)
        return {"image": image[::-1] if mirrored else image}

    def _draw(self, message: dict[str, Any], textures: Mapping[str, Float]) -> Float:
        try:
            if self._process is None:
                self._start()
            assert self._process is not None
            message = {**message, "seconds": self._timeout}
            answer, images = self._process.ask(message, self._timeout, textures)
        except (Ended, InputError) as reason:  # it compiled before, but a machine may be too busy to do so again
            self.close()
            raise FileFault(str(reason)) from None
        if "error" in answer:
            self.close()
            raise FileFault(f"{self._name}: {answer['error']}")
        return images["image"]

    def _start(self) -> list[Slot]:
        """Start a process and compile there."""
        package = _PACKAGES[self._language]
        if importlib.util.find_spec(package) is None:
            raise InputError(f"shader: needs {package}, which is not installed: pip install 'refdof[shaders]'")
        self._process = Process()
        message = {"do": "compile", "language": self._language, "text": self._text}
        try:
            answer, _ = self._process.ask(message, _START_S)
        except Ended as reason:
            self.close()
            raise InputError(f"shader: {self._name}: is not compiled: {reason}") from None
        if "error" in answer:
            self.close()
            raise InputError(f"shader: {self._name}: {answer['error']}")
        return [Slot._make(slot) for slot in answer["slots"]]


def _language(path: Path) -> str:
    if path.suffix.lower() not in SUFFIXES:
        raise InputError(f"shader: got {str(path)!r}; allowed are files that end in {', '.join(SUFFIXES)}")
    return SUFFIXES[path.suffix.lower()]


def _text(path: Path) -> str:
    plain = as_plain_file("shader", path)
    try:
        with plain.open("rb") as stream:
            data = stream.read(_LARGEST_FILE + 1)
        text = data.decode("utf-8-sig")
    except (OSError, ValueError) as error:
        raise InputError(f"shader: got {str(path)!r}, which cannot be read ({error})") from None
    if len(data) > _LARGEST_FILE or not text.strip() or "\0" in text:
        raise InputError(f"shader: got {str(path)!r}; allowed is a text of at most {_LARGEST_FILE} bytes")
    return text


def _method_of(task: Task) -> str:
    try:
        return str(json.loads((task.folder / "case.json").read_text(encoding="utf-8"))["method"])
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise FileFault(f"case.json: lacks or garbles {error}") from None


def _check_parameters(task: Task, method: str, owned: set[str]) -> None:
    """Raise if a parameter differs from the method's own, and the shader has no uniform for it."""
    defaults = plain(asdict(METHODS[method].METHOD.params()))
    for key, value in task.params.items():
        own = value is None or key in _BY_HOST or key in owned
        if not own and value != defaults.get(key):
            raise NotSupported(f"the case has {key} = {value}; the shader has no uniform for it")

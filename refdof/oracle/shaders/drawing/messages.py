"""Messages between the check and the process that draws: a line of JSON, then its arrays as raw float32."""

import json
from collections.abc import Mapping
from typing import IO, Any

import numpy as np

__all__ = ["receive", "send"]


def send(stream: IO[bytes], message: Mapping[str, Any], arrays: Mapping[str, np.ndarray] | None = None) -> None:
    """Write a message and arrays of any shape, which arrive as float32."""
    single = {name: np.ascontiguousarray(array, dtype="<f4") for name, array in (arrays or {}).items()}
    shapes = {name: array.shape for name, array in single.items()}
    stream.write(json.dumps({"message": dict(message), "arrays": shapes}).encode() + b"\n")
    for array in single.values():
        stream.write(array.tobytes())
    stream.flush()


def receive(stream: IO[bytes]) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Read a message and its arrays.

    Raises
    ------
    EOFError
        If the other side ended before or amid it.
    """
    line = stream.readline()
    if not line.endswith(b"\n"):
        raise EOFError
    head = json.loads(line)
    arrays = {}
    for name, shape in head["arrays"].items():
        array = np.empty(shape, dtype="<f4")
        if stream.readinto(array.reshape(-1).view(np.uint8)) != array.nbytes:  # type: ignore[attr-defined]
            raise EOFError
        arrays[name] = array
    return head["message"], arrays

"""Store: results that always come out the same, kept in the cache folder from run to run.

A file is named by a digest of all that its result depends on: the sources that make it, and its inputs to the bit. So
an edit, another number or another version of a library names another file, and no file can be stale. What was used
longest ago goes when a kind of results has more than half a gigabyte. Without a cache folder nothing is kept. A file
that cannot be read is made again.
"""

import hashlib
import os
import pickle
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from refdof._check import InputError
from refdof._jit import results_folder
from refdof.image.atomic import atomic_path

__all__ = ["fingerprint", "stored"]

_MOST_BYTES = 1 << 29  # of one kind
_T = TypeVar("_T")


def stored(kind: str, parts: Any, make: Callable[[], _T], most_bytes: int = _MOST_BYTES) -> _T:
    """The result of `make`, from the store if it was made before.

    Parameters
    ----------
    kind : str
        What it is, a word: the name of its folder.
    parts : anything that `fingerprint` takes
        All that it depends on.
    make : callable
        Makes a result that pickle takes; files are as trusted as machine code is, which lies beside them.
    """
    folder = results_folder()
    if folder is None:
        return make()
    try:
        file = folder / kind / f"{fingerprint(parts)}.pickle"
    except TypeError:  # an argument of a wrong kind, which `make` refuses
        return make()
    with suppress(Exception):  # whatever a file that was cut or overwritten makes of it
        result: _T = pickle.loads(file.read_bytes())
        for used in (file, folder):
            os.utime(used)
        return result
    result = make()
    with suppress(InputError, OSError):  # a full disk: the result is there all the same
        with atomic_path(file) as temporary:
            temporary.write_bytes(pickle.dumps(result, protocol=5))
        _forget_oldest(file.parent, most_bytes)
    return result


def fingerprint(value: Any) -> str:
    """A digest of a value: of arrays by type, shape and bits, of dataclasses and containers part by part.

    Raises
    ------
    TypeError
        For a value of another kind, which might differ without showing it.
    """
    digest = hashlib.sha256()
    _feed(digest.update, value)
    return digest.hexdigest()[:32]


def _feed(feed: Callable[[Any], None], value: Any) -> None:
    if isinstance(value, np.ndarray) and value.dtype != object:
        feed(f"array {value.dtype.str} {value.shape} ".encode())
        feed(np.ascontiguousarray(value).data.cast("B") if value.size else b"")
    elif is_dataclass(value) and not isinstance(value, type):
        feed(f"{type(value).__qualname__}(".encode())
        for field in fields(value):
            feed(f"{field.name}=".encode())
            _feed(feed, getattr(value, field.name))
        feed(b")")
    elif isinstance(value, Mapping):
        _feed(feed, tuple(value.items()))
    elif isinstance(value, (tuple, list)):
        feed(f"{len(value)}[".encode())
        for part in value:
            _feed(feed, part)
        feed(b"]")
    elif value is None or isinstance(value, (bool, int, float, str, bytes, np.generic)):
        feed(f"{type(value).__name__} {value!r},".encode())
    else:
        raise TypeError(f"{type(value).__name__} has no fingerprint")


def _forget_oldest(folder: Path, most_bytes: int) -> None:
    files = sorted(folder.glob("*.pickle"), key=lambda file: file.stat().st_mtime, reverse=True)
    total = 0
    for file in files:
        total += file.stat().st_size
        if total > most_bytes:
            file.unlink(missing_ok=True)

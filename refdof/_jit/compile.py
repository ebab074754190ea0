"""Compile: the decorators, and a cache that cannot go stale.

Numba's own cache does not see an edit in a helper of another file. So its folder is named by a digest of every
source file of this package, Numba's version, the processor and the JIT flags: any edit starts an empty folder,
and a second run of the same code compiles nothing. Folders unused for a month are removed.
"""

import hashlib
import os
import platform
import shutil
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
import numba
import numpy as np
from numba import types

__all__ = ["JIT_DISABLED", "callback", "inline", "kernel", "prange", "tile_kernel"]

JIT_DISABLED = bool(numba.config.DISABLE_JIT)
_KEEP_DAYS = 30


def _package_folder() -> Path:
    """The folder of the whole package, wherever in it this file lies."""
    return Path(__file__).parents[__name__.count(".") - 1]


def _source_digest(package: Path) -> str:
    digest = hashlib.sha256()
    for path in sorted(package.rglob("*.py")):
        digest.update(path.relative_to(package).as_posix().encode())
        digest.update(path.read_bytes())
    flags = (
        numba.__version__,
        platform.machine(),
        llvm.get_host_cpu_name(),
        str(numba.config.BOUNDSCHECK),
        sys.version,
    )
    digest.update("|".join(flags).encode())
    return digest.hexdigest()[:16]


def _cache_root() -> Path:
    if os.environ.get("REFDOF_CACHE_DIR"):
        return Path(os.environ["REFDOF_CACHE_DIR"])
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local"))
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / "refdof" / "numba"


def _open_cache() -> None:
    """Point Numba at this build's own folder and remove folders that nobody used for a month."""
    root = _cache_root()
    folder = root / _source_digest(_package_folder())
    try:
        folder.mkdir(parents=True, exist_ok=True)
        os.utime(folder)
        oldest = time.time() - _KEEP_DAYS * 86400
        for other in root.iterdir():
            if other.is_dir() and other.stat().st_mtime < oldest:
                shutil.rmtree(other, ignore_errors=True)
    except OSError:  # a read-only home: Numba then falls back to its own choice
        return
    numba.config.CACHE_DIR = str(folder)


_open_cache()

prange = numba.prange


def kernel(function: Callable[..., Any]) -> Any:
    """Compile a loop over pixels: `prange` iterations own what they write."""
    return numba.njit(parallel=True, cache=True, error_model="numpy")(function)


def tile_kernel(function: Callable[..., Any]) -> Any:
    """Compile one tile's work for `run_tasks`: serial inside, without the interpreter's lock."""
    if JIT_DISABLED:  # compiled integers wrap around silently, and so shall interpreted ones
        return np.errstate(over="ignore")(function)
    return numba.njit(nogil=True, cache=True, error_model="numpy")(function)


def inline(function: Callable[..., Any]) -> Any:
    """Compile a helper that a kernel calls in its inner loop."""
    return numba.njit(cache=True, error_model="numpy", forceinline=True)(function)


def callback(function: Callable[..., Any]) -> Any:
    """Compile a function that foreign code calls with an array of pointers; its `.address` is an integer."""
    return numba.cfunc(types.void(types.CPointer(types.intp)), cache=True, error_model="numpy")(function)

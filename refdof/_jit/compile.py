"""Compile: the decorators, and a cache that cannot go stale.

Numba's own cache does not see an edit in a helper of another file. So its folder is named by a digest of every
source file of this package, Numba's version, the processor and the JIT flags: any edit starts an empty folder,
and a second run of the same code compiles nothing, be it another copy of the package. Folders unused for a month are
removed.

An array that is written to a part of another one (`row[:] = other`) brings in the text of an error about shapes, which
takes three seconds to compile in each process: kernels copy element by element. A number written to a part does not.

Numba numbers the files of a function's signatures, and keeps a list of them. Two processes that compile at once may
give the same number to two signatures, and one would run the other's machine code. So files are named by what they were
compiled from, and there is no list.
"""

import atexit
import ctypes
import hashlib
import os
import platform
import shutil
import sys
import tempfile
import time
from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from threading import Lock
from typing import Any

import llvmlite.binding as llvm
import numba
import numpy as np
from numba import types
from numba.core.caching import FunctionCache, IndexDataCacheFile

from refdof._jit.lazy import HelperDispatcher, LazyCompiler, lazily

__all__ = [
    "JIT_DISABLED",
    "cache_folder",
    "callback",
    "compilations",
    "inline",
    "kernel",
    "prange",
    "processor",
    "results_folder",
    "source_digest",
    "tile_kernel",
]

JIT_DISABLED = bool(numba.config.DISABLE_JIT)
_KEEP_DAYS = 30
_HOW: dict[str, Any] = {
    "error_model": "numpy",
    "no_cfunc_wrapper": True,
    "pipeline_class": LazyCompiler,
}


def _package_folder() -> Path:
    """The folder of the whole package, wherever in it this file lies."""
    return Path(__file__).parents[__name__.count(".") - 1]


def _digest_of(package: Path, rooms: tuple[str, ...], *flags: str) -> str:
    digest = hashlib.sha256()
    for path in sorted(path for room in rooms for path in (package / room).rglob("*.py")):
        digest.update(path.relative_to(package).as_posix().encode())
        digest.update(path.read_bytes())
    words = (numba.__version__, platform.machine(), processor(), *flags, sys.version)
    digest.update("|".join(words).encode())
    return digest.hexdigest()[:16]


def source_digest(*rooms: str) -> str:
    """A name for what the code in some folders of the package makes on this kind of processor; of all, without any."""
    return _digest_of(_package_folder(), rooms or ("",), str(np.__version__))


def processor() -> str:
    """The kind of processor that machine code is made for."""
    return str(llvm.get_host_cpu_name())


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
    folder = root / _digest_of(_package_folder(), ("",), str(numba.config.BOUNDSCHECK), str(numba.config.OPT))
    try:
        folder.mkdir(parents=True, exist_ok=True)
        os.utime(folder)
        oldest = time.time() - _KEEP_DAYS * 86400
        for other in root.iterdir():
            if other.is_dir() and other.stat().st_mtime < oldest:
                shutil.rmtree(other, ignore_errors=True)
    except OSError:
        # A read-only home. Numba's own choice is a folder beside the sources, and it fails if there is none, either.
        passing = tempfile.mkdtemp(prefix="refdof-")
        atexit.register(shutil.rmtree, passing, ignore_errors=True)
        os.environ["REFDOF_CACHE_DIR"] = passing  # of the processes that this one starts, too
        folder = _cache_root() / folder.name
        folder.mkdir()
    numba.config.CACHE_DIR = str(folder)


_open_cache()


def cache_folder() -> Path | None:
    """Where this build's machine code is kept; None: it is not."""
    folder = numba.config.CACHE_DIR
    return Path(folder) if folder and not JIT_DISABLED else None


def results_folder() -> Path | None:
    """Where results are kept for later runs, of any version; None: there is no cache."""
    return Path(numba.config.CACHE_DIR).parent / "results" if numba.config.CACHE_DIR else None


prange = numba.prange


class _KeyedFiles(IndexDataCacheFile):
    """A function's cache files, each named by a digest of the function and of one signature."""

    def __init__(self, function: Callable[..., Any], cache: Any) -> None:
        code = function.__code__
        stamp = cache._impl.locator.get_source_stamp()
        super().__init__(cache.cache_path, cache._impl.filename_base, stamp)
        self._origin: tuple[Any, ...] = (code.co_filename, stamp)
        if numba.config.CACHE_DIR and Path(code.co_filename).is_relative_to(_package_folder()):
            self._cache_path = numba.config.CACHE_DIR  # its name tells the sources apart
            self._origin = ()
        self._origin += (function.__module__, function.__qualname__, code.co_firstlineno)

    def save(self, key: Any, data: Any) -> None:
        Path(self._cache_path).mkdir(parents=True, exist_ok=True)
        self._save_data(self._file_of(key), data)

    def load(self, key: Any) -> Any:
        try:
            return self._load_data(self._file_of(key))
        except FileNotFoundError:
            return None

    def flush(self) -> None:
        """Nothing: no list of files is kept."""

    def _file_of(self, key: Any) -> str:
        signature, *rest = key
        words = repr((numba.__version__, self._origin, str(signature), rest))
        return self._data_name_pattern.replace("{number:d}", hashlib.sha256(words.encode()).hexdigest()[:32])


class _Counter:
    """How often this process has compiled a function or read one from a cache file."""

    count = 0


def compilations() -> int:
    """How many functions this process has compiled, or read from cache files, so far."""
    return _Counter.count


class _LazyCache:
    """A function's cache, made when it is asked for, whose libraries are lazy.

    Numba's own is made with the function, and tries there and then whether its folder can be written.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        self._function = function

    @cached_property
    def _cache(self) -> Any:
        cache = FunctionCache(self._function)
        cache._cache_file = _KeyedFiles(self._function, cache)
        return cache

    def load_overload(self, signature: Any, context: Any) -> Any:
        _Counter.count += 1
        with lazily():
            return self._cache.load_overload(signature, context)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._cache, name)


def _keyed(compiled: Any) -> Any:
    """A dispatcher whose cache files are keyed; with compilation off, the function itself."""
    if not JIT_DISABLED:
        compiled._cache = _LazyCache(compiled.py_func)
    return compiled


def kernel(function: Callable[..., Any]) -> Any:
    """Compile a loop over pixels: `prange` iterations own what they write."""
    # An error in an iteration of a parallel loop is lost, that of an index out of bounds too.
    return _keyed(numba.njit(parallel=not numba.config.BOUNDSCHECK, **_HOW)(function))


def tile_kernel(function: Callable[..., Any]) -> Any:
    """Compile one tile's work for `run_tasks`: serial inside, without the interpreter's lock."""
    if JIT_DISABLED:  # compiled integers wrap around silently, and so shall interpreted ones
        return np.errstate(over="ignore")(function)
    return _keyed(numba.njit(nogil=True, **_HOW)(function))


def inline(function: Callable[..., Any]) -> Any:
    """Compile a helper that a kernel calls in its inner loop."""
    helper = _keyed(numba.njit(forceinline=True, no_cpython_wrapper=True, **_HOW)(function))
    if not JIT_DISABLED:
        helper.__class__ = HelperDispatcher
    return helper


class _Callback:
    """A function for foreign code, compiled when its address is asked for."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self._function, self._lock = function, Lock()
        self._compiled: Any = None

    @property
    def address(self) -> int:
        """Where the machine code is, as long as this object lives."""
        with self._lock:
            if self._compiled is None and JIT_DISABLED:
                function = np.errstate(over="ignore")(self._function)  # as in `tile_kernel`
                self._compiled = ctypes.CFUNCTYPE(None, ctypes.POINTER(ctypes.c_ssize_t))(function)
            if JIT_DISABLED:
                return ctypes.cast(self._compiled, ctypes.c_void_p).value or 0
            if self._compiled is None:
                _Counter.count += 1
                signature = types.void(types.CPointer(types.intp))
                self._compiled = numba.cfunc(signature, cache=True, error_model="numpy")(self._function)
            return int(self._compiled.address)


def callback(function: Callable[..., Any]) -> _Callback:
    """Compile a function that foreign code calls with an array of pointers; its `.address` is an integer."""
    return _Callback(function)

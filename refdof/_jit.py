"""All Numba policy: decorators, a cache that cannot go stale, and the number of threads.

Numba's own cache does not see an edit in a helper of another file. So its folder is named by a digest of every
source file of this package, Numba's version, the processor and the JIT flags: any edit starts an empty folder,
and a second run of the same code compiles nothing, be it another copy of the package. Folders unused for a month are
removed.

Numba numbers the files of a function's signatures, and keeps a list of them. Two processes that compile at once may
give the same number to two signatures, and one would run the other's machine code. So files are named by what they were
compiled from, and there is no list.
"""

import ctypes
import hashlib
import os
import platform
import shutil
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.caching import IndexDataCacheFile
from numba.extending import intrinsic

__all__ = [
    "JIT_DISABLED",
    "borrow",
    "call_address",
    "callback",
    "inline",
    "kernel",
    "load_int32",
    "prange",
    "run_tasks",
    "store_int32",
    "thread_count",
    "tile_kernel",
    "use_threads",
]

JIT_DISABLED = bool(numba.config.DISABLE_JIT)
_KEEP_DAYS = 30


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
    folder = root / _source_digest(Path(__file__).parent)
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


class _KeyedFiles(IndexDataCacheFile):
    """A function's cache files, each named by a digest of the function and of one signature."""

    def __init__(self, function: Callable[..., Any], cache: Any) -> None:
        code = function.__code__
        stamp = cache._impl.locator.get_source_stamp()
        super().__init__(cache.cache_path, cache._impl.filename_base, stamp)
        self._origin: tuple[Any, ...] = (code.co_filename, stamp)
        if numba.config.CACHE_DIR and Path(code.co_filename).is_relative_to(Path(__file__).parent):
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


def _keyed(compiled: Any) -> Any:
    """A dispatcher whose cache files are keyed; with compilation off, the function itself."""
    if not JIT_DISABLED:
        compiled._cache._cache_file = _KeyedFiles(compiled.py_func, compiled._cache)
    return compiled


def kernel(function: Callable[..., Any]) -> Any:
    """Compile a loop over pixels: `prange` iterations own what they write."""
    return _keyed(numba.njit(parallel=True, cache=True, error_model="numpy")(function))


def tile_kernel(function: Callable[..., Any]) -> Any:
    """Compile one tile's work for `run_tasks`: serial inside, without the interpreter's lock."""
    if JIT_DISABLED:  # compiled integers wrap around silently, and so shall interpreted ones
        return np.errstate(over="ignore")(function)
    return _keyed(numba.njit(nogil=True, cache=True, error_model="numpy")(function))


def inline(function: Callable[..., Any]) -> Any:
    """Compile a helper that a kernel calls in its inner loop."""
    return _keyed(numba.njit(cache=True, error_model="numpy", forceinline=True)(function))


def callback(function: Callable[..., Any]) -> Any:
    """Compile a function that foreign code calls with an array of pointers; its `.address` is an integer."""
    return numba.cfunc(types.void(types.CPointer(types.intp)), cache=True, error_model="numpy")(function)


def thread_count() -> int:
    """Threads that kernels and tasks may use."""
    return int(numba.get_num_threads())


def use_threads(count: int) -> None:
    """Let kernels and tasks use `count` threads, at most one per processor."""
    numba.set_num_threads(min(count, int(numba.config.NUMBA_NUM_THREADS)))


def run_tasks(
    task: Callable[[Any], None], jobs: Sequence[Any], progress: Callable[[int, int], None] | None = None
) -> None:
    """Run `task` on every job, on as many threads as Numba may use; call progress(done, all) between.

    Jobs own what they write, so order and thread count change nothing. Ctrl-C ends after the running jobs.
    """
    total, done = len(jobs), 0
    pool = ThreadPoolExecutor(thread_count())
    try:
        waiting = {pool.submit(task, job) for job in jobs}
        while waiting:
            finished, waiting = wait(waiting, timeout=0.5, return_when=FIRST_COMPLETED)
            for future in finished:
                future.result()
            done += len(finished)
            if progress is not None:
                progress(done, total)
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


@intrinsic
def _call_compiled(typingctx: Any, address: Any, first: Any, second: Any, third: Any, fourth: Any) -> Any:
    """Call the C function at `address` with four pointers given as integers."""
    signature = types.void(types.intp, types.intp, types.intp, types.intp, types.intp)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        pointer = ir.PointerType(ir.IntType(8))
        function_type = ir.FunctionType(ir.VoidType(), [pointer] * 4)
        function = builder.inttoptr(arguments[0], function_type.as_pointer())
        builder.call(function, [builder.inttoptr(a, pointer) for a in arguments[1:]])
        return context.get_dummy_value()

    return signature, generate


@intrinsic
def load_int32(typingctx: Any, address: Any) -> Any:
    """The int32 at `address`, an integer. For callbacks, which see raw memory only."""
    signature = types.int32(types.intp)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        return builder.load(builder.inttoptr(arguments[0], ir.IntType(32).as_pointer()))

    return signature, generate


@intrinsic
def store_int32(typingctx: Any, address: Any, value: Any) -> Any:
    """Write the int32 `value` to `address`, an integer. For callbacks, which see raw memory only."""
    signature = types.void(types.intp, types.int32)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        builder.store(arguments[1], builder.inttoptr(arguments[0], ir.IntType(32).as_pointer()))
        return context.get_dummy_value()

    return signature, generate


@intrinsic
def _borrow(typingctx: Any, array: Any) -> Any:
    """The same array without its reference count."""
    signature = array(array)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        view = context.make_array(array)(context, builder, arguments[0])
        view.meminfo = cgutils.get_null_value(view.meminfo.type)
        view.parent = cgutils.get_null_value(view.parent.type)
        return view._getvalue()

    return signature, generate


def _call_interpreted(address: int, first: int, second: int, third: int, fourth: int) -> None:
    ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * 4)(address)(first, second, third, fourth)


def _identity(array: Any) -> Any:
    return array


if JIT_DISABLED:
    call_address, borrow = _call_interpreted, _identity
else:

    @numba.njit(cache=True)
    def call_address(address, first, second, third, fourth):
        """Call the C function at `address` with four pointers, all given as integers."""
        _call_compiled(address, first, second, third, fourth)

    @numba.njit(cache=True)
    def borrow(array):
        """The same array without its reference count, for inner loops of many threads.

        Counting references to a shared array is an atomic write to one memory cell by every thread, for which
        they wait. The caller keeps the array alive.
        """
        return _borrow(array)

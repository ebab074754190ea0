"""All Numba policy: decorators, a cache that cannot go stale, and the number of threads."""

from refdof._jit.compile import (
    JIT_DISABLED,
    cache_folder,
    callback,
    compilations,
    inline,
    kernel,
    prange,
    results_folder,
    source_digest,
    tile_kernel,
)
from refdof._jit.memory import borrow, call_address, fetch_row, load_int32, store_int32
from refdof._jit.threads import run_tasks, thread_count, use_threads

__all__ = [
    "JIT_DISABLED",
    "borrow",
    "cache_folder",
    "call_address",
    "callback",
    "compilations",
    "fetch_row",
    "inline",
    "kernel",
    "load_int32",
    "prange",
    "results_folder",
    "run_tasks",
    "source_digest",
    "store_int32",
    "thread_count",
    "tile_kernel",
    "use_threads",
]

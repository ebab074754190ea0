"""All Numba policy: decorators, a cache that cannot go stale, and the number of threads."""

from refdof._jit.compile import (
    JIT_DISABLED,
    cache_folder,
    callback,
    compilations,
    inline,
    kernel,
    prange,
    processor,
    results_folder,
    source_digest,
    tile_kernel,
)
from refdof._jit.memory import array_at, borrow, call_address, fetch_row
from refdof._jit.threads import run_tasks, thread_count, use_threads

__all__ = [
    "JIT_DISABLED",
    "array_at",
    "borrow",
    "cache_folder",
    "call_address",
    "callback",
    "compilations",
    "fetch_row",
    "inline",
    "kernel",
    "prange",
    "processor",
    "results_folder",
    "run_tasks",
    "source_digest",
    "thread_count",
    "tile_kernel",
    "use_threads",
]

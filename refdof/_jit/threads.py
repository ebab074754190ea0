"""Threads: how many there are, and tasks that own what they write."""

from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from typing import Any

import numba

__all__ = ["run_tasks", "thread_count", "use_threads"]


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

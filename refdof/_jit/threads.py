"""Threads: how many there are, and tasks that own what they write."""

from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from queue import Empty, SimpleQueue
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
    task: Callable[[Any], Any], jobs: Sequence[Any], progress: Callable[[int, int], None] | None = None
) -> list[Any]:
    """Results of `task` on every job, on as many threads as Numba may use; call progress(done, all) between.

    Jobs own what they write, so order and thread count change nothing. Ctrl-C ends after the running jobs.
    """
    total = len(jobs)
    finished: SimpleQueue[Future[Any]] = SimpleQueue()
    pool = ThreadPoolExecutor(thread_count())
    try:
        futures = [pool.submit(task, job) for job in jobs]
        for future in futures:
            future.add_done_callback(finished.put)
        for done in range(1, total + 1):
            _next(finished).result()
            if progress is not None:
                progress(done, total)
        return [future.result() for future in futures]
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _next(finished: SimpleQueue[Future[Any]]) -> Future[Any]:
    """Wait in pieces: where a wait has no end, some systems do not see Ctrl-C."""
    while True:
        try:
            return finished.get(timeout=0.5)
        except Empty:
            continue

"""Ahead: compile what the float64 twins of methods need, in parallel processes, as `refdof.warm` does for methods."""

import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor

from refdof._jit import cache_folder, thread_count
from refdof.warm import is_warm, job_of

__all__ = ["compile_twins", "twin_job"]

_CHILD = """
import gc, sys
from refdof._process import die_with_parent
die_with_parent()
gc.disable()
from refdof._jit import cache_folder
from refdof.stability import CASES, matrix
matrix([sys.argv[1]], CASES[:1])
(cache_folder() / sys.argv[2]).touch()
"""


def twin_job(method: str) -> str:
    """The job, as `refdof.warm` names its own, that compiles a method's twin."""
    return job_of(method, "twin")


def compile_twins(methods: Sequence[str], tell: Callable[[str, int, int], None]) -> None:
    """Run a first case of methods that were not yet run with these sources, each in a process of its own.

    Nothing is done on one processor, or without a cache folder.
    """
    processes = min(thread_count(), os.cpu_count() or 1)
    todo = [name for name in methods if not is_warm([twin_job(name)])]
    if cache_folder() is None or processes < 2 or len(todo) < 2 or not sys.executable:
        return
    tell("compiling", 0, len(todo))
    with ThreadPoolExecutor(processes) as pool:
        for done, _ in enumerate(pool.map(_compile, todo), 1):
            tell("compiling", done, len(todo))


def _compile(method: str) -> None:
    """In a process; what it cannot do is done when it is called."""
    command = [sys.executable, "-c", _CHILD, method, f"{twin_job(method).replace(' ', '-')}.warm"]
    surroundings = {**os.environ, "NUMBA_NUM_THREADS": "1"}
    quiet = subprocess.DEVNULL
    subprocess.run(command, env=surroundings, stdin=quiet, stdout=quiet, stderr=quiet, check=False)

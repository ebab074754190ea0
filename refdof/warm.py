"""Warm: compile what methods and the reference need, into the cache, in parallel processes.

A job is "reference" or "METHOD PRESET". Each process takes the next job, until none is left: it renders a small picture
of a built-in scene. What is compiled once is marked in the cache's folder.
"""

import gc
import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from queue import Empty, SimpleQueue

from refdof._jit import cache_folder, thread_count
from refdof._process import die_with_parent
from refdof.methods import METHODS
from refdof.rendering import render_view
from refdof.scene.load import load_scene
from refdof.truth.reference import reference_of_view
from refdof.view import View

__all__ = ["REFERENCE", "is_warm", "job_of", "warm"]

REFERENCE = "reference"
_SCENE, _SIZE = "branches", (160, 120)  # large enough for the functions that pictures of more than 16384 px use


def job_of(method: str, preset: str) -> str:
    """The job that compiles a method with a preset's parameters."""
    return f"{method} {preset}"


def warm(jobs: Sequence[str], progress: Callable[[str, int, int], None] | None = None, at_least: int = 1) -> None:
    """Do the jobs that were not yet done with these sources on this kind of processor.

    Without a cache folder nothing is done: functions are compiled when they are called first.

    Parameters
    ----------
    jobs : names as of `job_of`, or `REFERENCE`
    progress : callable, optional
        Called with ("compiling", done, all).
    at_least : int
        Do nothing with fewer jobs or processors than these.
    """
    folder, processes = cache_folder(), min(thread_count(), os.cpu_count() or 1)
    if folder is None or processes < at_least or not sys.executable:
        return
    todo = sorted((job for job in dict.fromkeys(jobs) if not _mark(folder, job).exists()), key=_effort, reverse=True)
    if len(todo) < max(at_least, 1):
        return
    queue: SimpleQueue[str] = SimpleQueue()
    for job in todo:
        queue.put(job)
    done = 0

    def tell() -> None:
        if progress is not None:
            progress("compiling", done, len(todo))

    def work(_: int) -> None:
        nonlocal done
        environment = {**os.environ, "NUMBA_NUM_THREADS": "1"}
        command = [sys.executable, "-m", "refdof.warm"]
        with subprocess.Popen(
            command,
            env=environment,
            text=True,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        ) as worker:
            assert worker.stdin is not None
            assert worker.stdout is not None
            with suppress(Empty, BrokenPipeError):  # what is not compiled ahead is compiled when it is called
                while True:
                    print(queue.get_nowait(), file=worker.stdin, flush=True)
                    if not worker.stdout.readline():
                        break
                    done += 1
                    tell()

    tell()
    with ThreadPoolExecutor(processes) as pool:
        list(pool.map(work, range(min(processes, len(todo)))))


def is_warm(jobs: Sequence[str]) -> bool:
    """True if all these jobs were done with these sources on this kind of processor."""
    folder = cache_folder()
    return folder is not None and all(_mark(folder, job).exists() for job in jobs)


def _effort(job: str) -> tuple[int, str]:
    """What a job takes to compile, by the size of its sources; the reference, which all need, comes first."""
    if job == REFERENCE:
        return sys.maxsize, job
    module = METHODS[job.split()[0]]
    files = list(Path(module.__path__[0]).glob("*.py")) if hasattr(module, "__path__") else [Path(str(module.__file__))]
    return sum(file.stat().st_size for file in files), job


def _mark(folder: Path, job: str) -> Path:
    """The file that says that a job was done."""
    return folder / f"{job.replace(' ', '-')}.warm"


def _do(job: str, view: View) -> None:
    if job == REFERENCE:
        reference_of_view(view, samples=16)
    else:
        method, preset = job.split()
        render_view(method, view, preset=preset)
    folder = cache_folder()
    if folder is not None:
        _mark(folder, job).touch()


if __name__ == "__main__":  # a worker: a job a line
    die_with_parent()
    gc.disable()  # compiling leaves much that lives on; looking through it took a seventh of the time
    scene = load_scene(_SCENE)
    shared = View(scene, scene.camera.with_size(_SIZE), scene.lens)
    for line in sys.stdin:
        _do(line.strip(), shared)
        print("done", flush=True)

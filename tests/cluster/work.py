"""Tasks for workers, which tell what they do in a file: a line with the process that did it."""

import os
import signal
import time
from pathlib import Path

from refdof import InputError
from refdof._jit import thread_count
from refdof.truth import tile_tasks


def tell(words):
    """Append a line to the file named by REFDOF_TEST_LOG."""
    log = os.open(os.environ["REFDOF_TEST_LOG"], os.O_WRONLY | os.O_APPEND | os.O_CREAT)
    os.write(log, f"{os.getpid()} {words}\n".encode())  # one write: lines of two processes do not mix
    os.close(log)


def told():
    """The lines (process, words) so far."""
    path = Path(os.environ["REFDOF_TEST_LOG"])
    lines = path.read_text().splitlines() if path.exists() else []
    return [(int(line.split(" ", 1)[0]), line.split(" ", 1)[1]) for line in lines]


class Scene:
    """Something to share that tells when it arrives."""

    def __init__(self, number):
        self.number = number
        self.kept = None  # made by the first task

    def __getstate__(self):
        return {"number": self.number, "kept": None}

    def __setstate__(self, state):
        tell("arrived")
        self.__dict__ = state


def add(scene, task):
    if scene.kept is None:
        tell("made")
        scene.kept = 1000
    return scene.kept + scene.number + task


def slow(scene, task):
    tell(f"begin {task}")
    time.sleep(0.1)
    tell(f"end {task}")
    return scene.number + task


def fail(_, task):
    if task == "input":
        raise InputError("samples: got -1; allowed is a whole number >= 1")
    raise ZeroDivisionError(task)


def deadly(_, task):
    if task == 1:
        os.kill(os.getpid(), signal.SIGKILL)
    return task


def alone(_, task):
    tell("begin")
    time.sleep(0.02)
    tell("end")
    return task


def threads(*_):
    return thread_count()


def is_at_work(process):
    """Whether a process has begun something and not ended it."""
    said = [words for number, words in told() if number == process]
    return bool(said) and said[-1].startswith("begin")


def wait_until(true):
    """Wait for what other processes tell."""
    deadline = time.monotonic() + 120.0
    while not true():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def sample_beside_another(work, batch):
    """As the reference's own task, once two processes have one: neither does all of them."""
    tell("begin")
    wait_until(lambda: len({process for process, _ in told()}) == 2)
    return tile_tasks._sample(work, batch)


def sample(work, batch):
    """As the reference's own task."""
    tell(f"begin {batch}")
    time.sleep(0.1)
    tiles = tile_tasks._sample(work, batch)
    tell(f"end {batch}")
    return tiles

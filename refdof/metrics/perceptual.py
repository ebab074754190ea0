"""FLIP: how visible a difference is when one flips between two display images.

References
----------
.. [1] Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom & Fairchild (2020), FLIP: A Difference
   Evaluator for Alternating Images, Proceedings of the ACM on Computer Graphics and Interactive Techniques
   3(2).
"""

import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from queue import Empty, SimpleQueue
from typing import Any, TypeAlias

import numpy as np

from refdof._check import Float
from refdof.metrics import flip_worker
from refdof.metrics._pair import display_pair
from refdof.metrics.flip_worker import ANSWER, FLIP_PPD, SIZE, evaluate

__all__ = ["FLIP_PPD", "Asker", "flip", "flip_here", "flip_processes"]

Answer: TypeAlias = tuple[float, Float]  # the mean, and the error of each pixel (H, W) float32
Asker: TypeAlias = Callable[[Any, Any], Callable[[], Answer]]
_Worker: TypeAlias = subprocess.Popen[bytes]


def flip(reference: Any, image: Any) -> float:
    """Mean FLIP error of the display images at 67.02 pixels per degree: 0 for identical ones, at most 1.

    Parameters
    ----------
    reference, image : (H, W, 3)
        Linear RGB.

    Raises
    ------
    InputError
        If shapes differ or a value is not finite.
    """
    return evaluate(*display_pair(reference, image))[0]


def flip_here(reference: Any, image: Any) -> Callable[[], Answer]:
    """`flip` and the error of each pixel, worked out in this process when it is asked for."""
    return lambda: evaluate(*display_pair(reference, image))


@contextmanager
def flip_processes(count: int) -> Iterator[Asker]:
    """Processes that work out `flip` beside this one, as long as the block lasts.

    Yields
    ------
    ask : (reference, image) -> (() -> (float, (H, W) float32))
        Sends a pair to a process; the result waits for its mean and its map. Any thread may ask, `count` of them at
        once. What a process does not answer is worked out here.
    """
    started = [worker for worker in (_start() for _ in range(count)) if worker is not None]
    idle: SimpleQueue[_Worker] = SimpleQueue()
    for worker in started:
        idle.put(worker)

    def ask(reference: Any, image: Any) -> Callable[[], Answer]:
        pair = display_pair(reference, image)
        with suppress(Empty):
            worker = idle.get_nowait()
            if _send(worker, pair):
                return lambda: _answer(worker, pair, idle)
        return lambda: evaluate(*pair)

    try:
        yield ask
    finally:
        for worker in started:
            worker.kill()
            with suppress(OSError), worker:  # closes the pipes, which may hold what was never read
                pass


def _start() -> _Worker | None:
    """A process, which ends when this one does; None where there can be none."""
    command = [sys.executable, "-P", str(flip_worker.__file__)]
    pipe = subprocess.PIPE
    with suppress(OSError, ValueError):
        return subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL)
    return None


def _send(worker: _Worker, pair: tuple[Float, Float]) -> bool:
    assert worker.stdin is not None
    with suppress(OSError, ValueError):
        worker.stdin.write(SIZE.pack(*pair[0].shape[:2]))
        for image in pair:
            worker.stdin.write(image.data)
        worker.stdin.flush()
        return True
    return False


def _answer(worker: _Worker, pair: tuple[Float, Float], idle: SimpleQueue[_Worker]) -> Answer:
    """What the process says; if it has ended, both are worked out here."""
    assert worker.stdout is not None
    shape = pair[0].shape[:2]
    told = worker.stdout.read(ANSWER.size)
    errors = np.frombuffer(worker.stdout.read(4 * shape[0] * shape[1]), dtype=np.float32)
    if errors.size < shape[0] * shape[1]:
        return evaluate(*pair)
    idle.put(worker)
    return float(ANSWER.unpack(told)[0]), errors.reshape(shape)

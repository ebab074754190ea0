"""Desk: the one thread that renders, for every page.

Work comes as steps, which a page's next request cuts short: of a page's requests the newest wins, and pages take turns.
Short errands, such as picking a point, come first.
"""

import threading
from collections import deque
from collections.abc import Callable, Iterator
from typing import Any

from refdof._jit import use_threads

__all__ = ["Desk"]

_MOST_ERRANDS = 16  # before a step: who asks for many does not keep others from their pictures

Steps = Callable[[Callable[[], bool]], Iterator[None]]
"""Takes a function that tells whether something newer waits, and gives the steps of a piece of work."""


class Desk:
    """A thread that does the steps of the newest request of everyone; `failed` hears of errors that nobody caught."""

    def __init__(self, failed: Callable[[BaseException], None], threads: int | None = None) -> None:
        self._failed, self._threads = failed, threads
        self._errands: deque[Callable[[], None]] = deque()
        self._wanted: dict[Any, Steps] = {}
        self._changed = threading.Condition()
        self._closed = False
        self._thread = threading.Thread(target=self._work, name="refdof desk", daemon=True)
        self._thread.start()

    def ask(self, who: Any, steps: Steps) -> None:
        """Do these steps for `who` instead of those asked for before."""
        with self._changed:
            self._wanted[who] = steps
            self._changed.notify()

    def errand(self, work: Callable[[], None]) -> None:
        """Do this soon, after the errands before."""
        with self._changed:
            self._errands.append(work)
            self._changed.notify()

    def leave(self, who: Any) -> None:
        """Forget the requests of `who`."""
        self.ask(who, lambda _: iter(()))

    def close(self, seconds: float = 0.5) -> bool:
        """End the thread after the step it is in; wait for that so long. True if it has ended."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        self._thread.join(seconds)
        return not self._thread.is_alive()

    def _work(self) -> None:
        if self._threads is not None:
            use_threads(self._threads)  # a thread's own
        running: dict[Any, Iterator[None]] = {}
        done = 0  # errands since the last step
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._closed or self._errands or self._wanted or running)
                if self._closed:
                    return
                turn = self._errands and (done < _MOST_ERRANDS or not (running or self._wanted))
                errand = self._errands.popleft() if turn else None
                wanted, self._wanted = self._wanted, {}
            for who, steps in wanted.items():
                running.pop(who, None)
                running[who] = steps(lambda who=who: self._newer(who))  # type: ignore[misc]
            if errand is not None:
                self._guarded(errand)
                done += 1
                continue
            done = 0
            for who in list(running):
                one = running.pop(who)
                if self._guarded(lambda one=one: next(one)):  # type: ignore[misc]
                    running[who] = one  # behind the others
                if self._errands or self._wanted:
                    break

    def _newer(self, who: Any) -> bool:
        """Whether something waits that comes before the steps of `who`."""
        return self._closed or bool(self._errands) or who in self._wanted

    def _guarded(self, work: Callable[[], Any]) -> bool:
        """Do it; False if it has come to its end, in whatever way."""
        try:
            work()
        except StopIteration:
            return False
        except BaseException as error:
            self._failed(error)
            return False
        return True

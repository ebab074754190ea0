"""Time left: what a sweep will still take, from what its steps have taken so far."""

import time
from collections import Counter
from collections.abc import Sequence

__all__ = ["TimeLeft"]


class TimeLeft:
    """Steps of a long run, each of a kind; those of one kind take about the same time.

    Parameters
    ----------
    kinds : of all steps, in their order
    """

    def __init__(self, kinds: Sequence[str]) -> None:
        self.todo = Counter(kinds)
        self.count, self.done = len(kinds), 0
        self._taken: dict[str, list[float]] = {}
        self._began = time.monotonic()

    def ended(self, kind: str, measured: bool = True) -> None:
        """A step has ended; not `measured`: it was done in an earlier run, and took no time."""
        now = time.monotonic()
        self.todo[kind] -= 1
        self.done += 1
        if measured:
            self._taken.setdefault(kind, []).append(now - self._began)
        self._began = now

    def seconds(self) -> float | None:
        """What the other steps will take; None: nothing is known yet."""
        if not self._taken:
            return None
        means = {kind: sum(taken) / len(taken) for kind, taken in self._taken.items()}
        unseen = sum(means.values()) / len(means)
        return sum(count * means.get(kind, unseen) for kind, count in self.todo.items())

    def __str__(self) -> str:
        """Words to put behind others."""
        left = self.seconds()
        if left is None:
            return ""
        return f", about {left / 60.0:.0f} min left" if left >= 90.0 else f", about {left:.0f} s left"

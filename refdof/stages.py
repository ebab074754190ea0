"""Stages: the arrays of a method by name, for whoever ports it. Costs nothing when nobody listens."""

from collections.abc import Callable

import numpy as np

__all__ = ["StageRecorder"]


class StageRecorder:
    """Records arrays under names if `on`; otherwise `record` does not even make them."""

    def __init__(self, on: bool = False) -> None:
        self.on = on
        self.stages: dict[str, np.ndarray] = {}

    def record(self, name: str, make: Callable[[], np.ndarray]) -> None:
        """Keep a copy of `make()` as stage `name`."""
        if self.on:
            self.stages[name] = np.array(make())

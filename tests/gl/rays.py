"""What the tests of ports that trace one ray a pixel share: its lens point, and which of its answers are right.

A ray that meets a border may hit either side. Both are among the method's answers for rays that are shaken a little.
"""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from refdof.optics.pixel_samples import LensPointSets

__all__ = ["hits_off", "one_point", "share_tied"]


def one_point(point: Any) -> LensPointSets:
    """The same lens point (x, y) for every pixel."""
    return LensPointSets(np.array(point, float).reshape(1, 1, 2), np.ones((1, 1)), np.zeros((1, 1), np.int32))


def hits_off(found: np.ndarray, hit: np.ndarray, answers: Callable[[], Iterable[np.ndarray]]) -> tuple[np.ndarray, int]:
    """Where (H, W) rays hit (H, W, 3) what the method's do, and how many hit nothing that a shaken one does.

    `answers` is called only if some rays differ.
    """
    same = (found == hit).all(axis=-1)
    if same.all():
        return same, 0
    right = np.any([(found == answer).all(axis=-1) for answer in answers()], axis=0)
    return same, int((~(same | right)).sum())


def share_tied(hit: np.ndarray, answers: Iterable[np.ndarray]) -> float:
    """The share of rays with several answers: hits (H, W, 3)."""
    return float(np.any([answer != hit for answer in answers], axis=(0, -1)).mean())

"""Whole: causes that show on the pictures as they are, without any model."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from refdof.oracle.diagnosis.samples import Shot
from refdof.oracle.diagnosis.shots import METHOD, case_shot
from refdof.oracle.files import FileFault, Pack

__all__ = ["is_finite", "whole_cause"]

_CLOSE = 10.0  # tolerances
_MOST = 0.95  # of all pixels, or of all pictures


def is_finite(shots: Sequence[Shot]) -> bool:
    """Whether all results are numbers."""
    return all(bool(np.isfinite(shot.got).all()) for shot in shots)


def whole_cause(pack: Pack, failing: Sequence[Shot]) -> tuple[str, dict[str, Any]] | None:
    """The key of a cause and its words, or None."""
    if all(not np.isfinite(shot.got).any() for shot in failing):
        return "not_finite", {}
    varied = [shot for shot in failing if np.ptp(shot.expected) > 0.01]
    if varied and all(np.ptp(shot.got.reshape(-1, 3), axis=0).max() <= 1e-6 for shot in varied):
        return "constant", {}
    others = [_other_case(pack, shot) for shot in failing]
    named = [name for name in others if name]
    if named and len(named) >= 0.5 * len(others):
        return "other_case", {"words": named[0]}
    return None


def _other_case(pack: Pack, shot: Shot) -> str | None:
    """The case whose expected picture the results are."""
    for name in pack.cases:
        try:
            about = pack.description(name)
            if name == shot.name or about.get("method") != METHOD:
                continue
            if list(about["expected"]["image"]["shape"]) != list(shot.got.shape):
                continue
            _, other = case_shot(pack, name, about)
        except (FileFault, KeyError, TypeError):
            continue
        if np.array_equal(other.color, shot.color) and np.array_equal(other.depth, shot.depth):
            continue  # the same picture with another parameter: a model tells more
        close = np.abs(shot.got - other.expected).max(axis=-1) <= _CLOSE * other.tolerance
        if close.mean() >= _MOST:
            return name
    return None

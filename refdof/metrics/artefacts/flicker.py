"""Flicker: how restless pictures of a slow move are: the mean absolute second difference over time.

A pixel whose value changes evenly has none. One that jumps by a once has a / (N - 2) twice in N frames.

A noisy sequence flickers by its noise. With a second, independent sequence of the same truth, the sign of the second
difference comes from the other one. Of a true difference m with normal noise of deviation s in both,

    E[a sign(b)] = m (2 Phi(m / s) - 1) = |m| erf(|m| / (s sqrt(2))),

which is |m| where noise is small, 0 where it is all there is, and never more than |m|: noise adds nothing. (Ours.)
"""

import math
from typing import Any

import numpy as np

from refdof._check import Float, InputError, as_image, as_map

__all__ = ["flicker"]


def flicker(frames: Any, region: Any = None, second: Any = None) -> float:
    """Mean of |f(t - 1) - 2 f(t) + f(t + 1)| over frames 1 .. N - 2, the pixels of a region, and channels.

    Parameters
    ----------
    frames : (N, H, W, 3)
        Linear RGB, at least 3 frames.
    region : (H, W) bool, optional
        Where to look, as a rule what is out of focus in all frames; None: everywhere.
    second : (N, H, W, 3), optional
        An independent sequence of the same truth: noise is then not counted, see above; both take part alike. Chance
        may make the result negative.

    Returns
    -------
    float
        Linear value per frame squared; NaN of a region without pixels.

    Raises
    ------
    InputError
        If shapes disagree, there are fewer than 3 frames, or a value is not finite.
    """
    first = as_image("frames", frames, (None, None, None, 3), dtype=np.float64)
    if len(first) < 3:
        raise InputError(f"frames: got {len(first)}; allowed are at least 3")
    mask = np.ones(first.shape[1:3], dtype=np.bool_)
    if region is not None:
        mask = as_map("region", region, first.shape[1:3]) != 0.0
    if not mask.any():
        return math.nan
    change = _second_difference(first)[:, mask]
    if second is None:
        return float(np.abs(change).mean())
    other = _second_difference(as_image("second", second, first.shape, dtype=np.float64))[:, mask]
    return float((change * np.sign(other) + other * np.sign(change)).mean() / 2.0)


def _second_difference(frames: Float) -> Float:
    return frames[:-2] - 2.0 * frames[1:-1] + frames[2:]

"""Reach: which pixels lie within discs of their own size around other pixels.

|p - q| < r(q) for some q is max over q of r(q)^2 - |p - q|^2 > 0, an upper envelope of paraboloids, which comes apart
into one pass over columns and one over rows [1].

References
----------
.. [1] Felzenszwalb & Huttenlocher (2012), Distance Transforms of Sampled Functions, Theory of Computing 8(19).
"""

import math

import numpy as np

from refdof._check import Float

__all__ = ["within"]


def within(reach: Float) -> np.typing.NDArray[np.bool_]:
    """Pixels nearer than `reach` (H, W) [px] to the centre of a pixel that has it; 0 or less reaches none."""
    power = np.where(reach > 0.0, reach * reach, -np.inf)
    return np.asarray(_envelope(_envelope(power).T).T > 0.0)


def _envelope(power: Float) -> Float:
    """The greatest of power[q] - (p - q)^2 over q, along the first axis."""
    found = power.copy()
    farthest = min(len(power) - 1, math.ceil(math.sqrt(max(0.0, float(power.max())))))
    for step in range(1, farthest + 1):
        np.maximum(found[step:], power[:-step] - step * step, out=found[step:])
        np.maximum(found[:-step], power[step:] - step * step, out=found[:-step])
    return found

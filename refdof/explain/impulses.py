"""Impulses: the weight of every source in one pixel, recovered through the method itself.

A filter that is linear in colour at given depths has weights w with value = sum of w times colour. The weight of a
source is what the pixel gets where that source alone has the colour 1. A block of sources that adds nothing holds no
source that does, so blocks are halved until single sources are left: weights are not negative, or, of kernels that are,
do not add up to 0 to the last bit. The three channels of a colour serve three blocks at once.
"""

from collections.abc import Callable
from itertools import product

import numpy as np

from refdof._check import Float, Index

__all__ = ["weights_of"]

Block = tuple[tuple[int, int], ...]  # first and end along each axis


def weights_of(
    respond: Callable[[Float], Float], shape: tuple[int, ...], dtype: type = np.float32
) -> tuple[Index, Float]:
    """Recover weights.

    Parameters
    ----------
    respond : callable
        Colours (*shape, 3) -> answers (P, 3), the first of which is the pixel; further ones are only reported.
    shape : whole numbers
        Of the sources, such as (H, W).

    Returns
    -------
    places (N, len(shape)) int64, in the order of memory, and weights (N, P) float64 of sources with a part in the pixel
    """
    blocks: list[Block] = [tuple((0, side) for side in shape)]
    found: dict[tuple[int, ...], Float] = {}
    count = 1
    while blocks:
        batch, blocks = blocks[-3:], blocks[:-3]
        color: Float = np.zeros((*shape, 3), dtype=dtype)
        for channel, block in enumerate(batch):
            color[tuple(slice(first, end) for first, end in block)][..., channel] = 1
        answers = np.asarray(respond(color), dtype=np.float64)
        count = len(answers)
        for channel, block in enumerate(batch):
            if answers[0, channel] == 0.0:
                continue
            if all(end - first == 1 for first, end in block):
                found[tuple(first for first, _ in block)] = answers[:, channel]
            else:
                blocks.extend(_halves(block))
    places = sorted(found)
    weights = np.array([found[place] for place in places]).reshape(-1, count)
    return np.array(places, dtype=np.int64).reshape(-1, len(shape)), weights


def _halves(block: Block) -> list[Block]:
    """The block halved along every axis that is longer than 1."""
    sides = []
    for first, end in block:
        middle = (first + end) // 2
        sides.append([(first, end)] if end - first == 1 else [(first, middle), (middle, end)])
    return list(product(*sides))

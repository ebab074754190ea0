"""Samples: some pixels of a picture, what a port gave there, and all texels that may be read for them.

1. Choose the pixels: the worst ones, other wrong ones, and some over the whole picture    `choose`
2. Lay out what a model reads                                                              `samples_of`
"""

from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof.oracle.diagnosis.model import Model

__all__ = ["Samples", "Shot", "choose", "samples_of"]


class Shot(NamedTuple):
    """A picture, and what a port made of it; rows as in files.

    color, got, expected (H, W, 3); depth, coc (H, W); coc_scale, focus, near, far: of the lens and its planes;
    tolerance: of a value; off (H, W): how many tolerances the worst channel is outside of the bounds; right: the model
    of a right port.
    """

    name: str
    color: Float
    depth: Float
    coc: Float
    coc_scale: float
    focus: float
    near: float
    far: float
    got: Float
    expected: Float
    tolerance: float
    off: Float
    right: Model


class Samples(NamedTuple):
    """T texels of a picture, and P of its pixels.

    color (T, 3); depth, coc (T,); squared (T,): squared distance from the middle over half of the height; mirror_x,
    mirror_y (T,): the texel that is the mirror image; x, y (P,); got, expected (P, 3).
    """

    right: Model
    width: int
    height: int
    color: Float
    depth: Float
    coc: Float
    coc_scale: float
    focus: float
    near: float
    far: float
    squared: Float
    mirror_x: Index
    mirror_y: Index
    x: Index
    y: Index
    got: Float
    expected: Float
    tolerance: float


def choose(off: Float, count: int) -> tuple[Index, Index]:
    """x and y of up to `count` pixels: a third the worst, a third wrong ones, the rest over the whole picture."""
    random, flat = np.random.default_rng(0), np.nan_to_num(off.ravel(), nan=np.inf)
    ranked = np.argsort(-flat, kind="stable")
    wrong = ranked[: int((flat > 1.0).sum())]
    worst, others = wrong[: count // 3], wrong[count // 3 :]
    some = random.permutation(others)[: count // 3]
    rest = random.permutation(flat.size)[: max(0, count - len(worst) - len(some))]
    chosen = np.unique(np.concatenate([worst, some, rest]))
    return chosen % off.shape[1], chosen // off.shape[1]


def samples_of(shot: Shot, x: Index, y: Index) -> Samples:
    """What is needed to emulate a shot at pixels x, y (P,)."""
    height, width = shot.depth.shape
    row, column = np.indices(shot.depth.shape)
    squared = ((column + 0.5 - width / 2) ** 2 + (row + 0.5 - height / 2) ** 2) * (2.0 / height) ** 2
    depth = shot.depth.astype(np.float64)
    return Samples(
        right=shot.right,
        width=width,
        height=height,
        color=shot.color.reshape(-1, 3).astype(np.float64),
        depth=depth.ravel(),
        coc=shot.coc.astype(np.float64).ravel(),
        coc_scale=shot.coc_scale,
        focus=shot.focus,
        near=shot.near,
        far=shot.far,
        squared=squared.ravel(),
        mirror_x=(row * width + width - 1 - column).ravel(),
        mirror_y=((height - 1 - row) * width + column).ravel(),
        x=x,
        y=y,
        got=shot.got[y, x].astype(np.float64),
        expected=shot.expected[y, x].astype(np.float64),
        tolerance=shot.tolerance,
    )

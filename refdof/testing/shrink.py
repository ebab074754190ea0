"""Shrink: a case that fails, with as few pixels as possible, of which as few as possible are unlike the rest.

Nothing that can be left out of the result remains: no row or column, no unlike pixel; no smaller circle fails, and no
colour or depth that comes before.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from refdof._check import Float
from refdof.testing.picture import DEPTHS, Case, Picture

__all__ = ["smallest"]


def smallest(case: Case, fails: Callable[[Case], bool], circles: Sequence[float]) -> Case:
    """Take away what can be taken away, most first, as long as the case fails; its circle stays one of `circles`."""
    cost = _cost(case)
    while True:
        for smaller in _smaller(case, circles):
            if _cost(smaller) < cost and fails(smaller):
                case, cost = smaller, _cost(smaller)
                break
        else:
            return case


def _cost(case: Case) -> tuple[Any, ...]:
    """What is made smaller, in this order. It falls with every step, so that there is a last one."""
    picture = case.picture
    unlike, usual = picture.unlike(), picture.usual()
    depths = [DEPTHS.index(float(picture.depth[place])) for place in (usual, *unlike)]
    colors = [_rank(picture.color[place]) for place in (usual, *unlike)]
    differing = sum(
        int((picture.color[place] != picture.color[usual]).any()) + int(picture.depth[place] != picture.depth[usual])
        for place in unlike
    )
    return picture.depth.size, len(unlike), differing, sum(case.numbers), picture.circle, sum(colors), sum(depths)


def _rank(color: Float) -> int:
    """Of a colour: black, then ones and zeros, then others."""
    return int((color != 0.0).sum() + len(color) * (color != color.astype(bool)).sum())


def _smaller(case: Case, circles: Sequence[float]) -> Iterator[Case]:
    picture = case.picture
    for axis in (0, 1):
        for shorter in _shorter(picture, axis):
            yield Case(shorter, case.numbers)
    for k, number in enumerate(case.numbers):
        for less in range(number):
            yield Case(picture, (*case.numbers[:k], less, *case.numbers[k + 1 :]))
    for circle in circles:
        if circle < picture.circle:
            yield Case(picture.with_(circle=circle), case.numbers)
    for simpler in (*_more_alike(picture), *_plainer(picture)):
        yield Case(simpler, case.numbers)


def _shorter(picture: Picture, axis: int) -> Iterator[Picture]:
    """Without half of the rows or columns, a quarter, and so on, down to one."""
    length = picture.depth.shape[axis]
    count = length // 2
    while count > 0:
        for start in range(0, length - count + 1, count):
            gone = range(start, start + count)
            yield picture.moved(lambda a, gone=gone: np.delete(a, gone, axis=axis))
        count //= 2


def _more_alike(picture: Picture) -> Iterator[Picture]:
    """With an unlike pixel as most are, whole, then only its colour or its depth."""
    usual = picture.usual()
    for place in picture.unlike():
        color, depth = picture.color.copy(), picture.depth.copy()
        color[place], depth[place] = color[usual], depth[usual]
        yield picture.with_(color=color, depth=depth)
        yield picture.with_(color=color)
        yield picture.with_(depth=depth)


def _plainer(picture: Picture) -> Iterator[Picture]:
    """With another colour or depth of the usual pixels, of all unlike ones, or of one of them."""
    unlike = np.zeros(picture.depth.shape, dtype=bool)
    for place in picture.unlike():
        unlike[place] = True
    each = [unlike & (np.cumsum(unlike).reshape(unlike.shape) == k) for k in range(1, unlike.sum() + 1)]
    channels = picture.color.shape[2]
    for group in (~unlike, unlike, *each):
        for color in (np.zeros(channels), *np.eye(channels), np.ones(channels)):
            yield picture.with_(color=np.where(group[..., None], color, picture.color).astype(np.float32))
        for depth in DEPTHS:
            yield picture.with_(depth=np.where(group, np.float32(depth), picture.depth))

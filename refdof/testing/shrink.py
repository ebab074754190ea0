"""Shrink: a case that fails, with as few pixels as possible.

No row, column or unlike pixel of the result can be left out, no number made smaller and no circle.
"""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from refdof.testing.picture import Case, Picture

__all__ = ["smallest"]


def smallest(case: Case, fails: Callable[[Case], bool], circles: Sequence[float]) -> Case:
    """Take away what can be taken away, most first, as long as the case fails; its circle stays one of `circles`."""
    while True:
        for smaller in _smaller(case, circles):
            if fails(smaller):
                case = smaller
                break
        else:
            return case


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
    for simpler in _more_alike(picture):
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
        if (picture.color[place] != color[usual]).any() and picture.depth[place] != depth[usual]:
            yield picture.with_(color=color)
            yield picture.with_(depth=depth)

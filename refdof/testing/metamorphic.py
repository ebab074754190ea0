"""Metamorphic: properties of two results, of a picture and of what is made of it.

Functions as in `refdof.testing.pointwise`.
"""

from collections.abc import Callable
from itertools import permutations

import numpy as np

from refdof._check import Float
from refdof.testing.compared import Compared, Mask, Room, distance_to, inside
from refdof.testing.filter import Filter
from refdof.testing.picture import DEPTHS, FOCUS, NEAR, Case, Picture, axis_of

__all__ = [
    "channels",
    "crop",
    "far",
    "flip",
    "linearity",
    "locality",
    "nan",
    "pad",
    "sides",
    "symmetry",
    "tile",
    "translation",
    "transpose",
    "units",
]

_SO_FAR = FOCUS * 2.0**40  # its circle is that of the background but for 2^-40: the same number in float32
_WORDS = ("row", "top and bottom"), ("column", "left and right")  # of axes 0 and 1


def symmetry(run: Filter, case: Case, room: Room) -> Compared:
    """Left for right."""
    return _alike(run, case.picture, room, lambda a: a[:, ::-1])


def flip(run: Filter, case: Case, room: Room) -> Compared:
    """Upside down."""
    return _alike(run, case.picture, room, lambda a: a[::-1])


def transpose(run: Filter, case: Case, room: Room) -> Compared:
    """Rows for columns."""
    return _alike(run, case.picture, room, lambda a: np.swapaxes(a, 0, 1))


def _alike(run: Filter, picture: Picture, room: Room, change: Callable[[Float], Float]) -> Compared:
    expected = change(run(picture))
    return Compared(expected, run(picture.moved(change)), room.tolerance * picture.brightest)


def translation(run: Filter, case: Case, room: Room) -> Compared | None:
    """Two windows of one picture, so that what they show moves."""
    axis, shift = axis_of(case.numbers[0]), 1 + case.numbers[1]
    length = case.picture.depth.shape[axis]
    said = f"{_WORDS[axis][0]}s moved by {shift} px"
    return _windows(run, case.picture, room, axis, (0, length - shift), (shift, length), said)


def crop(run: Filter, case: Case, room: Room) -> Compared | None:
    """A window, and the whole picture."""
    axis, first, last = axis_of(case.numbers[0]), case.numbers[1], case.numbers[2]
    length = case.picture.depth.shape[axis]
    if first + last == 0:
        return None
    said = f"cropped by {first} and {last} px at {_WORDS[axis][1]}"
    return _windows(run, case.picture, room, axis, (0, length), (first, length - last), said)


def pad(run: Filter, case: Case, room: Room) -> Compared | None:
    """The picture, and with a border added."""
    axis, first, last = axis_of(case.numbers[0]), case.numbers[1], case.numbers[2]
    if first + last == 0:
        return None
    widths = [(0, 0), (0, 0), (0, 0)]
    widths[axis] = first, last
    padded = case.picture.moved(lambda a: np.pad(a, widths[: a.ndim], mode="edge"))
    length = padded.depth.shape[axis]
    said = f"padded by {first} and {last} px at {_WORDS[axis][1]}"
    return _windows(run, padded, room, axis, (first, length - last), (0, length), said)


def tile(run: Filter, case: Case, room: Room) -> Compared | None:
    """Two tiles beside each other, and the whole picture."""
    picture, axis = case.picture, axis_of(case.numbers[0])
    length = picture.depth.shape[axis]
    cut = length // 2 + case.numbers[1]
    if not 0 < cut < length:
        return None
    margin = room.margin(picture.largest)
    counts = inside(length, 0, cut, margin) | inside(length, cut, length, margin)
    if not counts.any():
        return None
    halves = [run(picture.moved(lambda a, part=part: _part(a, axis, part))) for part in ((0, cut), (cut, length))]
    said = f"cut before {_WORDS[axis][0]} {cut}"
    got = np.concatenate(halves, axis=axis)
    return Compared(run(picture), got, room.tolerance * picture.brightest, _along(counts, axis, picture), said)


def _windows(
    run: Filter, picture: Picture, room: Room, axis: int, first: tuple[int, int], second: tuple[int, int], said: str
) -> Compared | None:
    """Two windows of rows or columns, begin and end, where both are far from their cuts."""
    length, margin = picture.depth.shape[axis], room.margin(picture.largest)
    counts = inside(length, *first, margin) & inside(length, *second, margin)
    if not counts.any():
        return None
    results: list[Float] = []
    for window in (first, second):
        whole = np.zeros(picture.color.shape)
        _part(whole, axis, window)[...] = run(picture.moved(lambda a, window=window: _part(a, axis, window)))
        results.append(whole)
    return Compared(results[0], results[1], room.tolerance * picture.brightest, _along(counts, axis, picture), said)


def _part(array: Float, axis: int, window: tuple[int, int]) -> Float:
    return array[window[0] : window[1]] if axis == 0 else array[:, window[0] : window[1]]


def _along(counts: Mask, axis: int, picture: Picture) -> Mask:
    """(H, W) of (H,) or (W,)."""
    return np.broadcast_to(counts[:, None] if axis == 0 else counts, picture.depth.shape)


def locality(run: Filter, case: Case, room: Room) -> Compared | None:
    """One pixel changes."""
    depth = DEPTHS[case.numbers[2] % len(DEPTHS)]
    return _changed(run, case, room, 2.0 * case.picture.brightest + 1.0, depth, "another colour and depth")


def nan(run: Filter, case: Case, room: Room) -> Compared | None:
    """One pixel is no number, or infinite."""
    value = (np.nan, np.inf)[case.numbers[2] % 2]
    return _changed(run, case, room, value, None, f"colour {value}")


def _changed(run: Filter, case: Case, room: Room, value: float, depth: float | None, said: str) -> Compared | None:
    picture = case.picture
    y, x = (number % size for number, size in zip(case.numbers, picture.depth.shape, strict=False))
    marked = np.zeros(picture.depth.shape, dtype=bool)
    marked[y, x] = True
    color = np.where(marked[..., None], np.float32(value), picture.color)
    other = picture.with_(color=color)
    if depth is not None:
        other = other.with_(depth=np.where(marked, np.float32(depth), picture.depth))
    counts = distance_to(marked) > room.margin(max(picture.largest, other.largest))
    if not counts.any():
        return None
    finite = bool(np.isfinite(value))
    allowed = room.tolerance * (other.brightest if finite else picture.brightest)
    said = f"row {y}, column {x} given {said}"
    return Compared(run(picture), run(other, finite), allowed, counts, said)


def linearity(run: Filter, case: Case, room: Room) -> Compared:
    """A picture, and k times the same moved round its border."""
    picture, factor = case.picture, 2.0 ** (case.numbers[2] - 1)
    other = np.roll(picture.color, case.numbers[:2], axis=(0, 1))
    both = picture.with_(color=picture.color + np.float32(factor) * other)
    expected = run(picture) + factor * run(picture.with_(color=other))
    # Each of the three results may be off by the tolerance.
    allowed = room.tolerance * (both.brightest + (1.0 + factor) * picture.brightest)
    moved = f"moved by {case.numbers[0]} rows and {case.numbers[1]} columns round the border"
    return Compared(expected, run(both), allowed, said=f"the picture plus {factor:g} times itself {moved}")


def channels(run: Filter, case: Case, room: Room) -> Compared:
    """Another order of channels."""
    picture = case.picture
    orders = list(permutations(range(picture.color.shape[2])))[1:]
    order = list(orders[case.numbers[0] % len(orders)])
    got = run(picture.with_(color=np.ascontiguousarray(picture.color[..., order])))
    said = f"channels in the order {order}"
    return Compared(run(picture)[..., order], got, room.tolerance * picture.brightest, said=said)


def units(run: Filter, case: Case, room: Room) -> Compared:
    """Another unit of length."""
    exponent = (case.numbers[0] // 2 + 1) * (-1) ** case.numbers[0]  # 1, -1, 2, -2, ...
    other = case.picture.with_(depth=case.picture.depth * np.float32(2.0**exponent), unit=2.0**exponent)
    return Compared(run(case.picture), run(other), 0.0, said=f"depth and lens times 2^{exponent}")


def sides(run: Filter, case: Case, room: Room) -> Compared:
    """One wall behind the focal plane, one in front of it."""
    picture = case.picture
    there, here = (picture.with_(depth=np.full_like(picture.depth, depth)) for depth in (np.inf, NEAR))
    said = "all of it behind the focal plane (expected) and in front of it"
    return Compared(run(there), run(here), room.tolerance * picture.brightest, said=said)


def far(run: Filter, case: Case, room: Room) -> Compared | None:
    """The background, and a surface far away."""
    picture = case.picture
    empty = np.isinf(picture.depth)
    if not empty.any():
        return None
    other = picture.with_(depth=np.where(empty, np.float32(_SO_FAR), picture.depth))
    return Compared(
        run(picture), run(other), room.tolerance * picture.brightest, said="the background at infinity, and far away"
    )

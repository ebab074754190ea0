"""The gate: the only place that converts arguments and raises for bad ones.

Every error names the argument, what it got and what is allowed. Behind the gate nothing checks again.
"""

import difflib
import math
from collections.abc import Iterable, Sequence
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

__all__ = [
    "Float",
    "Index",
    "InputError",
    "as_bool",
    "as_choice",
    "as_color",
    "as_float",
    "as_index",
    "as_instance",
    "as_integer",
    "as_number",
    "as_pair",
    "as_vector",
    "shape_of",
]

Float: TypeAlias = npt.NDArray[np.floating[Any]]
Index: TypeAlias = npt.NDArray[np.integer[Any]]


class InputError(ValueError):
    """Bad input: the message is one line that names the argument, what it got and what is allowed."""


def as_float(
    name: str,
    value: Any,
    shape: Sequence[int | None],
    *,
    dtype: npt.DTypeLike | None = None,
    finite: bool = True,
    nan: bool = False,
    minimum: float | None = None,
) -> Float:
    """Return `value` as a C-contiguous float array of `shape` (None: any length).

    float32 and float64 are kept unless `dtype` is given; everything else becomes float64. NaN is only
    allowed if `nan` is True, infinities only if `finite` is False.
    """
    try:
        array = np.asarray(value)
        if np.iscomplexobj(array):
            raise TypeError
        wanted = np.dtype(dtype) if dtype is not None else array.dtype
        if wanted not in (np.float32, np.float64):
            wanted = np.dtype(np.float64)
        with np.errstate(over="ignore"):  # too large for `wanted` becomes infinite, which is judged below
            array = np.asarray(array, dtype=wanted, order="C")  # keeps a single number's shape ()
    except (TypeError, ValueError):
        raise InputError(f"{name}: expected numbers, got {type(value).__name__}") from None
    _check_shape(name, array.shape, shape)
    with np.errstate(over="ignore", invalid="ignore"):
        suspicious = not np.isfinite(array.sum())  # as it is if a value is not finite: one quick pass
    if suspicious:
        if not nan and np.isnan(array).any():
            raise InputError(f"{name}: has {int(np.isnan(array).sum())} NaN values; none are allowed")
        if finite and np.isinf(array).any():
            raise InputError(f"{name}: has {int(np.isinf(array).sum())} infinite values; only finite ones are allowed")
    if minimum is not None and array.size and array.min() < minimum:
        raise InputError(f"{name}: smallest value is {array.min():g}; allowed are values >= {minimum:g}")
    return array


def as_index(name: str, value: Any, shape: Sequence[int | None], *, end: int) -> Index:
    """Return `value` as a C-contiguous int64 array of `shape` with every entry in 0 .. end - 1."""
    try:
        array = np.asarray(value)
    except ValueError:  # rows of different lengths
        raise InputError(f"{name}: expected integers, got {type(value).__name__}") from None
    if array.size == 0:
        array = array.astype(np.int64)
    if not np.issubdtype(array.dtype, np.integer):
        raise InputError(f"{name}: expected integers, got {array.dtype}")
    array = np.ascontiguousarray(array, dtype=np.int64)
    _check_shape(name, array.shape, shape)
    if array.size and (array.min() < 0 or array.max() >= end):
        raise InputError(f"{name}: index {array.min() if array.min() < 0 else array.max()} is outside 0 .. {end - 1}")
    return array


def as_number(
    name: str,
    value: Any,
    *,
    above: float | None = None,
    minimum: float | None = None,
    maximum: float | None = None,
    finite: bool = True,
) -> float:
    """Return `value` as a float inside the stated range; `above` is exclusive, the others inclusive."""
    allowed = _range_in_words(above, minimum, maximum, finite)
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name}: got {value!r}; allowed is {allowed}") from None
    if (
        math.isnan(number)
        or (finite and math.isinf(number))
        or (above is not None and not number > above)
        or (minimum is not None and number < minimum)
        or (maximum is not None and number > maximum)
    ):
        raise InputError(f"{name}: got {number:g}; allowed is {allowed}")
    return number


def as_integer(name: str, value: Any, *, minimum: int, maximum: int | None = None) -> int:
    """Return `value` as an int inside minimum .. maximum; 3.0 is taken, 3.5 is not."""
    allowed = f"a whole number >= {minimum}" if maximum is None else f"a whole number in {minimum} .. {maximum}"
    try:
        if np.ndim(value) != 0:
            raise TypeError
        number = int(value)
        whole = not isinstance(value, bool) and number == float(value)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name}: got {value!r}; allowed is {allowed}") from None
    if not whole or number < minimum or (maximum is not None and number > maximum):
        raise InputError(f"{name}: got {value!r}; allowed is {allowed}")
    return number


def as_instance(name: str, value: Any, kind: type) -> Any:
    """Return `value` if it is a `kind`."""
    if not isinstance(value, kind):
        raise InputError(f"{name}: got {type(value).__name__}; allowed is a {kind.__name__}")
    return value


def as_bool(name: str, value: Any) -> bool:
    """Return `value` if it is a truth value; words and numbers are not taken."""
    if not isinstance(value, bool | np.bool_):
        raise InputError(f"{name}: got {value!r}; allowed are True and False")
    return bool(value)


def as_vector(name: str, value: Any) -> tuple[float, float, float]:
    """Return `value` as three finite floats."""
    x, y, z = as_float(name, value, (3,), dtype=np.float64).tolist()
    return x, y, z


def as_color(name: str, value: Any) -> tuple[float, float, float]:
    """Return `value` as three finite floats >= 0: linear RGB."""
    r, g, b = as_float(name, value, (3,), dtype=np.float64, minimum=0.0).tolist()
    return r, g, b


def as_pair(name: str, value: Any, *, minimum: int, maximum: int) -> tuple[int, int]:
    """Return `value` as two whole numbers inside minimum .. maximum."""
    try:
        first, second = value
    except (TypeError, ValueError):
        raise InputError(f"{name}: got {value!r}; allowed are two whole numbers") from None
    return (
        as_integer(name, first, minimum=minimum, maximum=maximum),
        as_integer(name, second, minimum=minimum, maximum=maximum),
    )


def as_choice(name: str, value: Any, allowed: Iterable[str]) -> str:
    """Return `value` if it is one of `allowed`; otherwise name the nearest one."""
    choices = list(allowed)
    if isinstance(value, str) and value in choices:
        return value
    near = difflib.get_close_matches(str(value), choices, n=1, cutoff=0.6)
    hint = f"did you mean {near[0]!r}? " if near else ""
    raise InputError(f"{name}: got {value!r}; {hint}allowed are {', '.join(choices)}")


def shape_of(name: str, value: Any) -> tuple[int, ...]:
    """The shape of numbers in any nesting."""
    try:
        return np.shape(value)
    except ValueError:  # rows of different lengths
        raise InputError(f"{name}: expected numbers, got {type(value).__name__} of unequal rows") from None


def _check_shape(name: str, shape: tuple[int, ...], wanted: Sequence[int | None]) -> None:
    fits = len(shape) == len(wanted) and all(w is None or w == s for s, w in zip(shape, wanted, strict=True))
    if not fits:
        words = ", ".join("any" if w is None else str(w) for w in wanted)
        raise InputError(f"{name}: got shape {shape}; allowed is ({words})")


def _range_in_words(above: float | None, minimum: float | None, maximum: float | None, finite: bool) -> str:
    words = ["a finite number" if finite else "a number"]
    if above is not None:
        words.append(f"> {above:g}")
    if minimum is not None:
        words.append(f">= {minimum:g}")
    if maximum is not None:
        words.append(f"<= {maximum:g}")
    return words[0] + (" " + " and ".join(words[1:]) if words[1:] else "")

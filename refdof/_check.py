"""Validation: the only place that converts arguments and raises for bad ones.

Every error names the argument, what it got and what is allowed. After validation nothing checks again, but for
the arrays of a scene or a part, which may be written to: `surfaces_of`, `Scene.from_parts`.
"""

import difflib
import math
import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

__all__ = [
    "LARGEST_COLOR",
    "LARGEST_LENGTH",
    "LARGEST_LIGHT",
    "Float",
    "Index",
    "InputError",
    "as_bool",
    "as_choice",
    "as_color",
    "as_depth",
    "as_float",
    "as_function",
    "as_image",
    "as_index",
    "as_instance",
    "as_instances",
    "as_integer",
    "as_map",
    "as_number",
    "as_pair",
    "as_path",
    "as_vector",
    "shape_of",
]

Float: TypeAlias = npt.NDArray[np.floating[Any]]
Index: TypeAlias = npt.NDArray[np.integer[Any]]

LARGEST_COLOR = 1e8  # of a scene: four of them multiplied, and some more added, stay below LARGEST_LIGHT
LARGEST_LIGHT = 1e33  # of a picture: sums of 65536 reads, the most of any filter, stay in float32
LARGEST_LENGTH = 1e100  # of a coordinate [scene units]: products of three stay in float64
_MOST_WORDS = 80  # characters of a value that an error repeats


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
    maximum: float | None = None,
) -> Float:
    """Return `value` as a C-contiguous float array of `shape` (None: any length).

    float32 and float64 are kept unless `dtype` is given; everything else becomes float64. NaN is only
    allowed if `nan` is True, infinities only if `finite` is False. Finite values must fit the type.
    """
    array = _as_array(name, value)
    if array.dtype.kind not in "buif":
        raise InputError(f"{name}: got {_said(value)}; allowed are numbers")
    _check_shape(name, array.shape, shape)
    if array.dtype not in (np.float32, np.float64):
        with np.errstate(over="ignore"):  # long doubles
            array = array.astype(np.float64)
    wanted = np.dtype(dtype) if dtype is not None else array.dtype
    with np.errstate(invalid="ignore"):
        lowest, highest = (array.min(), array.max()) if array.size else (0.0, 0.0)
    if (finite or not nan) and not (np.isfinite(lowest) and np.isfinite(highest)):  # NaN is the least and the greatest
        if not nan and np.isnan(array).any():
            raise InputError(f"{name}: has {int(np.isnan(array).sum())} NaN values; none are allowed")
        if finite and np.isinf(array).any():
            raise InputError(f"{name}: has {int(np.isinf(array).sum())} infinite values; only finite ones are allowed")
    if maximum is None and finite and wanted.itemsize < array.dtype.itemsize:
        maximum = float(np.finfo(wanted).max)
        minimum = -maximum if minimum is None else minimum
    if minimum is not None and array.size and float(lowest) < minimum:
        raise InputError(f"{name}: smallest value is {lowest:g}; allowed are values >= {minimum:g}")
    if maximum is not None and array.size and float(highest) > maximum:
        raise InputError(f"{name}: largest value is {highest:g}; allowed are values <= {maximum:g}")
    with np.errstate(over="ignore"):  # where infinities are allowed, what is too large becomes one
        return np.asarray(array, dtype=wanted, order="C")  # keeps a single number's shape ()


def as_image(
    name: str,
    value: Any,
    shape: Sequence[int | None] = (None, None, 3),
    *,
    dtype: npt.DTypeLike | None = None,
    finite: bool = True,
    minimum: float = -LARGEST_LIGHT,
    maximum: float = LARGEST_LIGHT,
) -> Float:
    """Return linear light as `as_float` does: at least one pixel, and not an 8- or 16-bit file's display values."""
    array = _as_array(name, value)
    if array.dtype.kind == "b" or (array.dtype.kind == "u" and array.dtype.itemsize <= 2):
        raise InputError(f"{name}: got {array.dtype} values; allowed are floats that hold linear light")
    if array.size == 0 and array.ndim == len(shape) >= 3:
        raise InputError(f"{name}: got shape {array.shape}; allowed is at least one pixel")
    low, high = (minimum, maximum) if finite else (None, None)
    return as_float(name, array, shape, dtype=dtype, finite=finite, minimum=low, maximum=high)


def as_map(name: str, value: Any, shape: Sequence[int | None]) -> Float:
    """Return an image of one number a pixel as `as_float` does: infinities are allowed, and it has a pixel at least."""
    array = as_float(name, value, shape, finite=False)
    if array.size == 0:
        raise InputError(f"{name}: got shape {array.shape}; allowed is at least one pixel")
    return array


def as_depth(
    value: Any, shape: Sequence[int | None], *, dtype: npt.DTypeLike | None = None, nan: bool = False
) -> Float:
    """Return the argument `depth` as `as_float` does: planar depths above 0, which may be infinite."""
    depth = as_float("depth", value, shape, dtype=dtype, finite=False, nan=nan)
    if (depth <= 0).any():
        raise InputError(f"depth: smallest value is {np.nanmin(depth):g}; allowed are values > 0")
    return depth


def as_index(name: str, value: Any, shape: Sequence[int | None], *, end: int) -> Index:
    """Return `value` as a C-contiguous int64 array of `shape` with every entry in 0 .. end - 1."""
    array = _as_array(name, value)
    if array.size == 0:
        array = np.zeros(array.shape, dtype=np.int64)
    if array.dtype.kind not in "ui":
        raise InputError(f"{name}: got {_said(value)} of type {array.dtype}; allowed are integers")
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
        if _is_no_number(value):
            raise TypeError
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name}: got {_said(value)}; allowed is {allowed}") from None
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
        if _is_no_number(value):
            raise TypeError
        number = int(value)
        whole = number == float(value) or isinstance(value, int | np.integer)  # above 2^53 a float is another number
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name}: got {_said(value)}; allowed is {allowed}") from None
    if not whole or number < minimum or (maximum is not None and number > maximum):
        raise InputError(f"{name}: got {_said(value)}; allowed is {allowed}")
    return number


def as_instance(name: str, value: Any, kind: type) -> Any:
    """Return `value` if it is a `kind`."""
    if not isinstance(value, kind):
        raise InputError(f"{name}: got {type(value).__name__}; allowed is a {kind.__name__}")
    return value


def as_instances(name: str, value: Any, kind: type) -> tuple[Any, ...]:
    """Return the items of `value`, a list or tuple, if each is a `kind`."""
    if not isinstance(value, list | tuple):
        raise InputError(f"{name}: got {_said(value)}; allowed is a list of {kind.__name__}")
    return tuple(as_instance(f"{name}[{k}]", item, kind) for k, item in enumerate(value))


def as_function(name: str, value: Any) -> Any:
    """Return `value` if it is None or can be called."""
    if value is not None and not callable(value):
        raise InputError(f"{name}: got {_said(value)}; allowed is a function")
    return value


def as_path(name: str, value: Any) -> Path:
    """Return `value` as the path of a file; it need not exist."""
    text = os.fspath(value) if isinstance(value, str | os.PathLike) else None
    if not isinstance(text, str) or not text or "\0" in text:
        raise InputError(f"{name}: got {_said(value)}; allowed is a path")
    return Path(text)


def as_bool(name: str, value: Any) -> bool:
    """Return `value` if it is a truth value; words and numbers are not taken."""
    if not isinstance(value, bool | np.bool_):
        raise InputError(f"{name}: got {_said(value)}; allowed are True and False")
    return bool(value)


def as_vector(name: str, value: Any) -> tuple[float, float, float]:
    """Return `value` as three finite floats: a place or a direction."""
    bound = LARGEST_LENGTH
    x, y, z = as_float(name, value, (3,), dtype=np.float64, minimum=-bound, maximum=bound).tolist()
    return x, y, z


def as_color(name: str, value: Any) -> tuple[float, float, float]:
    """Return `value` as three floats in 0 .. `LARGEST_COLOR`: linear RGB."""
    r, g, b = as_image(name, value, (3,), dtype=np.float64, minimum=0.0, maximum=LARGEST_COLOR).tolist()
    return r, g, b


def as_pair(name: str, value: Any, *, minimum: int, maximum: int) -> tuple[int, int]:
    """Return `value` as two whole numbers inside minimum .. maximum."""
    try:
        first, second = value
    except (TypeError, ValueError):
        raise InputError(f"{name}: got {_said(value)}; allowed are two whole numbers") from None
    return (
        as_integer(name, first, minimum=minimum, maximum=maximum),
        as_integer(name, second, minimum=minimum, maximum=maximum),
    )


def as_choice(name: str, value: Any, allowed: Iterable[str]) -> str:
    """Return `value` if it is one of `allowed`; otherwise name the nearest one."""
    choices = list(allowed)
    if isinstance(value, str) and value in choices:
        return value
    near = difflib.get_close_matches(_said(value).strip("'"), choices, n=1, cutoff=0.6)
    hint = f"did you mean {near[0]!r}? " if near else ""
    raise InputError(f"{name}: got {_said(value)}; {hint}allowed are {', '.join(choices)}")


def shape_of(name: str, value: Any) -> tuple[int, ...]:
    """The shape of numbers in any nesting."""
    return _as_array(name, value).shape


def _as_array(name: str, value: Any) -> np.ndarray:
    try:
        return np.asarray(value)
    except ValueError:  # rows of different lengths
        raise InputError(f"{name}: got {_said(value)}; allowed are numbers in rows of equal length") from None


def _is_no_number(value: Any) -> bool:
    """Whether float() would guess, or warn: truth values, complex numbers, arrays."""
    return isinstance(value, bool | np.bool_) or np.iscomplexobj(value) or np.ndim(value) != 0


def _said(value: Any) -> str:
    """What an error says it got: numbers and short words as they are, all else by type; always one line."""
    try:
        return _words(value)
    except ValueError:  # Python prints no number of more than some thousand digits
        return "a number too long to print"


def _words(value: Any) -> str:
    if value is None or isinstance(value, str | int | float | complex | np.generic):
        words = repr(value.item() if isinstance(value, np.generic) else value)
        return words if len(words) <= _MOST_WORDS else f"{words[:_MOST_WORDS]}..."
    if isinstance(value, list | tuple) and len(value) <= 4 and all(isinstance(v, int | float) for v in value):
        return str(value)
    if isinstance(value, np.ndarray):
        return f"an array of {value.dtype}, shape {value.shape}"
    return f"a {getattr(type(value), '__name__', 'thing')}"


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

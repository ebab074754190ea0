"""Wording: a cause as a sentence, with as many digits as tell its values from those of a right port."""

import re
import string
from collections.abc import Iterable, Mapping
from typing import Any

from refdof.oracle.diagnosis.causes import Cause

__all__ = ["least_digits", "sentence_of", "tell_something"]

_MOST_DIGITS = 17  # of a float64: more tell nothing
_BESIDE = (("value", "expected"), ("words", "expected"), ("count", "counts"))  # said as "A instead of B"
_PRECISION = re.compile(r"(\+?)\.(\d+)([fg])")


def sentence_of(cause: Cause, pictures: Iterable[Mapping[str, Any]]) -> str:
    """The sentence with the values of the first of these pictures for which the usual digits will do.

    pictures : what completes the sentence for each, the one that shows most first

    Where none is like that, with those of the picture that needs the fewest digits.
    """
    values = list(pictures)
    digits = [least_digits(cause, words) for words in values]
    best = min(range(len(values)), key=lambda k: _MOST_DIGITS + 1 if digits[k] is None else digits[k] or 0)
    return "".join(before + text for before, _, text in _printed(cause, values[best], digits[best] or 0))


def tell_something(cause: Cause, words: Mapping[str, Any]) -> bool:
    """Whether the values are others than those of a right port."""
    return least_digits(cause, words) is not None


def least_digits(cause: Cause, words: Mapping[str, Any]) -> int | None:
    """How many digits keep values from reading like those of a right port; 0: the usual ones. None: no number does."""
    right = {**words, **dict(cause.right)}
    for digits in range(_MOST_DIGITS + 1):
        said = {place: text for _, place, text in _printed(cause, words, digits)}
        usual = {place: text for _, place, text in _printed(cause, right, digits)}
        differ = not cause.right or any(said[place] != usual[place] for place, _ in cause.right)
        if differ and all(said[a] != said[b] for a, b in _BESIDE if a in said and b in said):
            return digits
    return None


def _printed(cause: Cause, words: Mapping[str, Any], digits: int) -> list[tuple[str, str, str]]:
    """Parts of the sentence: the text before a place, the place and what is printed there."""
    return [
        (before, place or "", _text(words[place], spec or "", digits) if place else "")
        for before, place, spec, _ in string.Formatter().parse(cause.sentence)
    ]


def _text(value: Any, spec: str, digits: int) -> str:
    """A value by its format, with at least so many digits; words as they are."""
    if isinstance(value, str):
        return value
    found = _PRECISION.fullmatch(spec)
    full = f"{found[1]}.{max(int(found[2]), digits)}{found[3]}" if found else spec
    text = format(value, full)
    return text if float(text) else format(0, full)  # there is no -0 to read

"""Typed: errors name an option as it was typed, whatever the argument is called that it becomes."""

from collections.abc import Iterator
from contextlib import contextmanager

from refdof._check import InputError

__all__ = ["as_typed"]


@contextmanager
def as_typed(**options: str) -> Iterator[None]:
    """Errors of the block about an argument begin with the option's name, which is given as argument="option"."""
    try:
        yield
    except InputError as error:
        name, colon, rest = str(error).partition(":")
        if name not in options:
            raise
        raise InputError(options[name] + colon + rest) from None

"""TOML files of the project's own: read strictly, with one clear line for what is wrong, and written."""

import difflib
import json
import tomllib
from collections.abc import Iterable, Mapping
from typing import Any

from refdof._check import InputError

__all__ = ["check_keys", "parse", "quoted", "shown"]


def parse(file: str, text: str, what: str) -> dict[str, Any]:
    """The tables of a file's text; `what` it shall be is said in errors.

    Raises
    ------
    InputError
        If the text is no TOML.
    """
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise InputError(f"{file}: is nested too deep; allowed is a TOML file of {what}") from None
    except ValueError as error:  # also of numbers with too many digits
        raise InputError(f"{file}: got {error}; allowed is a TOML file") from None


def check_keys(where: str, table: Mapping[str, Any], needed: Iterable[str], optional: Iterable[str] = ()) -> None:
    """Raise if a key is missing, or unknown (the nearest one is said)."""
    needed, known = tuple(needed), (*needed, *optional)
    start = f"{where}: " if where else ""
    for key in table:
        if key not in known:
            near = difflib.get_close_matches(key, known, n=1, cutoff=0.6)
            hint = f"did you mean {near[0]!r}? " if near else ""
            raise InputError(f"{start}{key[:80]!r}: unknown; {hint}allowed are {', '.join(known)}")
    for key in needed:
        if key not in table:
            raise InputError(f"{start}{key}: missing; needed are {', '.join(needed)}")


def quoted(name: str, text: str) -> str:
    """A basic string of TOML: JSON's, but that the control character 7F is escaped, too."""
    try:
        text.encode()
    except UnicodeEncodeError:
        raise InputError(f"{name}: has half of a surrogate pair; allowed is text") from None
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def shown(number: float) -> str:
    """A number that reads back as itself."""
    return repr(float(number))

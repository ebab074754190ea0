"""Waivers: known failures that are forgiven until a day, with a reason and a link.

A TOML file has one table for each:

    [[waiver]]
    case = "singlepass_noise_*"     # a pattern of cases
    part = "image"                  # a pattern of parts; left out: all of them
    reason = "the driver reads one texel too far"
    url = "https://example.org/bugs/1"
    expires = 2027-01-31            # the last day that it holds

1. Read and check the file               `read_waivers`
2. Find what a failing part is waived by  `Waiver.covers`
3. Tell which are of no use               `complaints`
"""

import os
import tomllib
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from datetime import date
from fnmatch import fnmatchcase
from typing import Any

from refdof._check import InputError
from refdof._files import as_plain_file

__all__ = ["Waiver", "complaints", "read_waivers"]

_NEEDED = ("case", "reason", "url", "expires")
_LONGEST = 400


@dataclass(frozen=True)
class Waiver:
    """One waiver: patterns of cases and of parts, why, where that is followed up, and the last day that it holds."""

    case: str
    reason: str
    url: str
    expires: date
    part: str = "*"

    def covers(self, case: str, part: str) -> bool:
        """Whether it is about this part of this case, in date or not."""
        return fnmatchcase(case, self.case) and fnmatchcase(part, self.part)

    def holds(self, today: date) -> bool:
        """Whether it is in date."""
        return today <= self.expires

    def words(self) -> str:
        """What it is called in a line."""
        return f"waiver of {self.case}" + ("" if self.part == "*" else f", {self.part}")


def read_waivers(path: str | os.PathLike[str]) -> tuple[Waiver, ...]:
    """Read a file of waivers.

    Raises
    ------
    InputError
        If it cannot be read, or a waiver lacks something or says more than it may.
    """
    plain = as_plain_file("waivers", path)
    try:
        with plain.open("rb") as file:
            content = tomllib.load(file)
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(f"waivers: cannot read {os.fspath(path)!r} ({error}); allowed is a TOML file") from None
    tables = content.get("waiver")
    if set(content) != {"waiver"} or not isinstance(tables, list) or not all(isinstance(one, dict) for one in tables):
        raise InputError("waivers: allowed are tables [[waiver]] and nothing else")
    return tuple(_waiver(number, table) for number, table in enumerate(tables, 1))


def complaints(
    waivers: Iterable[Waiver], used: Collection[Waiver], cases: Collection[str], checked: Collection[str], today: date
) -> list[str]:
    """Lines on waivers that are out of date, that match no case of the pack, or that nothing checked needs."""
    lines = []
    for waiver in waivers:
        if not waiver.holds(today):
            lines.append(f"{waiver.words()}: expired after {waiver.expires}, and is not applied: {waiver.url}")
        elif not any(fnmatchcase(case, waiver.case) for case in cases):
            lines.append(f"{waiver.words()}: matches no case of the pack")
        elif waiver not in used and any(fnmatchcase(case, waiver.case) for case in checked):
            lines.append(f"{waiver.words()}: is not needed, nothing that it covers fails")
    return lines


def _waiver(number: int, table: dict[str, Any]) -> Waiver:
    name = f"waivers, number {number}"
    missing = [key for key in _NEEDED if key not in table]
    if missing:
        raise InputError(f"{name}: lacks {', '.join(missing)}; needed are {', '.join(_NEEDED)}")
    unknown = set(table) - {*_NEEDED, "part"}
    if unknown:
        raise InputError(f"{name}: has {min(unknown)[:80]!r}; allowed are {', '.join((*_NEEDED, 'part'))}")
    words = {key: _line(f"{name}, {key}", table[key]) for key in table if key != "expires"}
    if not words["url"].startswith(("https://", "http://")):
        raise InputError(f"{name}, url: got {words['url']!r}; allowed is a link that starts with https://")
    if type(table["expires"]) is not date:  # a time is a date, too
        got = str(table["expires"])[:80]
        raise InputError(f"{name}, expires: got {got!r}; allowed is a day as 2027-01-31, unquoted")
    return Waiver(expires=table["expires"], **words)


def _line(name: str, value: Any) -> str:
    if not isinstance(value, str) or not value.strip() or not value.isprintable() or len(value) > _LONGEST:
        raise InputError(f"{name}: got {str(value)[:80]!r}; allowed is one line of text")
    return value.strip()

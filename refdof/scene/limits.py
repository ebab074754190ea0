"""Limits of what a scene's files may ask for: a small file can claim more than any machine has."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

from refdof._check import InputError, as_instances, as_number

__all__ = ["Limits", "Meter"]


@dataclass(frozen=True)
class Limits:
    """The most that reading a scene takes. Raise one with `Limits(pixels=1e9)`, or with `--limit pixels=1e9`.

    Parameters
    ----------
    pixels : float
        Of one picture; a larger one is left out with a warning. 8192 x 8192 by default, 805 MB as linear colours.
    total_pixels : float
        Of all pictures of a scene together.
    instances : float
        Nodes, and meshes that are placed.
    triangles : float
        Of the scene, each copy counted.
    bytes : float
        Of one file, and of what is unpacked from one.
    seconds : float
        Reading stops between two meshes, pictures or files when it has taken longer.
    """

    pixels: float = 1 << 26
    total_pixels: float = 1 << 28
    instances: float = 20_000
    triangles: float = 20e6
    bytes: float = 1 << 30
    seconds: float = 600.0

    def __post_init__(self) -> None:
        for field in fields(self):
            object.__setattr__(self, field.name, as_number(field.name, getattr(self, field.name), minimum=1.0))

    def with_words(self, words: Sequence[str]) -> "Limits":
        """The same but for limits given as "name=number", the words of the command line.

        Raises
        ------
        InputError
            If there is no such limit, or its value is no number of at least 1.
        """
        names, found = [field.name for field in fields(self)], {}
        for word in as_instances("limit", words, str):
            name, _, value = word.partition("=")
            try:
                found[name.strip()] = float(value)
            except ValueError:
                raise InputError(f"limit: got {word[:80]!r}; allowed is a name, = and a number: pixels=1e9") from None
            if name.strip() not in names:
                raise InputError(f"limit: got {name.strip()[:80]!r}; allowed are {', '.join(names)}")
        return replace(self, **found)


class Meter:
    """What reading a scene has taken so far, against its limits."""

    def __init__(self, limits: Limits) -> None:
        self.limits = limits
        self._start = time.monotonic()
        self._pixels = self._triangles = self._instances = 0

    def picture(self, width: int, height: int) -> None:
        """Count a picture; one that is too large raises a ValueError, as broken ones do."""
        self.check(width, height)
        self._pixels += width * height

    def check(self, width: int, height: int) -> None:
        """The same without counting it."""
        self.clock()
        name = "pixels" if width * height > self.limits.pixels else "total_pixels"
        most = getattr(self.limits, name)
        if width * height > self.limits.pixels or self._pixels + width * height > most:
            before = f" after {self._pixels} of others" if name == "total_pixels" else ""
            raise ValueError(f"{width} x {height} pixels{before}; allowed are at most {most:.0f}, the limit {name}")

    def triangles(self, count: int) -> None:
        """Count triangles."""
        self.clock()
        self._triangles += count
        _hold("triangles", self._triangles, self.limits.triangles)

    def instances(self, count: int) -> None:
        """Count nodes, or meshes that are placed."""
        self.clock()
        self._instances += count
        _hold("instances", self._instances, self.limits.instances)

    def check_instances(self, count: int) -> None:
        """So many more may be placed."""
        _hold("instances", self._instances + count, self.limits.instances)

    def bytes(self, what: str, count: int) -> None:
        """A file, or what is unpacked from one, has so many bytes."""
        self.clock()
        _hold("bytes", count, self.limits.bytes, f"{what}: ")

    def clock(self) -> None:
        """Time goes by."""
        _hold("seconds", time.monotonic() - self._start, self.limits.seconds)


def _hold(name: str, count: float, most: float, of: str = "") -> None:
    if count > most:
        raise InputError(
            f"{of}it asks for {count:.0f} {name}; at most {most:.0f}, the limit {name!r}, which can be raised"
        )

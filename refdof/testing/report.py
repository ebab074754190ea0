"""Report: which promises hold, and of each other one the smallest picture that breaks it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from refdof.testing.picture import Picture

__all__ = ["Failure", "PropertyError", "Report"]

_MOST_LINES = 8  # pixels that are listed one by one


@dataclass(frozen=True, eq=False)
class Failure:
    """A promise that does not hold.

    Attributes
    ----------
    promise, statement : str
        Its name, and what it says.
    picture : Picture
        The smallest picture found: `color` (H, W, C), `depth` (H, W), `coc` (H, W) px, `camera`, `lens`.
    done : str
        What was done to the picture, or what is compared.
    where : (row, column, channel); of numbers of the whole picture (channel,) or (); None of a broken call
    expected, got : float or None
        There.
    broken : str
        What the call did instead of returning a picture, if it did.
    """

    promise: str
    statement: str
    picture: Picture
    done: str = ""
    where: tuple[int, ...] | None = None
    expected: float | None = None
    got: float | None = None
    broken: str = ""

    @property
    def size(self) -> tuple[int, int]:
        """Height and width of the picture [px]."""
        height, width = self.picture.depth.shape
        return height, width

    @property
    def unlike(self) -> int:
        """How many pixels of the picture are not as most are."""
        return len(self.picture.unlike())

    def __str__(self) -> str:
        height, width = self.size
        if self.broken:
            return f"{self.promise}: the function {self.broken}; on a picture {width} px wide and {height} px high"
        lines = [f"{self.promise}: {self.statement}", f"  picture: {width} px wide, {height} px high"]
        rest = self.picture.unlike()
        most = f"all but {len(rest)}" if rest else "all pixels"
        lines.append(f"    {most}: " + self._pixel(self.picture.usual()))
        lines += [f"    row {y}, column {x}: " + self._pixel((y, x)) for y, x in rest[:_MOST_LINES]]
        if len(rest) > _MOST_LINES:
            lines.append(f"    and {len(rest) - _MOST_LINES} more")
        if self.done:
            lines.append(f"  {self.done}")
        return "\n".join([*lines, f"  {self._place()}: expected {self.expected:.9g}, got {self.got:.9g}"])

    def _pixel(self, place: tuple[int, int]) -> str:
        color = ", ".join(f"{value:g}" for value in self.picture.color[place])
        return f"color ({color}), depth {self.picture.depth[place]:g}, circle {self.picture.coc[place]:g} px"

    def _place(self) -> str:
        where = self.where or ()
        if len(where) == 3:
            return f"row {where[0]}, column {where[1]}, channel {where[2]}"
        return f"channel {where[0]}" if where else "all channels"


@dataclass(frozen=True, eq=False)
class Report:
    """What was found.

    Attributes
    ----------
    tested : {promise: number of pictures}
        All that were checked.
    failures : of those that do not hold, one each
    skipped : promises that were not checked, because the function does not return pictures
    """

    tested: Mapping[str, int]
    failures: Sequence[Failure]
    skipped: Sequence[str] = ()

    @property
    def passed(self) -> bool:
        """Whether all promises hold."""
        return not self.failures

    def __str__(self) -> str:
        failed = {failure.promise for failure in self.failures}
        held = [name for name, pictures in self.tested.items() if name not in failed and pictures]
        silent = [name for name, pictures in self.tested.items() if name not in failed and not pictures]
        lines = [f"{len(held)} of {len(self.tested)} promises hold: {', '.join(held) or 'none'}"]
        if silent:
            lines.append(f"no picture had anything to tell of: {', '.join(silent)}")
        if self.skipped:
            lines.append(f"not checked: {', '.join(self.skipped)}")
        return "\n".join([*lines, *map(str, self.failures)])


class PropertyError(AssertionError):
    """A promise does not hold; `report` says which, and why."""

    def __init__(self, report: Report) -> None:
        super().__init__(str(report))
        self.report = report

    def __reduce__(self) -> tuple[Any, ...]:
        return PropertyError, (self.report,)

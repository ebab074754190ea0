"""The mutation table: what check and diagnosis say of every wrong port, beside the truth."""

from collections.abc import Callable, Iterable
from typing import NamedTuple

from tests.oracle.mutations.row import Row

__all__ = ["Result", "shares", "summary", "table"]


class Result(NamedTuple):
    """What became of a wrong port.

    status: of the check, over all cases; stage and cause: what was named first, "" where nothing was
    """

    row: Row
    status: str
    stage: str
    cause: str
    seconds: float  # of a processor

    @property
    def caught(self) -> bool:
        """The check has not passed it."""
        return self.status in ("fail", "error")

    @property
    def drawn(self) -> bool:
        """There were pictures: else the check's own line is all that can be said."""
        return self.row.cause != "error"

    @property
    def right_stage(self) -> bool:
        """The blamed stage is the true one."""
        return self.stage == self.row.stage

    @property
    def right_cause(self) -> bool:
        """The named cause is the true one."""
        return self.cause in self.row.cause.split(" or ")


def shares(results: Iterable[Result]) -> tuple[float, float]:
    """Of the ports with pictures, how many have the right stage and how many the right cause named: 0 .. 1."""
    drawn = [result for result in results if result.drawn]

    def share(is_right: Callable[[Result], bool]) -> float:
        return sum(map(is_right, drawn)) / len(drawn)

    return share(lambda result: result.right_stage), share(lambda result: result.right_cause)


def summary(results: list[Result]) -> str:
    """One line."""
    stage, cause = shares(results)
    caught = sum(result.caught for result in results)
    honest = sum(result.right_cause and result.cause == "unexplained" for result in results)
    return (
        f"{caught} of {len(results)} wrong ports are caught. Of those that give a picture, {stage:.0%} are blamed on "
        f"the right stage and {cause:.0%} have the right cause named first, {honest} of them rightly as unexplained."
    )


def table(results: list[Result]) -> str:
    """The table in Markdown."""
    lines = ["| port | fault | check | stage | named cause | right? | CPU s |", "|---|---|---|---|---|---|---|"]
    for result in results:
        row = result.row
        cells = (
            row.port,
            row.name,
            result.status,
            result.stage,
            result.cause,
            _verdict(result),
            f"{result.seconds:.1f}",
        )
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def _verdict(result: Result) -> str:
    """Whether the named stage and cause are right, and what is."""
    if not result.drawn:
        return "no picture"
    if result.right_cause:
        return "yes" if result.right_stage else f"yes; the stage is {result.row.stage}"
    return f"no: {result.row.cause}, {result.row.stage}"

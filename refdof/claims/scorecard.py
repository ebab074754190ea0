"""Scorecard: claims held against what is measured."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from refdof.claims.bench import Bench
from refdof.claims.measures import MEASURES
from refdof.claims.statement import Claim
from refdof.claims.verdict import Figure, rounded, verdict_of
from refdof.report.rows import plain

__all__ = ["Row", "kind_of", "row_of", "scorecard"]


@dataclass(frozen=True)
class Row:
    """A claim with our figure, None where nothing measures it, and the verdict that follows from the two."""

    claim: Claim
    figure: Figure
    verdict: str

    @property
    def why(self) -> str:
        """One sentence on the verdict."""
        return self.claim.sentence(self.verdict)

    @property
    def ours(self) -> str:
        """The figure and its unit, as they are shown."""
        if self.figure is None:
            return ""
        digits = self.claim.digits
        if isinstance(self.figure, Mapping):
            words = ", ".join(f"{name} {value:.{digits}g}" for name, value in self.figure.items())
        else:
            words = f"{self.figure:.{digits}g}"
        return f"{words} {self.claim.unit}".strip()

    def as_json(self) -> dict[str, Any]:
        """Strings, numbers and null only."""
        claim = self.claim
        return {
            "id": claim.name,
            "source": claim.source,
            "place": claim.place,
            "says": claim.says,
            "printed": claim.printed,
            "measure": claim.measure,
            "kind": kind_of(claim),
            "setting": claim.setting,
            "rule": claim.rule.in_words(),
            "tolerance": claim.tolerance,
            "ours": plain(self.figure),
            "unit": claim.unit,
            "verdict": self.verdict,
            "why": self.why,
        }


def kind_of(claim: Claim) -> str:
    """The kind of its measure, "" without one."""
    return MEASURES[claim.measure].kind if claim.measure else ""


def row_of(claim: Claim, figure: Figure) -> Row:
    """A claim with a figure."""
    shown = rounded(figure, claim.digits)
    return Row(claim, shown, verdict_of(claim.rule, shown))


def scorecard(claims: Sequence[Claim], tell: Callable[[str, int, int], None] | None = None) -> list[Row]:
    """Measure claims, in their order; those of times last, when all else is made.

    Parameters
    ----------
    claims : of `refdof.claims.statement.claims`
    tell : callable, optional
        Called with (what, done, all).
    """
    say = tell or (lambda _what, _done, _all: None)
    order = sorted(range(len(claims)), key=lambda k: kind_of(claims[k]) == "time")
    rows: dict[int, Row] = {}
    bench = Bench()
    for done, k in enumerate(order):
        claim = claims[k]

        def step(what: str, done: int = done, name: str = claim.name) -> None:
            say(f"{name}: {what}", done, len(claims))

        bench.tell = step
        step("measuring")
        figure = MEASURES[claim.measure].function(bench, **claim.arguments) if claim.measure else None
        rows[k] = row_of(claim, figure)
    return [rows[k] for k in range(len(claims))]

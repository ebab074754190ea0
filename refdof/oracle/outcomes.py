"""Outcomes: what came of the cases of a check, for people and for programs."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from refdof.oracle.isolation import INHERITED, OWN
from refdof.oracle.verdict import FAIL, PASS, WAIVED, WARNING, Finding

__all__ = ["ERROR", "NOT_SUPPORTED", "REPORT_SCHEMA", "STATUSES", "Outcome", "Report", "sentence"]

NOT_SUPPORTED, ERROR = "not supported", "error"
STATUSES = (PASS, WARNING, WAIVED, FAIL, NOT_SUPPORTED, ERROR)
REPORT_SCHEMA = "refdof-check-1"


@dataclass(frozen=True)
class Outcome:
    """What came of one case.

    Attributes
    ----------
    case, status : str
    message : str
        One line: the part that is wrong first and its worst pixel, or why there is none.
    seconds : float
        Of the implementation.
    findings : {part: Finding}
        Cumulative: each stage and the image, as they came, beside the golden ones; in the order of making.
    isolated : {part: Finding or None}
        The same beside what a right port makes of this one's earlier parts, for parts with an earlier one that is
        off; None where that cannot be told. Of all other parts it is the cumulative finding.
    causes : {part: "own", "inherited" or "unknown"}
        Why each part that is off is so.
    waived : names of parts whose failure is waived
    """

    case: str
    status: str
    message: str
    seconds: float
    findings: dict[str, Finding] = field(default_factory=dict)
    isolated: dict[str, Finding | None] = field(default_factory=dict)
    causes: dict[str, str] = field(default_factory=dict)
    waived: tuple[str, ...] = ()

    @property
    def first_wrong(self) -> str | None:
        """The first part with an error of its own: where to look."""
        return next((part for part, cause in self.causes.items() if cause == OWN), None)

    def own(self, part: str) -> Finding | None:
        """A part's isolated finding; None if it cannot be told."""
        return self.isolated.get(part, self.findings[part])


@dataclass(frozen=True)
class Report:
    """All outcomes, in the order of the pack, and lines of warning."""

    outcomes: tuple[Outcome, ...]
    warnings: tuple[str, ...] = ()

    @property
    def passed(self) -> bool:
        """True if at least one case was compared and is right, and none failed or ended in an error."""
        statuses = {outcome.status for outcome in self.outcomes}
        return bool(statuses & {PASS, WARNING}) and not statuses & {FAIL, ERROR}

    def counts(self) -> dict[str, int]:
        """How many cases have each status."""
        return {status: sum(outcome.status == status for outcome in self.outcomes) for status in STATUSES}

    def as_json(self) -> dict[str, Any]:
        """Plain data, as `refdof check --json` writes it; a number that is none is null."""
        return {
            "schema": REPORT_SCHEMA,
            "passed": self.passed,
            "counts": self.counts(),
            "warnings": list(self.warnings),
            "cases": [_case_as_json(outcome) for outcome in self.outcomes],
        }


def sentence(findings: Mapping[str, Finding], causes: Mapping[str, str]) -> str:
    """One line on the parts of a case: the one to look at, its worst pixel, and what inherits from it."""
    if not causes:
        part = max(findings, key=lambda name: findings[name].worst)
        return f"{part}: {findings[part].words()}"
    first = next((part for part, cause in causes.items() if cause == OWN), next(iter(causes)))
    heirs = [part for part, cause in causes.items() if cause == INHERITED]
    others = [part for part, cause in causes.items() if part != first and part not in heirs]
    more = f"; inherited by {', '.join(heirs)}" if heirs else ""
    more += f"; also off: {', '.join(others)}" if others else ""
    return f"{first}: {findings[first].words()}{more}"


def _case_as_json(outcome: Outcome) -> dict[str, Any]:
    return {
        "case": outcome.case,
        "status": outcome.status,
        "message": outcome.message,
        "seconds": _plain(outcome.seconds),
        "first_wrong": outcome.first_wrong,
        "parts": {
            part: {
                "cause": outcome.causes.get(part),
                "waived": part in outcome.waived,
                "cumulative": _finding_as_json(finding),
                "isolated": _finding_as_json(outcome.own(part)),
            }
            for part, finding in outcome.findings.items()
        },
    }


def _finding_as_json(finding: Finding | None) -> dict[str, Any] | None:
    return None if finding is None else _plain({**asdict(finding), "words": finding.words()})


def _plain(value: Any) -> Any:
    """Data that JSON can hold."""
    if isinstance(value, dict):
        return {key: _plain(part) for key, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(part) for part in value]
    return None if isinstance(value, float) and not abs(value) < float("inf") else value

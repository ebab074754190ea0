"""JUnit's XML of a check, which CI systems show."""

from xml.etree import ElementTree

from refdof.oracle.outcomes import ERROR, NOT_SUPPORTED, Outcome, Report
from refdof.oracle.verdict import FAIL, WAIVED

__all__ = ["junit"]

_ELEMENTS = {FAIL: "failure", ERROR: "error", NOT_SUPPORTED: "skipped", WAIVED: "skipped"}


def junit(report: Report) -> str:
    """One test case for each case of the pack, with a line a part; quality warnings pass and say so."""
    counts = report.counts()
    suite = ElementTree.Element(
        "testsuite",
        name="refdof",
        tests=str(len(report.outcomes)),
        failures=str(counts[FAIL]),
        errors=str(counts[ERROR]),
        skipped=str(counts[NOT_SUPPORTED] + counts[WAIVED]),
    )
    for outcome in report.outcomes:
        case = ElementTree.SubElement(suite, "testcase", name=outcome.case, time=f"{outcome.seconds:.3f}")
        parts = "\n".join(_line(outcome, part) for part in outcome.findings)
        if outcome.status in _ELEMENTS:
            element = ElementTree.SubElement(case, _ELEMENTS[outcome.status], message=_plain(outcome.message))
            element.text = parts or None
        else:
            said = _plain(f"{outcome.status}: {outcome.message}")
            ElementTree.SubElement(case, "system-out").text = f"{said}\n{parts}"
    if report.warnings:
        ElementTree.SubElement(suite, "system-err").text = "\n".join(map(_plain, report.warnings))
    return ElementTree.tostring(suite, encoding="unicode", xml_declaration=True) + "\n"


def _line(outcome: Outcome, part: str) -> str:
    """Cumulative and isolated status of a part, and its worst pixel."""
    own = outcome.own(part)
    statuses = f"cumulative {outcome.findings[part].status}, isolated {'unknown' if own is None else own.status}"
    cause = f", {outcome.causes[part]}" if part in outcome.causes else ""
    return f"{part}: {statuses}{cause}: {outcome.findings[part].words()}"


def _plain(text: str) -> str:
    return "".join(letter if letter.isprintable() else "?" for letter in text)

"""JUnit's XML of a check, which CI systems show."""

from xml.etree import ElementTree

from refdof.oracle.checking import ERROR, NOT_SUPPORTED, Report
from refdof.oracle.verdict import FAIL

__all__ = ["junit"]

_ELEMENTS = {FAIL: "failure", ERROR: "error", NOT_SUPPORTED: "skipped"}


def junit(report: Report) -> str:
    """One test case for each case of the pack; quality warnings pass and say so."""
    counts = report.counts()
    suite = ElementTree.Element(
        "testsuite",
        name="refdof",
        tests=str(len(report.outcomes)),
        failures=str(counts[FAIL]),
        errors=str(counts[ERROR]),
        skipped=str(counts[NOT_SUPPORTED]),
    )
    for outcome in report.outcomes:
        case = ElementTree.SubElement(suite, "testcase", name=outcome.case, time=f"{outcome.seconds:.3f}")
        message = "".join(letter if letter.isprintable() else "?" for letter in outcome.message)
        if outcome.status in _ELEMENTS:
            ElementTree.SubElement(case, _ELEMENTS[outcome.status], message=message)
        else:
            ElementTree.SubElement(case, "system-out").text = f"{outcome.status}: {message}"
    return ElementTree.tostring(suite, encoding="unicode", xml_declaration=True) + "\n"

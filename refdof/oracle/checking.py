"""Check: run an implementation over the cases of a pack, and judge every picture and stage that it gives.

1. Open the pack, and read what a case holds          `refdof.oracle.files`
2. Let the implementation make its results            `refdof.oracle.sources`
3. Compare picture and stages with their bounds       `refdof.oracle.verdict`
4. Sum up                                             `Report`
"""

import os
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from refdof._check import InputError, as_number
from refdof.oracle.files import FileFault, Pack, open_pack
from refdof.oracle.goldens import Tolerance
from refdof.oracle.shaders import of_shader
from refdof.oracle.sources import NotSupported, Source, Task, of_command, of_folder, of_function
from refdof.oracle.verdict import FAIL, PASS, WARNING, Finding, judge

__all__ = [
    "ERROR",
    "NOT_SUPPORTED",
    "STATUSES",
    "Outcome",
    "Report",
    "check",
    "check_command",
    "check_results",
    "check_shader",
]

NOT_SUPPORTED, ERROR = "not supported", "error"
STATUSES = (PASS, WARNING, FAIL, NOT_SUPPORTED, ERROR)
TIMEOUT_S = 60.0

Tell = Callable[["Outcome", int, int], None]


@dataclass(frozen=True)
class Outcome:
    """What came of one case.

    Attributes
    ----------
    case, status : str
    message : str
        One line: the worst pixel, or why there is none.
    seconds : float
        Of the implementation.
    findings : {"image" or stage: Finding}
    """

    case: str
    status: str
    message: str
    seconds: float
    findings: dict[str, Finding] = field(default_factory=dict)


@dataclass(frozen=True)
class Report:
    """All outcomes, in the order of the pack."""

    outcomes: tuple[Outcome, ...]

    @property
    def passed(self) -> bool:
        """True if at least one case was compared, and none failed or ended in an error."""
        statuses = {outcome.status for outcome in self.outcomes}
        return bool(statuses & {PASS, WARNING}) and not statuses & {FAIL, ERROR}

    def counts(self) -> dict[str, int]:
        """How many cases have each status."""
        return {status: sum(outcome.status == status for outcome in self.outcomes) for status in STATUSES}

    def as_json(self) -> dict[str, Any]:
        """Plain data, as `refdof check --json` writes it; a number that is none is null."""
        return {
            "schema": "refdof-check-1",
            "passed": self.passed,
            "counts": self.counts(),
            "cases": [_plain(asdict(outcome)) for outcome in self.outcomes],
        }


def check(function: Callable[..., Any], pack: str | os.PathLike[str], tell: Tell | None = None) -> Report:
    """Check a Python function against a pack.

    Parameters
    ----------
    function : (color, depth, coc, params) -> image
        color (H, W, 3), depth (H, W) and coc (H, W) float32, rows as the case has them; params, a dict, holds what
        `params.txt` does under "params". It returns (H, W, 3), or a dict of "image" and stages. It may raise
        NotImplementedError for a case that it does not do.
    pack : path
        A folder that `refdof golden` has written.
    tell : callable, optional
        Called with each outcome, its number and the number of cases.

    Raises
    ------
    InputError
        If the function is none, or the pack is not as it was written.
    """
    if not callable(function):
        raise InputError(f"function: got {type(function).__name__}; allowed is a function")
    return _check(open_pack(pack), of_function(function), tell)


def check_command(
    command: str, pack: str | os.PathLike[str], timeout: float = TIMEOUT_S, tell: Tell | None = None
) -> Report:
    """Check a program: a command with {case} and {out} in it, which are folders. See `check`.

    It writes image.f32 or image.npy into {out}. Status 77 says that it does not do the case. After `timeout` seconds it
    is ended, with all that it started.
    """
    timeout = as_number("timeout", timeout, above=0.0)
    return _check(open_pack(pack), of_command(command, timeout), tell)


def check_results(folder: str | os.PathLike[str], pack: str | os.PathLike[str], tell: Tell | None = None) -> Report:
    """Check files made elsewhere: one folder for each case of the pack. See `check`."""
    return _check(open_pack(pack), of_folder(Path(folder)), tell)


def check_shader(
    file: str | os.PathLike[str],
    pack: str | os.PathLike[str],
    bindings: str | os.PathLike[str] | None = None,
    timeout: float = TIMEOUT_S,
    tell: Tell | None = None,
) -> Report:
    """Check a fragment shader in GLSL or WGSL, without a host: see `refdof.oracle.shaders.of_shader` and `check`.

    Cases whose parameters the shader holds as constants are not supported. A shader that does not compile, or reads
    what nothing binds, raises InputError.
    """
    opened = open_pack(pack)
    with of_shader(file, bindings, timeout) as source:
        return _check(opened, source, tell)


def _check(pack: Pack, source: Source, tell: Tell | None) -> Report:
    if not pack.cases:
        raise InputError("pack: holds no case; allowed are one or more")
    outcomes = []
    for name in pack.cases:
        outcome = _check_case(pack, name, source)
        outcomes.append(outcome)
        if tell is not None:
            tell(outcome, len(outcomes), len(pack.cases))
    return Report(tuple(outcomes))


def _check_case(pack: Pack, name: str, source: Source) -> Outcome:
    began = time.perf_counter()
    try:
        task, expected = _task(pack, name)
        began = time.perf_counter()
        results = source(task)
        seconds = time.perf_counter() - began
        findings = {part: judge(values, *_bounds(pack, name, expected[part])) for part, values in results.items()}
    except NotSupported as reason:
        return Outcome(name, NOT_SUPPORTED, str(reason) or "the implementation says so", time.perf_counter() - began)
    except FileFault as fault:
        return Outcome(name, ERROR, str(fault), time.perf_counter() - began)
    status = max((finding.status for finding in findings.values()), key=STATUSES.index)
    first = next(part for part, finding in findings.items() if finding.status == status)
    return Outcome(name, status, f"{first}: {findings[first].words()}", seconds, findings)


def _task(pack: Pack, name: str) -> tuple[Task, dict[str, dict[str, Any]]]:
    """The case as an implementation gets it, and what is expected, by name."""
    about = pack.description(name)
    try:
        width, height = (int(side) for side in about["size"])
        expected = {"image": about["expected"]["image"], **about["expected"]["stages"]}
        shapes = {part: tuple(int(side) for side in entry["shape"]) for part, entry in expected.items()}
        paths = [about["inputs"][part]["npy"] for part in ("color", "depth", "coc")]
        params = dict(about["params"])
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise FileFault(f"case.json: lacks or garbles {error}") from None
    sizes = ((height, width, 3), (height, width), (height, width))
    color, depth, coc = (pack.array(name, path, size) for path, size in zip(paths, sizes, strict=True))
    return Task(name, pack.folder / "cases" / name, (color, depth, coc), params, shapes), expected


def _bounds(pack: Pack, name: str, entry: dict[str, Any]) -> tuple[Any, Any, Tolerance]:
    """Least and greatest values and the tolerance of an expected array."""
    try:
        shape = tuple(int(side) for side in entry["shape"])
        low, high = (entry.get(part, entry["npy"]) for part in ("low", "high"))
        tolerance = Tolerance(**entry["tolerance"])
    except (KeyError, TypeError, ValueError) as error:
        raise FileFault(f"case.json: lacks or garbles {error}") from None
    return pack.array(name, low, shape), pack.array(name, high, shape), tolerance


def _plain(value: Any) -> Any:
    """Data that JSON can hold."""
    if isinstance(value, dict):
        return {key: _plain(part) for key, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(part) for part in value]
    return None if isinstance(value, float) and not abs(value) < float("inf") else value

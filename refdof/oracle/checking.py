"""Check: run an implementation over the cases of a pack, and judge every picture and stage that it gives.

1. Open the pack, and choose cases                     `refdof.oracle.files.open_pack`, `refdof.oracle.selection.select`
2. Read a case, then let the implementation run        `refdof.oracle.expectation`, `refdof.oracle.sources`
3. Compare its parts with their bounds                 `refdof.oracle.verdict.judge`
4. Tell own errors from inherited ones                 `refdof.oracle.isolation`
5. Forgive what is waived, and sum up                  `refdof.oracle.waivers`, `refdof.oracle.outcomes`
"""

import os
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from refdof._check import Float, InputError, as_choice, as_instance, as_number
from refdof.oracle.expectation import Expectation, Part, expectation_of, words_of
from refdof.oracle.files import FileFault, Pack, open_pack
from refdof.oracle.isolation import causes_of, follow
from refdof.oracle.outcomes import ERROR, NOT_SUPPORTED, STATUSES, Outcome, Report, sentence
from refdof.oracle.selection import Plan, select
from refdof.oracle.shaders import of_shader
from refdof.oracle.sources import NotSupported, Source, of_command, of_folder, of_function
from refdof.oracle.verdict import FAIL, PASS, WAIVED, Finding, judge
from refdof.oracle.waivers import complaints
from refdof.report.text import one_line

__all__ = [
    "ERROR", "NOT_SUPPORTED", "STATUSES", "TIMEOUT_S", "Outcome", "Report", "Show", "check", "check_command",
    "check_results", "check_shader", "check_source",
]  # fmt: skip

TIMEOUT_S = 60.0

Tell = Callable[[Outcome, int, int], None]
Show = Callable[[str, str, Float, Part], None]


def check(
    function: Callable[..., Any], pack: str | os.PathLike[str], tell: Tell | None = None, plan: Plan = Plan()
) -> Report:
    """Check a Python function against a pack.

    Parameters
    ----------
    function : (color, depth, coc, params) -> image
        color (H, W, 3), depth (H, W) and coc (H, W) float32, rows as the case has them; params, a dict, holds what
        `case.json` does under "params". It returns (H, W, 3), or a dict of "image" and stages. It may raise
        NotImplementedError for a case that it does not do.
    pack : path
        A folder that `refdof golden` has written.
    tell : callable, optional
        Called with each outcome, its number and the number of cases.
    plan : Plan
        Which cases, what is waived and what is not supported.

    Raises
    ------
    InputError
        If the function is none, the pack is not as it was written, or the plan does not fit it.
    """
    if not callable(function):
        raise InputError(f"function: got {type(function).__name__}; allowed is a function")
    return check_source(of_function(function), pack, tell, plan)


def check_command(
    command: str,
    pack: str | os.PathLike[str],
    timeout: float = TIMEOUT_S,
    tell: Tell | None = None,
    plan: Plan = Plan(),
) -> Report:
    """Check a program: a command with {case} and {out} in it, which are folders. See `check`.

    It writes image.f32 or image.npy into {out}. Status 77 says that it does not do the case. After `timeout` seconds it
    is ended, with all of its process group.
    """
    timeout = as_number("timeout", timeout, above=0.0)
    return check_source(of_command(command, timeout), pack, tell, plan)


def check_results(
    folder: str | os.PathLike[str], pack: str | os.PathLike[str], tell: Tell | None = None, plan: Plan = Plan()
) -> Report:
    """Check files made elsewhere: one folder for each case of the pack. See `check`."""
    if as_instance("plan", plan, Plan).given:
        raise InputError("given: got stages with files made elsewhere; allowed is an implementation that is run")
    return check_source(of_folder(Path(folder)), pack, tell, plan)


def check_shader(
    file: str | os.PathLike[str],
    pack: str | os.PathLike[str],
    bindings: str | os.PathLike[str] | None = None,
    timeout: float = TIMEOUT_S,
    tell: Tell | None = None,
    plan: Plan = Plan(),
) -> Report:
    """Check a fragment shader in GLSL or WGSL, without a host: see `refdof.oracle.shaders.of_shader` and `check`.

    Cases whose parameters the shader holds as constants are not supported. A shader that does not compile, or reads
    what nothing binds, raises InputError.
    """
    if as_instance("plan", plan, Plan).given:
        raise InputError("given: got stages with a shader; allowed is a function or a command")
    with of_shader(file, bindings, timeout) as source:
        return check_source(source, pack, tell, plan)


def check_source(
    source: Source,
    pack: str | os.PathLike[str],
    tell: Tell | None = None,
    plan: Plan = Plan(),
    show: Show | None = None,
) -> Report:
    """Check a source of results. See `check`.

    show : callable, optional
        Called with case, part, what came and what was expected, for every part that is off.
    """
    plan, opened = as_instance("plan", plan, Plan), open_pack(pack)
    if not opened.cases:
        raise InputError("pack: holds no case; allowed are one or more")
    chosen = select(opened.cases, plan)
    _check_words(opened, plan)
    outcomes: list[Outcome] = []
    for name in chosen:
        outcome = _check_case(opened, name, source, plan, show)
        outcomes.append(outcome)
        if tell is not None:
            tell(outcome, len(outcomes), len(chosen))
    used = [w for w in plan.waivers if any(w.covers(o.case, part) for o in outcomes for part in o.waived)]
    return Report(tuple(outcomes), tuple(complaints(plan.waivers, used, opened.cases, chosen, plan.today)))


def _check_words(pack: Pack, plan: Plan) -> None:
    """Raise if the plan names what no case has, as a misspelt tag."""
    if plan.not_supported or plan.given:
        tags, stages = words_of(pack)
        for tag in plan.not_supported:
            as_choice("not_supported", tag, sorted(tags))
        for stage in plan.given:
            as_choice("given", stage, sorted(stages))


def _check_case(pack: Pack, name: str, source: Source, plan: Plan, show: Show | None) -> Outcome:
    began = time.perf_counter()
    try:
        case = expectation_of(pack, name)
        lacking = [tag for tag in plan.not_supported if tag in case.about["tags"]]
        if lacking:
            return Outcome(name, NOT_SUPPORTED, f"tagged {', '.join(lacking)}", 0.0)
    except FileFault as fault:
        return Outcome(name, ERROR, one_line(str(fault)), 0.0)
    try:
        began = time.perf_counter()
        results = source(case.task)
        seconds = time.perf_counter() - began
        spoiled = pack.fault(name)
        if spoiled is not None:
            raise FileFault(f"the implementation has changed the pack: {spoiled}")
        findings = {part: _judged(results[part], one) for part, one in case.parts.items() if part in results}
        isolated = _isolated(case, source, results, findings, plan)
    except NotSupported as reason:
        message = one_line(str(reason)) or "the implementation says so"
        return Outcome(name, NOT_SUPPORTED, message, time.perf_counter() - began)
    except FileFault as fault:
        return _forgiven(Outcome(name, ERROR, one_line(str(fault)), time.perf_counter() - began), plan)
    causes = causes_of(findings, isolated)
    if show is not None:
        for part in causes:
            show(name, part, results[part], case.parts[part])
    status = max((finding.status for finding in findings.values()), key=STATUSES.index)
    return _forgiven(Outcome(name, status, sentence(findings, causes), seconds, findings, isolated, causes), plan)


def _judged(values: Float, part: Part) -> Finding:
    return judge(values, part.low, part.high, part.tolerance)


def _isolated(
    case: Expectation, source: Source, results: Mapping[str, Float], findings: Mapping[str, Finding], plan: Plan
) -> dict[str, Finding | None]:
    """Isolated findings of the parts that have an earlier one that is off: by the implementation itself if it can."""
    isolated: dict[str, Finding | None] = {}
    off: list[str] = []
    again = _run_isolated(case, source, findings, plan)
    for part in findings:
        if off and part in again and part not in plan.given and set(off) <= set(plan.given):
            isolated[part] = _judged(again[part], case.parts[part])
        elif off:
            earlier = {name: results[name] for name in list(findings)[: list(findings).index(part)]}
            made = follow(case.about, part, case.task.images, earlier)
            isolated[part] = made and judge(results[part], *made, case.parts[part].tolerance)
        if findings[part].status != PASS:
            off.append(part)
    return isolated


def _run_isolated(
    case: Expectation, source: Source, findings: Mapping[str, Finding], plan: Plan
) -> Mapping[str, Float]:
    """Results of the implementation with golden stages, if it takes some and is not right without."""
    given = {part: case.parts[part].values for part in plan.given if part in case.parts}
    if not given or all(finding.status == PASS for finding in findings.values()):
        return {}
    try:
        return source(case.task._replace(given=given))
    except NotSupported:
        return {}


def _forgiven(outcome: Outcome, plan: Plan) -> Outcome:
    """The outcome with its waivers; those of an error are the image's."""
    failing = [part for part, finding in outcome.findings.items() if finding.status == FAIL]
    if outcome.status == ERROR:
        failing = ["image"]
    reasons, waived, expired = [], [], []
    for part in failing:
        about = [waiver for waiver in plan.waivers if waiver.covers(outcome.case, part)]
        holding = [waiver for waiver in about if waiver.holds(plan.today)]
        if holding:
            waived.append(part)
            reasons.append(f"{holding[0].reason} ({holding[0].url})")
        expired += [f"{waiver.words()} expired after {waiver.expires}" for waiver in about if waiver not in holding]
    message = outcome.message
    status = WAIVED if failing and len(waived) == len(failing) else outcome.status
    if status == WAIVED:
        message = f"{'; '.join(dict.fromkeys(reasons))}: {message}"
    elif expired:
        message = f"{message}; {'; '.join(dict.fromkeys(expired))}"
    return Outcome(
        outcome.case, status, message, outcome.seconds, outcome.findings, outcome.isolated, outcome.causes,
        tuple(waived),
    )  # fmt: skip

"""Check: the properties of a user's filter.

1. Search a picture on which a promise does not hold     `refdof.testing.search`
2. Take away what is not needed                          `refdof.testing.shrink`
3. Say what was expected, what came, and where           `refdof.testing.report`
"""

from collections.abc import Callable, Sequence
from typing import Any

from refdof._check import InputError, as_choice, as_function, as_instances, as_integer, as_number
from refdof.testing.compared import Compared, Room
from refdof.testing.filter import INPUTS, BrokenCall, Filter
from refdof.testing.picture import Case, circles_up_to
from refdof.testing.promises import PROMISES, chosen
from refdof.testing.properties import PROPERTIES
from refdof.testing.report import Failure, PropertyError, Report
from refdof.testing.shrink import smallest

__all__ = ["check_properties"]


def check_properties(
    function: Callable[..., Any],
    promises: Sequence[str] | None = None,
    *,
    inputs: Sequence[str] = ("color", "depth", "coc"),
    channels: int = 3,
    tolerance: float = 1e-5,
    reach: float = 5.0,
    circle: float = 2.0,
    examples: int = 50,
) -> Report:
    """Check what a filter promises, on many small pictures. Every call checks the same ones.

    Parameters
    ----------
    function : callable
        Takes the `inputs`, by place, and returns the blurred picture, an array of floats of the shape of `color`.
    promises : names in `PROMISES`
        None: all.
    inputs : words, in the order of the function's arguments
        "color": (H, W, C) float32, linear; row 0 is the top row. "depth": (H, W) float32, planar, > 0; inf is
        background. "coc": (H, W) float32, signed circle of confusion, a **radius** [px], negative in front of the focal
        plane. "camera": a `refdof.Camera` of the picture's size. "lens": a `refdof.ThinLens`.
    channels : int
        3, or 4 with alpha, which is treated as the others are.
    tolerance : float
        Of the brightest value. The default allows for sums of some hundred float32 numbers; half floats need 2e-3.
    reach : float
        How far blurs spread, in radii of the largest circle. A disc has 1; the default has room for pyramids.
    circle : float
        The largest circle of confusion [px]. Pictures grow with `reach` times `circle`.
    examples : int
        Pictures for each promise, at most.

    Returns
    -------
    Report
        If all hold.

    Raises
    ------
    PropertyError
        If one does not; its `report` has the smallest picture found for each. It is an AssertionError.
    InputError
        If an argument is not allowed, or hypothesis is not installed.
    """
    __tracebackhide__ = True  # pytest shows the caller's line
    if as_function("function", function) is None:
        raise InputError("function: got None; allowed is a function")
    run = Filter(function, _as_inputs(inputs))
    names = chosen(promises)
    channels = as_integer("channels", channels, minimum=3, maximum=4)
    room = Room(
        as_number("tolerance", tolerance, minimum=0.0, maximum=1.0),
        as_number("reach", reach, minimum=0.0, maximum=16.0),
    )
    circle = as_number("circle", circle, minimum=0.25, maximum=16.0)
    examples = as_integer("examples", examples, minimum=1, maximum=100_000)
    tested: dict[str, int] = {}
    failures: list[Failure] = []
    for name in names:
        tested[name], failure = _check(name, run, room, circle, channels, examples)
        if failure is not None:
            failures.append(failure)
            if failure.broken and name != "nan":
                break  # the others would say the same
    report = Report(tested, failures, names[len(tested) :])
    if not report.passed:
        raise PropertyError(report)
    return report


def _as_inputs(inputs: Any) -> tuple[str, ...]:
    names = tuple(as_choice("inputs", name, INPUTS) for name in as_instances("inputs", inputs, str))
    if "color" not in names:
        raise InputError(f"inputs: got {', '.join(names) or 'none'}; allowed are words with color among them")
    return names


def _check(
    name: str, run: Filter, room: Room, circle: float, channels: int, examples: int
) -> tuple[int, Failure | None]:
    """How many pictures told something of a promise, and the smallest that breaks it."""
    try:
        from refdof.testing.search import Flaky, search
    except ImportError as error:
        raise InputError(
            f"function: got one without hypothesis ({error}); allowed after: pip install 'refdof[testing]'"
        ) from None
    prop = PROPERTIES[name]
    told = 0
    last: list[Case] = []

    def judged(case: Case) -> Compared | str | None:
        """What was compared, if it differs by too much; what the call did instead of returning a picture; or None."""
        nonlocal told
        try:
            compared = prop.check(run, case, room)
        except BrokenCall as error:
            return str(error)
        told += compared is not None
        return compared if compared is not None and compared.worst() is not None else None

    def fails(case: Case) -> bool:
        bad = judged(case) is not None
        if bad:
            last[:] = [case]
        return bad

    try:
        case = search(prop, fails, room, circle, channels, examples)
    except Flaky:
        return told, _broken(name, last[0], "returned two results for one picture; allowed is always the same one")
    if case is None:
        return told, None
    case = smallest(case, fails, circles_up_to(circle))
    found = judged(case)
    if not isinstance(found, Compared):
        return told, _broken(
            name, case, found or "returned two results for one picture; allowed is always the same one"
        )
    where = found.worst() or ()
    return told, Failure(
        name,
        PROMISES[name],
        case.picture,
        found.said,
        where,
        float(found.expected[where]),
        float(found.got[where]),
    )


def _broken(name: str, case: Case, what: str) -> Failure:
    return Failure(name, PROMISES[name], case.picture, broken=what)

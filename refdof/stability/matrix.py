"""The matrix: every case with every method, a cell each."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from refdof._check import InputError
from refdof.methods import METHODS
from refdof.stability.cases import CASES
from refdof.stability.cases.case import Case
from refdof.stability.checks import Check, finite, one_precision
from refdof.stability.degraded import DEGRADED, Documented
from refdof.stability.run import ROOM, Run, first_stage
from refdof.stability.verdict import BROKEN, NOT_APPLICABLE, PASS, Cell, Figure, verdict_of
from refdof.stability.verdict import DEGRADED as DEGRADED_VERDICT
from refdof.view import View

__all__ = ["cell_of", "matrix"]


def matrix(
    methods: Sequence[str] | None = None,
    cases: Sequence[Case] | None = None,
    tell: Callable[[str, int, int], None] | None = None,
) -> list[Cell]:
    """Cells of all cases, each with all methods; before each `tell` is called with ("case, method", done, all)."""
    chosen = list(METHODS) if methods is None else list(methods)
    rows = CASES if cases is None else cases
    cells: list[Cell] = []
    for case in rows:
        view = _seen(case)
        for method in chosen:
            if tell is not None:
                tell(f"{case.name}, {method}", len(cells), len(rows) * len(chosen))
            cells.append(cell_of(case, method, view))
    return cells


def _seen(case: Case) -> View | InputError:
    try:
        return case.view()
    except InputError as error:
        return error


def cell_of(case: Case, method: str, view: View | InputError) -> Cell:
    """What one method does with a case's view, or with the error that kept it from being made."""
    if method in case.skip:
        return Cell(case.name, method, NOT_APPLICABLE, case.skip[method])
    wanted = case.refusal(method)
    try:
        with np.errstate(all="ignore"):
            found = _measured(case, Run(method, _viewed(view), case.params.get(method, {})))
    except InputError as error:
        told = " ".join(str(error).split())
        if wanted and told.startswith(wanted):
            return Cell(case.name, method, PASS, f"refused: {told}")
        return Cell(case.name, method, BROKEN, f"refused, but should not be: {told}")
    except Exception as error:  # a crash is a finding, not the end of the matrix
        return Cell(case.name, method, BROKEN, f"raised {type(error).__name__}: {error}")
    if wanted:
        return found._replace(verdict=BROKEN, note=f"should be refused with: {wanted}")
    return found


def _viewed(view: View | InputError) -> View:
    if isinstance(view, InputError):
        raise view
    return view


def _measured(case: Case, run: Run) -> Cell:
    checks: tuple[Check, ...] = (finite, one_precision, *case.checks) if case.finite else case.checks
    figures = tuple(figure for figure in (check(run) for check in checks) if figure is not None)
    documented = DEGRADED.get((case.name, run.method), Documented({}, ""))
    verdict = verdict_of(figures, documented.bounds)
    error = run.error() if case.finite else None
    stage = "" if error is None or error <= ROOM + run.image.shape[1] else first_stage(run)
    note = documented.why if verdict == DEGRADED_VERDICT else _beyond(figures, documented.bounds)
    return Cell(case.name, run.method, verdict, note, figures, error, run.non_finite(), stage)


def _beyond(figures: Sequence[Figure], bounds: Mapping[str, float]) -> str:
    """The first figure that nothing allows, in words."""
    for figure in figures:
        if not figure.holds and not figure.value <= bounds.get(figure.name, -1.0):
            allowed = max(figure.bound, bounds.get(figure.name, figure.bound))
            return f"{figure.name}: {figure.value:.4g} {figure.unit}; allowed are {allowed:.4g}: {figure.reason}"
    return ""

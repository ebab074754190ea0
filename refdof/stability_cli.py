"""The command `refdof stability`: every method at the numerical extremes."""

import difflib
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated

import typer

from refdof._check import InputError, as_choice
from refdof.image.atomic import check_file, write_text
from refdof.methods import METHODS
from refdof.options import AsJson, Threads, listed, set_threads
from refdof.progress import progress_line
from refdof.stability import CASES, Case, as_json, counts_of, html_page, matrix, terminal_text
from refdof.stability.ahead import compile_twins, twin_job
from refdof.stability.verdict import BROKEN
from refdof.warm import is_warm, job_of, warm

__all__ = ["add_stability"]


def add_stability(app: typer.Typer) -> None:
    """Give `app` the command."""
    app.command()(stability)


def stability(
    methods: Annotated[
        str | None, typer.Option("--methods", metavar="A,B,C", help="These methods only. Default: all.")
    ] = None,
    only: Annotated[str | None, typer.Option("--only", metavar="CASE,CASE,...", help="These cases only.")] = None,
    html_file: Annotated[
        Path | None, typer.Option("--html", metavar="FILE", help="Also write a page with every figure.")
    ] = None,
    threads: Threads = None,
    as_json_text: AsJson = False,
) -> None:
    """Run every method at the numerical extremes.

    Each pair of a case and a method is pass, refused, degraded or broken. It takes about a minute on two cores, and
    some more to compile at first. The exit status is 0 if nothing is broken.
    The page docs/stability.md has the words, and what each case and figure is.
    """
    set_threads(threads)
    names = list(METHODS) if methods is None else _distinct("methods", listed(methods))
    for name in names:
        as_choice("methods", name, METHODS)
    cases = CASES if only is None else _named(_distinct("only", listed(only)))
    if html_file is not None:
        check_file(html_file, "html")
    with progress_line("stability") as tell:
        if only is None:
            warm([job_of(name, "best") for name in names], tell, at_least=2)
            compile_twins(names, tell)
        cells = matrix(names, cases, _with_compiling(names, tell))
    print(json.dumps(as_json(cells), indent=2, allow_nan=False) if as_json_text else terminal_text(cells))
    if html_file is not None:
        write_text(html_file, html_page(cells), "html")
    raise typer.Exit(1 if counts_of(cells)[BROKEN] else 0)


def _with_compiling(names: Sequence[str], tell: Callable[[str, int, int], None]) -> Callable[[str, int, int], None]:
    """`tell` that says "compiling" in the first cell of a method that was not compiled ahead."""
    cold = {name for name in names if not is_warm([job_of(name, "best"), twin_job(name)])}

    def tell_cell(cell: str, done: int, count: int) -> None:
        method = cell.rpartition(", ")[2]
        tell(f"{cell}: compiling" if method in cold else cell, done, count)
        cold.discard(method)

    return tell_cell


def _named(names: Sequence[str]) -> list[Case]:
    """Cases by their names; an unknown one is refused with the nearest."""
    known = {case.name: case for case in CASES}
    for name in names:
        if name not in known:
            near = difflib.get_close_matches(name, known, n=1, cutoff=0.6)
            hint = f"did you mean {near[0]!r}? " if near else ""
            raise InputError(f"only: got {name!r:.80}; {hint}allowed are {', '.join(known)}")
    return [case for case in CASES if case.name in names]


def _distinct(option: str, names: Sequence[str]) -> list[str]:
    for name in names:
        if list(names).count(name) > 1:
            raise InputError(f"{option}: got {name!r:.80} twice; allowed is once")
    return list(names)

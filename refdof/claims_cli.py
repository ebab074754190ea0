"""The command `refdof claims`: what the sources say, held against what is measured."""

import difflib
import json
from collections.abc import Sequence
from typing import Annotated

import typer

from refdof._check import InputError, as_choice
from refdof.claims.page import summary_rows, terminal_text
from refdof.claims.scorecard import kind_of, scorecard
from refdof.claims.statement import SOURCES, Claim
from refdof.claims.statement import claims as all_claims
from refdof.methods import METHODS
from refdof.options import AsJson, Threads, listed, set_threads
from refdof.progress import progress_line
from refdof.rendering import PRESETS
from refdof.warm import REFERENCE, job_of, warm

__all__ = ["add_claims"]


def add_claims(app: typer.Typer) -> None:
    """Give `app` the command."""
    app.command()(claims)


def claims(
    source: Annotated[
        str | None, typer.Option("--source", metavar="KEY", help=f"Of this source only: {', '.join(SOURCES)}.")
    ] = None,
    only: Annotated[str | None, typer.Option("--only", metavar="ID,ID,...", help="These claims only.")] = None,
    threads: Threads = None,
    as_json: AsJson = False,
) -> None:
    """Hold what the papers claim against what is measured.

    Some minutes for all; times are measured, too, so that a quiet machine tells more. References are kept.
    """
    set_threads(threads)
    chosen = all_claims()
    if source is not None:
        as_choice("source", source, SOURCES)
        chosen = tuple(claim for claim in chosen if claim.source == source)
    if only is not None:
        chosen = _named(listed(only), chosen)
    with progress_line("claims") as tell:
        if len({kind_of(claim) for claim in chosen} - {"", "formula"}) and only is None:
            warm([REFERENCE, *(job_of(name, preset) for name in METHODS for preset in PRESETS)], tell, at_least=2)
        rows = scorecard(chosen, tell)
    if as_json:
        head, *counts = summary_rows(rows)
        summary = {row[0]: dict(zip(head[1:], map(int, row[1:]), strict=True)) for row in counts}
        print(json.dumps({"claims": [row.as_json() for row in rows], "summary": summary}, indent=2))
    else:
        print(terminal_text(rows))


def _named(names: Sequence[str], chosen: Sequence[Claim]) -> tuple[Claim, ...]:
    """Claims by their ids; an unknown one is refused with the nearest."""
    ids = [claim.name for claim in chosen]
    for name in names:
        if name not in ids:
            near = difflib.get_close_matches(name, ids, n=1, cutoff=0.6)
            hint = f"did you mean {near[0]!r}? " if near else ""
            raise InputError(f"only: got {name!r:.80}; {hint}allowed are ids of claims, such as {ids[0]}")
    return tuple(claim for claim in chosen if claim.name in names)

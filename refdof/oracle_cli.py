"""The oracle's commands: `refdof golden | check`."""

import json
from pathlib import Path
from typing import Annotated

import typer

from refdof.options import AsJson, Threads, listed, set_threads
from refdof.oracle import write_pack
from refdof.oracle.cases import LEVELS

__all__ = ["add_commands"]

Methods = Annotated[
    str | None, typer.Option("--methods", metavar="A,B,C", help="Methods with cases. Default: all that have some.")
]


def add_commands(app: typer.Typer) -> None:
    """Give `app` the commands of the oracle."""
    app.command()(golden)


def golden(
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="A new folder, or an earlier pack.")],
    level: Annotated[
        str, typer.Option("--level", metavar="|".join(LEVELS), help="core is small; full has every size.")
    ] = "core",
    methods: Methods = None,
    threads: Threads = None,
    as_json: AsJson = False,
) -> None:
    """Write a pack: inputs and results, with bounds and tolerances, to check another implementation with.

    A port needs the pack only, not refdof: its README says what to read and what to write.
    """
    set_threads(threads)
    names = write_pack(out, level, None if methods is None else listed(methods))
    files = [path for path in out.rglob("*") if path.is_file()]
    facts = {"out": str(out), "cases": len(names), "bytes": sum(path.stat().st_size for path in files)}
    print(json.dumps(facts) if as_json else ", ".join(f"{key}={value}" for key, value in facts.items()))

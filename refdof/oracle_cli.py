"""The oracle's commands: `refdof golden | check | diagnose`."""

import json
from pathlib import Path
from typing import Annotated

import typer

from refdof._check import InputError
from refdof.image.atomic import write_text
from refdof.options import AsJson, Threads, listed, set_threads
from refdof.oracle import check_command, check_results, check_shader, write_pack
from refdof.oracle.cases import LEVELS
from refdof.oracle.checking import TIMEOUT_S, Outcome
from refdof.oracle.diagnosis import diagnose_source
from refdof.oracle.junit import junit
from refdof.oracle.sources import Source, of_command, of_folder
from refdof.oracle.verdict import FAIL

__all__ = ["add_commands"]

Methods = Annotated[
    str | None, typer.Option("--methods", metavar="A,B,C", help="Methods with cases. Default: all that have some.")
]


def add_commands(app: typer.Typer) -> None:
    """Give `app` the commands of the oracle."""
    app.command()(golden)
    app.command()(check)
    app.command()(diagnose)


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


def check(
    pack: Annotated[Path, typer.Option("--pack", metavar="DIR", help="What `refdof golden` wrote.")],
    results: Annotated[
        Path | None, typer.Option("--results", metavar="DIR", help="One folder for each case, with image.f32 or .npy.")
    ] = None,
    impl: Annotated[
        str | None,
        typer.Option("--impl", metavar="CMD", help="A program that makes them; {case} and {out} in it are folders."),
    ] = None,
    shader: Annotated[
        Path | None, typer.Option("--shader", metavar="FILE", help="A fragment shader, .frag, .glsl, .fs or .wgsl.")
    ] = None,
    bindings: Annotated[
        Path | None,
        typer.Option("--bindings", metavar="FILE", help='TOML: what its names mean, such as uDepth = "device".'),
    ] = None,
    timeout: Annotated[float, typer.Option("--timeout", help="Of one case [s].")] = TIMEOUT_S,
    json_file: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Also write all findings.")] = None,
    junit_file: Annotated[Path | None, typer.Option("--junit", metavar="FILE", help="Also write JUnit's XML.")] = None,
) -> None:
    """Check another implementation against a pack. The exit status is 0 if cases were compared and none failed."""
    if sum(given is not None for given in (results, impl, shader)) != 1:
        raise InputError("results, impl, shader: got several or none; allowed is one of them")
    if bindings is not None and shader is None:
        raise InputError("bindings: got a file without --shader; allowed is one with a shader")

    def tell(outcome: Outcome, done: int, count: int) -> None:
        print(f"{outcome.status:16}{outcome.case}: {outcome.message} ({outcome.seconds:.1f} s)", flush=True)

    if results is not None:
        report = check_results(results, pack, tell)
    elif shader is not None:
        report = check_shader(shader, pack, bindings, timeout, tell)
    else:
        report = check_command(impl or "", pack, timeout, tell)
    print(", ".join(f"{count} {status}" for status, count in report.counts().items() if count))
    if json_file is not None:
        write_text(json_file, json.dumps(report.as_json(), indent=1, allow_nan=False) + "\n")
    if junit_file is not None:
        write_text(junit_file, junit(report))
    if report.counts()[FAIL]:
        for line in diagnose_source(_source(results, impl, timeout), pack).lines():
            print(line)
    raise typer.Exit(0 if report.passed else 1)


def diagnose(
    pack: Annotated[Path, typer.Option("--pack", metavar="DIR", help="What `refdof golden` wrote.")],
    results: Annotated[
        Path | None, typer.Option("--results", metavar="DIR", help="One folder for each case, with image.f32 or .npy.")
    ] = None,
    impl: Annotated[
        str | None,
        typer.Option("--impl", metavar="CMD", help="A program that makes them; {case} and {out} in it are folders."),
    ] = None,
    case: Annotated[str | None, typer.Option("--case", metavar="NAME", help="Look at this case only.")] = None,
    timeout: Annotated[float, typer.Option("--timeout", help="Of one case [s].")] = TIMEOUT_S,
    json_file: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Also write all findings.")] = None,
) -> None:
    """Say what is wrong with a port of singlepass: its taps and weights, and the mistake that gives its output.

    The exit status is 0 if nothing is.
    """
    found = diagnose_source(_source(results, impl, timeout), pack, case)
    for line in found.lines():
        print(line)
    if json_file is not None:
        write_text(json_file, json.dumps(found.as_json(), indent=1, allow_nan=False) + "\n")
    raise typer.Exit(0 if found.key == "none" else 1)


def _source(results: Path | None, impl: str | None, timeout: float) -> Source:
    """The one that is given."""
    if (results is None) == (impl is None):
        raise InputError("results, impl: got both or none; allowed is one of the two")
    return of_folder(results) if results is not None else of_command(impl or "", timeout)

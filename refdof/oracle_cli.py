"""The oracle's commands: `refdof golden | check | diagnose`."""

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from refdof._check import InputError
from refdof.image.atomic import check_folder, write_text
from refdof.options import AsJson, Threads, listed, set_threads
from refdof.oracle import check_source, write_pack
from refdof.oracle.cases import LEVELS
from refdof.oracle.checking import TIMEOUT_S, Outcome
from refdof.oracle.diagnosis import diagnose_source
from refdof.oracle.junit import junit
from refdof.oracle.selection import Plan, as_shard
from refdof.oracle.shaders import of_shader
from refdof.oracle.sources import Source, of_command, of_folder
from refdof.oracle.verdict import FAIL
from refdof.oracle.waivers import read_waivers

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
        str,
        typer.Option(
            "--level", metavar="|".join(LEVELS), help="core is small; full has every size; extreme the ends of float32."
        ),
    ] = "core",
    methods: Methods = None,
    update: Annotated[bool, typer.Option("--update", help="Replace an earlier pack of other content.")] = False,
    exr: Annotated[bool, typer.Option("--exr", help="Inputs and pictures as EXR, too.")] = False,
    threads: Threads = None,
    as_json: AsJson = False,
) -> None:
    """Write a pack: inputs and results, with bounds and tolerances, to check another implementation with.

    A port needs the pack only, not refdof: its README says what to read and what to write.
    """
    set_threads(threads)
    names = write_pack(out, level, None if methods is None else listed(methods), update=update, exr=exr)
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
    only: Annotated[str, typer.Option("--only", metavar="GLOB", help="Cases of these names only.")] = "*",
    shard: Annotated[
        str, typer.Option("--shard", metavar="I/N", help="Part I of N: each case is in exactly one.")
    ] = "1/1",
    not_supported: Annotated[
        str | None, typer.Option("--not-supported", metavar="TAG,TAG", help="Cases with such a tag are not run.")
    ] = None,
    given: Annotated[
        str | None,
        typer.Option(
            "--given",
            metavar="STAGE,STAGE",
            help="Stages that the program takes from inputs/ where params.txt says so: wrong cases run once more.",
        ),
    ] = None,
    waivers: Annotated[
        Path | None, typer.Option("--waivers", metavar="TOML", help="Known failures, with reason, url and expires.")
    ] = None,
    html_file: Annotated[
        Path | None, typer.Option("--html", metavar="FILE", help="Also write a page with pictures.")
    ] = None,
    json_file: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Also write all findings.")] = None,
    junit_file: Annotated[Path | None, typer.Option("--junit", metavar="FILE", help="Also write JUnit's XML.")] = None,
) -> None:
    """Check another implementation against a pack. The exit status is 0 if cases were compared and none failed."""
    if given is not None and impl is None:
        raise InputError("given: got stages without --impl; allowed is a command that takes them")
    plan = Plan(
        only=only,
        shard=as_shard(shard),
        not_supported=() if not_supported is None else tuple(listed(not_supported)),
        given=() if given is None else tuple(listed(given)),
        waivers=() if waivers is None else read_waivers(waivers),
    )
    for file in (html_file, json_file, junit_file):
        if file is not None:
            check_folder(file.parent)

    def tell(outcome: Outcome, done: int, count: int) -> None:
        print(f"{outcome.status:16}{outcome.case}: {outcome.message} ({outcome.seconds:.1f} s)", flush=True)

    from refdof.oracle.page import Pictures, check_page  # templates and pictures are slow to import

    pictures = Pictures()
    with _source(results, impl, shader, bindings, timeout) as source:
        report = check_source(source, pack, tell, plan, pictures.add if html_file is not None else None)
        for line in report.warnings:
            print(f"warning: {line}", file=sys.stderr)
        print(", ".join(f"{count} {status}" for status, count in report.counts().items() if count))
        if html_file is not None:
            write_text(html_file, check_page(report, pictures))
        if json_file is not None:
            write_text(json_file, json.dumps(report.as_json(), indent=1, allow_nan=False) + "\n")
        if junit_file is not None:
            write_text(junit_file, junit(report))
        if report.counts()[FAIL]:
            single = report.outcomes[0].case if len(report.outcomes) == 1 else None
            for line in diagnose_source(source, pack, single, probes=False).lines():
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
    shader: Annotated[Path | None, typer.Option("--shader", metavar="FILE", help="A fragment shader.")] = None,
    bindings: Annotated[
        Path | None, typer.Option("--bindings", metavar="FILE", help="TOML: what the shader's names mean.")
    ] = None,
    case: Annotated[str | None, typer.Option("--case", metavar="NAME", help="Look at this case only.")] = None,
    timeout: Annotated[float, typer.Option("--timeout", help="Of one case [s].")] = TIMEOUT_S,
    json_file: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Also write all findings.")] = None,
) -> None:
    """Say what is wrong with a port of singlepass: its taps and weights, and the mistake that gives its output.

    The exit status is 0 if nothing is.
    """
    with _source(results, impl, shader, bindings, timeout) as source:
        found = diagnose_source(source, pack, case, probes=results is None)
    for line in found.lines():
        print(line)
    if json_file is not None:
        write_text(json_file, json.dumps(found.as_json(), indent=1, allow_nan=False) + "\n")
    raise typer.Exit(0 if found.key == "none" else 1)


@contextmanager
def _source(
    results: Path | None, impl: str | None, shader: Path | None, bindings: Path | None, timeout: float
) -> Iterator[Source]:
    """The one implementation that is given."""
    if sum(given is not None for given in (results, impl, shader)) != 1:
        raise InputError("results, impl, shader: got several or none; allowed is one of them")
    if bindings is not None and shader is None:
        raise InputError("bindings: got a file without --shader; allowed is one with a shader")
    if shader is not None:
        with of_shader(shader, bindings, timeout) as source:
            yield source
    else:
        yield of_folder(results) if results is not None else of_command(impl or "", timeout)

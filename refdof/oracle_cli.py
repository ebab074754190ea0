"""The oracle's commands: `refdof golden | check | diagnose`."""

import json
import sys
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Annotated

import typer

from refdof._check import InputError, as_number
from refdof.image.atomic import check_file, write_text
from refdof.options import AsJson, Threads, listed, refuse_ignored, set_threads
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
from refdof.typed import as_typed

__all__ = ["add_commands"]

_LONGEST_S = 86400.0

Methods = Annotated[
    str | None, typer.Option("--methods", metavar="A,B,C", help="Methods with cases. Default: all that have some.")
]

PackFolder = Annotated[Path, typer.Option("--pack", metavar="DIR", help="What `refdof golden` wrote.")]
Results = Annotated[
    Path | None, typer.Option("--results", metavar="DIR", help="One folder for each case, with image.f32 or .npy.")
]
Command = Annotated[
    str | None,
    typer.Option("--impl", metavar="CMD", help="A program that makes them; {case} and {out} in it are folders."),
]
Shader = Annotated[
    Path | None, typer.Option("--shader", metavar="FILE", help="A fragment shader, .frag, .glsl, .fs or .wgsl.")
]
Bindings = Annotated[
    Path | None,
    typer.Option("--bindings", metavar="FILE", help='TOML: what its names mean, such as uDepth = "device".'),
]
Timeout = Annotated[float | None, typer.Option("--timeout", help=f"Of one case, in seconds. Default: {TIMEOUT_S:g}.")]


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
    """Write a pack of cases to check another implementation with.

    A case has inputs and results, with bounds and tolerances.

    A port needs the pack only, not refdof: its README says what to read and what to write.
    """
    set_threads(threads)
    with as_typed(method="methods"):
        names = write_pack(out, level, None if methods is None else listed(methods), update=update, exr=exr)
    files = [path for path in out.rglob("*") if path.is_file()]
    facts = {"out": str(out), "cases": len(names), "bytes": sum(path.stat().st_size for path in files)}
    print(json.dumps(facts) if as_json else ", ".join(f"{key}={value}" for key, value in facts.items()))


def check(
    pack: PackFolder,
    results: Results = None,
    impl: Command = None,
    shader: Shader = None,
    bindings: Bindings = None,
    timeout: Timeout = None,
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
    """Check another implementation against a pack.

    The exit status is 0 if cases were compared and none failed.
    """
    if impl is None:
        refuse_ignored("without --impl", "with it", given=given)
    plan = Plan(
        only=only,
        shard=as_shard(shard),
        not_supported=() if not_supported is None else tuple(listed(not_supported)),
        given=() if given is None else tuple(listed(given)),
        waivers=() if waivers is None else read_waivers(waivers),
    )
    _check_files(html=html_file, json=json_file, junit=junit_file)

    def tell(outcome: Outcome, done: int, count: int) -> None:
        print(f"{outcome.status:16}{outcome.case}: {outcome.message} ({outcome.seconds:.1f} s)", flush=True)

    from refdof.oracle.page import Pictures, check_page  # templates and pictures are slow to import

    pictures = Pictures()
    with as_typed(not_supported="not-supported"), _source(results, impl, shader, bindings, timeout) as source:
        report = check_source(source, pack, tell, plan, pictures.add if html_file is not None else None)
        for line in report.warnings:
            print(f"warning: {line}", file=sys.stderr)
        print(", ".join(f"{count} {status}" for status, count in report.counts().items() if count))
        if html_file is not None:
            write_text(html_file, check_page(report, pictures), "html")
        if json_file is not None:
            write_text(json_file, json.dumps(report.as_json(), indent=1, allow_nan=False) + "\n", "json")
        if junit_file is not None:
            write_text(junit_file, junit(report), "junit")
        if report.counts()[FAIL]:
            single = report.outcomes[0].case if len(report.outcomes) == 1 else None
            for line in diagnose_source(source, pack, single, probes=False).lines():
                print(line)
    raise typer.Exit(0 if report.passed else 1)


def diagnose(
    pack: PackFolder,
    results: Results = None,
    impl: Command = None,
    shader: Shader = None,
    bindings: Bindings = None,
    case: Annotated[str | None, typer.Option("--case", metavar="NAME", help="Look at this case only.")] = None,
    timeout: Timeout = None,
    json_file: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Also write all findings.")] = None,
) -> None:
    """Say what is wrong with a port of singlepass.

    It names taps and weights, and the mistake that gives the port's output.

    The exit status is 0 if nothing is.
    """
    _check_files(json=json_file)
    with _source(results, impl, shader, bindings, timeout) as source:
        found = diagnose_source(source, pack, case, probes=results is None)
    for line in found.lines():
        print(line)
    if json_file is not None:
        write_text(json_file, json.dumps(found.as_json(), indent=1, allow_nan=False) + "\n", "json")
    raise typer.Exit(0 if found.key == "none" else 1)


def _check_files(**files: Path | None) -> None:
    """Raise before a long run if a file cannot be written, or two are the same."""
    seen: dict[Path, str] = {}
    for name, file in files.items():
        if file is None:
            continue
        check_file(file, name)
        if file.resolve() in seen:
            raise InputError(f"{name}: got {str(file)!r}, as {seen[file.resolve()]} has; allowed is another file")
        seen[file.resolve()] = name


def _source(
    results: Path | None, impl: str | None, shader: Path | None, bindings: Path | None, timeout: float | None
) -> AbstractContextManager[Source]:
    """The one implementation that is given."""
    if sum(given is not None for given in (results, impl, shader)) != 1:
        raise InputError("results, impl, shader: got several or none; allowed is one of them")
    if shader is None:
        refuse_ignored("without --shader", "with it", bindings=None if bindings is None else str(bindings))
    if results is not None:
        refuse_ignored("with --results, which runs nothing", "with --impl or --shader", timeout=timeout)
        return nullcontext(of_folder(results))
    limit = as_number("timeout", TIMEOUT_S if timeout is None else timeout, above=0.0, maximum=_LONGEST_S)
    return of_shader(shader, bindings, limit) if shader is not None else nullcontext(of_command(impl or "", limit))

"""The command `refdof sweep`: the trade of speed for accuracy, measured."""

import json
import math
import re
import shlex
import sys
from collections.abc import Iterator, Sequence
from dataclasses import asdict, replace
from itertools import chain
from pathlib import Path
from typing import Annotated

import typer

from refdof._check import InputError, as_choice
from refdof._files import as_plain_file
from refdof.cluster import connected
from refdof.compare import check_window
from refdof.image.atomic import check_folder
from refdof.methods import METHODS
from refdof.options import (
    DEFAULT_SCENE,
    AsJson,
    Background,
    Eye,
    FNumber,
    FocalLength,
    Focus,
    FocusPoints,
    Fov,
    Lens,
    Limit,
    MethodSettings,
    Most,
    NoFileCamera,
    NoVignetting,
    Radius,
    Samples,
    Scheduler,
    Seed,
    Sensor,
    Shading,
    Size,
    Target,
    Threads,
    Tolerance,
    Units,
    Up,
    Wavelengths,
    Workers,
    listed,
    refuse_ignored,
    sample_counts,
    set_threads,
)
from refdof.progress import progress_line
from refdof.report.rows import plain
from refdof.scene.builtin import SCENES
from refdof.settings import settings_by_method
from refdof.shot import CameraChoice, LensChoice, SceneChoice, lens_of_points, scene_camera_lens, size_of
from refdof.sweep.answers import answers_of, in_words, models_of, predictions_of
from refdof.sweep.front import front
from refdof.sweep.plan import SHOT_AXES, Job, Shot, axis_of, jobs_of, shots_of
from refdof.sweep.results import Results
from refdof.sweep.run import ReferenceChoice, sweep
from refdof.sweep.words import by_shot, front_table
from refdof.sweep.write import write_report
from refdof.view import View
from refdof.warm import REFERENCE, job_of, warm

__all__ = ["add_sweep"]

_FILE = "sweep.duckdb"
_OF_SHOT = (
    *("shading", "background", "size", "eye", "target", "up", "fov", "limit", "no_file_camera", "lens_radius", "focus"),
    *("lens_file", "f_number", "focal_length", "sensor", "units", "wavelengths", "no_vignetting", "focus_points"),
)


def add_sweep(app: typer.Typer) -> None:
    """Give `app` the command."""
    app.command(name="sweep")(sweep_command)


def sweep_command(
    context: typer.Context,
    scenes: Annotated[
        list[str] | None,
        typer.Argument(metavar="SCENE", help=f"Built-in scenes or mesh files. Default: {DEFAULT_SCENE}."),
    ] = None,
    method: Annotated[
        str | None, typer.Option("--method", metavar="A,B,C", help="Methods to measure. Default: all.")
    ] = None,
    vary: Annotated[
        list[str] | None,
        typer.Option(
            "--vary",
            metavar="KEY=V,V,...",
            help="Values of a parameter of the methods, or of size, lens_radius or focus; repeatable. A method of "
            "which no parameter is named takes the values of its own tradeoff, see `refdof methods --json`.",
        ),
    ] = None,
    preset: Annotated[
        str | None,
        typer.Option("--preset", metavar="tradeoff", help="All methods over their tradeoffs on all built-in scenes."),
    ] = None,
    budget: Annotated[
        str | None, typer.Option("--budget", metavar="TIME", help="Tell what comes nearest in this time: 50ms.")
    ] = None,
    quality: Annotated[
        str | None, typer.Option("--quality", metavar="DB", help="Tell the fastest with at least this PSNR: 32dB.")
    ] = None,
    predict: Annotated[
        str | None,
        typer.Option(
            "--predict",
            metavar="WxH,...",
            help="Tell the times at these sizes, by the cost of the points: of what answers --budget or --quality, or "
            "of the slowest setting of each method.",
        ),
    ] = None,
    out: Annotated[
        Path,
        typer.Option("--out", metavar="DIR", help=f"Folder of {_FILE}, which a later sweep goes on with, and report."),
    ] = Path("out/sweep"),
    settings: MethodSettings = None,
    shading: Shading = None,
    background: Background = None,
    size: Size = None,
    eye: Eye = None,
    target: Target = None,
    up: Up = None,
    fov: Fov = None,
    limit: Limit = None,
    no_file_camera: NoFileCamera = None,
    lens_radius: Radius = None,
    focus: Focus = None,
    lens_file: Lens = None,
    f_number: FNumber = None,
    focal_length: FocalLength = None,
    sensor: Sensor = None,
    units: Units = None,
    wavelengths: Wavelengths = None,
    no_vignetting: NoVignetting = None,
    focus_points: FocusPoints = None,
    seed: Seed = 0,
    samples: Samples = None,
    tolerance: Tolerance = None,
    max_samples: Most = None,
    scheduler: Scheduler = None,
    workers: Workers = None,
    threads: Threads = None,
    as_json: AsJson = False,
) -> None:
    """Measure methods with many settings: speed against accuracy.

    Points that were measured before are not measured again.
    """
    set_threads(threads)
    samples, max_samples = sample_counts(samples, tolerance, max_samples)
    axes = [axis_of(text) for text in vary or []]
    if preset is not None:
        as_choice("preset", preset, ("tradeoff",))
        refuse_ignored("with --preset, which takes all", "without it", method=method, vary=vary)
    shot_axes = [axis for axis in axes if axis.name in SHOT_AXES]
    given = {"size": size, "lens_radius": lens_radius, "focus": focus}
    for axis in shot_axes:
        refuse_ignored(f"with --vary {axis.name}, which sets it", "without it", **{axis.name: given[axis.name]})
    names = listed(method) if method is not None else list(METHODS)
    for name in names:
        as_choice("method", name, METHODS)
    jobs = jobs_of(names, axes, settings_by_method(settings or [], names, ["best"]))
    limits = (
        None if budget is None else _quantity("budget", budget, {"ms": 1e-3, "s": 1.0, "us": 1e-6}),
        None if quality is None else _quantity("quality", quality, {"dB": 1.0, "": 1.0}),
    )
    sizes = [size_of(text, "predict") for text in listed(predict)] if predict is not None else []
    check_folder(out)
    wanted = scenes or (list(SCENES) if preset is not None else [DEFAULT_SCENE])
    seen = CameraChoice(size, eye, target, up, fov)
    photo = focal_length, sensor, units
    lens = LensChoice(lens_radius, focus, lens_file, f_number, wavelengths, no_vignetting, *photo)
    look = SceneChoice(shading, background, limit, no_file_camera)

    def shots() -> Iterator[Shot]:
        for name in wanted:
            scene, camera, chosen = scene_camera_lens(name, seen, lens, look)
            view = View(scene, camera, lens_of_points(focus_points, scene, camera, chosen, lens))
            for shot in shots_of(view, axes):
                yield replace(shot, source=name)

    with progress_line(f"{wanted[0]}: scene") as tell:
        every = shots()
        first = next(every)  # what is wrong with it is told before a folder is made
        check_window(first.view)
        for name in wanted[1:]:
            if name not in SCENES:
                as_plain_file("scene", name)
        with connected(scheduler, workers) as cluster, Results(out / _FILE) as results:
            warm([REFERENCE, *(job_of(name, "best") for name in names)], tell, at_least=2)
            choice = ReferenceChoice(samples, tolerance, seed, max_samples)
            before = results.keys()
            words = _said(context)
            count = len(wanted) * math.prod(len(axis.values) for axis in shot_axes)

            def command(shot: Shot, job: Job) -> str:
                return _render_command(shot, job, words)

            keys = sweep(chain([first], every), jobs, results, choice, count, cluster, command, tell)
            points = results.points(dict.fromkeys(keys))
            models = models_of(points)
            tell("report", 0, 0)
            write_report(points, models, results, out, "refdof " + shlex.join(sys.argv[1:]))
    answers = answers_of(points, *limits)
    predicted, lacks = predictions_of(points, sizes, *limits)
    if as_json:
        facts = {
            "points": [plain(asdict(point)) for point in points],
            "fronts": {name: [point.key for point in front(own)] for name, own in by_shot(points).items()},
            "costs": [plain(asdict(model)) for model in models],
            "predictions": predicted,
            "not_predicted": lacks,
            "answers": answers,
        }
        print(json.dumps(facts, indent=2))
        return
    for name, own in by_shot(points).items():
        print(f"### {name}\n\n{front_table(own)}\n")
    for line in [*map(str, models), *map(in_words, predicted), *lacks, *(answer["words"] for answer in answers)]:
        print(line)
    known = len(before & set(keys))
    print(f"{len(points)} points, {known} of them from earlier runs. Report: {out / 'report.html'}")


def _said(context: typer.Context) -> list[str]:
    """The options of the shot that were given, as words of a command line."""
    words: list[str] = []
    for option in context.command.params:
        value = context.params.get(option.name or "")
        if option.name not in _OF_SHOT or value is None or value is False:
            continue
        for one in value if isinstance(value, list | tuple) else [value]:
            words += [option.opts[0], *([] if one is True else [str(one)])]
    return words


def _render_command(shot: Shot, job: Job, said: Sequence[str]) -> str:
    """What renders the picture of a point."""
    words = ["refdof", "render", shot.source, "--method", job.method, *said]
    for name, value in shot.varied.items():
        words += [f"--{name.replace('_', '-')}", str(value)]
    for name, value in job.settings.items():
        words += ["--set", f"{name}={str(value).lower() if isinstance(value, bool) else value}"]
    return shlex.join([*words, "-o", f"{job.method}.png"])


def _quantity(name: str, text: str, units: dict[str, float]) -> float:
    """A number and its unit, in seconds or dB."""
    found = re.fullmatch(r"([0-9.eE+-]+) *([A-Za-z]*)", text.strip())
    allowed = " or ".join(f"NUMBER{unit}" for unit in units)
    if found is None or found[2] not in units:
        raise InputError(f"{name}: got {text!r}; allowed is {allowed}")
    try:
        value = float(found[1])
    except ValueError:
        raise InputError(f"{name}: got {text!r}; allowed is {allowed}") from None
    if not 0.0 < value < math.inf:
        raise InputError(f"{name}: got {text!r}; allowed is {allowed}, above 0 and finite")
    return value * units[found[2]]

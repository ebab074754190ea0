"""The command `refdof compare`: methods beside the reference."""

import json
import shlex
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from refdof.cluster import connected
from refdof.compare import compare as compare_scene
from refdof.compare import warming_up
from refdof.comparison import Comparison
from refdof.image.atomic import check_folder
from refdof.methods import METHODS
from refdof.options import (
    DEFAULT_SCENE,
    PRESET_HELP,
    AsJson,
    Background,
    Crops,
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
    say_rounded,
    set_threads,
)
from refdof.progress import overall, progress_line
from refdof.rendering import PRESETS
from refdof.report import markdown_table, rows_as_json, terminal_table, write_comparisons
from refdof.report.crops import boxes_of
from refdof.scene.builtin import SCENES
from refdof.settings import settings_by_method
from refdof.shot import CameraChoice, LensChoice, SceneChoice, lens_of_points, scene_camera_lens
from refdof.truth.forecast import Forecast
from refdof.truth.reference import samples_taken
from refdof.warm import REFERENCE, is_warm, job_of

__all__ = ["add_compare"]

_MOST_SAMPLES = 1 << 22  # more are refused


def add_compare(app: typer.Typer) -> None:
    """Give `app` the command."""
    app.command()(compare)


def compare(
    scenes: Annotated[
        list[str] | None,
        typer.Argument(metavar="SCENE", help=f"Built-in scenes or mesh files. Default: {DEFAULT_SCENE}."),
    ] = None,
    methods: Annotated[
        str | None, typer.Option("--methods", metavar="A,B,C", help="Methods to compare. Default: all.")
    ] = None,
    out: Annotated[
        Path,
        typer.Option("--out", metavar="DIR", help="Output folder for table, images and report; made if it is missing."),
    ] = Path("out"),
    settings: MethodSettings = None,
    preset: Annotated[str, typer.Option("--preset", metavar="best|paper|best,paper", help=PRESET_HELP)] = "best",
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
    crop: Crops = None,
    scheduler: Scheduler = None,
    workers: Workers = None,
    threads: Threads = None,
    wide: Annotated[bool | None, typer.Option("--wide", help="Print all columns, beyond 80 characters.")] = None,
    as_json: AsJson = False,
) -> None:
    """Compare methods with a reference: table, images and report."""
    set_threads(threads)
    samples, max_samples = sample_counts(samples, tolerance, max_samples)
    if tolerance is None and 1 <= samples <= _MOST_SAMPLES:
        say_rounded("reference", samples, samples_taken(samples))
    if as_json:
        refuse_ignored("with --json", "without it", wide=wide)
    check_folder(out)
    names = listed(methods) if methods is not None else list(METHODS)
    presets = listed(preset)
    params = settings_by_method(settings or [], names, presets)
    seen = CameraChoice(size, eye, target, up, fov)
    photo = focal_length, sensor, units
    chosen = LensChoice(lens_radius, focus, lens_file, f_number, wavelengths, no_vignetting, *photo)
    look = SceneChoice(shading, background, limit, no_file_camera)
    comparisons: list[Comparison] = []
    soon = [("accumulation", "best"), *((name, kind) for name in names for kind in presets if kind in PRESETS)]
    if not is_warm([REFERENCE, *(job_of(*one) for one in soon)]):
        soon = []  # compiled in parallel processes, by `compare_scene`
    wanted = scenes or [DEFAULT_SCENE]
    first = "scene" if scheduler is None and workers is None else "waiting for workers"
    with progress_line(first) as tell, connected(scheduler, workers) as cluster:
        for number, name in enumerate(wanted):
            tell(f"{name}: scene", 1000 * number, 1000 * len(wanted))
            share = overall(tell, name, number, len(wanted))
            with warming_up(soon if name in SCENES and not comparisons else []):
                scene, camera, lens = scene_camera_lens(name, seen, chosen, look)
            lens = lens_of_points(focus_points, scene, camera, lens, chosen)
            boxes = boxes_of(crop or [], camera.size)
            shot = camera, lens, samples, tolerance, seed
            where = max_samples, _announce, cluster
            made = compare_scene(scene, names, params, *shot, share, presets, *where)
            comparisons.append(replace(made, crops=boxes))
        comparisons = _told_apart(comparisons, wanted)
        tell("report", 1000 * len(wanted), 1000 * len(wanted))
        write_comparisons(comparisons, out, "refdof " + shlex.join(sys.argv[1:]))
    if as_json:
        tables = [rows_as_json(comparison) for comparison in comparisons]
        print(json.dumps(tables[0] if len(tables) == 1 else tables, indent=2))
        return
    print(markdown_table(comparisons) if wide else terminal_table(comparisons))
    print(f"Report: {out / 'report.html'}; all columns: {out / 'table.md'}, or --wide")


def _told_apart(comparisons: list[Comparison], names: list[str]) -> list[Comparison]:
    """Files of one name in two folders are called as on the command line."""
    count = Counter(comparison.scene for comparison in comparisons)
    return [
        replace(comparison, scene=name) if count[comparison.scene] > 1 else comparison
        for comparison, name in zip(comparisons, names, strict=True)
    ]


def _announce(forecast: Forecast) -> None:
    print(f"refdof: reference: {forecast}", file=sys.stderr)

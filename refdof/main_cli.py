"""The commands `refdof render | export | compare | warm`: pictures of a scene, how near they are to the reference."""

import json
import shlex
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from refdof._check import InputError, as_choice
from refdof.cluster import connected
from refdof.compare import compare as compare_scene
from refdof.compare import warming_up
from refdof.comparison import Comparison
from refdof.export import export_view, save_stages, with_declared_stages
from refdof.image.arrays import check_arrays_folder
from refdof.image.atomic import check_folder
from refdof.image.file import SUFFIXES, save_image
from refdof.listing_cli import in_words
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
    Preset,
    Probes,
    Radius,
    Samples,
    Scheduler,
    Seed,
    Sensor,
    Settings,
    Shading,
    Size,
    Steps,
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
    settings_by_method,
    settings_of,
    stages_of,
)
from refdof.progress import overall, progress_line
from refdof.rendering import PRESETS, make_params, render_view
from refdof.report import markdown_table, rows_as_json, terminal_table, write_comparisons
from refdof.report.crops import boxes_of
from refdof.scene.builtin import SCENES
from refdof.shot import CameraChoice, LensChoice, SceneChoice, lens_of_points, photographic_facts, scene_camera_lens
from refdof.truth.forecast import Forecast
from refdof.truth.reference import samples_taken
from refdof.truth.tile_sampler import power_of_two
from refdof.view import View
from refdof.warm import REFERENCE, is_warm, job_of
from refdof.warm import warm as compile_jobs

__all__ = ["add_main"]

_MOST_SAMPLES = 1 << 22  # more are refused


def add_main(app: typer.Typer) -> None:
    """Give `app` the commands."""
    for command in (render, export, compare, warm):
        app.command()(command)


def render(
    scene: Annotated[str, typer.Argument(metavar="SCENE", help="Built-in scene or mesh file.")],
    method: Annotated[str, typer.Option("--method", help="Method name, see `refdof methods`.")],
    output: Annotated[Path, typer.Option("-o", "--output", help="Output file: .png (display), .exr or .npy (linear).")],
    settings: Settings = None,
    preset: Preset = "best",
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
    seed: Annotated[int | None, typer.Option("--seed", help="Same as --set seed=N.")] = None,
    samples: Annotated[int | None, typer.Option("--samples", help="Same as --set samples=N.")] = None,
    stages: Annotated[
        Path | None,
        typer.Option("--stages", metavar="DIR", help="Also write the stages into this folder, a new one."),
    ] = None,
    steps: Steps = None,
    pixel: Probes = None,
    threads: Threads = None,
    as_json: AsJson = False,
) -> None:
    """Render a scene with one method."""
    set_threads(threads)
    if stages is None:
        refuse_ignored("without --stages", "with it", steps=steps, pixel=pixel)
    if output.suffix.lower() not in SUFFIXES:
        raise InputError(f"output: got {output.name!r}; allowed are names that end in {', '.join(SUFFIXES)}")
    check_folder(output.parent, "output")
    if stages is not None:
        check_arrays_folder(stages, "stages")
    params = settings_of(settings or [], seed=seed, samples=samples)
    given = make_params(method, params, preset)
    if method == "accumulation":
        say_rounded(method, given.samples, int(power_of_two(given.samples)))
    wanted = stages_of(steps, pixel, [method])
    seen = CameraChoice(size, eye, target, up, fov)
    photo = focal_length, sensor, units
    chosen = LensChoice(lens_radius, focus, lens_file, f_number, wavelengths, no_vignetting, *photo)
    compiling = "" if is_warm([job_of(method, preset)]) else ", compiling what was not used before"
    with progress_line(f"{scene}: scene{compiling}") as tell:
        with warming_up([(method, preset)] if scene in SCENES else []):
            look = SceneChoice(shading, background, limit, no_file_camera)
            loaded, camera, lens = scene_camera_lens(scene, seen, chosen, look)
        view = View(loaded, camera, lens_of_points(focus_points, loaded, camera, lens, chosen))
        photographic = photographic_facts(view, chosen)
        tell(f"{scene}: {method}{compiling}", 0, 0)
        result = render_view(method, view, wanted if stages is not None else False, preset, **params)
        if stages is not None:
            save_stages(method, view, result, stages)
        save_image(output, result.image)
    facts = {
        "output": str(output),
        **({} if stages is None else {"stages": str(stages)}),
        **photographic,
        **{f"{name}_s": round(seconds, 4) for name, seconds in result.seconds.items()},
    }
    print(json.dumps(facts) if as_json else in_words(facts))


def export(
    scene: Annotated[str, typer.Argument(metavar="SCENE", help="Built-in scene or mesh file.")],
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="A new folder, or an earlier export.")],
    methods: Annotated[
        str | None,
        typer.Option("--methods", metavar="A,B,C", help="Methods to run. Default: those that declare their stages."),
    ] = None,
    settings: MethodSettings = None,
    layers: Annotated[int, typer.Option("--layers", help="Surfaces per pixel.")] = 4,
    steps: Steps = None,
    pixel: Probes = None,
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
    threads: Threads = None,
    as_json: AsJson = False,
) -> None:
    """Write what a port starts from, and is compared with.

    That is pinhole colour, depth, circles of confusion, layers, and the stages of methods.

    Each array is written as NPY and as raw little-endian numbers; arrays.json tells shapes, units and conventions.
    """
    set_threads(threads)
    names = listed(methods) if methods is not None else with_declared_stages()
    for name in names:
        as_choice("method", name, METHODS)
    wanted = stages_of(steps, pixel, names)
    params = settings_by_method(settings or [], names, ["best"])
    seen = CameraChoice(size, eye, target, up, fov)
    photo = focal_length, sensor, units
    chosen = LensChoice(lens_radius, focus, lens_file, f_number, wavelengths, no_vignetting, *photo)
    with progress_line(f"{scene}: scene") as tell:
        look = SceneChoice(shading, background, limit, no_file_camera)
        loaded, camera, lens = scene_camera_lens(scene, seen, chosen, look)
        view = View(loaded, camera, lens_of_points(focus_points, loaded, camera, lens, chosen))
        facts = {"out": str(out), "methods": ",".join(names), **photographic_facts(view, chosen)}
        tell(f"{scene}: layers and {', '.join(names) or 'no method'}", 0, 0)
        export_view(view, out, names, params, layers, wanted)
    print(json.dumps(facts) if as_json else in_words(facts))


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


def warm() -> None:
    """Compile everything now, so that later runs start at once.

    It is for container images and CI.
    """
    with progress_line() as tell:
        compile_jobs([REFERENCE, *(job_of(name, preset) for name in METHODS for preset in PRESETS)], tell)


def _announce(forecast: Forecast) -> None:
    print(f"refdof: reference: {forecast}", file=sys.stderr)

"""The command `refdof compare`: methods beside the reference."""

import json
import math
import shlex
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from refdof._check import Float, InputError, as_integer
from refdof.cluster import Cluster, connected
from refdof.compare import compare as compare_scene
from refdof.compare import kept_reference, warming_up
from refdof.comparison import Comparison
from refdof.image.atomic import check_folder
from refdof.methods import METHODS
from refdof.motion import MOST_FRAMES, STEP_PX, moved_views, small_size, with_motion
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens
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
from refdof.report import files_line, markdown_table, rows_as_json, terminal_table, write_comparisons
from refdof.report.crops import boxes_of
from refdof.scene.builtin import SCENES
from refdof.scene.scene import Scene
from refdof.settings import settings_by_method
from refdof.shot import CameraChoice, LensChoice, SceneChoice, lens_of_points, scene_camera_lens
from refdof.truth.forecast import Forecast
from refdof.truth.reference import MAX_SAMPLES, samples_taken
from refdof.typed import as_typed
from refdof.view import View
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
    motion: Annotated[
        int | None,
        typer.Option(
            "--motion",
            metavar="N",
            help=f"Flicker of each method while the camera moves over N frames, 3 to {MOST_FRAMES}, by "
            f"1/{1 / STEP_PX:g} px each; with a moving picture.",
        ),
    ] = None,
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
    frames = None if motion is None else as_integer("motion", motion, minimum=3, maximum=MOST_FRAMES)
    names = listed(methods) if methods is not None else list(METHODS)
    presets = listed(preset)
    with as_typed(method="methods"):
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
            views = [] if frames is None else _moved(frames, scene, camera, lens, focus_points, chosen)
            lens = lens_of_points(focus_points, scene, camera, lens, chosen)
            boxes = boxes_of(crop or [], camera.size)
            shot = camera, lens, samples, tolerance, seed
            where = max_samples, _announce, cluster
            made = compare_scene(scene, names, params, *shot, share, presets, *where)
            if views:
                made = with_motion(made, views, samples, _reference(samples, seed, cluster), partial(share, "motion"))
            comparisons.append(replace(made, crops=boxes))
        comparisons = _told_apart(comparisons, wanted)
        tell("report", 1000 * len(wanted), 1000 * len(wanted))
        write_comparisons(comparisons, out, "refdof " + shlex.join(sys.argv[1:]))
    if as_json:
        tables = [rows_as_json(comparison) for comparison in comparisons]
        print(json.dumps(tables[0] if len(tables) == 1 else tables, indent=2))
        return
    print(markdown_table(comparisons) if wide else terminal_table(comparisons))
    print(files_line(out, bool(wide)))
    if frames is not None and not wide:
        print(f"Flicker: in {out / 'table.md'}; motion.png and motion_strip.png are beside each report.html")


def _moved(
    frames: int, scene: Scene, camera: Camera, lens: ThinLens, points: Path | None, choice: LensChoice
) -> list[View]:
    """Views of a slow move; focus points are followed at the size of its frames."""
    if not math.isfinite(lens.focus_distance):
        raise InputError(f"motion: got {frames} with focus at infinity, where nothing moves; allowed with finite focus")
    small = camera.with_size(small_size(camera.size))
    return moved_views(View(scene, small, lens_of_points(points, scene, small, lens, choice)), frames)


def _reference(samples: int, seed: int, cluster: Cluster | None) -> Callable[[View, int], Float]:
    """A reference's picture, kept from run to run, with `seed` or one of the next."""

    def picture(view: View, other: int) -> Float:
        return kept_reference(view, samples, None, (seed + other) % 2**32, MAX_SAMPLES, None, cluster)[0].image

    return picture


def _told_apart(comparisons: list[Comparison], names: list[str]) -> list[Comparison]:
    """Files of one name in two folders are called as on the command line."""
    count = Counter(comparison.scene for comparison in comparisons)
    return [
        replace(comparison, scene=name) if count[comparison.scene] > 1 else comparison
        for comparison, name in zip(comparisons, names, strict=True)
    ]


def _announce(forecast: Forecast) -> None:
    print(f"refdof: reference: {forecast}", file=sys.stderr)

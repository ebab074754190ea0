"""The commands `refdof render | export | warm`: pictures of a scene, and what they are made of."""

import json
from pathlib import Path
from typing import Annotated

import typer

from refdof._check import InputError, as_choice
from refdof.compare import warming_up
from refdof.export import export_view, save_stages, with_declared_stages
from refdof.image.arrays import check_arrays_folder
from refdof.image.atomic import check_file
from refdof.image.file import SUFFIXES, save_image
from refdof.listing_cli import in_words
from refdof.methods import METHODS
from refdof.options import (
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
    NoFileCamera,
    NoVignetting,
    Preset,
    Probes,
    Radius,
    Sensor,
    Settings,
    Shading,
    Size,
    Steps,
    Target,
    Threads,
    Units,
    Up,
    Wavelengths,
    listed,
    pixel_of,
    refuse_ignored,
    say_rounded,
    set_threads,
    stages_of,
)
from refdof.progress import progress_line
from refdof.rendering import PRESETS, make_params, render_view
from refdof.scene.builtin import SCENES
from refdof.settings import settings_by_method, settings_of
from refdof.shot import CameraChoice, LensChoice, SceneChoice, lens_of_points, photographic_facts, scene_camera_lens
from refdof.truth.tile_sampler import power_of_two
from refdof.typed import as_typed
from refdof.view import View
from refdof.warm import REFERENCE, is_warm, job_of
from refdof.warm import warm as compile_jobs

__all__ = ["add_main"]


def add_main(app: typer.Typer) -> None:
    """Give `app` the commands."""
    for command in (render, export, warm):
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
        raise InputError(f"output: got {str(output)!r}; allowed are names that end in {', '.join(SUFFIXES)}")
    check_file(output, "output")
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
        _check_pixels(pixel, camera.size)
        view = View(loaded, camera, lens_of_points(focus_points, loaded, camera, lens, chosen))
        photographic = photographic_facts(view, chosen)
        tell(f"{scene}: {method}{compiling}", 0, 0)
        result = render_view(method, view, wanted if stages is not None else False, preset, **params)
        if stages is not None:
            save_stages(method, view, result, stages)
        with as_typed(out="output"):
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
    check_arrays_folder(out)
    names = listed(methods) if methods is not None else with_declared_stages()
    for name in names:
        as_choice("methods", name, METHODS)
    wanted = stages_of(steps, pixel, names)
    params = settings_by_method(settings or [], names, ["best"])
    seen = CameraChoice(size, eye, target, up, fov)
    photo = focal_length, sensor, units
    chosen = LensChoice(lens_radius, focus, lens_file, f_number, wavelengths, no_vignetting, *photo)
    with progress_line(f"{scene}: scene") as tell:
        look = SceneChoice(shading, background, limit, no_file_camera)
        loaded, camera, lens = scene_camera_lens(scene, seen, chosen, look)
        _check_pixels(pixel, camera.size)
        view = View(loaded, camera, lens_of_points(focus_points, loaded, camera, lens, chosen))
        facts = {"out": str(out), "methods": ",".join(names), **photographic_facts(view, chosen)}
        tell(f"{scene}: layers and {', '.join(names) or 'no method'}", 0, 0)
        export_view(view, out, names, params, layers, wanted)
    print(json.dumps(facts) if as_json else in_words(facts))


def warm() -> None:
    """Compile everything now, so that later runs start at once.

    It is for container images and CI.
    """
    with progress_line() as tell:
        compile_jobs([REFERENCE, *(job_of(name, preset) for name in METHODS for preset in PRESETS)], tell)


def _check_pixels(pixels: list[str] | None, size: tuple[int, int]) -> None:
    """Raise if a pixel is none of a picture of this size."""
    for text in pixels or []:
        if not all(place < side for place, side in zip(pixel_of(text), size, strict=True)):
            raise InputError(f"pixel: got {text!r}; allowed are 0,0 .. {size[0] - 1},{size[1] - 1}")

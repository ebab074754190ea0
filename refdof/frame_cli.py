"""The commands `refdof filter | score`: frames and pictures made elsewhere."""

import json
import math
import shlex
import sys
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from refdof._check import InputError, as_number
from refdof.filtering import filter_frame, methods_of_frame
from refdof.frame.depth_kinds import DEPTH_KINDS
from refdof.frame.files import load_frame
from refdof.image.atomic import check_folder
from refdof.image.file import read_color
from refdof.optics.lens import ThinLens
from refdof.options import (
    PRESET_HELP,
    AsJson,
    Crops,
    MethodSettings,
    ThinUnits,
    Threads,
    listed,
    metres_of,
    refuse_ignored,
    set_threads,
)
from refdof.progress import overall, progress_line
from refdof.report import files_line, markdown_table, rows_as_json, terminal_table, write_comparisons
from refdof.report.crops import boxes_of
from refdof.score import score_images
from refdof.settings import settings_by_method
from refdof.typed import as_typed

__all__ = ["add_frames"]

_SENSOR_MM, _MM_PER_METRE = 24.0, 1000.0
_LEAST_FOV, _MOST_FOV = 1e-6, 179.0  # as of a camera
_FILE = "FILE[:LAYER]"
Wide = Annotated[bool | None, typer.Option("--wide", help="Print all columns, beyond 80 characters.")]


def add_frames(app: typer.Typer) -> None:
    """Give `app` the commands."""
    app.command(name="filter")(filter_files)
    app.command()(score)


def filter_files(
    color: Annotated[
        str,
        typer.Option("--color", metavar=_FILE, help="What a pinhole sees: .exr, flat or deep, .png, .hdr or .npy."),
    ],
    depth: Annotated[
        str | None, typer.Option("--depth", metavar=_FILE, help="Depth: .exr or .npy. Default: in the --color file.")
    ] = None,
    depth_kind: Annotated[
        str, typer.Option("--depth-kind", metavar="|".join(DEPTH_KINDS), help="What the depths are.")
    ] = "planar",
    near: Annotated[float | None, typer.Option("--near", help="Near plane of a depth buffer [scene units].")] = None,
    far: Annotated[float | None, typer.Option("--far", help="Far plane of a depth buffer [scene units].")] = None,
    fov: Annotated[float | None, typer.Option("--fov", metavar="DEGREES", help="Vertical field of view.")] = None,
    focus: Annotated[float | None, typer.Option("--focus", help="Focus distance [scene units]; may be inf.")] = None,
    lens_radius: Annotated[float | None, typer.Option("--lens-radius", help="Lens radius [scene units].")] = None,
    f_number: Annotated[
        float | None,
        typer.Option("--f-number", help="Instead of --lens-radius: focal length / (2 F), as the sensor and fov say."),
    ] = None,
    sensor: Annotated[
        float | None, typer.Option("--sensor", help=f"Height of the sensor [mm]. Default: {_SENSOR_MM:g}.")
    ] = None,
    units: ThinUnits = None,
    coc: Annotated[
        str | None,
        typer.Option(
            "--coc",
            metavar=_FILE,
            help="Instead of a lens: signed circles of confusion, radii [px], negative in front of the focal plane.",
        ),
    ] = None,
    reference: Annotated[
        str | None, typer.Option("--reference", metavar=_FILE, help="The picture to score methods against.")
    ] = None,
    methods: Annotated[
        str | None,
        typer.Option("--methods", metavar="A,B,C", help="Methods. Default: all that need no more."),
    ] = None,
    out: Annotated[
        Path, typer.Option("--out", metavar="DIR", help="Output folder for table, images and report.")
    ] = Path("out"),
    settings: MethodSettings = None,
    preset: Annotated[str, typer.Option("--preset", metavar="best|paper|best,paper", help=PRESET_HELP)] = "best",
    crop: Crops = None,
    threads: Threads = None,
    wide: Wide = None,
    as_json: AsJson = False,
) -> None:
    """Blur a frame made elsewhere: a picture with its depth.

    Methods that need triangles are left out. A deep EXR also feeds methods of layers.
    """
    set_threads(threads)
    if as_json:
        refuse_ignored("with --json", "without it", wide=wide)
    check_folder(out)
    presets = listed(preset)
    if coc is None or depth_kind == "radial":
        if fov is None:
            raise InputError("fov: got none; allowed is the vertical field of view [degrees], 1e-06 .. 179")
        as_number("fov", fov, minimum=_LEAST_FOV, maximum=_MOST_FOV)
    else:
        refuse_ignored("with --coc, which replaces it", "without it", fov=fov)
    lens = None
    if coc is None:
        lens = _lens(fov, focus, lens_radius, f_number, sensor, units)
    else:
        said = {"focus": focus, "lens_radius": lens_radius, "f_number": f_number, "sensor": sensor, "units": units}
        refuse_ignored("with --coc, which replaces it", "without it", **said)
    frame = load_frame(color, depth, 40.0 if fov is None else fov, lens, coc, depth_kind, near, far)
    boxes = boxes_of(crop or [], frame.camera.size)
    names = methods_of_frame(frame) if methods is None else listed(methods)
    with as_typed(method="methods"):
        params = settings_by_method(settings or [], names, presets)
    truth = None if reference is None else read_color("reference", reference)
    command = "refdof " + shlex.join(sys.argv[1:])
    with progress_line() as tell:
        comparison = filter_frame(frame, names, params, presets, truth, overall(tell, frame.name, 0, 1))
        tell("report", 1, 1)
        comparison = replace(comparison, crops=boxes)
        write_comparisons([comparison], out, command)
    if as_json:
        print(json.dumps(rows_as_json(comparison, command), indent=2))
        return
    print(markdown_table([comparison]) if wide else terminal_table([comparison]))
    print(files_line(out, bool(wide)))


def _lens(
    fov: Any,
    focus: float | None,
    radius: float | None,
    f_number: Any,
    sensor: float | None,
    units: str | None,
) -> ThinLens:
    """The lens that options say."""
    if focus is None:
        raise InputError("focus: got none; allowed is the distance in focus in scene units, above 0, or inf")
    as_number("focus", focus, above=0.0, finite=False)
    if (radius is None) == (f_number is None):
        got = "neither --lens-radius nor" if radius is None else "--lens-radius and"
        raise InputError(f"f-number: got {got} --f-number; allowed is one of the two")
    if radius is not None:
        refuse_ignored("with --lens-radius", "without it", sensor=sensor, units=units)
        return ThinLens(as_number("lens-radius", radius, minimum=0.0), focus)
    as_number("f-number", f_number, above=0.0)
    height = as_number("sensor", _SENSOR_MM if sensor is None else sensor, above=0.0)
    metres = metres_of(units)
    focal_mm = height / (2.0 * math.tan(math.radians(fov) / 2.0))
    with as_typed(focus_distance="focus", f_number="f-number"):
        return ThinLens.from_f_number(focal_mm / (_MM_PER_METRE * metres), f_number, focus)


def score(
    reference: Annotated[str, typer.Argument(metavar="REF", help="The reference: .exr, .png, .hdr or .npy.")],
    images: Annotated[list[str], typer.Argument(metavar="IMAGE...", help="Pictures of the same size.")],
    variance: Annotated[
        str | None,
        typer.Option("--variance", metavar=_FILE, help="Variance of each value of the reference, for its noise floor."),
    ] = None,
    second: Annotated[
        str | None,
        typer.Option(
            "--second", metavar=_FILE, help="An independent reference of as many samples, for the noise floor instead."
        ),
    ] = None,
    threads: Threads = None,
    wide: Wide = None,
    as_json: AsJson = False,
) -> None:
    """Score pictures made elsewhere with all metrics.

    Linear pictures are compared as they are; a PNG is decoded from sRGB.
    """
    set_threads(threads)
    if as_json:
        refuse_ignored("with --json", "without it", wide=wide)
    if variance is not None:
        refuse_ignored("with --variance", "without it", second=second)
    with progress_line() as tell:
        found = score_images(reference, images, variance, second, lambda done, count: tell("scores", done, count))
    print(json.dumps(found.as_json(), indent=2) if as_json else found.table(bool(wide)))

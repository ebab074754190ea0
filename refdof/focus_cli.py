"""The commands `refdof pick` and `refdof focus`: focus points on a scene, and pictures of a lens that follows them."""

import json
from pathlib import Path
from typing import Annotated

import typer

from refdof._check import InputError, as_number
from refdof.focus.focus_file import load_focus, point_text
from refdof.focus.focus_lens import focus_lens
from refdof.focus.point import pick as pick_point
from refdof.image.atomic import atomic_folder, check_own_folder
from refdof.image.file import save_image
from refdof.options import (
    AsJson,
    Background,
    Eye,
    FieldFocalLength,
    FieldSensor,
    FocalLength,
    Fov,
    Limit,
    NoFileCamera,
    Preset,
    Radius,
    Sensor,
    Settings,
    Shading,
    Size,
    Target,
    ThinFNumber,
    ThinUnits,
    Threads,
    Up,
    pixel_of,
    set_threads,
)
from refdof.progress import progress_line
from refdof.rendering import make_params, render_view
from refdof.settings import settings_of
from refdof.shot import THIN, CameraChoice, LensChoice, SceneChoice, scene_camera_lens
from refdof.view import View

__all__ = ["add_focus"]

_MOST_FRAMES = 100_000
_FORMATS = ("png", "exr", "npy")

Points = Annotated[Path, typer.Option("--points", metavar="FILE", help="Focus points, a focus.toml.")]


def add_focus(app: typer.Typer) -> None:
    """Give `app` the commands."""
    app.command()(pick)
    app.command()(focus)


def pick(
    scene: Annotated[str, typer.Argument(metavar="SCENE", help="Built-in scene or mesh file.")],
    pixel: Annotated[str, typer.Option("--pixel", metavar="X,Y", help="Column and row, from the upper left.")],
    size: Size = None,
    eye: Eye = None,
    target: Target = None,
    up: Up = None,
    fov: Fov = None,
    limit: Limit = None,
    no_file_camera: NoFileCamera = None,
    focal_length: FieldFocalLength = None,
    sensor: FieldSensor = None,
    frame: Annotated[int, typer.Option("--frame", metavar="N", help="Frame of an animated scene, 24 a second.")] = 0,
    name: Annotated[str, typer.Option("--name", help="What the point is called.")] = "",
    as_json: AsJson = False,
) -> None:
    """Print the focus point under a pixel, ready for a focus.toml."""
    lens = LensChoice(focal_length=focal_length, sensor=sensor, known=("focal-length", "sensor"))
    read = SceneChoice(None, None, limit, no_file_camera)
    shot = View(*scene_camera_lens(scene, CameraChoice(size, eye, target, up, fov), lens, read))
    view = shot.at_frame(as_number("frame", frame, minimum=0))
    point = pick_point(view, pixel_of(pixel), name)
    if as_json:
        facts = {"name": point.name, "triangle": point.triangle, "barycentrics": point.barycentrics}
        print(json.dumps(facts))
    else:
        print(point_text(point))


def focus(
    scene: Annotated[str, typer.Argument(metavar="SCENE", help="Built-in scene or mesh file.")],
    points: Points,
    method: Annotated[str, typer.Option("--method", help="Method name, see `refdof methods`.")],
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder for the pictures; made if it is missing.")],
    frames: Annotated[
        str, typer.Option("--frames", metavar="A:B", help="Frames A to B - 1, 24 a second. Default: frame 0.")
    ] = "0:1",
    file_format: Annotated[
        str, typer.Option("--format", metavar="png|exr|npy", help="Of the pictures: display, or linear.")
    ] = "png",
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
    f_number: ThinFNumber = None,
    focal_length: FocalLength = None,
    sensor: Sensor = None,
    units: ThinUnits = None,
    threads: Threads = None,
    as_json: AsJson = False,
) -> None:
    """Render frames with a lens that follows focus points.

    Keyframes of the points and the animation of a glTF file move with the frames.
    """
    set_threads(threads)
    if file_format not in _FORMATS:
        raise InputError(f"format: got {file_format!r}; allowed are {', '.join(_FORMATS)}")
    first, end = _frames(frames)
    check_own_folder(out, _is_frame)
    params = settings_of(settings or [])
    make_params(method, params, preset)
    seen, look = CameraChoice(size, eye, target, up, fov), SceneChoice(shading, background, limit, no_file_camera)
    photo = focal_length, sensor, units
    lens = LensChoice(lens_radius, None, None, f_number, None, None, *photo, THIN)
    shot = View(*scene_camera_lens(scene, seen, lens, look))
    wanted = load_focus(points, "points")
    names = []
    with progress_line(f"{scene}: compiling") as tell, atomic_folder(out) as temporary:
        for frame in range(first, end):
            tell(f"{scene}: frame {frame}", frame - first, end - first)
            view = shot.at_frame(frame).with_lens(focus_lens(wanted, shot, frame))
            names.append(f"{frame:05d}.{file_format}")
            save_image(temporary / names[-1], render_view(method, view, preset=preset, **params).image)
    print(json.dumps({"out": str(out), "files": names}) if as_json else f"out={out}, frames={len(names)}")


def _is_frame(name: str) -> bool:
    number, _, kind = name.partition(".")
    return number.isdecimal() and kind in _FORMATS


def _frames(text: str) -> tuple[int, int]:
    first, _, end = text.partition(":")
    if not all(word.isdecimal() and len(word) < 7 for word in (first, end)) or not int(first) < int(end):
        raise InputError(f"frames: got {text!r}; allowed is A:B, whole numbers with A below B")
    if int(end) - int(first) > _MOST_FRAMES:
        raise InputError(f"frames: got {int(end) - int(first)} of them; allowed are at most {_MOST_FRAMES}")
    return int(first), int(end)

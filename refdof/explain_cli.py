"""The command `refdof explain`: what made a pixel, of a case of a pack or of a scene."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from refdof._check import InputError
from refdof.explain import Explanation, csv_of, explain_pictures, explain_view, save_picture, text_of
from refdof.explain.pictures import Pictures, given_pictures
from refdof.image.atomic import atomic_folder, check_own_folder
from refdof.methods import METHODS
from refdof.options import (
    PRESET_HELP,
    AsJson,
    Background,
    Eye,
    FocalLength,
    Focus,
    Fov,
    Limit,
    NoFileCamera,
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
    refuse_ignored,
    set_threads,
)
from refdof.oracle.case import in_file_order
from refdof.oracle.files import FileFault, open_pack
from refdof.rendering import make_params
from refdof.scene.builtin import SCENES
from refdof.settings import settings_of
from refdof.shot import THIN, CameraChoice, LensChoice, SceneChoice, scene_camera_lens
from refdof.view import View

__all__ = ["add_explain"]

_LENS = ("coc_scale", "focus")
_FILES = ("explanation.json", "table.csv", "picture.png")


def add_explain(app: typer.Typer) -> None:
    """Give `app` the command."""
    app.command()(explain)


@dataclass(frozen=True)
class _Case:
    """A case of a pack: its method, parameters and pictures, rows top-down."""

    method: str
    params: Any
    given: Pictures


def explain(
    case: Annotated[
        str, typer.Argument(metavar="CASE", help="Folder of a case in a pack, or a built-in scene or mesh file.")
    ],
    pixel: Annotated[
        str,
        typer.Option("--pixel", metavar="X,Y", help="Column and row; 0,0 is the first of the picture or of the files."),
    ],
    method: Annotated[str | None, typer.Option("--method", help="For a scene: which method.")] = None,
    stage: Annotated[str, typer.Option("--stage", help="A stage of the method instead of its picture.")] = "image",
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Also write the whole table and a picture, PNG.")
    ] = None,
    settings: Settings = None,
    preset: Annotated[
        str | None, typer.Option("--preset", metavar="best|paper", help=f"{PRESET_HELP} Default: best.")
    ] = None,
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
    f_number: ThinFNumber = None,
    focal_length: FocalLength = None,
    sensor: Sensor = None,
    units: ThinUnits = None,
    threads: Threads = None,
    as_json: AsJson = False,
) -> None:
    """Explain a pixel: every tap, ray, layer and weight that made it.

    Their sum stands beside the method's value.

    The exit status is 1 if the table's sum is not the method's value.
    """
    set_threads(threads)
    place = pixel_of(pixel)
    if out is not None:
        check_own_folder(out, _FILES.__contains__)
    if (Path(case) / "case.json").exists():
        refuse_ignored(
            "with a case, which has its own", "with a scene",
            method=method, set=settings, preset=preset, size=size, eye=eye, target=target, up=up, fov=fov,
            lens_radius=lens_radius, focus=focus, shading=shading, background=background, f_number=f_number,
            focal_length=focal_length, sensor=sensor, units=units, limit=limit, no_file_camera=no_file_camera,
        )  # fmt: skip
        read = _read_case(Path(case))
        found = explain_pictures(read.method, read.given, read.params, place, stage)
    else:
        if Path(case).is_dir() or (method is None and case not in SCENES and not Path(case).exists()):
            allowed = "a folder PACK/cases/NAME of a pack, a built-in scene or a mesh file"
            raise InputError(f"case: got {case!r}; allowed is {allowed}")
        if method is None:
            raise InputError(f"method: got none with a scene; allowed are {', '.join(METHODS)}")
        params = make_params(method, settings_of(settings or []), "best" if preset is None else preset)
        photo = focal_length, sensor, units
        lens = LensChoice(lens_radius, focus, None, f_number, None, None, *photo, THIN)
        seen, look = CameraChoice(size, eye, target, up, fov), SceneChoice(shading, background, limit, no_file_camera)
        view = View(*scene_camera_lens(case, seen, lens, look))
        found = explain_view(method, view, params, place, stage)
    if out is not None:
        _write(out, found)
    print(json.dumps(found.as_json()) if as_json else text_of(found))
    raise typer.Exit(0 if found.agrees else 1)


def _read_case(folder: Path) -> _Case:
    """A case as `refdof golden` wrote it, in its pack.

    Raises
    ------
    InputError
        If it is no case of a pack, or a file is not as it was written.
    """
    folder = folder.resolve()
    pack = open_pack(folder.parent.parent)
    if folder.parent.name != "cases" or folder.name not in pack.cases:
        raise InputError(f"case: got {str(folder)!r}; allowed is a folder PACK/cases/NAME of a pack")
    try:
        about = pack.description(folder.name)
        width, height = (int(side) for side in about["size"])
        shapes = {"color": (height, width, 3), "depth": (height, width), "coc": (height, width)}
        images = [pack.array(folder.name, about["inputs"][name]["npy"], shape) for name, shape in shapes.items()]
        lens = [None if about.get("lens", {}).get(name) is None else float(about["lens"][name]) for name in _LENS]
        method, values, rows = str(about["method"]), dict(about["params"]), str(about["rows"])
    except FileFault as fault:
        raise InputError(f"case: {folder.name}: {fault}") from None
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise InputError(f"case: case.json of {folder.name} lacks or garbles {error}") from None
    color, depth, coc = (np.ascontiguousarray(image) for image in images)
    params = in_file_order(make_params(method, values), rows)  # pixels are counted as `refdof check` counts them
    return _Case(method, params, given_pictures(color, depth, coc, *lens))


def _write(folder: Path, found: Explanation) -> None:
    """Write all rows, and the picture."""
    with atomic_folder(folder) as temporary:
        (temporary / "explanation.json").write_text(json.dumps(found.as_json(), indent=1) + "\n", encoding="utf-8")
        (temporary / "table.csv").write_text(csv_of(found), encoding="utf-8", newline="\n")
        save_picture(temporary / "picture.png", found)

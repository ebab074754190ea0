"""The command `refdof lens`: the numbers of a lens, and drawings of what it does to light."""

import json
import math
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer

from refdof._check import InputError, as_number
from refdof.image.atomic import atomic_folder, check_own_folder
from refdof.optics.systems.data_sheet import FILM, DataSheet, data_sheet, focused
from refdof.optics.systems.paraxial import nearest_focus
from refdof.optics.systems.prescription import LENSES, load_lens
from refdof.options import AsJson, Threads, set_threads
from refdof.report.text import one_line

__all__ = ["add_lens"]

DRAWINGS = ("cross_section.png", "spots.png", "longitudinal_aberration.png", "field_curvature.png")


def add_lens(app: typer.Typer) -> None:
    """Give `app` the command."""
    app.command()(lens)


def lens(
    file: Annotated[
        str, typer.Argument(metavar="FILE", help=f"A .toml, .dat or .zmx file, or one of {', '.join(LENSES)}.")
    ],
    focus: Annotated[
        float, typer.Option("--focus", help="Distance in focus, in metres before the entrance pupil; may be inf.")
    ] = math.inf,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Also write drawings, PNG, into this folder.")
    ] = None,
    threads: Threads = None,
    as_json: AsJson = False,
) -> None:
    """Measure a lens, and draw it with --out.

    Focal length, f-number, T-stop, pupils, field of view, vignetting and distortion.
    """
    set_threads(threads)
    distance = 1000.0 * as_number("focus", focus, above=0.0, finite=False)
    if out is not None:
        check_own_folder(out, DRAWINGS.__contains__)
    system = load_lens(file)
    nearest = nearest_focus(system)
    if not distance > nearest:
        raise InputError(f"focus: got {focus:g}; allowed is more than {nearest / 1000.0:.6g} metres")
    system = focused(system, distance)
    sheet = data_sheet(system, distance)
    if out is not None:
        from refdof.report.lens_drawings import draw_lens  # matplotlib is slow to import

        with atomic_folder(out) as temporary:
            draw_lens(system, distance, [temporary / name for name in DRAWINGS])
    print(json.dumps(_plain(asdict(sheet)), indent=2) if as_json else _text(sheet))


def _text(sheet: DataSheet) -> str:
    """A table of the lens, and one of the field."""
    width, height = FILM
    rows = [
        ("lens", one_line(sheet.name)),
        ("source", one_line(sheet.source)),
        ("focal length", f"{sheet.focal_length:.3f} mm"),
        ("f-number", f"{sheet.f_number:.3f}"),
        ("T-stop", f"{sheet.t_stop:.3f} (uncoated glass, absorption not counted)"),
        ("in focus at", _distance(sheet.focus_distance)),
        ("principal planes", f"{sheet.front_principal:.3f} and {sheet.back_principal:.3f} mm"),
        ("entrance pupil", f"at {sheet.entrance_pupil_z:.3f} mm, radius {sheet.entrance_pupil_radius:.3f} mm"),
        ("exit pupil", f"at {sheet.exit_pupil_z:.3f} mm, radius {sheet.exit_pupil_radius:.3f} mm"),
        ("last surface, sensor", f"at {sheet.last_vertex:.3f} and {sheet.sensor:.3f} mm"),
        (
            f"field of view, {width:g} x {height:g} mm",
            f"{sheet.field_width:.2f} x {sheet.field_height:.2f} degrees, diagonal {sheet.field_diagonal:.2f}",
        ),
    ]
    wide = max(len(name) for name, _ in rows)
    lines = [f"{name.ljust(wide)}  {value}" for name, value in rows]
    lines += ["", "film height [mm]  light / centre  pupil height / width  distortion"]
    for row in sheet.field:
        values = f"{row.height:16g}", f"{row.light:14.3f}", f"{_shown(row.cat_eye, '.3f'):>20}"
        lines.append("  ".join([*values, f"{_shown(row.distortion, '+.3%'):>10}"]))
    return "\n".join(lines)


def _distance(metres: float) -> str:
    return "infinity" if math.isinf(metres) else f"{metres:g} m"


def _shown(number: float, form: str) -> str:
    return format(number, form) if math.isfinite(number) else "-"


def _plain(value: Any) -> Any:
    """JSON has neither infinity nor NaN: null."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return value if not isinstance(value, float) or math.isfinite(value) else None

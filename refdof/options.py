"""Options of the command line: their help, and what their words mean."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from refdof._check import InputError, as_integer, as_number
from refdof._jit import use_threads
from refdof.methods import METHODS
from refdof.scene.material import SHADINGS
from refdof.stages import Stages
from refdof.truth.reference import MAX_SAMPLES
from refdof.typed import as_typed

__all__ = [
    "DEFAULT_SCENE",
    "PRESET_HELP",
    "AsJson",
    "Background",
    "Eye",
    "FNumber",
    "FieldFocalLength",
    "FieldSensor",
    "FocalLength",
    "Focus",
    "FocusPoints",
    "Fov",
    "Lens",
    "Limit",
    "MethodSettings",
    "Most",
    "NoFileCamera",
    "NoVignetting",
    "Preset",
    "Probes",
    "Radius",
    "Samples",
    "Scheduler",
    "Seed",
    "Sensor",
    "Settings",
    "Shading",
    "Size",
    "Steps",
    "Target",
    "ThinFNumber",
    "ThinUnits",
    "Threads",
    "Tolerance",
    "Units",
    "Up",
    "Wavelengths",
    "Workers",
    "listed",
    "metres_of",
    "pixel_of",
    "refuse_ignored",
    "sample_counts",
    "say_rounded",
    "set_threads",
    "stages_of",
]

DEFAULT_SCENE = "fence"
Size = Annotated[
    str | None, typer.Option("--size", metavar="WxH", help="Image size in pixels. Default: the scene's own.")
]
Shading = Annotated[
    str | None,
    typer.Option("--shading", metavar="|".join(SHADINGS), help="Of all surfaces. Default: the scene's own."),
]
Background = Annotated[
    str | None,
    typer.Option("--background", metavar="R,G,B", help="Linear colour behind everything. Default: the scene's own."),
]
_PLACE, _UNITS = "X,Y,Z", "m|cm|mm|inch|ft|METRES"
Eye = Annotated[
    str | None, typer.Option("--eye", metavar=_PLACE, help="Where the camera stands. Default: the scene's own.")
]
Target = Annotated[
    str | None,
    typer.Option("--target", metavar=_PLACE, help="What the camera looks at. Default: the scene's own."),
]
Up = Annotated[
    str | None,
    typer.Option("--up", metavar=_PLACE, help="What is upwards in the picture. Default: the scene's own."),
]
Fov = Annotated[
    float | None, typer.Option("--fov", metavar="DEGREES", help="Vertical field of view. Default: the scene's own.")
]
Radius = Annotated[
    float | None, typer.Option("--lens-radius", help="Lens radius in scene units. Default: the scene's own.")
]
Focus = Annotated[
    float | None, typer.Option("--focus", help="Focus distance in scene units; may be inf. Default: the scene's own.")
]
Lens = Annotated[
    str | None,
    typer.Option(
        "--lens",
        metavar="FILE",
        help="A real lens, a name or file as in `refdof lens`; scaled to the lens radius, it sets the field of view.",
    ),
]
FNumber = Annotated[
    float | None,
    typer.Option(
        "--f-number",
        help="Focal length over the lens's diameter: with --lens, its stop, by default open as far as it goes; with "
        "--focal-length or --sensor, it sets the lens radius.",
    ),
]
ThinFNumber = Annotated[  # of a command without --lens
    float | None,
    typer.Option(
        "--f-number",
        help="Focal length over the lens's diameter: with --focal-length or --sensor, it sets the lens radius.",
    ),
]
FocalLength = Annotated[
    float | None,
    typer.Option(
        "--focal-length",
        metavar="MM",
        help="In millimetres: with --f-number it sets the lens radius, with --sensor the field of view.",
    ),
]
FieldFocalLength = Annotated[  # of a command without --f-number
    float | None,
    typer.Option("--focal-length", metavar="MM", help="In millimetres: with --sensor it sets the field of view."),
]
Sensor = Annotated[
    float | None,
    typer.Option(
        "--sensor",
        metavar="MM",
        help="Height of the sensor in millimetres: with --focal-length it sets the field of view; without, and with "
        "--f-number, the focal length follows from the field of view.",
    ),
]
FieldSensor = Annotated[
    float | None,
    typer.Option(
        "--sensor",
        metavar="MM",
        help="Height of the sensor in millimetres: with --focal-length it sets the field of view.",
    ),
]
Units = Annotated[
    str | None,
    typer.Option(
        "--units",
        metavar=_UNITS,
        help="What a scene unit is, for --f-number; a --lens then has its own size. Default: m.",
    ),
]
ThinUnits = Annotated[
    str | None,
    typer.Option("--units", metavar=_UNITS, help="What a scene unit is, for --f-number. Default: m."),
]
Wavelengths = Annotated[
    int | None,
    typer.Option(
        "--wavelengths",
        metavar="N",
        help="Trace the --lens at so many wavelengths, 3 to 31, each a pass. Default: 3, for red, green and blue.",
    ),
]
NoVignetting = Annotated[
    bool | None, typer.Option("--no-vignetting", help="Let nothing but its stop block light in the --lens.")
]
FocusPoints = Annotated[
    Path | None,
    typer.Option("--focus-points", metavar="FILE", help="A focus.toml, whose points the lens follows: `refdof pick`."),
]
Limit = Annotated[
    list[str] | None,
    typer.Option("--limit", metavar="NAME=NUMBER", help="Most that reading a file may take: pixels=1e9. Repeatable."),
]
NoFileCamera = Annotated[
    bool | None, typer.Option("--no-file-camera", help="Suggest a shot even if a glTF file has a camera of its own.")
]
Seed = Annotated[int, typer.Option("--seed", help="Random seed of the reference.")]
_METRES = {"m": 1.0, "cm": 0.01, "mm": 0.001, "inch": 0.0254, "ft": 0.3048}
_SAMPLES = 256
Samples = Annotated[
    int | None,
    typer.Option("--samples", help=f"Lens samples per pixel of the reference. Default: {_SAMPLES}."),
]
Tolerance = Annotated[
    float | None,
    typer.Option(
        "--tolerance",
        help="Sample each pixel until its standard error, in linear values, is below this; replaces --samples.",
    ),
]
Most = Annotated[
    int | None,
    typer.Option(
        "--max-samples", help=f"With --tolerance: stop a pixel after this many samples. Default: {MAX_SAMPLES}."
    ),
]
Threads = Annotated[int | None, typer.Option("--threads", help="Number of threads; results do not depend on it.")]
Scheduler = Annotated[
    str | None,
    typer.Option(
        "--scheduler",
        metavar="tcp://HOST:PORT",
        help="Make references on the workers of this Dask scheduler, with the same bits; needs refdof[distributed].",
    ),
]
Workers = Annotated[
    int | None,
    typer.Option("--workers", metavar="N", help="Instead of --scheduler: on N processes on this machine."),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON instead of text.")]
PRESET_HELP = "Start from the parameters that come closest to the reference (best) or from the paper's text (paper)."
Preset = Annotated[str, typer.Option("--preset", metavar="best|paper", help=PRESET_HELP)]
Crops = Annotated[
    list[str] | None,
    typer.Option(
        "--crop", metavar="X,Y,W,H", help="Show this window enlarged in the report; repeatable. Default: two."
    ),
]
Settings = Annotated[list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Set a parameter; repeatable.")]
MethodSettings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="METHOD.KEY=VALUE", help="Set a parameter of one method; repeatable."),
]
Steps = Annotated[
    str | None,
    typer.Option(
        "--steps",
        metavar="K,K,...",
        help="Steps of a method's loop whose state is kept, such as taps. Default: 1, 4, 16 ..",
    ),
]
Probes = Annotated[
    list[str] | None,
    typer.Option("--pixel", metavar="X,Y", help="A pixel whose loop is kept step by step; up to 16. Default: 4 x 4."),
]


def refuse_ignored(why: str, allowed: str, **options: Any) -> None:
    """Raise if one of these options is given, which would be ignored: an option does what it says or is refused."""
    for name, value in options.items():
        if value is not None:
            raise InputError(f"{name.replace('_', '-')}: got {value!r} {why}; allowed {allowed}")


def sample_counts(samples: int | None, tolerance: float | None, most: int | None) -> tuple[int, int]:
    """Samples per pixel of the reference without a tolerance, and at most with one."""
    if tolerance is None:
        refuse_ignored("without --tolerance", "with it", max_samples=most)
    else:
        refuse_ignored("with --tolerance, which replaces it", "without it", samples=samples)
    return _SAMPLES if samples is None else samples, MAX_SAMPLES if most is None else most


def say_rounded(what: str, asked: int, taken: int) -> None:
    """Say on stderr that more samples are taken than were asked for."""
    if asked != taken:
        print(f"refdof: {what}: {asked} samples per pixel are rounded up to {taken}", file=sys.stderr)


def metres_of(units: str | None) -> float:
    """How many metres a scene unit has, of --units."""
    text = "m" if units is None else units.strip()
    try:
        return _METRES[text] if text in _METRES else as_number("units", float(text), minimum=1e-12, maximum=1e12)
    except ValueError:
        allowed = f"{', '.join(_METRES)}, or how many metres a scene unit has, 1e-12 to 1e12"
        raise InputError(f"units: got {units!r}; allowed are {allowed}") from None


def stages_of(steps: str | None, pixels: list[str] | None, methods: Sequence[str]) -> Stages:
    """The stages that options ask for, of methods of which at least one has such."""
    declared = [stage for name in methods for stage in METHODS[name].METHOD.stages]
    none = f"with methods that record none ({', '.join(methods)})"
    if not any(stage.name.endswith("*") for stage in declared):
        refuse_ignored(none, "with one whose stages have steps, see `refdof methods --json`", steps=steps)
    if not any(stage.axes.startswith("P ") for stage in declared):
        refuse_ignored(none, "with one whose stages have probes, see `refdof methods --json`", pixel=pixels)
    places = None if pixels is None else tuple(pixel_of(text) for text in pixels)
    with as_typed(pixels="pixel"):
        return Stages(None if steps is None else _whole("steps", steps), places)


def pixel_of(text: str) -> tuple[int, int]:
    """'X,Y' as a column and a row."""
    place = _whole("pixel", text)
    if len(place) != 2:
        raise InputError(f"pixel: got {text!r}; allowed is X,Y")
    return place[0], place[1]


def _whole(name: str, text: str) -> tuple[int, ...]:
    words = listed(text)
    if not all(word.isdecimal() and len(word) < 10 for word in words):
        raise InputError(f"{name}: got {text!r}; allowed are whole numbers between commas")
    return tuple(int(word) for word in words)


def listed(text: str) -> list[str]:
    """Words between commas."""
    return [word.strip() for word in text.split(",")]


def set_threads(threads: int | None) -> None:
    """Use so many threads; None: as many as there are."""
    if threads is not None:
        use_threads(as_integer("threads", threads, minimum=1))

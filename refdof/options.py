"""Options of the command line: their help, and what their words mean."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from refdof._check import InputError, as_integer, as_pair
from refdof._jit import use_threads
from refdof.focus.focus_file import load_focus
from refdof.focus.focus_lens import focus_lens
from refdof.methods import METHODS
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens
from refdof.optics.systems.paraxial import entrance_pupil
from refdof.optics.systems.prescription import load_lens
from refdof.optics.systems.system_lens import SystemLens
from refdof.rendering import make_params
from refdof.scene.load import load_scene
from refdof.scene.scene import Scene
from refdof.stages import Stages
from refdof.truth.reference import MAX_SAMPLES
from refdof.view import View

__all__ = [
    "DEFAULT_SCENE",
    "PRESET_HELP",
    "AsJson",
    "FNumber",
    "Focus",
    "FocusPoints",
    "Lens",
    "MethodSettings",
    "Most",
    "NoVignetting",
    "Preset",
    "Probes",
    "Radius",
    "Samples",
    "Seed",
    "Settings",
    "Size",
    "Steps",
    "Threads",
    "Tolerance",
    "Wavelengths",
    "lens_of_points",
    "listed",
    "pixel_of",
    "refuse_ignored",
    "sample_counts",
    "scene_camera_lens",
    "set_threads",
    "settings_by_method",
    "settings_of",
    "stages_of",
]

DEFAULT_SCENE = "fence"
Size = Annotated[
    str | None, typer.Option("--size", metavar="WxH", help="Image size in pixels. Default: the scene's own.")
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
    float | None, typer.Option("--f-number", help="Stop of the --lens. Default: open as far as it goes.")
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
Seed = Annotated[int, typer.Option("--seed", help="Random seed of the reference.")]
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
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON instead of text.")]
PRESET_HELP = "Start from the parameters that come closest to the reference (best) or from the paper's text (paper)."
Preset = Annotated[str, typer.Option("--preset", metavar="best|paper", help=PRESET_HELP)]
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


def stages_of(steps: str | None, pixels: list[str] | None, methods: Sequence[str]) -> Stages:
    """The stages that options ask for, of methods of which at least one has such."""
    declared = [stage for name in methods for stage in METHODS[name].METHOD.stages]
    none = f"with methods that record none ({', '.join(methods)})"
    if not any(stage.name.endswith("*") for stage in declared):
        refuse_ignored(none, "with one whose stages have steps, see `refdof methods --json`", steps=steps)
    if not any(stage.axes.startswith("P ") for stage in declared):
        refuse_ignored(none, "with one whose stages have probes, see `refdof methods --json`", pixel=pixels)
    places = None if pixels is None else tuple(pixel_of(text) for text in pixels)
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


def scene_camera_lens(
    name: str,
    size: str | None,
    lens_radius: float | None,
    focus: float | None,
    lens_file: str | None = None,
    f_number: float | None = None,
    wavelengths: int | None = None,
    no_vignetting: bool | None = None,
) -> tuple[Scene, Camera, ThinLens]:
    """Load a scene and put the options over its suggested shot.

    A lens system is scaled so that its entrance pupil, open as far as it goes, has the lens radius.
    """
    pixels = None if size is None else _size(size)
    if lens_file is None:
        given = {"f_number": f_number, "wavelengths": wavelengths, "no_vignetting": no_vignetting}
        refuse_ignored("without --lens", "with it", **given)
    system = None if lens_file is None else load_lens(lens_file)
    scene = load_scene(name)
    camera = scene.camera if pixels is None else scene.camera.with_size(pixels)
    lens = scene.lens
    try:
        lens = replace(
            lens,
            radius=lens.radius if lens_radius is None else lens_radius,
            focus_distance=lens.focus_distance if focus is None else focus,
        )
    except InputError as error:  # by the names of the options
        names = str(error).replace("radius:", "lens-radius:", 1).replace("focus_distance:", "focus:", 1)
        raise InputError(names) from None
    if system is None:
        return scene, camera, lens
    if lens.radius == 0.0:
        raise InputError("lens-radius: got 0 with --lens; allowed is a size to which the lens is scaled, above 0")
    try:
        scale, count = entrance_pupil(system).radius / lens.radius, 3 if wavelengths is None else wavelengths
        real = SystemLens(system, lens.focus_distance, f_number, scale, count, not no_vignetting)
    except InputError as error:
        names = str(error).replace("f_number:", "f-number:", 1).replace("focus_distance:", "focus:", 1)
        raise InputError(names) from None
    return scene, real.seen_by(camera), real


def lens_of_points(
    points: Path | None, scene: Scene, camera: Camera, lens: ThinLens, focus: float | None, lens_file: str | None
) -> ThinLens:
    """The lens that follows the focus points of a file; the lens itself without one. It calls kernels."""
    if points is None:
        return lens
    refuse_ignored("with --focus-points, which set it", "without them", focus=focus)
    refuse_ignored("with --focus-points, which need a thin lens", "without them", lens=lens_file)
    return focus_lens(load_focus(points), View(scene, camera, lens))


def listed(text: str) -> list[str]:
    """Words between commas."""
    return [word.strip() for word in text.split(",")]


def _size(text: str) -> tuple[int, int]:
    width, _, height = text.lower().partition("x")
    if not (width.isdigit() and height.isdigit()):
        raise InputError(f"size: got {text!r}; allowed is WIDTHxHEIGHT, such as 640x480")
    return as_pair("size", (width, height), minimum=1, maximum=32768)


def set_threads(threads: int | None) -> None:
    """Use so many threads; None: as many as there are."""
    if threads is not None:
        use_threads(as_integer("threads", threads, minimum=1))


def settings_of(texts: list[str], **options: Any) -> dict[str, Any]:
    """'key=value' lines, and options of the same meaning where they are given, as {key: value}."""
    values: dict[str, Any] = {}
    pairs = [_setting(text) for text in texts]
    for key, value in [*pairs, *((name, value) for name, value in options.items() if value is not None)]:
        if key in values:
            raise InputError(f"{key}: got {values[key]!r} and {value!r}; allowed is one value")
        values[key] = value
    return values


def _setting(text: str) -> tuple[str, Any]:
    """'key=value' as a name and a number, a truth value or a word."""
    key, equals, value = text.partition("=")
    if not equals or not key:
        raise InputError(f"set: got {text!r}; allowed is KEY=VALUE")
    for parse in (int, float, {"true": True, "false": False, "None": None}.__getitem__):
        try:
            return key, parse(value)
        except (ValueError, KeyError):
            continue
    return key, value


def settings_by_method(texts: list[str], methods: list[str], presets: list[str]) -> dict[str, dict[str, Any]]:
    """'method.key=value' lines as {method: {key: value}}."""
    params: dict[str, dict[str, Any]] = {name: {} for name in methods}
    for key, value in settings_of(texts).items():
        method, dot, field = key.partition(".")
        if not dot or method not in params:
            known = f", METHOD one of {', '.join(methods)}"
            raise InputError(f"set: got '{key}={value}'; allowed is METHOD.KEY=VALUE{known}")
        params[method][field] = value
    for method, values in params.items():
        for preset in presets:
            make_params(method, values, preset)
    return params

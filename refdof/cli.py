"""The command line: `refdof scenes | methods | render | compare | warm`.

stdout carries the result only; progress and errors go to stderr. Exit status: 0 done, 2 bad input, with one line that
names the argument, what it got and what is allowed.
"""

import json
import shlex
import sys
import textwrap
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from refdof._check import InputError, as_integer, as_pair
from refdof._jit import use_threads
from refdof.compare import compare as compare_scene
from refdof.image.atomic import check_folder
from refdof.image.file import SUFFIXES, save_image
from refdof.methods import METHODS
from refdof.methods._contract import facts_of
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens
from refdof.rendering import PRESETS, make_params, render_view
from refdof.report import markdown_table, rows_as_json, write_comparisons
from refdof.report.rows import plain
from refdof.scene.builtin import SCENES, shot_of
from refdof.scene.load import load_scene
from refdof.scene.scene import Scene
from refdof.truth.forecast import Forecast
from refdof.truth.reference import MAX_SAMPLES
from refdof.view import View
from refdof.warm import REFERENCE, job_of
from refdof.warm import warm as compile_jobs

__all__ = ["app", "main"]

DEFAULT_SCENE = "fence"
_INTERRUPTED = 130  # what a shell reports after Ctrl-C
_UsageError: Any = typer.BadParameter.__bases__[0]  # wrong words on the command line, whichever click typer brings

app = typer.Typer(
    name="refdof",
    help="Reference implementation of depth-of-field rendering: references with error bars, exact layers, "
    "and published methods pixel for pixel.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

Size = Annotated[
    str | None, typer.Option("--size", metavar="WxH", help="Image size in pixels. Default: the scene's own.")
]
Radius = Annotated[
    float | None, typer.Option("--lens-radius", help="Lens radius in scene units. Default: the scene's own.")
]
Focus = Annotated[
    float | None, typer.Option("--focus", help="Focus distance in scene units; may be inf. Default: the scene's own.")
]
Seed = Annotated[int, typer.Option("--seed", help="Random seed of the reference.")]
Samples = Annotated[int, typer.Option("--samples", help="Lens samples per pixel of the reference.")]
Tolerance = Annotated[
    float | None,
    typer.Option(
        "--tolerance",
        help="Sample each pixel until its standard error, in linear values, is below this; replaces --samples.",
    ),
]
Most = Annotated[int, typer.Option("--max-samples", help="With --tolerance: stop a pixel after this many samples.")]
Threads = Annotated[int | None, typer.Option("--threads", help="Number of threads; results do not depend on it.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON instead of text.")]
_PRESETS = "Start from the parameters that come closest to the reference (best) or from the paper's text (paper)."
Preset = Annotated[str, typer.Option("--preset", metavar="best|paper", help=_PRESETS)]
Settings = Annotated[list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Set a parameter; repeatable.")]
MethodSettings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="METHOD.KEY=VALUE", help="Set a parameter of one method; repeatable."),
]


@app.command()
def scenes(as_json: AsJson = False) -> None:
    """List the built-in scenes and what each one shows."""
    shots = {name: shot_of(name) for name in SCENES}
    rows = [{"scene": n, "title": s.title, "shows": s.shows, "inspired_by": s.inspired_by} for n, s in shots.items()]
    if as_json:
        print(json.dumps(rows, indent=2))
    else:
        _print_columns([[row["scene"], row["shows"]] for row in rows])


@app.command()
def methods(as_json: AsJson = False) -> None:
    """List the methods: source, inputs, texture reads per pixel, parameters, and those that the paper sets differently.

    Texture reads are counted for the image size of the default scene.
    """
    rows, texts = [], []
    size = shot_of(DEFAULT_SCENE).camera.size
    for name, module in METHODS.items():
        method, title = module.METHOD, _title(module)
        rows.append({"method": name, "title": title, **facts_of(method, *size)})
        reads = method.reads_in_words(*size)
        about = [f"{title} {method.origin}.", f"Needs {', '.join(method.inputs)}; {reads}.", _words(method.defaults())]
        if method.paper:
            about.append(f"paper: {_words(method.paper)}")
        texts.append((name, about))
    if as_json:
        print(json.dumps(plain(rows), indent=2))
        return
    for name, about in texts:
        print(name)
        for line in about:
            print(textwrap.fill(line, 100, initial_indent="    ", subsequent_indent="        "))


@app.command()
def render(
    scene: Annotated[str, typer.Argument(metavar="SCENE", help="Built-in scene or mesh file.")],
    method: Annotated[str, typer.Option("--method", help="Method name, see `refdof methods`.")],
    output: Annotated[Path, typer.Option("-o", "--output", help="Output file: .png (display), .exr or .npy (linear).")],
    settings: Settings = None,
    preset: Preset = "best",
    size: Size = None,
    lens_radius: Radius = None,
    focus: Focus = None,
    seed: Annotated[int | None, typer.Option("--seed", help="Same as --set seed=N.")] = None,
    samples: Annotated[int | None, typer.Option("--samples", help="Same as --set samples=N.")] = None,
    threads: Threads = None,
    as_json: AsJson = False,
) -> None:
    """Render a scene with one method."""
    _use_threads(threads)
    if output.suffix not in SUFFIXES:
        raise InputError(f"output: got {output.name!r}; allowed are names that end in {', '.join(SUFFIXES)}")
    check_folder(output.parent, "output")
    params = dict(_setting(text) for text in settings or [])
    params |= {name: value for name, value in (("seed", seed), ("samples", samples)) if value is not None}
    make_params(method, params, preset)
    loaded, camera, lens = _scene_camera_lens(scene, size, lens_radius, focus)
    result = render_view(method, View(loaded, camera, lens), preset=preset, **params)
    save_image(output, result.image)
    facts = {
        "output": str(output),
        **{f"{name}_s": round(seconds, 4) for name, seconds in result.seconds.items()},
    }
    print(json.dumps(facts) if as_json else _words(facts))


@app.command()
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
    preset: Annotated[str, typer.Option("--preset", metavar="best|paper|best,paper", help=_PRESETS)] = "best",
    size: Size = None,
    lens_radius: Radius = None,
    focus: Focus = None,
    seed: Seed = 0,
    samples: Samples = 256,
    tolerance: Tolerance = None,
    max_samples: Most = MAX_SAMPLES,
    threads: Threads = None,
    as_json: AsJson = False,
) -> None:
    """Compare methods with a reference: writes a table, images and a report, and prints the table."""
    _use_threads(threads)
    check_folder(out)
    names = _listed(methods) if methods is not None else list(METHODS)
    presets = _listed(preset)
    params = _settings_by_method(settings or [], names, presets)
    comparisons = []
    with _progress() as tell:
        for name in scenes or [DEFAULT_SCENE]:
            scene, camera, lens = _scene_camera_lens(name, size, lens_radius, focus)
            shot = camera, lens, samples, tolerance, seed
            comparisons.append(compare_scene(scene, names, params, *shot, tell, presets, max_samples, _announce))
        tell("report", 0, 1)
        write_comparisons(comparisons, out, "refdof " + shlex.join(sys.argv[1:]))
    if as_json:
        tables = [rows_as_json(comparison) for comparison in comparisons]
        print(json.dumps(tables[0] if len(tables) == 1 else tables, indent=2))
    else:
        print(markdown_table(comparisons))


@app.command()
def warm() -> None:
    """Compile everything now, in parallel, so that later runs start at once: for container images and CI."""
    with _progress() as tell:
        compile_jobs([REFERENCE, *(job_of(name, preset) for name in METHODS for preset in PRESETS)], tell)


def main() -> None:
    """Run the command line; bad input is one line on stderr and status 2."""
    try:
        status = app(standalone_mode=False)
    except InputError as error:
        _fail(str(error), 2)
    except _UsageError as error:
        _fail(error.format_message(), 2)
    except (typer.Abort, KeyboardInterrupt):
        status = _INTERRUPTED
    if status == _INTERRUPTED:
        _fail("interrupted; nothing was written", _INTERRUPTED)
    sys.exit(status if isinstance(status, int) else 0)


def _fail(message: str, status: int) -> None:
    print("refdof: " + " ".join(message.split()), file=sys.stderr)
    sys.exit(status)


def _scene_camera_lens(
    name: str, size: str | None, lens_radius: float | None, focus: float | None
) -> tuple[Scene, Camera, ThinLens]:
    """Load a scene and put the options over its suggested shot."""
    pixels = None if size is None else _size(size)
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
    return scene, camera, lens


def _listed(text: str) -> list[str]:
    """Words between commas."""
    return [word.strip() for word in text.split(",")]


def _size(text: str) -> tuple[int, int]:
    width, _, height = text.lower().partition("x")
    if not (width.isdigit() and height.isdigit()):
        raise InputError(f"size: got {text!r}; allowed is WIDTHxHEIGHT, such as 640x480")
    return as_pair("size", (width, height), minimum=1, maximum=32768)


def _use_threads(threads: int | None) -> None:
    if threads is not None:
        use_threads(as_integer("threads", threads, minimum=1))


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


def _settings_by_method(texts: list[str], methods: list[str], presets: list[str]) -> dict[str, dict[str, Any]]:
    """'method.key=value' lines as {method: {key: value}}."""
    params: dict[str, dict[str, Any]] = {name: {} for name in methods}
    for text in texts:
        key, value = _setting(text)
        method, dot, field = key.partition(".")
        if not dot or method not in params:
            known = f", METHOD one of {', '.join(methods)}"
            raise InputError(f"set: got {text!r}; allowed is METHOD.KEY=VALUE{known}")
        params[method][field] = value
    for method, values in params.items():
        for preset in presets:
            make_params(method, values, preset)
    return params


@contextmanager
def _progress() -> Iterator[Any]:
    """A progress line on stderr, where stderr is a terminal."""
    console = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        line = bar.add_task("scene", total=1)

        def tell(what: str, done: int, count: int) -> None:
            bar.update(line, description=what, completed=done, total=count)

        yield tell


def _announce(forecast: Forecast) -> None:
    print(f"refdof: reference: {forecast}", file=sys.stderr)


def _title(module: Any) -> str:
    return str(module.__doc__).split("\n", 1)[0]


def _words(values: Mapping[str, Any]) -> str:
    return ", ".join(f"{key}={value}" for key, value in values.items())


def _print_columns(rows: list[list[str]]) -> None:
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    for row in rows:
        print("  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)).rstrip())


if __name__ == "__main__":
    main()

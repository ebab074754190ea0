"""Compare: the reference, every method and its scores, on one scene."""

import math
import statistics
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict, replace
from importlib.metadata import version
from threading import Thread
from typing import Any

import numpy as np

from refdof._check import Float, InputError, as_choice, as_function, as_instance
from refdof._jit import JIT_DISABLED, compilations, source_digest
from refdof._store import stored
from refdof.cluster import Cluster
from refdof.comparison import Comparison, Row
from refdof.field_strip import field_strip
from refdof.kernel_shape import kept_kernel_shapes
from refdof.methods import METHODS
from refdof.metrics import Scored, scored_of_many
from refdof.metrics.artefacts import ArtefactMaps, artefacts_of_many
from refdof.metrics.structural import WINDOW
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens
from refdof.optics.systems.system_lens import SystemLens
from refdof.rendering import PRESETS, Result, make_params, render_view
from refdof.scene.scene import Part, Scene
from refdof.truth.forecast import Forecast, forecast_of_view
from refdof.truth.reference import MAX_SAMPLES, Reference, reference_of_view
from refdof.view import View, view_of
from refdof.warm import REFERENCE, job_of, warm

__all__ = [
    "as_settings",
    "check_window",
    "compare",
    "distinct",
    "kept_reference",
    "rows_of",
    "timed",
    "warm_up",
    "warming_up",
]

_RUNS = 3  # of a method, whose median is told; one if it takes longer than
_SHORT_S = 1.0
_CHART_SAMPLES = 64  # at most, of a lens chart: it is looked at, and not scored


def compare(
    scene: Scene,
    methods: Sequence[str],
    params: Mapping[str, Mapping[str, Any]] | None = None,
    camera: Camera | None = None,
    lens: ThinLens | None = None,
    samples: int = 256,
    tolerance: float | None = None,
    seed: int = 0,
    progress: Callable[[str, int, int], None] | None = None,
    preset: str | Sequence[str] = "best",
    max_samples: int = MAX_SAMPLES,
    announce: Callable[[Forecast], None] | None = None,
    cluster: Cluster | None = None,
) -> Comparison:
    """Render the reference and every method, and score them; through a real lens, also draw a lens chart.

    Parameters
    ----------
    scene, camera, lens
        Camera and lens default to the scene's suggested shot.
    methods : names in `refdof.METHODS`
    params : {method: {field: value}}
        Fields of the methods' `Params`; what is left out is the preset's.
    samples, tolerance, seed
        Of the reference.
    progress : callable, optional
        Called with (what, done, all).
    preset : one or more of `refdof.rendering.PRESETS`
        What parameters have that `params` leaves out. With several, a method is rendered once for each that differs.
    max_samples : int
        Of the reference, where `tolerance` is not met before.
    announce : callable, optional
        Called with the `Forecast` of a reference with a tolerance before it starts; not with a cluster, whose time it
        cannot tell.
    cluster : Cluster, optional
        Make the references there, with the same bits: `refdof.cluster.connected`. Methods, which are timed, are
        rendered in this process.

    Raises
    ------
    InputError
        If a method, preset or parameter is not allowed, or the picture is too small for SSIM's window.
    """
    view = view_of(scene, camera, lens)
    view.times_warm_runs = True
    as_function("progress", progress)
    as_function("announce", announce)
    if cluster is not None:
        as_instance("cluster", cluster, Cluster)
    given = as_settings(methods, params)
    check_window(view)
    chosen = distinct(given, preset)
    tell = progress or (lambda _what, _done, _all: None)

    def step(done: int, count: int) -> None:
        tell("reference", done, count)

    warm([REFERENCE, *(job_of(name, kind) for name, kind in chosen)], progress, at_least=2)
    warm_up("accumulation", {})  # the reference's kernels are the same
    if tolerance is not None and announce is not None and cluster is None:
        announce(forecast_of_view(view, tolerance, max_samples, seed))
    truth, kept = kept_reference(view, samples, tolerance, seed, max_samples, step, cluster)
    rows = rows_of(view, chosen, given, truth.image, tell, truth.standard_error)
    rows = _with_kernels(rows, given, tell)
    chart = None
    if isinstance(view.lens, SystemLens):
        tell("lens chart", 0, 1)
        fewer = min(samples, _CHART_SAMPLES)
        wanted = [(row.name, row.method, row.preset, given[row.method]) for row in rows]
        chart = field_strip(
            view,
            wanted,
            lambda one: kept_reference(one, fewer, None, seed, MAX_SAMPLES, None, cluster)[0].image,
        )
    return Comparison(
        scene.name,
        view.camera,
        view.lens,
        view.pinhole().color,
        truth.image,
        truth.standard_error,
        float(truth.samples.mean()),
        truth.seconds,
        truth.noise_floor_psnr,
        tuple(rows),
        kept,
        chart,
        view.pinhole().depth,
        view.coc_px(),
        view.surface_counts(),
    )


def kept_reference(
    view: View,
    samples: int,
    tolerance: float | None,
    seed: int,
    max_samples: int,
    progress: Callable[[int, int], None] | None,
    cluster: Cluster | None = None,
) -> tuple[Reference, bool]:
    """The reference of a view, from the store if an earlier run made it, and whether it is."""
    made = []

    def make() -> Reference:
        made.append(True)
        spend: dict[str, Any] = {"samples": samples, "tolerance": tolerance, "max_samples": max_samples}
        return reference_of_view(view, seed=seed, progress=progress, cluster=cluster, **spend)

    sources = source_digest(), version("embreex"), JIT_DISABLED
    shot = view.scene, view.camera, view.lens, samples, tolerance, seed, max_samples
    return stored("references", (sources, shot), make), not made


def as_settings(methods: Any, params: Any) -> dict[str, dict[str, Any]]:
    """Return the arguments of `compare` as {method: {field: value}} if they are names of methods and their settings."""
    if isinstance(methods, str) or not isinstance(methods, Sequence):
        raise InputError(f"methods: got {type(methods).__name__}; allowed is a list of names")
    for name in methods:
        as_choice("methods", name, METHODS)
    given = {} if params is None else as_instance("params", params, Mapping)
    for name, settings in given.items():
        as_instance(f"params of {as_choice('params', name, methods)}", settings, Mapping)
    return {name: dict(given.get(name, {})) for name in methods}


def check_window(view: View) -> None:
    """Raise if the picture is too small for SSIM's window."""
    if min(view.camera.size) < WINDOW:
        width, height = view.camera.size
        raise InputError(f"size: got {width}x{height}; allowed for scores is at least {WINDOW}x{WINDOW}")


def distinct(values: Mapping[str, Mapping[str, Any]], preset: Any) -> list[tuple[str, str]]:
    """Method and preset of each row; presets that give a method the same parameters make one row."""
    several = [preset] if isinstance(preset, str) or not isinstance(preset, Sequence) else list(preset)
    if not several:
        raise InputError(f"preset: got none; allowed are {', '.join(PRESETS)}")
    presets = [as_choice("preset", one, PRESETS) for one in several]
    rows = []
    for name, given in values.items():
        seen: list[Any] = []
        for one in presets:
            params = make_params(name, given, one)
            if params not in seen:
                seen.append(params)
                rows.append((name, one))
    return rows


def rows_of(
    view: View,
    chosen: Sequence[tuple[str, str]],
    values: Mapping[str, Mapping[str, Any]],
    reference: Float | None,
    tell: Callable[[str, int, int], None],
    standard_error: Float | None = None,
) -> list[Row]:
    """Render each method and preset, timed warm; scored where there is a reference, whose noise may be known."""
    results = []
    for k, (name, kind) in enumerate(chosen):
        if k and name != chosen[k - 1][0]:
            view.forget_layers()
        tell(name, k, len(chosen))
        warm_up(name, values[name], kind)
        results.append(timed(name, view, kind, values[name]))
    found = [Scored({}, None) for _ in results]
    located: list[dict[str, float]] = [{} for _ in results]
    if reference is not None:
        images = [result.image for result, _ in results]
        found = scored_of_many(reference, images, lambda done, count: tell("scores", done, count))
        pinhole = view.pinhole()
        maps = ArtefactMaps(pinhole.depth, view.coc_px(), pinhole.color, standard_error)
        located = artefacts_of_many(maps, reference, images, lambda done, count: tell("artefacts", done, count))
    return [
        Row(
            name,
            asdict(result.params),
            result.image,
            found[k].scores,
            result.seconds["prepare"],
            statistics.median(times),
            kind,
            len(times),
            max(times) - min(times) if len(times) > 1 else math.nan,
            located[k],
            found[k].flip_map,
        )
        for k, ((name, kind), (result, times)) in enumerate(zip(chosen, results, strict=True))
    ]


def _with_kernels(
    rows: Sequence[Row], values: Mapping[str, Mapping[str, Any]], tell: Callable[[str, int, int], None]
) -> list[Row]:
    """The rows with what each method makes of one small light; measured once for all scenes and runs."""
    shapes = kept_kernel_shapes(
        [(row.method, row.preset, values[row.method]) for row in rows],
        lambda done, count: tell("kernels", done, count),
    )
    return [
        replace(row, artefacts={**row.artefacts, "kernel_radius": shape.radius, "light_energy": shape.energy})
        for row, shape in zip(rows, shapes, strict=True)
    ]


def timed(name: str, view: View, preset: str, values: Mapping[str, Any]) -> tuple[Result, list[float]]:
    """A method's result, and the seconds of each warm run: one in which nothing was compiled or read from the cache.

    A short one is repeated.
    """
    times: list[float] = []
    while True:
        before = compilations()
        result = render_view(name, view, preset=preset, **values)
        if compilations() == before:
            times.append(result.seconds["blur"])
            if len(times) == _RUNS or times[0] > _SHORT_S:
                return result, times


def warm_up(method: str, params: Mapping[str, Any], preset: str = "best") -> None:
    """Compile nearly all that `method` needs on a small picture of one triangle."""
    camera = Camera(eye=(0.0, 0.0, 2.0), target=(0.0, 0.0, 0.0), size=(32, 24))
    lens = ThinLens(radius=0.1, focus_distance=1.0)
    triangle = Part(np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]]), np.array([[0, 1, 2]]))
    view = View(Scene.from_parts("warm-up", [triangle], camera, lens), camera, lens)
    render_view(method, view, preset=preset, **params)


@contextmanager
def warming_up(methods: Sequence[tuple[str, str]]) -> Iterator[None]:
    """`warm_up` of methods and presets beside what the block does, which calls no kernel; ends when both have ended.

    Functions are read from the cache, or compiled, while another core makes the scene. Parameters are the presets' own:
    others may take long. What fails here fails again, in sight, where it is rendered.
    """

    def work() -> None:
        with suppress(Exception):
            for method, preset in methods:
                warm_up(method, {}, preset)

    thread = Thread(target=work)
    thread.start()
    try:
        yield
    finally:
        thread.join()

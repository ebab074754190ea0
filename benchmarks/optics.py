"""Benchmark: rays through pbrt's double Gauss, beside optiland and NumPy; rays that the exit pupil's bounds save; and
what a lens adds to the reference.

1. time the trace alone on the same rays in refdof, optiland (if it is installed) and plain NumPy     `trace_rows`
2. time the lens map, from image and square to rays in camera space                                   `map_row`
3. count the rays that pay for one that passes: through the bounds, and through the last surface      `sampling_rows`
4. time a ray that passes: from the lens map, and by rejection on the last surface, as pbrt has it    `rejection_rows`
5. time the reference on `lights` through lenses of 2, 11 and 13 surfaces, beside the thin lens       `reference_rows`

Targets: 50 times optiland's rays per second; 1.27 to 1.44 rays for one, where the last surface's disc takes about 10 at
f/5.6; a reference of at most 2 times the thin lens's time through two surfaces and 4 times through a dozen, at one
wavelength. Rounds alternate; numbers are medians, first calls are left out.

    pip install '.[optiland]' && python benchmarks/optics.py [--rays 200000] [--rounds 5] [--json out.json]
"""

import argparse
import importlib.util
import json
import math
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the lens and optiland's twin of it are the tests' own

import refdof
from refdof._jit import thread_count
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens
from refdof.optics.systems.glass import LINE_D, Glass
from refdof.optics.systems.lens_map import lens_map_of, lens_map_rays
from refdof.optics.systems.paraxial import sensor_for, stopped_down
from refdof.optics.systems.prescription import load_lens
from refdof.optics.systems.pupil import bounds_at, pupil_bounds
from refdof.optics.systems.system import LensSystem
from refdof.optics.systems.system_lens import SystemLens
from refdof.optics.systems.trace import table_of, trace, traced
from refdof.truth.reference import reference_of_view
from refdof.view import View
from tests.optics.systems.lenses import double_gauss

TARGET = 50.0
WAVELENGTH = 0.51
HEIGHTS = (0.0, 10.0, 18.0, 21.6)  # [mm] on the film
F_STOPS = (2.0, 2.8, 5.6)
SIZE, SAMPLES = (400, 300), 64  # of the reference
REFERENCE_TARGETS = {"biconvex": 2.0, "double_gauss": 4.0, "wide_angle": 4.0}


def rays_of(count):
    """Skew rays that start in front of the first surface."""
    random = np.random.default_rng(1)
    aim = random.uniform(-8.0, 8.0, (count, 2))
    directions = np.column_stack([random.uniform(-0.15, 0.15, (count, 2)), np.ones(count)])
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return np.column_stack([aim, np.zeros(count)]) - 40.0 * directions, directions


def numpy_trace(system, origins, directions):
    """The same rays in plain NumPy, a surface at a time: points, directions and which passed."""
    index, point, way = system.indices(WAVELENGTH), origins.copy(), directions.copy()
    passed = np.ones(len(point), dtype=bool)
    for k, surface in enumerate(system.surfaces):
        vertex = np.array([0.0, 0.0, system.vertices[k]])
        if math.isinf(surface.radius):
            point = point + way * ((vertex[2] - point[:, 2]) / way[:, 2])[:, None]
            normal = np.broadcast_to([0.0, 0.0, -1.0], way.shape)
        else:
            offset = point - np.add(vertex, [0.0, 0.0, surface.radius])
            b, c = (offset * way).sum(axis=1), (offset**2).sum(axis=1) - surface.radius**2
            root = np.sqrt(np.maximum(b * b - c, 0.0))
            passed &= b * b > c
            point = point + way * (-b - math.copysign(1.0, surface.radius) * root)[:, None]
            normal = (offset + way * (-b - math.copysign(1.0, surface.radius) * root)[:, None]) / surface.radius
            normal = -normal * np.sign((normal * way).sum(axis=1))[:, None]
        passed &= (point[:, :2] ** 2).sum(axis=1) <= surface.semi_diameter**2
        ratio, cosine = index[k] / index[k + 1], -(normal * way).sum(axis=1)
        rest = 1.0 - ratio**2 * (1.0 - cosine**2)
        passed &= rest > 0.0
        way = ratio * way + (ratio * cosine - np.sqrt(np.maximum(rest, 0.0)))[:, None] * normal
    return point, way, passed


def medians(rounds, functions):
    """Median seconds of each function, called in turn after one call that does not count."""
    seconds: dict[str, list[float]] = {name: [] for name in functions}
    for number in range(rounds + 1):
        for name, function in functions.items():
            start = time.perf_counter()
            function()
            if number:
                seconds[name].append(time.perf_counter() - start)
    return {name: statistics.median(times) for name, times in seconds.items()}


def trace_rows(count, rounds):
    """Rays per second of each program."""
    system, (origins, directions) = double_gauss(), rays_of(count)
    single = origins.astype(np.float32), directions.astype(np.float32)
    functions = {
        "refdof": lambda: trace(system, origins, directions, WAVELENGTH),
        "refdof, float32": lambda: trace(system, *single, WAVELENGTH),
        "NumPy": lambda: numpy_trace(system, origins, directions),
    }
    found, (points, ways, passed) = functions["refdof"](), functions["NumPy"]()
    assert (found.passed == passed).all()
    assert np.abs(found.origins - points)[passed].max() < 1e-9
    assert np.abs(found.directions - ways)[passed].max() < 1e-9
    if importlib.util.find_spec("optiland"):
        from tests.optics.systems import make_optiland_rays as optiland

        rows = optiland.LENSES["double_gauss"]
        lens = optiland.optic_of(rows)
        functions["optiland"] = lambda: optiland.trace(lens, rows, origins, directions)
    return {name: count / seconds for name, seconds in medians(rounds, functions).items()}


def map_row(count, rounds):
    """Rays per second of the lens map, and the share of them that pass."""
    camera = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), size=(800, 600))
    lens_map = lens_map_of(double_gauss(), camera, 3.0, sensor_height=24.0)
    random = np.random.default_rng(2)
    places, squares = random.uniform(0.0, 1.0, (count, 2)) * camera.size, random.uniform(0.0, 1.0, (count, 2))
    seconds = medians(rounds, {"map": lambda: lens_map_rays(lens_map, places, squares)})["map"]
    return {"rays_per_s": count / seconds, "passed": float((lens_map_rays(lens_map, places, squares)[1] > 0).mean())}


def sampling_rows(count):
    """Rays for one that passes, at each f-number and film height: through the bounds, and through the rear disc."""
    rows, random = [], np.random.default_rng(3)
    u, v = random.uniform(0.0, 1.0, (2, count))
    rear = double_gauss().surfaces[-1].semi_diameter * np.sqrt(u)
    for f_stop in F_STOPS:
        system = stopped_down(double_gauss(), f_stop)
        sensor, plane = sensor_for(system, math.inf), system.vertices[-1]
        start = time.perf_counter()
        bounds = pupil_bounds(system, 21.7, sensor=sensor)
        seconds = time.perf_counter() - start
        for height in HEIGHTS:
            x0, x1, y1 = bounds_at(bounds, height)
            shares = []
            for x, y in (
                (x0 + (x1 - x0) * u, y1 * (2.0 * v - 1.0)),
                (rear * np.cos(2 * np.pi * v), rear * np.sin(2 * np.pi * v)),
            ):
                origins = np.tile([height, 0.0, sensor], (count, 1))
                directions = np.stack([x, y, np.full(count, plane)], axis=1) - origins
                shares.append(1.0 / trace(system, origins, directions, LINE_D, reverse=True).passed.mean())
            rows.append({"f_stop": f_stop, "height_mm": height, "bounds": shares[0], "rear_disc": shares[1]})
            rows[-1]["bounds_s"] = seconds
    return rows


def rejection_rows(count, rounds):
    """Nanoseconds of a ray that passes, from places all over a film of 36 x 24 mm.

    Of rejection only the trace is timed, not the drawing of points; of the lens map everything.
    """
    rows, random = [], np.random.default_rng(4)
    camera = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), size=(360, 240))
    places, squares = random.uniform(0.0, 1.0, (count, 2)) * camera.size, random.uniform(0.0, 1.0, (count, 2))
    film = (0.5 - places / camera.size) * [36.0, -24.0]
    u, v = random.uniform(0.0, 1.0, (2, count))
    rear = double_gauss().surfaces[-1].semi_diameter * np.sqrt(u)
    for f_stop in F_STOPS:
        system = stopped_down(double_gauss(), f_stop)
        table, sensor = table_of(system, LINE_D), sensor_for(system, math.inf)
        lens_map = lens_map_of(system, camera, math.inf, wavelengths_um=(LINE_D,), sensor_height=24.0)
        origins = np.column_stack([film, np.full(count, sensor)])
        aims = np.column_stack(
            [rear * np.cos(2 * np.pi * v), rear * np.sin(2 * np.pi * v), np.full(count, system.vertices[-1])]
        )
        ways = aims - origins
        ways /= np.linalg.norm(ways, axis=1, keepdims=True)
        functions: dict[str, Callable[[], Any]] = {
            "lens map": partial(lens_map_rays, lens_map, places, squares),
            "rejection": partial(traced, table, True, origins, ways),
        }
        seconds = medians(rounds, functions)
        shares = {
            "lens map": float((functions["lens map"]()[1] > 0.0).mean()),
            "rejection": float(functions["rejection"]().passed.mean()),
        }
        rows.append({"f_stop": f_stop} | {f"{way}_ns": 1e9 * seconds[way] / count / shares[way] for way in seconds})
    return rows


def reference_rows(rounds):
    """Seconds of the reference on `lights` through each lens, all with one camera and one pupil."""
    scene = refdof.load_scene("lights")
    camera = SystemLens(load_lens("double_gauss"), scene.lens.focus_distance).seen_by(scene.camera.with_size(SIZE))
    thin = ThinLens(scene.lens.radius, scene.lens.focus_distance)
    views = {"thin lens": View(scene, camera, thin)}
    for name in REFERENCE_TARGETS:
        system = load_lens(name)
        for waves, lens in ((1, of_one_color(system)), (3, system)):
            scale = 1000.0 * SystemLens(lens, thin.focus_distance).radius / thin.radius
            focused = SystemLens(lens, thin.focus_distance, mm_per_unit=scale)
            views[f"{name}, {waves}"] = View(scene, camera, focused)
    functions = {name: partial(reference_of_view, view, SAMPLES) for name, view in views.items()}
    seconds = medians(rounds, functions)
    least = seconds["thin lens"]
    rays = SIZE[0] * SIZE[1] * SAMPLES
    rows = [{"lens": "thin lens", "surfaces": 0, "ns": 1e9 * least / rays, "ratio": 1.0, "ratio_of_3": None}]
    for name in REFERENCE_TARGETS:
        one, three = seconds[f"{name}, 1"], seconds[f"{name}, 3"]
        rows.append({"lens": name, "surfaces": len(load_lens(name).surfaces), "ns": 1e9 * one / rays})
        rows[-1] |= {"ratio": one / least, "ratio_of_3": three / least, "target": REFERENCE_TARGETS[name]}
    return rows


def of_one_color(system: LensSystem) -> LensSystem:
    """The lens with glasses of one index each, that of green: it is traced at one wavelength."""
    surfaces = [
        replace(surface, glass=Glass(f"green {surface.glass.name}", surface.glass.index(WAVELENGTH)))
        for surface in system.surfaces
    ]
    return replace(system, surfaces=tuple(surfaces))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--rays", type=int, default=200_000)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--json", type=Path)
    words = parser.parse_args()
    traced, mapped, sampled = (
        trace_rows(words.rays, words.rounds),
        map_row(words.rays, words.rounds),
        sampling_rows(words.rays),
    )
    rejected, references = rejection_rows(words.rays, words.rounds), reference_rows(words.rounds)
    print(f"double Gauss, 11 surfaces, {words.rays} rays, {thread_count()} threads: rays per second\n")
    for name, rate in traced.items():
        print(f"{name:16} {rate:12.0f}  {rate / traced['refdof']:8.4f} of refdof's")
    if "optiland" in traced:
        print(f"refdof over optiland: {traced['refdof'] / traced['optiland']:.0f}; target {TARGET:.0f}")
    print(f"{'lens map':16} {mapped['rays_per_s']:12.0f}  {mapped['passed']:8.4f} of them pass\n")
    print("rays for one that passes\n\n| f-number | film height [mm] | bounds | rear disc |\n|---|---|---|---|")
    for row in sampled:
        print(f"| {row['f_stop']} | {row['height_mm']} | {row['bounds']:.2f} | {row['rear_disc']:.2f} |")
    print("\na ray that passes [ns], from all over the film\n\n| f-number | lens map | rear disc, rejection | ratio |")
    print("|---|---|---|---|")
    for row in rejected:
        ours, theirs = row["lens map_ns"], row["rejection_ns"]
        print(f"| {row['f_stop']} | {ours:.0f} | {theirs:.0f} | {ours / theirs:.2f} |")
    print(f"\nreference of `lights`, {SIZE[0]}x{SIZE[1]}, {SAMPLES} samples\n")
    print("| lens | surfaces | ns a ray | over the thin lens | target | at 3 wavelengths |\n|---|---|---|---|---|---|")
    for row in references:
        three = "" if row["ratio_of_3"] is None else f"{row['ratio_of_3']:.2f}"
        print(f"| {row['lens']} | {row['surfaces']} | {row['ns']:.0f} | {row['ratio']:.2f} | ", end="")
        print(f"{row.get('target', '')} | {three} |")
    if words.json:
        figures = {"threads": thread_count(), "trace": traced, "map": mapped, "sampling": sampled, "target": TARGET}
        figures |= {"rejection": rejected, "reference": references}
        words.json.write_text(json.dumps(figures, indent=1))


if __name__ == "__main__":
    main()

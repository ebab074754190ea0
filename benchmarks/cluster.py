"""Benchmark: what tasks cost on a cluster, and a plan for 1 000 scenes, 16 methods and 3840x2160 pixels made of it.

Measured on this machine: CPU time of a ray of the reference at 3840x2160, on tiles spread over the picture; CPU time of
every method at two sizes, from which its growth follows; scores; the bytes of scenes and tiles; what a task costs that
does nothing; and one reference, here and on workers. `plan` multiplies; docs/cluster.md holds its table for the
measurements recorded in `benchmarks/cluster_measured.json`.

Run it from the root of the repository: ``python benchmarks/cluster.py`` measures and prints; ``--recorded`` prints the
plan of the recorded measurements, ``--record`` writes them anew.
"""

import argparse
import json
import math
import operator
import pickle
import statistics
import time
from pathlib import Path
from typing import Any

import refdof
from refdof._jit import processor, thread_count, use_threads
from refdof.cluster import completed, connected
from refdof.rendering import render_view
from refdof.truth.tile_sampler import Spend, corners_of
from refdof.truth.tile_tasks import TileWork
from refdof.view import View

RECORDED = Path(__file__).with_name("cluster_measured.json")
SCENES, METHODS, SIZE, SAMPLES = 1000, 16, (3840, 2160), 256
MACHINES, CORES = 100, 16  # of the cluster that is planned for; a worker on each, with all its cores
TASK_S = 1.0  # what a batch of tiles lasts
NETWORK = 125e6  # bytes a second, of 1 Gbit/s
_LEAST, _SMALL, _LARGE = (160, 120), (480, 270), (960, 540)
_TILES, _EMPTY, _REPEAT = 16, 300, 5
_KEPT = 3 * 4  # bytes a pixel of a method's picture


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--recorded", action="store_true", help="do not measure")
    parser.add_argument("--record", action="store_true", help=f"write {RECORDED.name}")
    words = parser.parse_args()
    found = json.loads(RECORDED.read_text()) if words.recorded else measure()
    if words.record:
        RECORDED.write_text(json.dumps(found, indent=1) + "\n")
    print(measured_table(found), plan_table(plan(found)), sep="\n\n")


def measure() -> dict[str, Any]:
    """All figures, of this machine."""
    scenes = {name: refdof.load_scene(name) for name in refdof.SCENES}
    fence = scenes["fence"]
    overhead = _overhead(fence)
    tiles = {name: _tiles(scene) for name, scene in scenes.items()}
    methods = {name: [_method_s(name, fence, size) for size in (_SMALL, _LARGE)] for name in refdof.METHODS}
    return {
        "processor": processor(),
        "threads": thread_count(),
        "ray_ns": {name: one["ray_ns"] for name, one in tiles.items()},
        "tree_s": {name: one["tree_s"] for name, one in tiles.items()},
        "scene_bytes": {name: len(pickle.dumps(scene, protocol=5)) for name, scene in scenes.items()},
        "tile_bytes_per_pixel": max(one["bytes"] for one in tiles.values()),
        "method_s": methods,
        "scores_s": _scores_s(fence),
        **overhead,
    }


def _tiles(scene: refdof.Scene) -> dict[str, float]:
    """A ray's CPU time [ns], on one thread; that of making Embree's tree [s]; bytes a pixel that come back."""
    threads = thread_count()
    use_threads(1)
    work = TileWork(
        View(scene, scene.camera.with_size(SIZE), scene.lens), 4, 0, Spend(SAMPLES, None, 4096), False, False
    )
    began = time.process_time()
    work.sampler()
    tree = time.process_time() - began
    corners = corners_of(SIZE)
    chosen = [corners[(2 * k + 1) * len(corners) // (2 * _TILES)] for k in range(_TILES)]
    work.tile(chosen[0])  # compiles
    began = time.process_time()
    made = [work.tile(corner) for corner in chosen]
    seconds = time.process_time() - began
    use_threads(threads)
    pixels = sum(tile.samples.size for tile in made)
    return {
        "ray_ns": 1e9 * seconds / (pixels * SAMPLES),
        "tree_s": tree,
        "bytes": len(pickle.dumps(made, protocol=5)) / pixels,
    }


def _method_s(name: str, scene: refdof.Scene, size: tuple[int, int]) -> float:
    """CPU time of a method with all that it prepares [s], warm."""
    render_view(name, View(scene, scene.camera.with_size(_LEAST), scene.lens))  # compiles
    began = time.process_time()
    render_view(name, View(scene, scene.camera.with_size(size), scene.lens))
    return time.process_time() - began


def _scores_s(scene: refdof.Scene) -> float:
    """All scores of one picture at the larger size [s]."""
    view = View(scene, scene.camera.with_size(_LARGE), scene.lens)
    picture = render_view("mipmap", view).image
    began = time.perf_counter()
    refdof.metrics.scores(view.pinhole().color, picture)
    return time.perf_counter() - began


def _overhead(scene: refdof.Scene) -> dict[str, Any]:
    """A task that does nothing [s], and a reference here and on as many workers as there are threads, in turn [s]."""
    camera = scene.camera.with_size((320, 240))
    here, there = [], []
    with connected(workers=thread_count()) as cluster:
        list(completed(operator.add, 0, range(20), cluster))
        began = time.perf_counter()
        list(completed(operator.add, 0, range(_EMPTY), cluster))
        empty = (time.perf_counter() - began) / _EMPTY
        for _ in range(_REPEAT + 1):
            here.append(refdof.reference(scene, camera, samples=SAMPLES).seconds)
            there.append(refdof.reference(scene, camera, samples=SAMPLES, cluster=cluster).seconds)
    return {
        "empty_task_s": empty,
        "reference_here_s": min(here[1:]),
        "reference_there_s": min(there[1:]),
        "first_there_s": there[0],
    }


def plan(found: dict[str, Any]) -> dict[str, float]:
    """The plan's figures. Times are of the mean scene and the mean method."""
    pixels = SIZE[0] * SIZE[1]
    rays = SCENES * pixels * SAMPLES
    reference_s = rays * 1e-9 * statistics.mean(found["ray_ns"].values())
    method_s = SCENES * METHODS * statistics.mean(grown(*both) for both in found["method_s"].values())
    scores_s = SCENES * METHODS * found["scores_s"] * pixels / (_LARGE[0] * _LARGE[1])
    tasks = reference_s / CORES / TASK_S + SCENES * METHODS
    scene = statistics.mean(found["scene_bytes"].values())
    return {
        "rays": rays,
        "reference_h": reference_s / 3600,
        "method_h": method_s / 3600,
        "scores_h": scores_s / 3600,
        "core_h": (reference_s + method_s + scores_s) / 3600,
        "wall_h": (reference_s + method_s + scores_s) / 3600 / (MACHINES * CORES),
        "tasks": tasks,
        "client_h": tasks * found["empty_task_s"] / 3600,
        "most_workers": TASK_S / found["empty_task_s"],
        "scene_bytes": SCENES * MACHINES * scene,
        "reference_bytes": SCENES * pixels * found["tile_bytes_per_pixel"],
        "reference_s_network": pixels * found["tile_bytes_per_pixel"] / NETWORK,
        "picture_bytes": SCENES * METHODS * pixels * _KEPT,
    }


def grown(small: float, large: float) -> float:
    """Seconds at `SIZE` of what takes these at the two measured sizes, as a power of the number of pixels."""
    power = math.log(large / small) / math.log((_LARGE[0] * _LARGE[1]) / (_SMALL[0] * _SMALL[1]))
    return large * ((SIZE[0] * SIZE[1]) / (_LARGE[0] * _LARGE[1])) ** power


def measured_table(found: dict[str, Any]) -> str:
    """What was measured, as Markdown."""
    rays, slow, fast = found["ray_ns"], *_extremes(found["ray_ns"])
    methods = {name: grown(*both) for name, both in found["method_s"].items()}
    dear, cheap = _extremes(methods)
    heavy, _ = _extremes(found["scene_bytes"])
    late, _ = _extremes(found["tree_s"])
    scene_mb, heavy_mb = (
        b / 1e6 for b in (statistics.mean(found["scene_bytes"].values()), found["scene_bytes"][heavy])
    )
    mean_ns, mean_s = statistics.mean(rays.values()), statistics.mean(methods.values())
    more = 100 * (found["reference_there_s"] / found["reference_here_s"] - 1)
    return _table(
        ("measured", "figure"),
        [
            (
                "a ray, CPU time",
                f"{mean_ns:.0f} ns (`{fast}` {rays[fast]:.0f}, `{slow}` {rays[slow]:.0f})",
            ),
            (
                "a method at 3840x2160, CPU time",
                f"{mean_s:.0f} s (`{cheap}` {methods[cheap]:.1f}, `{dear}` {methods[dear]:.0f})",
            ),
            ("all scores of a picture at 960x540", f"{found['scores_s']:.1f} s"),
            ("Embree's tree, once for each scene and worker", f"at most {found['tree_s'][late]:.1f} s (`{late}`)"),
            ("a scene on its way to a worker", f"{scene_mb:.1f} MB (at most `{heavy}`, {heavy_mb:.1f} MB)"),
            ("a pixel of a reference on its way back", f"{found['tile_bytes_per_pixel']:.0f} bytes"),
            ("a task that does nothing", f"{1e3 * found['empty_task_s']:.1f} ms"),
            (
                f"`fence`, 320x240, 256 samples: here, and with `--workers {found['threads']}`",
                f"{found['reference_here_s']:.2f} s, {found['reference_there_s']:.2f} s ({more:+.0f} %; the first one"
                f" {found['first_there_s']:.1f} s, since every worker makes its tree and reads machine code)",
            ),
        ],
    )


def plan_table(figures: dict[str, float]) -> str:
    """The plan, as Markdown."""
    f = figures
    return _table(
        ("planned", "figure"),
        [
            ("rays of the references", f"{f['rays']:.2e}"),
            ("core hours of the references", f"{f['reference_h']:.0f}"),
            ("core hours of the methods", f"{f['method_h']:.0f}"),
            ("core hours of the scores", f"{f['scores_h']:.0f}"),
            ("core hours in all", f"{f['core_h']:.0f}"),
            (f"hours on {MACHINES} machines of {CORES} cores", f"{f['wall_h']:.1f}"),
            ("tasks", f"{f['tasks']:.0f}"),
            ("hours of the client, which hands them out", f"{f['client_h']:.1f}"),
            ("workers that one client keeps busy with tasks of a second", f"{f['most_workers']:.0f}"),
            ("scenes to all workers", f"{f['scene_bytes'] / 1e12:.2f} TB"),
            ("references back to the client", f"{f['reference_bytes'] / 1e12:.2f} TB"),
            ("one of them over 1 Gbit/s", f"{f['reference_s_network']:.1f} s"),
            ("pictures of the methods, if they were kept", f"{f['picture_bytes'] / 1e12:.2f} TB"),
        ],
    )


def _extremes(figures: dict[str, float]) -> tuple[str, str]:
    """Names of the largest and the smallest."""
    return max(figures, key=figures.__getitem__), min(figures, key=figures.__getitem__)


def _table(head: tuple[str, str], rows: list[tuple[str, str]]) -> str:
    return "\n".join(f"| {a} | {b} |" for a, b in [head, ("---", "---"), *rows])


if __name__ == "__main__":
    main()

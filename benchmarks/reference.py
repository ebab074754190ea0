"""How fast the reference is: against embreex's own class and against Mitsuba 3, in rays per second and to equal error.

    python benchmarks/reference.py [--json FILE]

One scene, one run, two integrals: over the lens and the pixel's area ("box"), and over the lens through the pixel's
centre ("centre", refdof's default). The work is the same for all: closest hit and interpolated vertex colours.
Building acceleration structures and compiling are left out of every time and stated apart.
"""

import argparse
import json
import os
import platform
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
import embreex_peer
import mitsuba_peer
from comparison_table import print_report
from equal_error import Run, at_rmse, combine, rmse
from plain_scene import plain

import refdof
from refdof._jit import thread_count
from refdof.truth.reference import MAX_SAMPLES, PIXEL_FILTERS, estimate, reference_of_view
from refdof.truth.tile_sampler import Spend

SAMPLES = (16, 64, 256, 1024)
TOLERANCES = (0.03, 0.01, 0.003)
GOAL_SAMPLES = 256  # the common error is that of Mitsuba's multijitter with so many samples
LONG_SEED = 2**31  # far from the seed of every short run
TARGETS = {
    "refdof's rays per second over Mitsuba's": (">=", 2.0),
    "refdof's time over Mitsuba independent's, equal error": ("<=", 0.2),
    "refdof's time over Mitsuba multijitter's, equal error": ("<=", 0.5),
    "refdof's rays per second over embreex's class": (">=", 5.0),
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--scene", default="figures", help="a built-in scene or a mesh file")
    parser.add_argument("--size", default="320x240", help="WIDTHxHEIGHT [px]")
    parser.add_argument("--long", type=int, default=4096, help="samples per pixel of refdof's long reference")
    parser.add_argument("--most", type=int, default=max(SAMPLES), help="leave out runs of more samples, >= 256")
    parser.add_argument("--json", type=Path, help="also write every figure to this file")
    words = parser.parse_args()
    width, height = (int(side) for side in words.size.split("x"))

    if words.most < GOAL_SAMPLES:
        parser.error(f"--most: got {words.most}; allowed is at least {GOAL_SAMPLES}")
    counts = [count for count in SAMPLES if count <= words.most]

    scene = plain(refdof.load_scene(words.scene))
    camera, lens = scene.camera.with_size((width, height)), scene.lens
    began = time.perf_counter()
    view = refdof.View(scene, camera, lens)
    view.surfaces(), view.tracer()
    built = time.perf_counter() - began
    mitsuba = mitsuba_peer.start(thread_count())

    report = {
        "scene": {"name": words.scene, "triangles": len(scene.faces), "size": [width, height]},
        "machine": {
            "processor": platform.machine(),
            "processors": os.cpu_count(),
            "threads": thread_count(),
            "python": platform.python_version(),
            "numpy": np.__version__,
            "mitsuba": mitsuba.__version__,
        },
        "refdof_build_seconds": built,
        "embreex": embreex_peer.trace_rate(scene, camera, lens),
        "integrals": {name: compare(mitsuba, view, name, counts, words.long) for name in PIXEL_FILTERS},
    }
    report["targets"] = judge(report)
    print_report(report)
    if words.json:
        words.json.write_text(json.dumps(report, indent=1))


def compare(mitsuba, view: refdof.View, pixel_filter: str, counts: list[int], long_samples: int) -> dict:
    """Every renderer's runs for one integral, and the time each needs for the common error."""
    runs = {
        "refdof": [refdof_run(view, pixel_filter, n) for n in counts],
        "refdof, one net": [refdof_run(view, pixel_filter, n, replicates=1) for n in counts],
        "refdof, tolerance": [refdof_run(view, pixel_filter, tolerance=t) for t in TOLERANCES],
    }
    compiling = 0.0
    for sampler in ("independent", "multijitter"):
        peer = mitsuba_peer.new_peer(mitsuba, view.scene, view.camera, view.lens, sampler, pixel_filter)
        pictures = [mitsuba_run(peer, n, seed=k) for k, n in enumerate(counts)]
        runs[f"Mitsuba {sampler}"] = [run for run, _ in pictures]
        compiling += sum(seconds for _, seconds in pictures)

    # The long reference: both renderers, with seeds of their own.
    ours = reference_of_view(view, long_samples, seed=LONG_SEED, pixel_filter=pixel_filter)
    halves = [mitsuba_peer.render(peer, max(counts), seed).image.astype(np.float64) for seed in (101, 102)]
    theirs = (halves[0] + halves[1]) / 2.0
    long = combine(
        ours.image, float(np.mean(ours.standard_error.astype(np.float64) ** 2)),
        theirs, float(np.mean((halves[0] - halves[1]) ** 2)) / 4.0,
    )  # fmt: skip

    pixels = view.camera.width * view.camera.height
    rows = {name: [row(run, rmse(run.image, long), pixels) for run in some] for name, some in runs.items()}
    goal = rows["Mitsuba multijitter"][counts.index(GOAL_SAMPLES)]["rmse"]
    return {
        "rows": rows,
        "goal_rmse": goal,
        "equal_error": {name: to_goal(some, goal) for name, some in rows.items()},
        "mitsuba_compile_seconds": compiling,
        "long_rmse": float(np.sqrt(long.variance)),
        "long_weight_of_refdof": long.weight_of_first,
        "long_agreement": long.agreement,
    }


def refdof_run(
    view: refdof.View, pixel_filter: str, samples: int = 1024, tolerance: float | None = None, replicates: int = 16
) -> Run:
    """A run of refdof; the first call compiles, or loads what an earlier one compiled.

    One replicate is the method `accumulation`: the best picture for the rays, without an error bar.
    """
    estimate(view, replicates, 1, Spend(16, None, 16), pixel_filter)
    wall, cpu = time.perf_counter(), time.process_time()
    result = estimate(view, replicates, 1, Spend(samples, tolerance, MAX_SAMPLES), pixel_filter)
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    return Run(result.image, float(result.samples.mean()), wall, cpu, tolerance)


def mitsuba_run(peer, samples: int, seed: int) -> tuple[Run, float]:
    """A run of Mitsuba, and the seconds spent on compiling before it."""
    first = mitsuba_peer.render(peer, samples, seed)
    # A short run is repeated: what compiling costs can be told apart only to some hundredths of a second.
    again = first.compile_seconds > 0.0 and first.seconds < 3.0
    picture = mitsuba_peer.render(peer, samples, seed) if again else first
    return Run(picture.image, picture.samples, picture.seconds, picture.cpu_seconds), first.compile_seconds


def row(run: Run, error: float, pixels: int) -> dict:
    rays = run.samples * pixels
    return {
        "samples": run.samples,
        "tolerance": run.tolerance,
        "seconds": run.seconds,
        "cpu_seconds": run.cpu_seconds,
        "rays_per_second": rays / run.seconds,
        "rays_per_cpu_second": rays / run.cpu_seconds,
        "rmse": error,
    }


def to_goal(rows: list[dict], goal: float) -> dict:
    """Seconds, CPU seconds and samples per pixel at the common error."""
    errors = [r["rmse"] for r in rows]
    found = {what: at_rmse(errors, [r[what] for r in rows], goal) for what in ("seconds", "cpu_seconds", "samples")}
    return {what: cost for what, (cost, _) in found.items()} | {"extrapolated": found["seconds"][1]}


def judge(report: dict) -> list[dict]:
    """Every target with the figure by the wall clock and by CPU time. Mitsuba's rate is that of its best run."""
    verdicts = []

    def add(target: str, integral: str, wall: float, cpu: float) -> None:
        relation, limit = TARGETS[target]
        met = wall >= limit if relation == ">=" else wall <= limit
        verdicts.append({
            "target": target, "integral": integral, "limit": f"{relation} {limit:g}",
            "figure": wall, "figure_cpu": cpu, "met": met,
        })  # fmt: skip

    rate, time_independent, time_multijitter, embreex = TARGETS
    for name, part in report["integrals"].items():
        rows = part["rows"]
        peers = rows["Mitsuba independent"] + rows["Mitsuba multijitter"]
        ours = rows["refdof"][-1]
        best = {key: max(r[key] for r in peers) for key in ("rays_per_second", "rays_per_cpu_second")}
        add(rate, name, *(ours[key] / best[key] for key in best))
        times = part["equal_error"]
        for target, peer in ((time_independent, "Mitsuba independent"), (time_multijitter, "Mitsuba multijitter")):
            add(target, name, *(times["refdof"][key] / times[peer][key] for key in ("seconds", "cpu_seconds")))
    theirs = report["embreex"]
    ours = report["integrals"]["centre"]["rows"]["refdof"][-1]
    add(embreex, "centre", ours["rays_per_second"] * theirs["seconds"] / theirs["rays"],
        ours["rays_per_cpu_second"] * theirs["cpu_seconds"] / theirs["rays"])  # fmt: skip
    return verdicts


if __name__ == "__main__":
    main()

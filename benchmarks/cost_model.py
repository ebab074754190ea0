"""Benchmark: how well the cost of a sweep predicts times at 1920x1080 and 3840x2160.

A sweep of each method at four small sizes gives its cost, `refdof.sweep.cost`; then the method is timed at the large
sizes, in the same run. `miss` is predicted over measured, less one. Run it from the root of the repository:
``python benchmarks/cost_model.py --json out.json``.
"""

import argparse
import json
import tempfile
from pathlib import Path

import numpy as np

import refdof
from refdof.compare import timed, warm_up
from refdof.machine import processor
from refdof.sweep import Results, axis_of, fitted, jobs_of, shots_of, sweep
from refdof.sweep.run import ReferenceChoice
from refdof.view import View

FITTED = "480x270,640x360,960x540,1280x720"
ASKED = ((1920, 1080), (3840, 2160))
LIMIT = 0.2  # of the miss
SETTINGS = {"accumulation": {"samples": 16}, "multiview": {"samples": 16}, "lensblur": {"samples": 32}}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--scene", default="town", help="a built-in scene")
    parser.add_argument("--methods", default=",".join(refdof.METHODS), help="comma-separated")
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write the numbers there")
    words = parser.parse_args()
    scene = refdof.load_scene(words.scene)
    view = View(scene, scene.camera.with_size((480, 270)), scene.lens)
    rows = []
    for method in words.methods.split(","):
        rows += predicted(view, method)
        print("\n".join(line(row) for row in rows[-len(ASKED) :]), flush=True)
    worst = max(abs(row["miss"]) for row in rows)
    print(f"worst miss {worst:.0%}, goal {LIMIT:.0%}; {processor()}")
    if words.json:
        words.json.write_text(json.dumps({"machine": processor(), "rows": rows}, indent=1) + "\n")


def predicted(view, method):
    """Predicted and measured seconds of one method at the large sizes."""
    fixed = SETTINGS.get(method, {})
    tradeoff = refdof.METHODS[method].METHOD.tradeoff
    if not fixed and tradeoff is not None:
        fixed = {tradeoff[0]: refdof.METHODS[method].METHOD.defaults()[tradeoff[0]]}
    axes = [axis_of("size=" + FITTED)]
    jobs = jobs_of([method], axes, {method: fixed})
    with tempfile.TemporaryDirectory() as folder, Results(Path(folder) / "sweep.duckdb") as results:
        points = results.points(sweep(shots_of(view, axes), jobs, results, ReferenceChoice(samples=16)))
    model = fitted(points)
    assert model is not None  # four sizes are enough
    rows = []
    for size in ASKED:
        large = view.with_size(size)
        large.times_warm_runs = True
        large.coc_px()
        warm_up(method, fixed)
        result, times = timed(method, large, "best", fixed)
        seconds = result.layers_s + float(np.median(times))
        guess = model.predict(points[-1], size[0] * size[1], points[-1].mean_coc_px * size[1] / points[-1].height)
        rows.append(
            {
                "method": method,
                "settings": fixed,
                "size": f"{size[0]}x{size[1]}",
                "law": str(model),
                "predicted_s": guess,
                "measured_s": seconds,
                "miss": guess / seconds - 1.0,
            }
        )
    return rows


def line(row):
    seconds = f"predicted {row['predicted_s']:8.3f} s, measured {row['measured_s']:8.3f} s"
    return f"{row['method']:<13} {row['size']:>9}: {seconds}, miss {row['miss']:+.0%}"


if __name__ == "__main__":
    main()

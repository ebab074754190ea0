"""Benchmark: lens blur at 800 x 600, its time and its error, against layers, rays, peeling and cuts.

1. render a long reference of each scene                       `refdof.reference`
2. change one parameter at a time from the paper's numbers     `STUDIES`
3. print Markdown tables; the targets stand beside             `table`, `verdicts`
4. plot error against layers and rays, if asked                `plot`

Times are of the method without raster products (`blur`), the least of some rounds; steps are texels walked per ray. Run
it from the root of the repository: ``python benchmarks/lensblur.py --json out.json --plot out.png``.
"""

import argparse
import json
import os
from pathlib import Path

import numpy as np

import refdof
from refdof.metrics import psnr, ssim
from refdof.rendering import render_view

SECONDS = 1.2  # 100 rays, 4 layers, 800 x 600, two cores
PSNR, SSIM = 34.8, 0.97  # the paper's table 1: at least
STUDIES: dict[str, list[dict[str, object]]] = {
    "default": [{}],
    "n-buffers": [{"iterations": k} for k in (0, 1, 3)],
    "footprint": [{"footprint": name} for name in ("closed", "rays", "quarter")],
    "layers": [
        {"peel": peel, "layers": k} for peel in ("plain", "umbra", "extended") for k in (1, 2, 3, 4, 5, 6, 7, 8, 0)
    ],
    "rays": [{"samples": n} for n in (1, 4, 16, 36, 64, 100, 144, 256, 400)],
    "jitter": [{"jitter": name} for name in ("none", "noise", "halton")],
    "filter": [{"filter": name} for name in ("nearest", "linear")],
    "misses": [{"misses": name} for name in ("renormalise", "black", "pinhole")],
    "deferred": [{"deferred": True}],
}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scenes", nargs="*", default=["town"], help="built-in scenes")
    parser.add_argument("--size", default="800x600", help="WxH")
    parser.add_argument("--studies", default=",".join(STUDIES), help="comma-separated: " + ", ".join(STUDIES))
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--samples", type=int, default=512, help="of the reference")
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write the numbers there")
    parser.add_argument("--plot", type=Path, metavar="FILE", help="also plot error against layers and rays")
    words = parser.parse_args()
    width, height = (int(side) for side in words.size.split("x"))
    print(f"{words.size}, {os.cpu_count()} processors, {refdof._jit.thread_count()} threads")
    rows = []
    for name in words.scenes:
        scene = refdof.load_scene(name)
        view = refdof.View(scene, scene.camera.with_size((width, height)), scene.lens)
        truth = refdof.reference(scene, view.camera, view.lens, samples=words.samples).image
        render_view("lensblur", view, deferred=True)  # compiles
        for study in words.studies.split(","):
            rows += [measure(view, truth, name, study, params, words.rounds) for params in STUDIES[study]]
        print("\n" + table([row for row in rows if row["scene"] == name]))
        print("\n".join(verdicts([row for row in rows if row["scene"] == name])), flush=True)
    if words.json:
        words.json.write_text(json.dumps(rows, indent=1) + "\n")
    if words.plot:
        plot(rows, words.plot)


def measure(view, truth, scene, study, params, rounds):
    """One row: parameters, scores, seconds, counters."""
    results = [render_view("lensblur", view, True, **params) for _ in range(rounds)]
    stages, image = results[0].stages, results[0].image
    return {
        "scene": scene,
        "study": study,
        "params": params,
        "psnr": psnr(truth, image),
        "ssim": ssim(truth, image),
        "rmse": float(np.sqrt(np.mean((truth.astype(np.float64) - image) ** 2))),
        "prepare_s": results[0].seconds["prepare"],
        "blur_s": min(result.seconds["blur"] for result in results),
        "steps": float(stages["steps"].mean()),
        "missed": float(stages["missed"].mean()),
        "layers": len(stages["parallax"]),
        "levels": stages["lowest"].shape[1],
    }


def table(rows):
    """The rows as Markdown."""
    lines = [
        "| scene | study | parameters | PSNR | SSIM | RMSE | prepare [s] | blur [s] | steps | missed | layers "
        "| levels |",
        "|---|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for r in rows:
        words = ", ".join(f"{key} {value}" for key, value in r["params"].items())
        lines.append(
            f"| {r['scene']} | {r['study']} | {words} | {r['psnr']:.2f} | {r['ssim']:.4f} | {r['rmse']:.4f} "
            f"| {r['prepare_s']:.2f} | {r['blur_s']:.2f} | {r['steps']:.2f} | {r['missed']:.4f} | {r['layers']} "
            f"| {r['levels']} |"
        )
    return "\n".join(lines)


def verdicts(rows):
    """Lines that hold the paper's figures and the targets against what was measured."""

    def find(study, **params):
        return next((r for r in rows if r["study"] == study and r["params"] == params), None)

    lines = []
    if default := find("default"):
        lines.append(f"blur {default['blur_s']:.2f} s, target < {SECONDS:g} s")
        lines.append(f"PSNR {default['psnr']:.2f}, paper >= {PSNR}; SSIM {default['ssim']:.4f}, paper >= {SSIM}")
    four, eight = find("layers", peel="extended", layers=4), find("layers", peel="extended", layers=8)
    if four and eight:
        extra = {key: eight[key] / four[key] - 1.0 for key in ("blur_s", "steps")}
        lines.append(f"second four layers: {extra['blur_s']:+.0%} time, {extra['steps']:+.0%} steps, paper 20 to 30 %")
    few, many = find("rays", samples=16), find("rays", samples=400)
    if few and many:
        power = np.log(many["blur_s"] / few["blur_s"]) / np.log(400 / 16)
        lines.append(f"time grows as rays^{power:.2f} from 16 to 400, paper slightly below 1")
    return lines


def plot(rows, path):
    """PSNR against layers, one line a peel rule, and against rays; one column a scene."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    figure, axes = pyplot.subplots(2, len(scenes), figsize=(5 * len(scenes), 8), squeeze=False)
    for k, scene in enumerate(scenes):
        mine = [row for row in rows if row["scene"] == scene]
        for peel in ("plain", "umbra", "extended"):
            line = [r for r in mine if r["study"] == "layers" and r["params"]["peel"] == peel and r["params"]["layers"]]
            axes[0, k].plot([r["params"]["layers"] for r in line], [r["psnr"] for r in line], "o-", label=peel)
        axes[0, k].set(title=scene, xlabel="layers", ylabel="PSNR [dB]")
        axes[0, k].legend()
        line = [r for r in mine if r["study"] == "rays"]
        axes[1, k].semilogx([r["params"]["samples"] for r in line], [r["psnr"] for r in line], "o-")
        axes[1, k].set(xlabel="rays", ylabel="PSNR [dB]")
    figure.tight_layout()
    figure.savefig(path, dpi=90)


if __name__ == "__main__":
    main()

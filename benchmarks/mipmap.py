"""Benchmark: mipmap interpolation and the baselines at 1024 x 768, beside shaders on llvmpipe and filters of SciPy.

1. make pictures: a built-in scene with ever wider lenses                 `pictures`
2. time `mipmap` and its shaders for each mean circle of confusion         `mipmap_rows`
3. time the baselines and their counterparts, where there are any          `baseline_rows`
4. print Markdown tables                                                   `tables`

Targets: `mipmap` takes the same time for a mean circle of 4 to 128 px, within 15 %, and a third of the shaders' time at
most. Rounds alternate; numbers are medians, first calls are left out. Of the shaders, draws are timed, uploads and the
copies that join their levels to a chain are not. Circles are **diameters** here, as in the paper. Run it from the root
of the repository: ``python benchmarks/mipmap.py --json out.json``.
"""

import argparse
import json
import os
import statistics
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy import ndimage, signal

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the shaders are the tests' own

import refdof
from refdof.methods import METHODS, mipmap, poisson, scatter
from tests.gl import mipmap as shaders
from tests.gl import poisson as listing
from tests.gl import shader

MEANS = (4, 8, 16, 32, 64, 128)  # px, figure 14 of the paper
SPREAD, RATIO = 0.15, 3.0
EVEN = 8.0  # px, radius of the even circle that SciPy's filters can do


def pictures(name, width, height):
    """(mean circle [px], colour, depth, circles) with the scene's lens scaled to each of `MEANS`."""
    scene = refdof.load_scene(name)
    view = refdof.View(scene, scene.camera.with_size((width, height)), scene.lens)
    pinhole = view.pinhole()
    lens = scene.lens
    mean = 2.0 * np.abs(view.coc_px()).mean()
    for wanted in MEANS:
        wider = replace(lens, radius=lens.radius * wanted / mean)
        coc = wider.coc_px(pinhole.depth, view.camera).astype(np.float32)
        yield wanted, pinhole.color, pinhole.depth.astype(np.float32), coc


def timed(function, *arguments):
    """Seconds of one call."""
    start = time.perf_counter()
    function(*arguments)
    return time.perf_counter() - start


def alternated(rounds, *functions):
    """Median seconds of each function, called in turn after one call that does not count."""
    for function in functions:
        function()
    times = [[timed(function) for function in functions] for _ in range(rounds)]
    return [statistics.median(side) for side in zip(*times, strict=True)]


def mipmap_rows(context, name, width, height, rounds):
    rows = []
    for mean, color, depth, coc in pictures(name, width, height):
        last = mipmap.method._last_level(float(np.abs(coc).max()), width, height)
        work = shaders.upload(context, color, coc, last)
        shaders.draw_levels(work)
        chains = shaders.chains(work)

        def draw(work=work, chains=chains):
            shaders.draw_levels(work)
            shaders.draw_picture(work, chains)

        def ours(color=color, depth=depth, coc=coc):
            mipmap.blur(color, depth, coc)

        seconds, shader_seconds = alternated(rounds, ours, draw)
        rows.append(
            {"mean_circle_px": mean, "levels": last, "refdof_s": seconds, "llvmpipe_s": shader_seconds}
            | {"ratio": shader_seconds / seconds}
        )
    return rows


def baseline_rows(context, name, width, height, rounds):
    """Each baseline on the scene as it is; counterparts with their own inputs, the same for both sides."""
    _, color, depth, coc = next(iter(pictures(name, width, height)))
    even = np.full_like(coc, EVEN)
    params = poisson.Params(code="thin_lens")
    coded = np.concatenate([color, poisson.code_of(depth, coc, params)[..., None]], axis=-1).astype(np.float32)
    work, textures, uniforms = listing.upload(context, coded, poisson.shrink(coded), params.max_radius)
    point = np.zeros((33, 33, 3))
    point[16, 16] = 1.0
    disc = np.asarray(scatter.blur(point, np.ones((33, 33)), np.full((33, 33), EVEN)))[..., :1].astype(np.float32)
    box = np.ones(2 * int(EVEN) - 1, dtype=np.float32) / np.float32(2 * EVEN - 1)

    def two_passes():
        ndimage.convolve1d(ndimage.convolve1d(color, box, axis=1), box, axis=0)

    pairs = {
        "poisson": (lambda: poisson.blur(color, depth, coc, params), lambda: shader.draw(work, textures, **uniforms)),
        "separable": (lambda: METHODS["separable"].blur(color, depth, even), two_passes),
        "scatter": (
            lambda: scatter.blur(color, depth, even),
            lambda: signal.fftconvolve(color, disc, mode="same", axes=(0, 1)),
        ),
        "pyramidal": (lambda: METHODS["pyramidal"].blur(color, depth, coc),),
    }
    beside = {
        "poisson": "the same shader on llvmpipe, without the small picture",
        "separable": "scipy.ndimage.convolve1d twice, 17 taps, an even circle of 16 px",
        "scatter": "scipy.signal.fftconvolve, an even circle of 16 px",
        "pyramidal": "none",
    }
    rows = []
    for method, functions in pairs.items():
        seconds = alternated(rounds, *functions)
        other = seconds[1] if len(seconds) > 1 else None
        rows.append({"method": method, "refdof_s": seconds[0], "other_s": other, "other": beside[method]})
    return rows


def tables(result):
    """The result as Markdown."""
    width, height = result["size"]
    rows, spread = result["mipmap"], result["spread"]
    lines = [
        f"{width} x {height}, median of {result['rounds']}, {result['processors']} processors, {result['renderer']}",
        "",
        "| mean circle [px] | levels | mipmap [s] | llvmpipe [s] | ratio |",
        "|---|---|---|---|---|",
    ]
    lines += [
        f"| {r['mean_circle_px']} | {r['levels']} | {r['refdof_s']:.4f} | {r['llvmpipe_s']:.4f} | {r['ratio']:.2f} |"
        for r in rows
    ]
    least = min(r["ratio"] for r in rows)
    lines += [
        "",
        f"Slowest over fastest: {1 + spread:.2f}, target 1.15: {'met' if spread <= SPREAD else 'missed'}. "
        f"Least ratio: {least:.2f}, target {RATIO:g}: {'met' if least >= RATIO else 'missed'}.",
        "",
        "| method | refdof [s] | beside [s] | what |",
        "|---|---|---|---|",
    ]
    for r in result["baselines"]:
        other = "-" if r["other_s"] is None else f"{r['other_s']:.4f}"
        lines.append(f"| {r['method']} | {r['refdof_s']:.4f} | {other} | {r['other']} |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--scene", default="cans", help="a built-in scene")
    parser.add_argument("--size", default="1024x768", help="WxH")
    parser.add_argument("--rounds", type=int, default=25)
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write the numbers there")
    arguments = parser.parse_args()
    width, height = (int(side) for side in arguments.size.split("x"))
    context = shader.open_context()
    rows = mipmap_rows(context, arguments.scene, width, height, arguments.rounds)
    times = [row["refdof_s"] for row in rows]
    result = {
        "size": [width, height],
        "rounds": arguments.rounds,
        "processors": os.cpu_count(),
        "renderer": context.info["GL_RENDERER"],
        "mipmap": rows,
        "spread": max(times) / min(times) - 1.0,
        "baselines": baseline_rows(context, arguments.scene, width, height, arguments.rounds),
    }
    print(tables(result))
    if arguments.json:
        arguments.json.write_text(json.dumps(result, indent=2) + "\n")


if __name__ == "__main__":
    main()

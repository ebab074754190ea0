"""Benchmark: the single pass at 800 x 600 beside the same loop as a fragment shader on Mesa's llvmpipe.

1. make a picture: the view of a built-in scene          `picture`
2. time the compiled kernel, compiling told apart        `time_ours`
3. time the shader, upload and read-back left out        `time_shader`
4. print a Markdown table; the target is 8 times         `table`

Both run on the same processor in turn, round by round, with as many threads as each takes by itself. The time to
compile is what the first call takes longer than the others; a kernel that Numba finds in its cache is only loaded (an
empty folder in REFDOF_CACHE_DIR makes it compile), and both filters share one kernel. Run it from the root of the
repository: ``python benchmarks/singlepass.py --json out.json``.
"""

import argparse
import json
import os
import statistics
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the shader is the tests' own

import refdof
from refdof.methods.singlepass import Params, blur, spiral
from tests.gl import shader
from tests.gl import singlepass as listing

TARGET = 8.0
FILTERS = ("nearest", "bilinear")


def picture(name, width, height):
    """Colour, depth and circles of confusion [px] of a built-in scene, float32."""
    scene = refdof.load_scene(name)
    view = refdof.View(scene, scene.camera.with_size((width, height)), scene.lens)
    pinhole = view.pinhole()
    return pinhole.color, pinhole.depth.astype(np.float32), view.coc_px().astype(np.float32)


def time_ours(image, depth_filter):
    """Seconds of one call of `blur`, padding included."""
    color, depth, coc = image
    start = time.perf_counter()
    blur(color, depth, coc, Params(depth_filter))
    return time.perf_counter() - start


def time_shader(prepared):
    """Seconds of one draw, from the call until glFinish returns."""
    work, textures, uniforms = prepared
    start = time.perf_counter()
    shader.draw(work, textures, **uniforms)
    return time.perf_counter() - start


def measure(image, rounds):
    """Rows of the table: first calls apart, then medians of `rounds` alternating ones."""
    context = shader.open_context()
    color, depth, coc = image
    pixels, taps, rows = depth.size, len(spiral()), []
    for depth_filter in FILTERS:
        prepared = listing.upload(context, color, depth, coc, depth_filter)
        first = time_ours(image, depth_filter), time_shader(prepared)
        pairs = [(time_ours(image, depth_filter), time_shader(prepared)) for _ in range(rounds)]
        ours, theirs = (statistics.median(side) for side in zip(*pairs, strict=True))
        rows.append(
            {
                "depth_filter": depth_filter,
                "refdof_s": ours,
                "llvmpipe_s": theirs,
                "ratio": theirs / ours,
                "refdof_taps_per_s": pixels * taps / ours,
                "llvmpipe_taps_per_s": pixels * taps / theirs,
                "refdof_spread_s": [min(p[0] for p in pairs), max(p[0] for p in pairs)],
                "llvmpipe_spread_s": [min(p[1] for p in pairs), max(p[1] for p in pairs)],
                "refdof_compile_s": max(first[0] - ours, 0.0),
                "llvmpipe_compile_s": max(first[1] - theirs, 0.0),
            }
        )
    height, width = image[1].shape
    return {
        "size": [width, height],
        "taps": taps,
        "rounds": rounds,
        "processors": os.cpu_count(),
        "renderer": context.info["GL_RENDERER"],
        "target_ratio": TARGET,
        "rows": rows,
    }


def table(result):
    """The result as Markdown."""
    width, height = result["size"]
    lines = [
        f"{width} x {height}, {result['taps']} taps, median of {result['rounds']}, "
        f"{result['processors']} processors, {result['renderer']}",
        "",
        "| depth filter | refdof [s] | llvmpipe [s] | ratio | target | refdof [tap-pixels/s] "
        "| llvmpipe [tap-pixels/s] | refdof compile [s] | llvmpipe compile [s] |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for row in result["rows"]:
        met = "met" if row["ratio"] >= result["target_ratio"] else "missed"
        lines.append(
            f"| {row['depth_filter']} | {row['refdof_s']:.3f} | {row['llvmpipe_s']:.3f} | {row['ratio']:.1f} "
            f"| >= {result['target_ratio']:g}, {met} | {row['refdof_taps_per_s']:.2e} "
            f"| {row['llvmpipe_taps_per_s']:.2e} | {row['refdof_compile_s']:.2f} | {row['llvmpipe_compile_s']:.2f} |"
        )
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--scene", default="fence", help="a built-in scene")
    parser.add_argument("--size", default="800x600", help="WxH")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write the numbers there")
    arguments = parser.parse_args()
    width, height = (int(side) for side in arguments.size.split("x"))
    result = measure(picture(arguments.scene, width, height), arguments.rounds)
    print(table(result))
    if arguments.json:
        arguments.json.write_text(json.dumps(result, indent=2) + "\n")


if __name__ == "__main__":
    main()

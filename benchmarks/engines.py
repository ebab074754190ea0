"""Benchmark: the methods that engines use, at 1280 x 720, beside the same passes in GLSL on Mesa's llvmpipe.

1. make pictures: a built-in scene whose lens gives largest circles of 4, 8, 16 and 32 px      `pictures`
2. prepare a port: every pass compiled, its inputs uploaded                                    `Port`
3. time method and port, and see that their pictures agree                                     `measure`
4. print a Markdown table; the target is 3 times                                               `table`

Both run on the same processor in turn, round by round, with as many threads as each takes by itself; first calls are
left out, numbers are medians. Of the ports, all draws are timed, uploads and read-backs are not. Circles are radii, and
every method cuts them at 32 px. The time of the processor, of all threads, is told beside that of the clock: on a busy
machine look at that one. Numba's threads sleep while they wait, as llvmpipe's do: waiting is no work. Run it from the
root of the repository: ``python benchmarks/engines.py --json out.json``.
"""

import argparse
import json
import os
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the shaders' hosts are the tests' own
os.environ.setdefault("OMP_WAIT_POLICY", "passive")  # read when Numba starts its threads

import refdof
from refdof.methods import METHODS
from tests.gl.engine_ports import PORTS
from tests.gl.port import Prepared, prepared
from tests.gl.shader import open_context

TARGET = 3.0
LARGEST = (4, 8, 16, 32)  # px
CUT = 32.0


def pictures(name, width, height):
    """(largest circle [px], colour, depth, circles) with the scene's lens scaled to each of `LARGEST`, float32."""
    scene = refdof.load_scene(name)
    view = refdof.View(scene, scene.camera.with_size((width, height)), scene.lens)
    pinhole, lens = view.pinhole(), scene.lens
    widest = np.abs(view.coc_px()).max()
    for largest in LARGEST:
        scaled = replace(lens, radius=lens.radius * largest / widest)
        coc = scaled.coc_px(pinhole.depth, view.camera).astype(np.float32)
        yield largest, pinhole.color, pinhole.depth.astype(np.float32), coc


class Port:
    """All passes of a method's shaders, prepared for one picture; `picture` is what they make."""

    def __init__(self, context, name, *inputs):
        self.passes: list[Prepared] = []

        def draw(*arguments, **uniforms):
            self.passes.append(prepared(context, *arguments, **uniforms))
            self.passes[-1].draw()
            return self.passes[-1].pictures()

        _, self.picture = PORTS[name](draw, *inputs)

    def draw(self):
        for one in self.passes:
            one.draw()

    def release(self):
        for one in self.passes:
            one.release()


def timed(function):
    """Seconds of one call, by the clock and of the processor."""
    start, busy = time.perf_counter(), time.process_time()
    function()
    return time.perf_counter() - start, time.process_time() - busy


def measure(context, name, image, rounds):
    """One row: medians of `rounds` alternating calls, and how many pixels differ by more than 1e-4."""
    largest, color, depth, coc = image
    method = METHODS[name]
    inputs = color, depth, coc, method.Params(largest_px=CUT)
    port = Port(context, name, *inputs)
    differ = np.abs(method.blur(*inputs) - port.picture).max(axis=2) > 1e-4
    pairs = np.array([(timed(lambda: method.blur(*inputs)), timed(port.draw)) for _ in range(rounds)])
    port.release()
    (ours, ours_busy), (theirs, theirs_busy) = np.median(pairs, axis=0).tolist()
    return {
        "method": name,
        "largest_px": largest,
        "refdof_s": ours,
        "llvmpipe_s": theirs,
        "ratio": theirs / ours,
        "refdof_busy_s": ours_busy,
        "llvmpipe_busy_s": theirs_busy,
        "busy_ratio": theirs_busy / ours_busy,
        "refdof_spread_s": [pairs[:, 0, 0].min(), pairs[:, 0, 0].max()],
        "llvmpipe_spread_s": [pairs[:, 1, 0].min(), pairs[:, 1, 0].max()],
        "differ": float(differ.mean()),
    }


def table(result):
    """The result as Markdown: a row for every method and circle."""
    width, height = result["size"]
    lines = [
        f"{result['scene']}, {width} x {height}, median of {result['rounds']}, {result['processors']} processors, "
        f"load {result['load']:.1f}, {result['renderer']}",
        "",
        "| method | circles up to [px] | refdof [s] | llvmpipe [s] | ratio | target | ratio of processor time "
        "| pixels that differ by 1e-4 |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for row in result["rows"]:
        met = "met" if row["ratio"] >= result["target_ratio"] else "missed"
        lines.append(
            f"| {row['method']} | {row['largest_px']} | {row['refdof_s']:.3f} | {row['llvmpipe_s']:.3f} "
            f"| {row['ratio']:.1f} | >= {result['target_ratio']:g}, {met} | {row['busy_ratio']:.1f} "
            f"| {row['differ']:.2%} |"
        )
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--scene", default="cans", help="a built-in scene")
    parser.add_argument("--size", default="1280x720", help="WxH")
    parser.add_argument("--methods", default=",".join(PORTS), help="comma-separated")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write the numbers there")
    arguments = parser.parse_args()
    width, height = (int(side) for side in arguments.size.split("x"))
    context, rows = open_context(), []
    for image in pictures(arguments.scene, width, height):
        rows += [measure(context, name, image, arguments.rounds) for name in arguments.methods.split(",")]
    result = {
        "scene": arguments.scene,
        "size": [width, height],
        "rounds": arguments.rounds,
        "processors": os.cpu_count(),
        "load": os.getloadavg()[0],
        "renderer": context.info["GL_RENDERER"],
        "target_ratio": TARGET,
        "rows": sorted(rows, key=lambda row: list(PORTS).index(row["method"])),
    }
    print(table(result))
    if arguments.json:
        arguments.json.write_text(json.dumps(result, indent=2) + "\n")


if __name__ == "__main__":
    main()

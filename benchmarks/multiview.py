"""Benchmark: multiview synthesis at 800 x 600, over lens samples and layers, with early culling and without.

1. draw and colour the layers of a built-in scene, untimed          `prepared`
2. time `blur`: lens points, N-buffers and rays                     `time_blur`
3. print Markdown tables; the target is 0.5 s at 32 samples, 16 layers `table`

The table over samples should grow in proportion, that over layers slower than that. Run it from the root of the
repository: ``python benchmarks/multiview.py --json out.json``.
"""

import argparse
import json
import os
import statistics
from pathlib import Path

import refdof
from refdof.compare import warm_up
from refdof.rendering import render_view

RAYS = {"search": "false position", "jitter": "noise", "pattern": "poisson", "cones": "none"}  # as the paper times them
TARGET_S, TARGET = 0.5, {"samples": 32, "layers": 16, **RAYS}
SAMPLES = (8, 16, 32, 64, 128, 256)
LAYERS = (1, 2, 4, 8, 16, 32)


def prepared(name, width, height):
    """A view of a built-in scene, whose products later calls share."""
    scene = refdof.load_scene(name)
    return refdof.View(scene, scene.camera.with_size((width, height)), scene.lens)


def time_blur(view, rounds, **words):
    """Median seconds of `blur`, and the seconds of `prepare`."""
    results = [render_view("multiview", view, **words) for _ in range(rounds)]
    seconds = [result.seconds for result in results]
    return statistics.median(s["blur"] for s in seconds), max(s["prepare"] for s in seconds)


def measure(view, rounds, tables):
    """Rows of the tables asked for."""
    rows = []
    for kind, values in (("samples", SAMPLES), ("layers", LAYERS)):
        for value in values if kind in tables else ():
            for culling in (True, False):
                params = {**TARGET, kind: value, "culling": culling}
                blur, prepare = time_blur(view, rounds, **params)
                rows.append({"over": kind, **params, "blur_s": blur, "prepare_s": prepare})
    for words in (
        {"search": "march"},
        {"start": "middle"},
        {"jitter": "none"},
        {"jitter": "halton"},
        {"cones": "paper"},
        {"view_dependent": True},
        {"cones": "paper", "view_dependent": True},
    ):
        if "variants" not in tables:
            break
        warm_up("multiview", words)
        blur, prepare = time_blur(view, rounds, **{**TARGET, **words})
        rows.append({"over": "variants", **TARGET, **words, "blur_s": blur, "prepare_s": prepare})
    return rows


def table(name, size, rows):
    """The result as Markdown."""
    lines = [f"`{name}`, {size}, {os.cpu_count()} processors", ""]
    for kind in ("samples", "layers"):
        if not any(row["over"] == kind for row in rows):
            continue
        lines += [f"| {kind} | prepare [s] | blur [s] | without culling [s] |", "|---|---|---|---|"]
        chosen = [row for row in rows if row["over"] == kind]
        for row, plain in zip(chosen[::2], chosen[1::2], strict=True):
            mark = ""
            if all(row[key] == TARGET[key] for key in TARGET):
                mark = f" ({'met' if row['blur_s'] < TARGET_S else 'missed'}: {TARGET_S:g})"
            lines.append(
                f"| {row[kind]} | {row['prepare_s']:.2f} | {row['blur_s']:.2f}{mark} | {plain['blur_s']:.2f} |"
            )
        lines.append("")
    if any(row["over"] == "variants" for row in rows):
        lines += ["| variant | blur [s] |", "|---|---|"]
    for row in rows:
        if row["over"] == "variants":
            words = ", ".join(f"{k}={v}" for k, v in row.items() if k not in ("over", "blur_s", "prepare_s", *TARGET))
            lines.append(f"| {words} | {row['blur_s']:.2f} |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--scene", default="fence", help="a built-in scene")
    parser.add_argument("--size", default="800x600", help="WxH")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--tables", default="samples,layers,variants", help="which of them")
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write the numbers there")
    arguments = parser.parse_args()
    width, height = (int(side) for side in arguments.size.split("x"))
    warm_up("multiview", {})
    rows = measure(prepared(arguments.scene, width, height), arguments.rounds, arguments.tables.split(","))
    print(table(arguments.scene, arguments.size, rows))
    if arguments.json:
        arguments.json.write_text(json.dumps(rows, indent=2) + "\n")


if __name__ == "__main__":
    main()

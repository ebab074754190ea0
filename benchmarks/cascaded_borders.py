"""Benchmark: what `cascaded` gains by its choices where the paper is silent: matting at the ends, and picture borders.

PSNR [dB] of the display image against the reference, for all built-in scenes, in one run. Run it from the root of the
repository: ``python benchmarks/cascaded_borders.py --size 320x240 --samples 256``.
"""

import argparse
from itertools import product

import numpy as np

import refdof
from refdof.metrics import psnr
from refdof.rendering import render_view
from refdof.truth.reference import reference_of_view

BORDERS, BOUNDARIES = ("transparent", "clamp"), ("extrapolate", "hard", "as_printed")


def scores(name, size, samples):
    """PSNR for every choice, by (border, boundary)."""
    scene = refdof.load_scene(name)
    view = refdof.View(scene, scene.camera.with_size(size), scene.lens)
    truth = reference_of_view(view, samples=samples).image
    return {
        (border, boundary): psnr(truth, render_view("cascaded", view, border=border, boundary=boundary).image)
        for border, boundary in product(BORDERS, BOUNDARIES)
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--size", default="320x240", help="WxH")
    parser.add_argument("--samples", type=int, default=256, help="of the reference")
    arguments = parser.parse_args()
    size = tuple(int(side) for side in arguments.size.split("x"))
    rows = {}
    print("| scene | " + " | ".join(f"{a}, {b}" for a, b in product(BORDERS, BOUNDARIES)) + " |")
    print("|---" * (1 + len(BORDERS) * len(BOUNDARIES)) + "|")
    for name in refdof.SCENES:
        rows[name] = list(scores(name, size, arguments.samples).values())
        print(f"| {name} | " + " | ".join(f"{score:.2f}" for score in rows[name]) + " |", flush=True)
    print("| mean | " + " | ".join(f"{score:.2f}" for score in np.mean(list(rows.values()), axis=0)) + " |")


if __name__ == "__main__":
    main()

"""Benchmark: the raster stages beside scipy.ndimage, OpenCV, llvmpipe and the speed of memory, in one run.

1. one row per stage: our call, the peers' calls, bytes        `rows`
2. time them and a copy of as many bytes in turn, compiled     `measure`
3. print a Markdown table and the targets                      `table`

Bytes are those that must be read or written once: arguments and results, and of an N-buffer query one value of each
side per rectangle. The limit is the time in which all threads copy as many, half read and half written, into a new
array, whose pages the system has to clear first: our results, scipy's and OpenCV's are new arrays, too. "In use" is the
same copy into an array that is there already; llvmpipe draws into textures made beforehand. Times are the shortest of
some rounds. Largest differences from the peers' results are printed, too. It needs ``make peers``:
``python benchmarks/raster.py --json out.json``.
"""

import argparse
import json
import os
import sys
import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the OpenGL harness is the tests' own

import raster_gl as gl
import raster_peers as peers

import refdof
from refdof._jit import kernel, prange, thread_count
from refdof.raster.filters.downsample import downsample_gaussian
from refdof.raster.filters.mip_chain import box_mipmaps, gaussian_mipmaps, generate_mipmaps
from refdof.raster.filters.n_buffer import n_buffer, query
from refdof.raster.gpu.depth_peeling import peel_raster
from refdof.raster.gpu.rasterize import rasterize
from refdof.raster.gpu.texture import bilinear, trilinear
from tests.gl import shader

BANDWIDTH_TARGET = 3.0  # times the limit
LAYERS = 4
COPIES = ("limit", "in use")
OTHER = "OpenCV pyrDown (5x5)"  # another filter: shown, not judged


class Row(NamedTuple):
    """A stage: calls that return arrays (llvmpipe's return nothing), bytes, and what is asked of it."""

    name: str
    ours: Any
    peers: dict[str, Any]
    moved: int
    target: str  # "fastest": of all peers and near the limit; "twice": at most twice llvmpipe's time; "" : none


@kernel
def _copy(source, out):
    for row in prange(len(source)):
        out[row] = source[row]


def rows(context, size, scene_name):
    """All stages at size x size, four channels of float32; the scene's triangles."""
    random = np.random.default_rng(1)
    image, depth = random.random((size, size, 4), dtype=np.float32), random.random((size, size), dtype=np.float32)
    y, x = np.indices((size, size))
    buffer, levels, pixels = n_buffer(depth), generate_mipmaps(image), size * size
    count = len(levels) - 1
    chain = sum(level.nbytes for level in levels)

    # A rectangle per pixel, as a circle of confusion of 0 .. 15 px gives it.
    radius = np.abs(15.5 * np.sin(x / 97.0 + y / 61.0)).astype(np.int64)
    sides = [np.clip(v, 0, size - 1).ravel() for v in (x - radius, y - radius, x + radius, y + radius)]
    rectangles = np.stack(sides, axis=-1).reshape(size, size, 4)

    # Reads off the texels' centres, at levels that vary slowly.
    places = np.zeros((size, size, 4), dtype=np.float32)
    places[..., 0], places[..., 1] = (x + 0.8) / size, (y + 0.2) / size
    flat, places[..., 2] = places.copy(), 2.5 + 2.4 * np.sin(x / 71.0)
    u, v, lod = (places[..., c].astype(np.float64) for c in range(3))
    at_x, at_y = (places[..., c] * np.float32(size) - np.float32(0.5) for c in (0, 1))

    scene = refdof.load_scene(scene_name)
    view = refdof.View(scene, scene.camera.with_size((size, size)), scene.lens)
    vertices, faces = view.triangles()
    drawn = 3 * 4 * len(vertices) + 3 * 8 * len(faces) + pixels * (8 + 4 + 2 * 8)
    return [
        Row("N-buffer build", lambda: n_buffer(depth)[:2], {
            "scipy": lambda: stacked(peers.ndi_windows(depth, len(buffer.lowest))),
            "OpenCV": lambda: stacked(peers.cv_windows(depth, len(buffer.lowest))),
            "llvmpipe": gl.build(context, depth, len(buffer.lowest)),
        }, depth.nbytes + 2 * buffer.lowest.nbytes, "fastest"),
        Row("N-buffer query", lambda: query(buffer, *sides), {
            "llvmpipe": gl.query(context, buffer, rectangles),
        }, pixels * (4 * 8 + 2 * 4 + 2 * 4), "fastest"),
        Row("generateMipmap", lambda: generate_mipmaps(image)[1:], {
            "scipy": lambda: peers.ndi_box(image), "OpenCV": lambda: peers.cv_box(image),
            "llvmpipe": gl.generate(context, image),
        }, chain, "fastest"),
        Row("2x2 box chain", lambda: box_mipmaps(image)[1:], {
            "scipy": lambda: peers.ndi_box(image), "OpenCV": lambda: peers.cv_box(image),
            "llvmpipe": gl.generate(context, image),
        }, chain, "fastest"),
        Row("Gaussian 3x3 level", lambda: [gaussian_level(image)], {
            "scipy": lambda: [peers.ndi_gaussian(image)], "OpenCV": lambda: [peers.cv_gaussian(image)],
            OTHER: lambda: peers.cv_pyramid(image), "llvmpipe": gl.gaussian(context, image, 1),
        }, image.nbytes * 5 // 4, "fastest"),
        Row("Gaussian 3x3 chain", lambda: gaussian_mipmaps(image)[1:], {
            "scipy": lambda: chain_of(peers.ndi_gaussian, image), "OpenCV": lambda: chain_of(peers.cv_gaussian, image),
            OTHER: lambda: chain_of(peers.cv_pyramid, image), "llvmpipe": gl.gaussian(context, image, count),
        }, chain, "fastest"),
        Row("bilinear reads", lambda: [bilinear(image, u, v)], {
            "scipy": lambda: [peers.ndi_reads(image, at_x, at_y)],
            "OpenCV": lambda: [peers.cv_reads(image, at_x, at_y)],
            "llvmpipe": gl.reads(context, levels, flat),
        }, 2 * image.nbytes + pixels * 2 * 8, ""),
        Row("trilinear reads", lambda: [trilinear(levels, u, v, lod)], {
            "llvmpipe": gl.reads(context, levels, places),
        }, image.nbytes + chain + pixels * 3 * 8, ""),
        Row(f"rasterise {len(faces)} triangles", lambda: rasterize(vertices, faces, view.camera), {
            "llvmpipe": gl.peel(context, vertices, faces, view.camera, 1),
        }, drawn, "twice"),
        Row(f"peel {LAYERS} layers", lambda: peel_raster(vertices, faces, view.camera, LAYERS), {
            "llvmpipe": gl.peel(context, vertices, faces, view.camera, LAYERS),
        }, LAYERS * drawn, ""),
    ]  # fmt: skip


def stacked(windows):
    return [np.stack(levels) for levels in windows]


def gaussian_level(image):
    """The first level of the chain alone."""
    side = np.exp(-0.5)
    weights = np.array([side, 1.0, side]) / (1.0 + 2.0 * side)
    out = np.empty((len(image) // 2, image.shape[1] // 2, image.shape[2]), dtype=image.dtype)
    nine = np.outer(weights, weights).astype(image.dtype).ravel()
    downsample_gaussian(image.reshape(len(image), -1), image.shape[2], nine, out.reshape(len(out), -1))
    return out


def chain_of(downsample, image):
    levels = [image]
    while len(levels[-1]) > 1:
        levels.append(downsample(levels[-1]))
    return levels[1:]


def measure(row, rounds):
    """Times [s], shortest of all rounds, in turn; the limit; and differences from the peers' results."""
    half = np.ones((512, -(-row.moved // 4096)), dtype=np.float32)
    target = half.copy()
    copies = {"limit": lambda: _copy(half, np.empty_like(half)), "in use": lambda: _copy(half, target)}
    calls = {"refdof": row.ours, **row.peers, **copies}
    results = {name: call() for name, call in calls.items()}  # compiles, and touches what is reused
    seconds = dict.fromkeys(calls, np.inf)
    for _ in range(rounds):
        for name, call in calls.items():
            repeats = 1 + int(min(0.05 / seconds[name], 20.0))  # short calls more often
            for _ in range(repeats):
                start = time.perf_counter()
                call()
                seconds[name] = min(seconds[name], time.perf_counter() - start)
    differences = {
        name: max(float(np.abs(a - b).max()) for a, b in zip(results["refdof"], found, strict=True))
        for name, found in results.items()
        if name not in ("refdof", *COPIES, OTHER) and found is not None
    }
    return {"name": row.name, "seconds": seconds, "differences": differences, "bytes": row.moved} | judge(row, seconds)


def judge(row, seconds):
    """The figures that the targets speak of: times the best peer, times the limit."""
    best = min(t for name, t in seconds.items() if name not in ("refdof", *COPIES, OTHER))
    over_peer, over_limit = seconds["refdof"] / best, seconds["refdof"] / seconds["limit"]
    met = {
        "fastest": over_peer <= 1.0 and over_limit <= BANDWIDTH_TARGET,
        "twice": over_peer <= 2.0,
        "": None,
    }[row.target]
    in_use = seconds["refdof"] / seconds["in use"]
    return {"over_best_peer": over_peer, "over_limit": over_limit, "over_copy_in_use": in_use, "met": met}


def table(report):
    """The report as Markdown."""
    names = ["refdof", "scipy", "OpenCV", "llvmpipe", *COPIES]
    lines = [
        f"{report['size']} x {report['size']}, {report['threads']} threads, best of {report['rounds']} rounds [ms], "
        f"{report['renderer']}",
        "",
        "| stage | " + " | ".join(names) + " | / best peer | / limit | / in use | target |",
        "|---|" + "---|" * (len(names) + 4),
    ]
    for row in report["rows"]:
        times = [f"{1e3 * row['seconds'][n]:.2f}" if n in row["seconds"] else "" for n in names]
        verdict = {True: "met", False: "missed", None: ""}[row["met"]]
        figures = f"{row['over_best_peer']:.2f} | {row['over_limit']:.2f} | {row['over_copy_in_use']:.2f} | {verdict}"
        lines.append(f"| {row['name']} | " + " | ".join(times) + f" | {figures} |")
    lines.append("")
    for row in report["rows"]:
        if OTHER in row["seconds"]:
            lines.append(f"{row['name']}: {OTHER}, another filter: {1e3 * row['seconds'][OTHER]:.2f} ms")
        if row["differences"]:
            words = ", ".join(f"{name} {value:.1e}" for name, value in row["differences"].items())
            lines.append(f"{row['name']}: largest difference from {words}")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--scene", default="figures", help="a built-in scene or a mesh file")
    parser.add_argument("--size", type=int, default=1024, help="width and height [px], a power of two")
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--only", default="", help="stages whose name holds this word")
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write the numbers there")
    words = parser.parse_args()
    if words.size < 2 or words.size & (words.size - 1):
        parser.error(f"--size: got {words.size}; allowed is a power of two >= 2")
    context = shader.open_context()
    chosen = [row for row in rows(context, words.size, words.scene) if words.only in row.name]
    report = {
        "size": words.size,
        "threads": thread_count(),
        "processors": os.cpu_count(),
        "rounds": words.rounds,
        "renderer": context.info["GL_RENDERER"],
        "rows": [measure(row, words.rounds) for row in chosen],
    }
    print(table(report))
    if words.json:
        words.json.write_text(json.dumps(report, indent=2) + "\n")


if __name__ == "__main__":
    main()

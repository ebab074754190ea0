"""Benchmark: the most memory that `refdof render` and `refdof compare` hold, at three sizes.

Each figure is the peak of a process of its own (its resident set, interpreter and libraries included), with warm
caches: compiling takes memory, too, but does not grow with the picture. `per pixel` is the slope between the smallest
and the largest picture; `straight` is the middle one's figure over that of the line between them, 1 where memory grows
with the number of pixels. Run it from the root of the repository: ``python benchmarks/memory.py --json out.json``.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import refdof

SIZES = ((480, 270), (960, 540), (1920, 1080))
LIMIT_MIB = 2048.0  # at the largest size
_MIB = 1024.0 * 1024.0


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--scene", default="fence", help="a built-in scene")
    parser.add_argument("--methods", default=",".join(refdof.METHODS), help="comma-separated")
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write the numbers there")
    words = parser.parse_args()
    methods = words.methods.split(",")
    subprocess.run([sys.executable, "-m", "refdof.cli", "warm"], check=True, stdout=subprocess.DEVNULL)
    with tempfile.TemporaryDirectory() as folder:
        jobs = {name: ["render", words.scene, "--method", name, "-o", f"{folder}/a.npy"] for name in methods}
        few = ["--methods", "singlepass", "--samples", "16", "--out", folder]
        jobs["compare (singlepass, 16 samples)"] = ["compare", words.scene, *few]
        jobs[f"compare ({len(methods)} methods, 16 samples)"] = [*jobs["compare (singlepass, 16 samples)"]]
        jobs[f"compare ({len(methods)} methods, 16 samples)"][3] = words.methods
        rows = [measure(name, job) for name, job in jobs.items()]
    print(table(words.scene, rows))
    if words.json:
        words.json.write_text(json.dumps(rows, indent=1) + "\n")


def measure(name, command):
    """Peak memory [MiB] and seconds of one command at every size."""
    peaks, seconds = [], []
    for width, height in SIZES:
        began = time.perf_counter()
        process = subprocess.Popen(
            [sys.executable, "-m", "refdof.cli", *command, "--size", f"{width}x{height}"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode:
            raise SystemExit(f"{name} ended with {process.returncode} at {width}x{height}")
        peaks.append(usage.ru_maxrss * (1.0 if sys.platform == "darwin" else 1024.0) / _MIB)
        seconds.append(time.perf_counter() - began)
    pixels = [width * height for width, height in SIZES]
    slope = (peaks[-1] - peaks[0]) / (pixels[-1] - pixels[0])
    line = peaks[0] + slope * (pixels[1] - pixels[0])
    return {
        "name": name,
        "peak_mib": peaks,
        "seconds": seconds,
        "bytes_per_pixel": slope * _MIB,
        "straight": peaks[1] / line,
    }


def table(scene, rows):
    """The rows as Markdown."""
    heads = " | ".join(f"{width}x{height} [MiB]" for width, height in SIZES)
    lines = [f"{scene}, peak resident memory\n", f"| command | {heads} | per pixel [bytes] | straight | |"]
    lines.append("|" + "---|" * (len(SIZES) + 4))
    for row in rows:
        peaks = " | ".join(f"{peak:.0f}" for peak in row["peak_mib"])
        verdict = "met" if row["peak_mib"][-1] <= LIMIT_MIB else "missed"
        lines.append(f"| {row['name']} | {peaks} | {row['bytes_per_pixel']:.0f} | {row['straight']:.2f} | {verdict} |")
    return "\n".join(lines)


if __name__ == "__main__":
    main()

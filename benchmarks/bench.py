"""Every benchmark with a peer or a goal, one table of ratios, and a JSON file of all figures.

Each benchmark runs in a process of its own, one after the other, and measures both sides itself. Run it from the root
of the repository, after `make peers`: ``make bench``, or ``python benchmarks/bench.py --only raster,memory``.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

from lensblur import SECONDS as LENSBLUR_S
from memory import LIMIT_MIB
from multiview import TARGET_S as MULTIVIEW_S

from refdof.machine import processor

HERE = Path(__file__).parent


class Line(NamedTuple):
    """One row: ours and the peer's in the same unit, and the ratio ours / peer that is wanted at most."""

    what: str
    ours: float
    unit: str
    peer: float | None = None
    beside: str = ""
    goal: float | None = None


def raster(rows):
    for row in rows["rows"]:
        peers = {key: row["seconds"].get(key) for key in ("scipy", "OpenCV", "llvmpipe")}
        best = min((key for key in peers if peers[key]), key=lambda key: peers[key])
        ours, limit = 1e3 * row["seconds"]["refdof"], 1e3 * row["seconds"]["limit"]
        yield Line(row["name"], ours, "ms", 1e3 * peers[best], best, 1.0)
        yield Line(f"{row['name']}, bytes", ours, "ms", limit, "copy")


def mipmap(rows):
    for row in rows["mipmap"]:
        what = f"mipmap, circles of {row['mean_circle_px']} px"
        yield Line(what, row["refdof_s"], "s", row["llvmpipe_s"], "llvmpipe", 1.0 / 3.0)
    goals = {"poisson": (0.8, None), "scatter": (None, 0.2), "pyramidal": (None, 0.08)}
    for row in rows["baselines"]:
        name, ours = row["method"], row["refdof_s"]
        ratio, seconds = goals.get(name, (None, None))
        if seconds is not None:
            yield Line(name, ours, "s", seconds, "the goal", 1.0)
        if row["other_s"] is not None:
            yield Line(name, ours, "s", row["other_s"], row["other"], ratio)


def singlepass(rows):
    goal = 1.0 / rows["target_ratio"]
    for row in rows["rows"]:
        yield Line(f"singlepass, {row['depth_filter']}", row["refdof_s"], "s", row["llvmpipe_s"], "llvmpipe", goal)


def engines(rows):
    for row in rows["rows"]:
        what, goal = f"{row['method']}, circles up to {row['largest_px']} px", 1.0 / rows["target_ratio"]
        yield Line(what, row["refdof_s"], "s", row["llvmpipe_s"], "llvmpipe", goal)


def reference(rows):
    for target in rows["targets"]:
        over = target["limit"].startswith(">=")
        goal = float(target["limit"].split()[1])
        figure, goal = (1.0 / target["figure"], 1.0 / goal) if over else (target["figure"], goal)
        what = f"{rows['scene']['name']}, {target['integral']}: {target['target']}" + (", inverse" if over else "")
        yield Line(what, figure, "", 1.0, "the peer", goal)


def multiview(rows):
    for row in rows:
        if row["over"] == "layers" and row["layers"] == 16 and row["culling"]:
            yield Line("multiview, 32 samples, 16 layers, town", row["blur_s"], "s", MULTIVIEW_S, "the goal", 1.0)


def lensblur(rows):
    for row in rows:
        if row["study"] == "default":
            yield Line("lensblur, 100 rays, 4 layers, town", row["blur_s"], "s", LENSBLUR_S, "the goal", 1.0)


def optics(rows):
    rates = rows["trace"]
    peer = "optiland" if "optiland" in rates else "NumPy"
    goal = 1.0 / rows["target"] if peer == "optiland" else None
    yield Line("double Gauss, a ray", 1e6 / rates["refdof"], "us", 1e6 / rates[peer], peer, goal)
    for row in rows["sampling"]:
        if row["height_mm"] == 0.0:
            what = f"rays for one that passes, f/{row['f_stop']}"
            yield Line(what, row["bounds"], "", row["rear_disc"], "the rear disc", 1.1 if row["f_stop"] == 2.0 else 1.0)
    for row in rows["rejection"]:
        what, goal = (
            f"a ray that passes, f/{row['f_stop']}",
            None if row["f_stop"] == 2.0 else 1.0,
        )  # open: the disc is full
        yield Line(what, row["lens map_ns"], "ns", row["rejection_ns"], "rejection on the rear disc", goal)
    thin = rows["reference"][0]["ns"]
    for row in rows["reference"][1:]:
        what = f"reference of lights, a ray, {row['lens']}, {row['surfaces']} surfaces"
        yield Line(what, row["ns"], "ns", thin, "the thin lens", row["target"])


def studio(rows):
    for row in rows["rows"]:
        for step in ("coarse", "fine"):
            goal = rows[f"{step}_target_s"]
            yield Line(
                f"studio, {row['what']}, {step}", row[f"{step}_s"], "s", goal, "the goal of the first click", 1.0
            )


def memory(rows):
    for row in rows:
        yield Line(f"memory at 1920x1080, {row['name']}", row["peak_mib"][-1], "MiB", LIMIT_MIB, "the goal", 1.0)


RUNS = {
    "raster": ("raster.py", [], raster),
    "mipmap": ("mipmap.py", [], mipmap),
    "singlepass": ("singlepass.py", [], singlepass),
    "engines": ("engines.py", [], engines),
    "multiview": ("multiview.py", ["--scene", "town", "--tables", "layers"], multiview),
    "lensblur": ("lensblur.py", ["town", "--studies", "default"], lensblur),
    **{
        f"reference-{scene}": ("reference.py", ["--scene", scene, "--most", "256", "--long", "1024"], reference)
        for scene in ("figures", "fence", "foliage")
    },
    "optics": ("optics.py", [], optics),
    "studio": ("studio.py", [], studio),
    "memory": ("memory.py", [], memory),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--only", default=",".join(RUNS), help="comma-separated, of: " + ", ".join(RUNS))
    parser.add_argument("--out", type=Path, default=Path("out/bench"), help="folder of the JSON files")
    words = parser.parse_args()
    chosen = words.only.split(",")
    if unknown := [name for name in chosen if name not in RUNS]:
        parser.error(f"--only: got {', '.join(unknown)}; allowed are {', '.join(RUNS)}")
    words.out.mkdir(parents=True, exist_ok=True)
    lines, failed = [], []
    for name in chosen:
        script, arguments, lines_of = RUNS[name]
        target, began = words.out / f"{name}.json", time.perf_counter()
        target.unlink(missing_ok=True)
        command = [sys.executable, str(HERE / script), *arguments, "--json", str(target)]
        with (words.out / f"{name}.txt").open("w") as stream:
            code = subprocess.run(command, stdout=stream, stderr=subprocess.STDOUT, check=False).returncode
        print(f"{name}: {time.perf_counter() - began:.0f} s", file=sys.stderr, flush=True)
        if code:
            failed.append(f"{name} ended with {code}: see {words.out / f'{name}.txt'}")
        else:
            lines += lines_of(json.loads(target.read_text()))
    machine = f"{processor()}, {os.cpu_count()} processors"
    print(f"{machine}\n\n{table(lines)}")
    result = {"machine": machine, "lines": [line._asdict() for line in lines]}
    (words.out / "bench.json").write_text(json.dumps(result, indent=1) + "\n")
    if failed:
        raise SystemExit("\n".join(failed))


def table(lines):
    """The rows as Markdown."""
    rows = ["| what | refdof | beside | peer | refdof / peer | at most | |", "|---|---|---|---|---|---|---|"]
    for line in lines:
        ratio = line.ours / line.peer if line.peer else None
        verdict = "" if ratio is None or line.goal is None else ("met" if ratio <= line.goal else "missed")
        cells = [line.what, _number(line.ours, line.unit), line.beside, _number(line.peer, line.unit)]
        cells += [_number(ratio), _number(line.goal), verdict]
        rows.append("| " + " | ".join(cells) + " |")
    return "\n".join(rows)


def _number(value, unit=""):
    return "" if value is None else f"{value:.3g} {unit}".strip()


if __name__ == "__main__":
    main()

"""The figures of `benchmarks/reference.py` as Markdown."""

from itertools import pairwise

__all__ = ["print_report"]

_BUSY = 0.85  # below this share of the threads' time others had the machine


def print_report(report: dict) -> None:
    scene, machine, embreex = report["scene"], report["machine"], report["embreex"]
    width, height = scene["size"]
    print(f"# The reference and its peers: {scene['name']}, {scene['triangles']} triangles, {width} x {height}\n")
    print("Unlit, textures replaced by their values at the vertices; closest hit and vertex colour for all.")
    print("`CPU s` adds up the threads' time; RMSE is linear, against a long reference of both renderers.")
    print(f"Machine: {', '.join(f'{key} {value}' for key, value in machine.items())}.")
    print(f"refdof builds its view in {report['refdof_build_seconds']:.2f} s (not counted below).\n")
    for name, part in report["integrals"].items():
        _print_integral(name, part, machine["threads"])
    print("## embreex's own class: traversal only, one thread, rays made beforehand\n")
    _table(
        ["rays", "seconds", "CPU s", "M rays/s"],
        [[f"{embreex['rays']}", f"{embreex['seconds']:.2f}", f"{embreex['cpu_seconds']:.2f}",
          f"{embreex['rays'] / embreex['seconds'] / 1e6:.2f}"]],
    )  # fmt: skip
    print("## Targets\n")
    _table(
        ["target", "integral", "wanted", "wall clock", "by CPU time", ""],
        [[t["target"], t["integral"], t["limit"], f"{t['figure']:.2f}", f"{t['figure_cpu']:.2f}",
          "met" if t["met"] else "missed"] for t in report["targets"]],
    )  # fmt: skip


def _print_integral(name: str, part: dict, threads: int) -> None:
    print(f"## Integral: {name}\n")
    lines = []
    for renderer, rows in part["rows"].items():
        for r in rows:
            label = renderer if r["tolerance"] is None else f"{renderer} {r['tolerance']:g}"
            lines.append([label, f"{r['samples']:.0f}", f"{r['seconds']:.2f}", f"{r['cpu_seconds']:.2f}",
                          f"{r['rays_per_second'] / 1e6:.2f}", f"{r['rays_per_cpu_second'] / 1e6:.2f}",
                          f"{r['rmse']:.3g}"])  # fmt: skip
    _table(["renderer", "samples", "seconds", "CPU s", "M rays/s", "M rays/CPU s", "RMSE"], lines)
    print(f"Time to an RMSE of {part['goal_rmse']:.3g}, that of Mitsuba's multijitter with 256 samples:\n")
    ours = part["equal_error"]["refdof"]
    lines = []
    for renderer, cost in part["equal_error"].items():
        note = " (extrapolated)" if cost["extrapolated"] else ""
        lines.append([renderer, f"{cost['seconds']:.2f}{note}", f"{cost['cpu_seconds']:.2f}", f"{cost['samples']:.0f}",
                      f"{ours['seconds'] / cost['seconds']:.2f}"])  # fmt: skip
    _table(["renderer", "seconds", "CPU s", "samples", "refdof / this"], lines)
    print(
        f"Long reference: RMSE {part['long_rmse']:.2g}, weight of refdof's part {part['long_weight_of_refdof']:.2f}; "
        f"the two long runs differ by {part['long_agreement']:.2f} of what their noise explains."
    )
    falling = all(a["rmse"] > b["rmse"] for rows in part["rows"].values() for a, b in pairwise(rows))
    print(f"Every renderer's RMSE keeps falling: {'yes' if falling else 'NO'}.")
    print(f"Mitsuba compiled for {part['mitsuba_compile_seconds']:.2f} s (not counted above).")
    runs = [r for rows in part["rows"].values() for r in rows]
    share = sum(r["cpu_seconds"] for r in runs) / (threads * sum(r["seconds"] for r in runs))
    if share < _BUSY:
        print(f"The machine was busy: the threads ran {100 * share:.0f} % of the time; trust CPU time.")
    print()


def _table(head: list[str], rows: list[list[str]]) -> None:
    print("| " + " | ".join(head) + " |")
    print("|" + "---|" * len(head))
    for line in rows:
        print("| " + " | ".join(line) + " |")
    print()

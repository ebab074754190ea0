"""Run: atheris on the targets, each in a process of its own, or all of them in one.

Usage: `python -m tests.fuzz.run [--seconds N] [--together] [TARGET ...]`. The seconds are shared among the targets.
Inputs that reach new code are kept in build/fuzz, and a later run starts from them. A finding is an exception other
than the clear refusal, a crash, an input that takes 30 seconds, or more than 3 GiB: its input is kept there, too, and
the exit code is 1.
"""

import argparse
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path

ROOT = Path(__file__).parents[2]
WORK = ROOT / "build" / "fuzz"
ALL = "all"
_SLOWEST_S, _MOST_MB = 30, 3072


def fuzz(name: str, seconds: int, rooms: list[str]) -> None:
    """Fuzz one target, or all in turn, in this process; it ends the process."""
    import atheris

    packages = sorted({room.split(".")[0] for room in rooms})
    with atheris.instrument_imports(include=packages, exclude=_unwatched(rooms)):
        targets = import_module("tests.fuzz.targets")
    chosen = targets.TARGETS if name == ALL else {name: targets.TARGETS[name]}
    corpus = WORK / name
    corpus.mkdir(parents=True, exist_ok=True)
    for number, target in enumerate(chosen.values()):
        start = bytes([number]) if name == ALL else b""
        for k, seed in enumerate(target.seeds()):
            (corpus / f"seed_{number}_{k}").write_bytes(start + seed)
            targets.refused(target, seed)  # some import what they need, slowly, when they are first called
    readers = list(chosen.values())

    def one(data: bytes) -> None:
        if name != ALL:
            targets.refused(readers[0], data)
        elif data:
            targets.refused(readers[data[0] % len(readers)], data[1:])

    options = [
        f"-max_total_time={seconds}",
        f"-timeout={_SLOWEST_S}",
        f"-rss_limit_mb={_MOST_MB}",
        f"-max_len={max(target.most for target in readers)}",
        f"-artifact_prefix={WORK}/{name}-",
        "-print_final_stats=1",
        "-seed=1",
    ]
    atheris.Setup([sys.argv[0], *options, str(corpus)], one)
    atheris.Fuzz()


def _unwatched(rooms: list[str]) -> list[str]:
    """Modules of this package outside the rooms; atheris takes whole packages."""
    paths = (path.relative_to(ROOT).with_suffix("") for path in (ROOT / "refdof").rglob("*.py"))
    modules = (".".join(path.parts).removesuffix(".__init__") for path in paths)
    return [module for module in modules if not f"{module}.".startswith(tuple(f"{room}." for room in rooms))]


def figures(words: str) -> tuple[int, int]:
    """How many inputs were run, and how many edges of the watched code they reached."""
    runs = re.findall(r"stat::number_of_executed_units: *(\d+)", words)
    edges = re.findall(r"cov: (\d+)", words)
    return int(runs[-1]) if runs else 0, int(edges[-1]) if edges else 0


def main() -> int:
    """Fuzz what is asked for, and print a line each."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("targets", nargs="*")
    parser.add_argument("--seconds", type=int, default=600)
    parser.add_argument("--together", action="store_true", help="all in one process, which starts once")
    parser.add_argument("--one", help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    from tests.fuzz.rooms import ROOMS

    if chosen.one:
        rooms = [room for name, some in ROOMS.items() for room in some if chosen.one in (name, ALL)]
        fuzz(chosen.one, chosen.seconds, sorted(set(rooms)))
    names = [ALL] if chosen.together else chosen.targets or list(ROOMS)
    found = 0
    for name in names:
        each = max(1, chosen.seconds // len(names))
        command = [sys.executable, "-m", "tests.fuzz.run", "--one", name, "--seconds", str(each)]
        done = subprocess.run(command, cwd=ROOT, text=True, capture_output=True, errors="replace", check=False)
        runs, edges = figures(done.stderr)
        print(
            f"{name}: {runs} inputs in {each} s, {edges} edges, {'nothing found' if not done.returncode else 'FOUND'}",
            flush=True,
        )
        if done.returncode:
            found = 1
            print(done.stdout[-3000:], done.stderr[-3000:])
    return found


if __name__ == "__main__":
    sys.exit(main())

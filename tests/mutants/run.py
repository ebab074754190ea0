"""Run: plant single-line faults, one at a time, in a copy of the tree, and see which tests fail.

1. draw the faults by seed                                    `drawn`
2. note once which fast test calls which function             `seen_by`
3. plant each fault, run the tests that call its function     `Bench.judge`
4. a fault that passes them meets the compiled tests          `compiled_files`
5. write docs/mutants.md and docs/mutants.json                `page.write`

Usage: `python -m tests.mutants.run`. Each result is a line of build/mutants.jsonl: a run that was stopped goes on, and
`--again` tries survivors again, after new tests. A fault counts as caught only if pytest ends with code 1, a failed
test; if the package cannot be imported any more; or if a test takes more than four times its processor time and ten
seconds.
"""

import argparse
import json
import os
import queue
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from dataclasses import asdict
from pathlib import Path
from typing import Any

from tests.mutants import page
from tests.mutants.faults import Fault, planted, sample
from tests.mutants.pick import compiled_files, dependents, fast_tests, module_of
from tests.mutants.seen import HANGS

ROOT = Path(__file__).parents[2]
SEED = 20
ROOMS = {"optics": 26, "raster": 26, "methods": 34, "metrics": 12, "oracle": 24, "truth": 14}
_LEFT_OUT = (".git", ".venv", "out", "build", "__pycache__", "*.egg-info", ".*_cache", ".hypothesis")
_COMPILED_S = 420.0  # for the compiled tests of one fault; what is not caught by then counts as survived
_FAST_S = 900.0
_NOT_COLLECTED = (2, 4)  # codes of pytest: interrupted, and tests that were asked for and are not there


def drawn(seed: int) -> list[Fault]:
    """The faults of all rooms."""
    return [fault for room, count in ROOMS.items() for fault in sample(ROOT, f"refdof/{room}", count, seed)]


def seen_by(file: Path) -> dict[str, Any]:
    """Which fast test calls what; noted by one run of them, without compiling, if the file is not there."""
    if not file.exists():
        file.parent.mkdir(parents=True, exist_ok=True)
        folders = [f"tests/{room}" for room in (*ROOMS, "claims", "explain", "frame")]
        tests = [*folders, *(path.name and f"tests/{path.name}" for path in (ROOT / "tests").glob("test_*.py"))]
        surroundings = _surroundings(ROOT, NUMBA_DISABLE_JIT="1", REFDOF_SEEN_OUT=str(file))
        subprocess.run(
            [*_PYTEST, "-m", "fast", *tests], cwd=ROOT, env=surroundings, check=False
        )  # what fails is left out
    tests = json.loads(file.read_text(encoding="utf-8"))
    return dict(tests)


_PYTEST = [sys.executable, "-m", "pytest", "-q", "-p", "tests.mutants.seen", "-p", "no:cacheprovider"]


def _surroundings(root: Path, **more: str) -> dict[str, str]:
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("NUMBA_", "REFDOF_SEEN"))}
    return {
        **kept,
        "PYTHONPATH": str(root),
        "PYTHONDONTWRITEBYTECODE": "1",
        "HYPOTHESIS_PROFILE": "ci",
        "NUMBA_NUM_THREADS": "2",
        **more,
    }


def _machine_code(root: Path, surroundings: dict[str, str]) -> Path | None:
    """Where a tree's compiled kernels are kept; None: it cannot be imported."""
    words = "from refdof._jit.compile import cache_folder; print(cache_folder())"
    done = subprocess.run(
        [sys.executable, "-c", words], cwd=root, env=surroundings, text=True, capture_output=True, check=False
    )
    return Path(done.stdout.strip()) if done.returncode == 0 else None


class Bench:
    """A copy of the tree in which faults are planted one after the other."""

    def __init__(self, folder: Path, seen: dict[str, Any], cache: Path, sound: Path | None) -> None:
        self.root, self.seen, self.cache, self.sound = folder / "tree", seen, cache, sound
        shutil.copytree(ROOT, self.root, ignore=shutil.ignore_patterns(*_LEFT_OUT))
        self.first = folder / "first.json"

    def judge(self, fault: Fault, compiled: bool = True) -> dict[str, Any]:
        """Plant a fault, run tests until one fails, and put the file back."""
        path = self.root / fault.path
        before = path.read_text(encoding="utf-8")
        start = time.monotonic()
        try:
            path.write_text(planted(before, fault), encoding="utf-8")
            found = self._interpreted(fault)
            if compiled and found["outcome"] == "survived":
                found |= {name: value for name, value in self._compiled(fault).items() if value}
        finally:
            path.write_text(before, encoding="utf-8")
        lines = [text.split("\n")[fault.line - 1].strip() for text in (before, planted(before, fault))]
        found |= {"line_before": lines[0], "line_after": lines[1], "seconds": round(time.monotonic() - start, 1)}
        return {"name": fault.name, "room": fault.path.split("/")[1], **asdict(fault), **found}

    def _interpreted(self, fault: Fault) -> dict[str, Any]:
        ids = fast_tests(fault, self.seen)
        if not ids:
            return {"outcome": "survived", "stage": "no fast test", "test": ""}
        limits = {name: 10.0 + 4.0 * self.seen[name]["seconds"] for name in ids}
        self.first.write_text(json.dumps(limits), encoding="utf-8")
        surroundings = _surroundings(
            self.root,
            NUMBA_DISABLE_JIT="1",
            REFDOF_SEEN_FIRST=str(self.first),
            REFDOF_CACHE_DIR=str(self.cache / "interpreted"),
        )
        return self._pytest(ids, surroundings, _FAST_S, "interpreted", fault)

    def _compiled(self, fault: Fault) -> dict[str, Any]:
        files = compiled_files(fault, self.root)
        if not files:
            return {}
        surroundings = _surroundings(self.root, REFDOF_CACHE_DIR=str(self.cache))
        folder = _machine_code(self.root, surroundings)
        if folder and self.sound:
            self._fill(folder, fault)
        found = self._pytest(files, surroundings, _COMPILED_S, "compiled", fault)
        if folder:
            shutil.rmtree(folder, ignore_errors=True)
        return found

    def _fill(self, folder: Path, fault: Fault) -> None:
        """Give the changed package the machine code that the change cannot reach."""
        stale = tuple(f"{name}." for name in dependents(self.root / "refdof", fault.path))
        for file in (self.sound or folder).glob("*.nbc"):
            if not file.name.startswith(stale) and not (folder / file.name).exists():
                shutil.copy2(file, folder / file.name)

    def _pytest(
        self, tests: list[str], surroundings: dict[str, str], limit: float, stage: str, fault: Fault
    ) -> dict[str, Any]:
        command = [*_PYTEST, "-x", "--tb=line", "-rfE", *tests]
        process = subprocess.Popen(
            command, cwd=self.root, env=surroundings, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            start_new_session=True,
        )  # fmt: skip
        try:
            words, _ = process.communicate(timeout=limit)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            outcome = "hang" if stage == "interpreted" else "survived"
            return {"outcome": outcome, "stage": f"{stage}, stopped", "test": ""}
        failed = [line.split(" ", 1)[1] for line in words.split("\n") if line.startswith(("FAILED ", "ERROR "))]
        test = failed[0].split(" - ")[0] if failed else ""
        if process.returncode in (1, HANGS):
            return {"outcome": "caught" if process.returncode == 1 else "hang", "stage": stage, "test": test}
        if process.returncode == 0:
            return {"outcome": "survived", "stage": stage, "test": ""}
        broken = {re.split("::| - ", line)[0] for line in failed}  # files that the fault keeps from being collected
        others = [name for name in tests if name.split("::")[0] not in broken]
        if process.returncode in _NOT_COLLECTED and others and len(others) < len(tests):
            return self._pytest(others, surroundings, limit, stage, fault)
        if process.returncode < 0:
            return {"outcome": "crash", "stage": stage, "test": f"signal {-process.returncode}"}
        found = subprocess.run(
            [sys.executable, "-c", f"import refdof, {module_of(fault.path)}"],
            cwd=self.root, env=surroundings, capture_output=True, check=False,
        )  # fmt: skip
        if found.returncode:
            return {"outcome": "caught", "stage": "import", "test": test}
        return {
            "outcome": "survived",
            "stage": f"{stage}: code {process.returncode}",
            "test": test,
            "words": words[-400:],
        }


def results_of(file: Path) -> dict[str, list[dict[str, Any]]]:
    """Every result so far, by the fault's name, the first one first."""
    found: dict[str, list[dict[str, Any]]] = {}
    for line in file.read_text(encoding="utf-8").splitlines() if file.exists() else ():
        row = json.loads(line)
        found.setdefault(row["name"], []).append(row)
    return found


def main() -> None:
    """Judge all faults that have no result yet, then write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--again", action="store_true", help="try survivors again, but those that change nothing")
    parser.add_argument("--fast", action="store_true", help="leave the compiled tests out")
    parser.add_argument("--only", default="", help="only faults whose path has this word")
    parser.add_argument("--page", action="store_true", help="only write the page")
    parser.add_argument("--work", type=Path, default=ROOT / "build" / "mutants")
    chosen = parser.parse_args()
    work: Path = chosen.work
    log = work / "results.jsonl"
    faults, past = drawn(chosen.seed), results_of(log)
    if not chosen.page:
        waiting: queue.Queue[Fault] = queue.Queue()
        for fault in faults:
            rows = past.get(fault.name)
            if chosen.only not in fault.path:
                continue
            hopeless = page.reasons().get(fault.name, {}).get("equivalent", False)
            if not rows or (chosen.again and rows[-1]["outcome"] == "survived" and not hopeless):
                waiting.put(fault)
        seen = seen_by(work / "seen.json")
        lock = threading.Lock()

        def work_off(number: int) -> None:
            folder = work / f"bench{number}"
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(parents=True)
            bench = Bench(folder, seen, work / "cache", _machine_code(ROOT, _surroundings(ROOT)))
            while True:
                try:
                    fault = waiting.get_nowait()
                except queue.Empty:
                    return
                row = bench.judge(fault, compiled=not chosen.fast)
                with lock, log.open("a", encoding="utf-8") as out:
                    out.write(json.dumps(row) + "\n")
                    print(f"{row['outcome']:9}{row['seconds']:7.1f} s  {row['name']}  {row['test']}", flush=True)

        threads = [threading.Thread(target=work_off, args=(number,)) for number in range(chosen.jobs)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    past = results_of(log)
    page.write(ROOT / "docs", [past[fault.name] for fault in faults if fault.name in past], chosen.seed)


if __name__ == "__main__":
    main()

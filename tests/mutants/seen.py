"""A pytest plugin that notes which test calls which function of the package, and one that runs such tests first.

With `REFDOF_SEEN_OUT`, a file that does not exist yet, every call of a function of the package is noted beside the test
that made it. What a fixture of a module or session calls counts for every test that uses the fixture. Only with
`NUMBA_DISABLE_JIT=1` are kernels seen, too. With `REFDOF_SEEN_FIRST`, a JSON file of test ids and seconds, tests run in
that order, and fail when they take more processor time.
"""

import json
import os
import signal
import sys
import threading
import time
from collections import defaultdict
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
HANGS = 86  # the exit code of a test that takes too long
PACKAGE = str(ROOT / "refdof") + os.sep


class _Calls:
    """Functions called since the last `take`, by file and qualified name."""

    def __init__(self) -> None:
        self.codes: set[Any] = set()

    def __call__(self, frame: Any, event: str, argument: Any) -> None:
        self.codes.add(frame.f_code)

    def take(self) -> set[str]:
        codes, self.codes = self.codes, set()
        return {
            f"{code.co_filename[len(PACKAGE) :]}:{code.co_qualname}"
            for code in codes
            if code.co_filename.startswith(PACKAGE)
        }


class Seen:
    """The plugin that notes calls."""

    def __init__(self, out: Path) -> None:
        self.out, self.calls = out, _Calls()
        self.of_fixture: dict[str, set[str]] = defaultdict(set)
        self.tests: dict[str, dict[str, Any]] = {}
        self.failed: set[str] = set()

    def _watch(self) -> None:
        sys.settrace(self.calls)
        threading.settrace(self.calls)

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: Any) -> Any:
        if fixturedef.scope == "function":
            return (yield)
        before = self.calls.take()
        try:
            return (yield)
        finally:
            self.of_fixture[f"{fixturedef.baseid}:{fixturedef.argname}"] |= self.calls.take()
            self.calls.codes = set()
            self._kept = before

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: Any) -> Any:
        self._watch()  # anew each time: Hypothesis takes the interpreter's one hook for itself
        self.calls.take()
        self._kept: set[str] = set()
        start = time.perf_counter()
        try:
            return (yield)
        finally:
            seen = self.calls.take() | self._kept
            for name in item.fixturenames:
                for fixture in item.session._fixturemanager.getfixturedefs(name, item) or ():
                    seen |= self.of_fixture.get(f"{fixture.baseid}:{name}", set())
            self.tests[item.nodeid] = {"seconds": round(time.perf_counter() - start, 3), "seen": sorted(seen)}

    def pytest_runtest_logreport(self, report: Any) -> None:
        if report.failed:  # without a fault, or for being watched: such a test tells nothing
            self.failed.add(report.nodeid)

    def pytest_sessionfinish(self) -> None:
        sys.settrace(None)
        threading.settrace(None)  # type: ignore[arg-type]
        kept = {name: facts for name, facts in self.tests.items() if name not in self.failed}
        self.out.write_text(json.dumps(kept), encoding="utf-8")


class First:
    """The plugin that runs tests in a given order, each with a limit to its processor time [s]."""

    def __init__(self, limits: dict[str, float]) -> None:
        self.limits = limits
        self.rank = {name: number for number, name in enumerate(limits)}

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[Any]) -> None:
        items.sort(key=lambda item: self.rank.get(item.nodeid, len(self.rank)))

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item: Any) -> Any:
        previous = signal.signal(signal.SIGVTALRM, _hangs)
        signal.setitimer(signal.ITIMER_VIRTUAL, self.limits.get(item.nodeid, 0.0))
        try:
            return (yield)
        finally:
            signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
            signal.signal(signal.SIGVTALRM, previous)


def _hangs(number: int, frame: Any) -> None:
    os._exit(HANGS)  # an exception would wait for threads that never end


def pytest_configure(config: pytest.Config) -> None:
    """Register what the environment asks for."""
    if out := os.environ.get("REFDOF_SEEN_OUT"):
        config.pluginmanager.register(Seen(Path(out)))
    if first := os.environ.get("REFDOF_SEEN_FIRST"):
        config.pluginmanager.register(First(json.loads(Path(first).read_text(encoding="utf-8"))))

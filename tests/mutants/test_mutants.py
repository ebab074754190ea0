"""The tool itself, on a toy package: it plants, finds and restores, and a seed draws the same faults again."""

import ast
import json
from pathlib import Path

import pytest

from tests.mutants import page
from tests.mutants.faults import faults_of, planted, sample
from tests.mutants.pick import dependents, fast_tests

pytestmark = pytest.mark.fast

TOY = '''"""A toy: 1 + 1."""

LIMIT: "int < 3" = 4


def far(a: float, b: float = 0.5) -> float:
    """Add 1 < 2."""
    if a < b and not a == 1:
        raise ValueError(f"{a + b} is -1")
    rows = [abs(a - b)]
    rows[0] += -b  # a + b
    return max(rows[0] *
               2.0, apart(a, b))


def apart(a, b):
    for k in range(3):
        if k > 1:
            continue
    return a**2 // b, rows[a]
'''


def changes(kind):
    return [(fault.line, fault.old, fault.new) for fault in faults_of("toy.py", TOY) if fault.kind == kind]


def test_what_can_be_changed_by_hand():
    assert changes("< to <=") == [(8, "<", "<=")]
    assert changes("and to or") == [(8, "and", "or")]
    assert changes("not dropped") == [(8, "not a == 1", "a == 1")]
    assert changes("- to +") == [(10, "-", "+")]
    assert changes("abs dropped") == [(10, "abs(a - b)", "(a - b)")]
    assert changes("minus dropped") == [(11, "-b", "b")]
    assert changes("* to /") == [(12, "*", "/")]  # over the line's end
    assert changes("max to min") == [(12, "max", "min")]
    assert changes("arguments swapped") == [(13, "a, b", "b, a")]
    assert changes("range off by one") == [(17, "3", "3 - 1")]
    assert changes("statement removed") == [(11, "rows[0] += -b", "pass"), (19, "continue", "pass")]
    assert changes("index off by one") == [(20, "a", "a - 1")]
    assert changes("number") == [(6, "0.5", "0.25"), (13, "2.0", "1.0")]
    assert (3, "4", "5") in changes("integer")
    assert changes("+ to -") == [(11, "+", "-")]  # and none in words


def test_each_fault_is_python_and_one_line_of_it():
    lines = TOY.split("\n")
    for fault in faults_of("toy.py", TOY):
        changed = planted(TOY, fault)
        ast.parse(changed)
        others = [k for k, (one, other) in enumerate(zip(lines, changed.split("\n"), strict=True), 1) if one != other]
        assert others == [fault.line]


def test_speed_is_left_out():
    assert not faults_of("toy.py", "for block in range((count + BLOCK - 1) // BLOCK):\n    pass\n")


def test_a_seed_draws_the_same_and_one_a_function(tmp_path):
    (tmp_path / "room").mkdir()
    (tmp_path / "room" / "toy.py").write_text(TOY)
    first = sample(tmp_path, "room", 3, seed=1)
    assert first == sample(tmp_path, "room", 3, seed=1)
    assert any(first != sample(tmp_path, "room", 3, seed=seed) for seed in range(2, 6))
    assert len({fault.function for fault in first}) == len(first) > 1


def test_tests_that_call_the_function_are_run_near_and_quick_ones_first():
    fault = next(fault for fault in faults_of("refdof/room/toy.py", TOY) if fault.function == "apart")
    seen = {
        "tests/other/test_a.py::one": {"seconds": 0.1, "seen": ["room/toy.py:apart"]},
        "tests/room/test_b.py::slow": {"seconds": 2.0, "seen": ["room/toy.py:apart", "room/toy.py:far"]},
        "tests/room/test_b.py::quick": {"seconds": 0.2, "seen": ["room/toy.py:apart"]},
        "tests/room/test_toy.py::none": {"seconds": 0.1, "seen": ["room/toy.py:far"]},
    }
    order = ["tests/room/test_b.py::quick", "tests/room/test_b.py::slow", "tests/other/test_a.py::one"]
    assert fast_tests(fault, seen) == order
    outside = next(fault for fault in faults_of("refdof/room/toy.py", TOY) if not fault.function)
    assert set(fast_tests(outside, seen)) == set(seen)


def test_modules_that_a_change_can_reach(tmp_path):
    package = tmp_path / "refdof"
    package.mkdir()
    for name, text in {"a": "", "b": "from refdof.a import x", "c": "import refdof.b", "d": "import math"}.items():
        (package / f"{name}.py").write_text(text)
    assert dependents(package, "refdof/a.py") == {"a", "b", "c"}


@pytest.fixture
def rows():
    def row(name, room, outcome):
        fault = {"path": f"refdof/{room}/a.py", "line": 3, "kind": "number", "function": "f", "stage": "", "test": ""}
        return {"name": name, "room": room, "outcome": outcome, "line_before": "x = 1", "line_after": "x = 2", **fault}

    survived, same = row("c", "raster", "survived"), row("d", "raster", "survived")
    return [
        [row("a", "optics", "caught")],
        [row("b", "raster", "survived"), row("b", "raster", "hang")],
        [survived],
        [same],
    ]


def test_the_page_counts_by_hand(rows):
    reasons = {"d": {"reason": "It is rounded away.", "equivalent": True}}
    text = page.page(rows, reasons, seed=7)
    assert "| raster | 3 | 0 | 1 | 1 | 1 |" in text
    assert "| all | 4 | 1 | 2 | 1 | 1 |" in text
    assert "2 of 4 faults are caught, 50.0%; without the 1 that change no result, 66.7%" in text
    assert "It is rounded away." in text
    assert text.count("became") == 2


def test_both_files_are_written(rows, tmp_path):
    page.write(tmp_path, rows, seed=7)
    told = json.loads((tmp_path / "mutants.json").read_text())
    assert [fault["outcome"] for fault in told["faults"]] == ["caught", "hang", "survived", "survived"]
    assert [fault["at_first"] for fault in told["faults"]] == ["caught", "survived", "survived", "survived"]


def test_what_the_page_says_is_what_was_found():
    docs = Path(__file__).parents[2] / "docs"
    faults = json.loads((docs / "mutants.json").read_text())["faults"]
    caught = sum(fault["outcome"] in page.CAUGHT for fault in faults)
    assert len(faults) >= 120
    assert caught / len(faults) >= 0.95
    assert f"\n{caught} of {len(faults)} faults are caught" in (docs / "mutants.md").read_text()
    assert set(page.reasons()) == {fault["name"] for fault in faults if fault["outcome"] not in page.CAUGHT}

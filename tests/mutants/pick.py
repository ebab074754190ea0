"""Pick: which tests are run for a fault, the likeliest first.

A fast test is run if it called the function that has the fault; a fault outside functions, or in a class's fields, is
met by every test that calls anything of the module. Compiled tests are chosen by what they import, and by their folder.
"""

import ast
import re
from functools import cache
from pathlib import Path
from typing import Any

from tests.mutants.faults import Fault

__all__ = ["compiled_files", "dependents", "fast_tests", "module_of"]

_MOST_S = 150.0  # of tests for one fault, measured as they were noted
_FARTHEST = 3
_OTHER_ROOMS = re.compile(r"tests/(studio|cluster|scene|sweep|ports|mutants|_jit|image|report)/")


def fast_tests(fault: Fault, seen: dict[str, Any]) -> list[str]:
    """Ids of the tests that call the function, near ones first, then quick ones."""
    module = fault.path.removeprefix("refdof/")
    key = f"{module}:{fault.function}"
    ids = [test for test, facts in seen.items() if key in facts["seen"]]
    if not ids:  # of a module or class: whoever calls any of it
        ids = [test for test, facts in seen.items() if any(name.startswith(f"{module}:") for name in facts["seen"])]
    ids.sort(key=lambda test: (_distance(fault.path, test.split("::")[0]), seen[test]["seconds"], test))
    kept, total = [], 0.0
    for test in ids:
        total += seen[test]["seconds"]
        if kept and total > _MOST_S:
            break
        kept.append(test)
    return kept


def compiled_files(fault: Fault, root: Path) -> list[str]:
    """Files of tests in the fault's folder, all of them, and those that import its module."""
    module = module_of(fault.path)
    ranked = []
    for path in sorted((root / "tests").rglob("test_*.py")):
        name = path.relative_to(root).as_posix()
        distance = _distance(fault.path, name)
        if module not in _imports(path):
            distance += 1
        if not _OTHER_ROOMS.match(name) and distance <= _FARTHEST:
            ranked.append((distance, name))
    return [name for _, name in sorted(ranked)]


def dependents(package: Path, path: str) -> set[str]:
    """Last names of the modules that import a module, by whatever way, and its own."""
    modules = {module_of(file.relative_to(package.parent).as_posix()): file for file in package.rglob("*.py")}
    reached = {module_of(path)}
    imports = {name: _imports(file) for name, file in modules.items()}
    while True:
        more = {name for name, others in imports.items() if others & reached} - reached
        if not more:
            return {name.split(".")[-1] for name in reached}
        reached |= more


def module_of(path: str) -> str:
    """The name by which a file of the package is imported."""
    return path.removesuffix(".py").replace("/", ".").removesuffix(".__init__")


def _distance(path: str, test: str) -> int:
    """0: the test's file is named after the module; 1: the same folder; 2: the same room; 3: elsewhere."""
    folder, _, file = path.removeprefix("refdof/").rpartition("/")
    test_folder, _, test_file = test.removeprefix("tests/").rpartition("/")
    if test_folder == folder:
        return 0 if test_file == f"test_{file}" or file.removesuffix(".py") in test_file else 1
    return 2 if test_folder.split("/")[0] == folder.split("/")[0] else 3


@cache
def _imports(path: Path) -> frozenset[str]:
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {name.name for name in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module, *(f"{node.module}.{name.name}" for name in node.names)}
    return frozenset(found)

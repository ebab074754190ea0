"""docs/threads.md and the tests of this folder agree: every test is named once or more, and every name is a test."""

import re
from importlib import import_module
from pathlib import Path

import pytest

ROOT = next(folder for folder in Path(__file__).parents if (folder / "pyproject.toml").exists())
PAGE = (ROOT / "docs" / "threads.md").read_text()
LINK = r"\[([\w.-]+/[\w.-]+)#(\d+)\]\(https://github\.com/\1/(?:issues|pull)/\2\)"
WITH_TESTS = re.findall(rf"^\| {LINK} \| [^|]+ \| [^|]+ \| (`test_[^|]+`) \|$", PAGE, flags=re.MULTILINE)
WITHOUT = re.findall(rf"^\| {LINK} \| ([^|]{{8,}}) \|$", PAGE, flags=re.MULTILINE)
NAMED = [name for *_, names in WITH_TESTS for name in re.findall(r"`([^`]+)`", names)]

pytestmark = pytest.mark.fast


def names_here():
    """Names of all tests of threads; with [id] where the page has it so, since the ids are threads."""
    by_id = {name.partition("[")[0] for name in NAMED if "[" in name}
    for path in sorted(Path(__file__).parent.glob("test_*.py")):
        if path.stem == Path(__file__).stem:
            continue
        module = import_module(f"{__package__}.{path.stem}")
        for name in (name for name in dir(module) if name.startswith("test_")):
            if name not in by_id:
                yield name
                continue
            marks = [mark for mark in getattr(module, name).pytestmark if mark.name == "parametrize"]
            yield from (f"{name}[{case.id}]" for mark in marks for case in mark.args[1] if getattr(case, "id", None))


def test_every_row_can_be_read():
    rows = [line for line in PAGE.splitlines() if line.startswith("| [")]
    assert len(rows) == len(WITH_TESTS) + len(WITHOUT)
    threads = [row[:2] for row in WITH_TESTS] + [row[:2] for row in WITHOUT]
    assert len(set(threads)) == len(threads)
    assert len(WITH_TESTS) >= 80


def test_every_test_is_named_and_every_name_is_a_test():
    assert sorted(NAMED) == sorted(names_here())


def test_names_have_the_numbers_of_their_threads():
    for _, number, names in WITH_TESTS:
        for name in re.findall(r"`([^`]+)`", names):
            assert re.search(rf"(?<!\d){number}(?!\d)", name), name

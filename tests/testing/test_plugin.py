"""The pytest plugin: a test for each promise, in a run of its own, and nothing slow for those who do not use it."""

import re
import subprocess
import sys
import tomllib
from importlib import import_module
from pathlib import Path

import pytest

ROOT = next(folder for folder in Path(__file__).parents if (folder / "pyproject.toml").exists())
PAGE = (ROOT / "docs" / "testing.md").read_text()
# The module by its name, also where the installed entry point is there, or not yet.
PLUGIN = ("-p", "no:refdof", "-p", "refdof.testing.plugin")

pytestmark = pytest.mark.fast


def run(folder, text, *words):
    """Lines that a run of pytest prints about a file of tests."""
    (folder / "test_mine.py").write_text(text)
    command = [sys.executable, "-m", "pytest", "--strict-markers", "-p", "no:cacheprovider", *PLUGIN, *words]
    environment = {"PYTHONPATH": str(ROOT), "COLUMNS": "200"}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=300)
    return done.stdout + done.stderr


def test_the_page_shows_what_pytest_says(tmp_path):
    (example,) = re.findall(r"```python\n# test_mine\.py\n(.*?)```", PAGE, flags=re.DOTALL)
    (shown,) = re.findall(r"```text\n(.*?)```", PAGE, flags=re.DOTALL)
    said = run(tmp_path, example, "-v", "--tb=line")
    for line in shown.splitlines():
        assert line in re.sub(r"[ ]+\[ *\d+%\]", "", said), said


def test_without_a_marker_there_is_a_test_for_each_promise(tmp_path):
    from refdof.testing import PROMISES

    said = run(tmp_path, "def test_all(check_promise):\n    pass\n", "-q", "--collect-only")
    assert re.findall(r"test_all\[(\w+)\]", said) == list(PROMISES)


def test_a_wrong_name_ends_the_run_in_one_line(tmp_path):
    text = """import pytest
@pytest.mark.refdof_promises("energie")
def test_all(check_promise):
    pass
"""
    said = run(tmp_path, text)
    assert "test_mine.py::test_all: promises: got 'energie'; did you mean 'energy'" in said
    assert "Traceback" not in said


def test_the_entry_point_names_the_plugin():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    (module,) = project["entry-points"]["pytest11"].values()
    assert module == PLUGIN[-1]
    assert import_module(module).check_promise


def test_loading_it_is_quick():
    code = """
import sys, time
import pytest
before = set(sys.modules)
start = time.process_time()
import refdof.testing.plugin
print(time.process_time() - start, *sorted(name for name in sys.modules if name not in before))
"""
    environment = {"PYTHONPATH": str(ROOT)}
    runs = [
        subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
        for _ in range(3)
    ]
    seconds = min(float(done.stdout.split()[0]) for done in runs)
    loaded = runs[0].stdout.split()[1:]
    assert not {"numpy", "scipy", "numba", "hypothesis", "refdof._check"} & set(loaded), loaded
    assert seconds < 0.02

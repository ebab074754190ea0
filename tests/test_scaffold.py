"""`make new-method` and `make new-scene` write what passes the contract tests: both run in a copy of the tree."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
TREE = ("Makefile", "README.md", "papers.bib", "pyproject.toml", "data", "refdof", "scaffold", "tests")


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    """A copy of the tree with a new method, `sketch`, and a new scene, `sketched`."""
    copy = tmp_path_factory.mktemp("tree")
    for name in TREE:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(ROOT / name, copy / name)
    for task, name in (("new-method", "sketch"), ("new-scene", "sketched")):
        done = make(copy, task, name)
        assert done.returncode == 0, done.stderr
    return copy


def make(copy, task, name):
    words = ["make", "--silent", task, f"NAME={name}", f"PYTHON={sys.executable}"]
    return subprocess.run(words, cwd=copy, capture_output=True, text=True, timeout=60)


def run(copy, *words):
    environment = os.environ | {"PYTHONPATH": str(copy), "NUMBA_DISABLE_JIT": "1", "PYTHONDONTWRITEBYTECODE": "1"}
    return subprocess.run(
        [sys.executable, "-m", *words], cwd=copy, env=environment, capture_output=True, text=True, timeout=300
    )


@pytest.mark.slow
def test_the_skeletons_pass_the_contract_tests(tree):
    places = ("methods/test_contract", "test_bad_calls", "test_rendering", "test_readme", "scene/test_scenes")
    files = [f"tests/{place}.py" for place in (*places, "methods/test_sketch")]
    done = run(tree, "pytest", "-v", "-p", "no:cacheprovider", *files, "-k", "sketch or table or order")
    assert done.returncode == 0, done.stdout[-3000:]
    for test in (  # the new ones were among them
        "contract.py::test_convexity[sketch] PASSED",
        "bad_calls.py::test_bad_values_are_refused_in_one_line_or_do_no_harm[refdof.methods.sketch.blur-coc] PASSED",
        "sketch.py::test_a_white_pixel_by_hand PASSED",
        "scenes.py::test_the_camera_sees_no_holes[sketched] PASSED",
    ):
        assert test in done.stdout


def test_the_guide_names_every_file_that_is_written(tree):
    guide = (ROOT / "CONTRIBUTING.md").read_text()
    for kind, name in (("method", "sketch"), ("scene", "sketched")):
        paths = re.findall(rf"`(\S*my_{kind}\.\w+)`", guide)
        assert len(paths) == (3 if kind == "method" else 2)
        for path in paths:
            text = (tree / path.replace(f"my_{kind}", name)).read_text()
            assert "NAME" not in text
            assert not (ROOT / path.replace(f"my_{kind}", name)).exists()


def test_the_skeletons_are_in_the_house_style(tree):
    pytest.importorskip("ruff", reason="needs the extra `lint`")
    for words in (("check",), ("format", "--check")):
        done = run(tree, "ruff", *words, "--no-cache", ".")
        assert done.returncode == 0, done.stdout


def test_the_row_is_in_its_place(tree):
    old, new = ((root / "README.md").read_text().splitlines() for root in (ROOT, tree))
    row = "| `sketch` | Author 2026 | pinhole colour, pinhole depth | constant, pinhole, focus, convexity, symmetry |"
    assert [line for line in new if line not in old] == [row]
    assert new[new.index(row) - 1].startswith("| `singlepass` |")
    assert len(new) == len(old) + 1


@pytest.mark.parametrize(
    ("task", "name", "message"),
    [
        ("new-method", "Sketch", "NAME: got 'Sketch'; allowed are lower-case letters, digits and _, a letter first"),
        ("new-method", "", "NAME: got ''; allowed are lower-case"),
        ("new-scene", "class", "NAME: got 'class'; allowed are lower-case"),
        (
            "new-method",
            "mipmap",
            "NAME: got 'mipmap', but refdof/methods/mipmap exists; allowed is a new name",
        ),
        (
            "new-method",
            "separable",
            "NAME: got 'separable', but refdof/methods/separable.py exists; allowed is a new name",
        ),
        ("new-scene", "fence", "NAME: got 'fence', but refdof/scene/builtin/fence.py exists; allowed is a new name"),
    ],
)
def test_bad_names_are_one_line_and_write_nothing(tree, task, name, message):
    before = {path: path.read_bytes() for path in tree.rglob("*") if path.is_file()}
    done = make(tree, task, name)
    assert done.returncode == 2
    assert done.stderr.splitlines()[0].startswith(f"{task}: {message}")
    assert {path: path.read_bytes() for path in tree.rglob("*") if path.is_file()} == before

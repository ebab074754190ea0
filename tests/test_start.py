"""Starting: names of `refdof` and commands are found without importing what is slow, and say what they are."""

import ast
import importlib
import subprocess
import sys
from pathlib import Path

import pytest
import typer
from typer.main import get_group
from typer.testing import CliRunner

import refdof
from refdof.cli import app
from refdof.command_group import COMMANDS

pytestmark = pytest.mark.fast
SLOW = ("numba", "embreex", "trimesh", "scipy", "matplotlib", "rich.markdown")


def imported_by(code):
    """Modules of SLOW that are imported after `code`."""
    looks = f"import sys\n{code}\nprint([name for name in {SLOW!r} if name in sys.modules], file=sys.stderr)"
    return subprocess.run([sys.executable, "-c", looks], capture_output=True, text=True, timeout=300)


@pytest.mark.parametrize(
    "code",
    [
        "import refdof; refdof.InputError; refdof.__version__",
        "from typer.testing import CliRunner; from refdof.cli import app; CliRunner().invoke(app, ['-h'])",
        "from typer.testing import CliRunner; from refdof.cli import app; CliRunner().invoke(app, ['--version'])",
        "from typer.testing import CliRunner; from refdof.cli import app; CliRunner().invoke(app, ['nope'])",
    ],
)
def test_who_asks_for_little_waits_for_nothing(code):
    done = imported_by(code)
    assert done.stderr.strip() == "[]"


def test_names_are_those_that_type_checkers_see():
    tree = ast.parse(Path(refdof.__file__).read_text())
    block = next(node for node in tree.body if isinstance(node, ast.If))
    seen = {alias.name: node.module for node in block.body for alias in node.names}
    homes = {name: f"refdof.{home}" for name, home in refdof._HOMES.items()}
    rooms = {"cluster", "metrics"}
    assert {name: home for name, home in seen.items() if name not in rooms} == homes
    assert set(homes) | rooms == set(refdof.__all__)
    for name in refdof.__all__:
        thing = getattr(refdof, name)
        assert name in dir(refdof)
        if name not in rooms:
            assert thing is getattr(importlib.import_module(homes[name]), name)
    assert refdof.methods.singlepass.METHOD
    with pytest.raises(AttributeError, match="nope"):
        _ = refdof.nope


def test_the_help_lists_every_command_as_it_describes_itself():
    made = {}
    for home in set(COMMANDS.values()):
        more = typer.Typer()
        getattr(importlib.import_module(f"refdof.{home.module}"), home.adder)(more)
        made |= get_group(more).commands
    assert {name: command.help.split("\n\n")[0] for name, command in made.items()} == {
        name: home.help for name, home in COMMANDS.items()
    }
    listed = CliRunner().invoke(app, ["--help"], env={"COLUMNS": "80"}).output
    widest = max(map(len, COMMANDS))
    for name, home in COMMANDS.items():
        assert f"  {name:{widest}}  {home.help}\n" in listed  # in one line, whole


def test_ways_to_ask_for_help():
    by_h, by_help = (CliRunner().invoke(app, [word]) for word in ("-h", "--help"))
    assert by_h.output == by_help.output
    assert (by_h.exit_code, by_help.exit_code) == (0, 0)
    assert CliRunner().invoke(app, ["render", "-h"]).exit_code == 0
    nothing = CliRunner().invoke(app, [])
    assert (nothing.stdout, nothing.stderr, nothing.exit_code) == (by_h.output, "", 2)
    version = CliRunner().invoke(app, ["--version"])
    assert (version.stdout, version.exit_code) == (f"refdof {refdof.__version__}\n", 0)


def test_suffixes_may_be_capitals(tmp_path):
    words = ["render", "cans", "--method", "scatter", "--size", "16x12", "-o", str(tmp_path / "a.PNG")]
    assert CliRunner().invoke(app, words, catch_exceptions=False).exit_code == 0
    assert (tmp_path / "a.PNG").read_bytes().startswith(b"\x89PNG")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is full, as Linux has")
def test_a_full_disk_behind_stdout_is_one_line():
    with open("/dev/full", "w") as full:
        done = subprocess.run([sys.executable, "-m", "refdof.cli", "scenes"], stdout=full, stderr=subprocess.PIPE)
    assert done.returncode == 2
    assert done.stderr == b"refdof: stdout: cannot write (No space left on device); allowed is a place with room\n"


def test_a_reader_that_has_enough_is_no_error():
    command = [sys.executable, "-m", "refdof.cli", "methods", "--json"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as child:
        child.stdout.close()
        errors = child.stderr.read()
    assert errors == b""


def test_files_of_one_name_are_told_apart(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for folder in ("d1", "d2"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    words = ["compare", "d1/a.obj", "d2/a.obj", "--methods", "scatter", "--size", "16x12", "--samples", "16"]
    done = CliRunner().invoke(app, words, catch_exceptions=False)
    assert [line for line in done.stdout.splitlines() if "###" in line] == [
        "### d1/a.obj, 16 x 12",
        "### d2/a.obj, 16 x 12",
    ]
    assert {path.name for path in (tmp_path / "out").iterdir() if path.is_dir()} == {"d1-a.obj", "d2-a.obj"}

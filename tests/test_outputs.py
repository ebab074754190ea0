"""Outputs that cannot be written are refused by the name of their option, before anything is read or rendered."""

import re
from pathlib import Path

import pytest
import typer

from refdof.cli import app
from refdof.command_group import COMMANDS
from refdof.image.atomic import check_file, check_folder
from tests.one_line import refused

pytestmark = pytest.mark.fast

# Commands with inputs that are not there, and their outputs: who complained of those first would be late.
FOLDERS = {
    "render": [("stages", "nowhere --method mipmap -o a.png")],
    "export": [("out", "nowhere")],
    "compare": [("out", "nowhere")],
    "filter": [("out", "--color no.exr --fov 40 --focus 2 --lens-radius 1")],
    "sweep": [("out", "nowhere")],
    "golden": [("out", "")],
    "explain": [("out", "nowhere --method mipmap --pixel 1,1")],
    "lens": [("out", "nowhere.toml")],
    "focus": [("out", "nowhere --points no.toml --method mipmap")],
}
CHECK, DIAGNOSE = "--pack no --results no", "--pack no --results no"
FILES = {
    "render": [("output", "nowhere --method mipmap")],
    "stability": [("html", "")],
    "check": [("html", CHECK), ("json", CHECK), ("junit", CHECK)],
    "diagnose": [("json", DIAGNOSE)],
}
CALLS = [
    *(
        (name, *one, kind)
        for kind, table in (("folder", FOLDERS), ("file", FILES))
        for name in table
        for one in table[name]
    )
]


@pytest.mark.parametrize(("command", "option", "words", "kind"), CALLS, ids=lambda part: str(part)[:12])
def test_outputs_are_looked_at_first(tmp_path, monkeypatch, capsys, command, option, words, kind):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("kept")
    (tmp_path / "there.png").mkdir()
    places = ["/proc/a.png", "/proc/no/a.png", "file/a.png", *(["file"] if kind == "folder" else ["there.png"])]
    for place in places:  # nobody may write to /proc, not even root, to whom its folder looks writable
        said = refused(monkeypatch, capsys, command, *words.split(), f"--{option}", place)
        assert re.match(rf"refdof: {option}: got '{place}', (but .* is not a writable folder|which is not)", said), said
        assert sorted(path.name for path in tmp_path.rglob("*")) == ["file", "there.png"]


@pytest.mark.parametrize("place", [".", "/dev/full", "there"])
def test_what_has_no_suffix_is_said_as_it_was_typed(tmp_path, monkeypatch, capsys, place):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there").mkdir()
    said = refused(monkeypatch, capsys, "render", "nowhere", "--method", "mipmap", "-o", place)
    assert said.startswith(f"refdof: output: got '{place}'; allowed are names that end in .png")


def test_no_output_is_left_out():
    for name in COMMANDS:
        _, command, _ = typer.main.get_command(app).resolve_command(None, [name])
        helps = {part.opts[-1][2:]: part.help or "" for part in command.params if part.opts[-1].startswith("--")}
        found = {key for key, text in helps.items() if re.search("^Also write|[Oo]utput f|^A new|^Folder", text)}
        assert found == {option for table in (FOLDERS, FILES) for option, _ in table.get(name, [])}, name


def test_what_can_be_written_is_left_as_it_is(tmp_path):
    (tmp_path / "a").write_text("old")
    for file in ("a", "b", "new/b"):
        check_file(tmp_path / file)
    for folder in (".", "new", "new/new"):
        check_folder(tmp_path / folder, beside=True)
    assert [path.name for path in Path(tmp_path).iterdir()] == ["a"]
    assert (tmp_path / "a").read_text() == "old"

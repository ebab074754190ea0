"""Messages of the command line: the option and its value as they were typed."""

import typing
from pathlib import Path

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

from refdof.cli import app
from refdof.command_group import COMMANDS
from tests.one_line import refused

pytestmark = pytest.mark.fast


def commands():
    for name in COMMANDS:
        _, command, _ = typer.main.get_command(app).resolve_command(None, [name])
        yield name, command


def kinds(command):
    """The type of each parameter of a command, by its name."""
    return {name: set(typing.get_args(hint)) | {hint} for name, hint in typing.get_type_hints(command.callback).items()}


NUMBERS = [
    (name, part.opts[-1][2:], "a whole number" if int in kinds(command)[part.name] else "a number")
    for name, command in commands()
    for part in command.params
    if {int, float} & kinds(command).get(part.name, set())
]


def test_there_are_numbers():
    assert len(NUMBERS) > 80
    assert ("compare", "samples", "a whole number") in NUMBERS
    assert ("lens", "focus", "a number") in NUMBERS


# What is typed, and how its error begins: the option's name and its value.
TYPED = [
    ("sweep --predict 1920", "predict: got '1920'; allowed is WIDTHxHEIGHT"),
    ("sweep --vary focus=-1", "vary: focus: got -1;"),
    ("sweep --vary lens-radius=-1", "vary: lens_radius: got -1;"),
    ("sweep --vary size=0x9", "vary: size: got '0x9';"),
    ("sweep --budget -5ms", "budget: got '-5ms'; allowed is NUMBERms or NUMBERs or NUMBERus, above 0"),
    ("sweep --quality 1e999dB", "quality: got '1e999dB';"),
    ("sweep --method mipmp", "method: got 'mipmp';"),
    ("golden --out g --methods mipmp", "methods: got 'mipmp';"),
    ("export fence --out g --methods mipmp", "methods: got 'mipmp';"),
    ("compare --methods mipmp", "methods: got 'mipmp';"),
    ("filter --color a.npy --depth d.npy --methods mipmp --fov 40 --focus 2 --lens-radius 1", "methods: got 'mipmp';"),
    ("stability --methods mipmp", "methods: got 'mipmp';"),
    ("focus fence --points text --method mipmap --out g", "points: text: "),
    ("render fence --focus-points text --method mipmap -o a.png", "focus-points: text: "),
    ("export fence --size 32x24 --out g --pixel 500,2", "pixel: got '500,2'; allowed are 0,0 .. 31,23"),
    ("export fence --size 32x24 --out g" + " --pixel 1,1" * 17, "pixel: got 17; allowed are at most 16"),
    ("check --pack {pack} --results . --not-supported foo", "not-supported: got 'foo';"),
    ("render fence --method mipmap -o a.png --size 0x0", "size: got '0x0'; allowed is WIDTHxHEIGHT"),
    ("render fence --method mipmap -o a.png --size 9x99999", "size: got '9x99999'; allowed is WIDTHxHEIGHT"),
    ("lens double_gauss --focus 0.01", "focus: got 0.01; allowed is more than 0.0470689 metres"),
    ("render fence --method mipmap -o a.png --lens biconvex --focus 0.0001", "focus: got 0.0001; allowed is more than"),
]


@pytest.mark.parametrize(("words", "begins"), TYPED, ids=lambda words: words[:30])
def test_errors_name_what_was_typed(tmp_path, monkeypatch, capsys, words, begins):
    pack = Path(__file__).parents[1] / "data" / "packs" / "core"
    monkeypatch.chdir(tmp_path)
    np.save("a.npy", np.ones((24, 32, 3)))
    np.save("d.npy", np.ones((24, 32)))
    Path("text").write_bytes(b"\xff")
    said = refused(monkeypatch, capsys, *(word.format(pack=pack) for word in words.split()))
    assert said.startswith(f"refdof: {begins}")


@pytest.mark.parametrize("name", COMMANDS)
def test_words_in_the_place_of_numbers(monkeypatch, capsys, name):
    for command, option, allowed in NUMBERS:
        if command == name:
            for word in ("abc", "", "1,5", *(["1.5"] if allowed == "a whole number" else [])):
                said = refused(monkeypatch, capsys, command, f"--{option}={word}")
                assert said == f"refdof: {option}: got '{word}'; allowed is {allowed}\n"


# Every file that a command reads is none.
MISSING = [
    "check --pack no --results .",
    "check --pack {pack} --results no",
    "check --pack {pack} --shader no.frag",
    "check --pack {pack} --shader {root}/ports/glsl/singlepass.frag --bindings no",
    "check --pack {pack} --results . --waivers no",
    "diagnose --pack {pack} --shader no.frag",
    "explain no --pixel 1,1",
    "filter --color no.exr --fov 40 --focus 2 --lens-radius 1",
    "filter --color a.npy --depth no.npy --fov 40 --focus 2 --lens-radius 1",
    "focus fence --points no --method mipmap --out g",
    "lens no.toml",
    "render no.obj --method mipmap -o a.png",
    "render fence --lens no.toml --method mipmap -o a.png",
    "render fence --focus-points no --method mipmap -o a.png",
    "score no.npy a.npy",
    "score a.npy no.npy",
]


@pytest.mark.parametrize("words", MISSING, ids=lambda words: words[:40])
def test_what_is_missing_is_said_once(tmp_path, monkeypatch, capsys, words):
    root = Path(__file__).parents[1]
    monkeypatch.chdir(tmp_path)
    np.save("a.npy", np.ones((24, 32, 3)))
    places = {"root": root, "pack": root / "data" / "packs" / "core"}
    said = refused(monkeypatch, capsys, *(word.format(**places) for word in words.split()))
    assert "'no" in said
    assert said.count("got ") + said.count("cannot read") == 1, said
    assert said.count("allowed") == 1, said


def test_a_folder_that_is_no_case_is_named(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty").mkdir()
    for words in (["empty"], ["empty", "--method", "mipmap"], ["nowhere"]):
        said = refused(monkeypatch, capsys, "explain", *words, "--pixel", "30,19")
        assert said.startswith(f"refdof: case: got '{words[0]}'"), said
    said = refused(monkeypatch, capsys, "explain", "fence", "--pixel", "30,19")
    assert said.startswith("refdof: method: got none with a scene; allowed are ")


def test_no_line_of_the_help_is_cut():
    shown = CliRunner().invoke(app, ["--help"], env={"COLUMNS": "80"}).output
    lines = [line for line in shown.splitlines() if not line.startswith("Usage:")]
    assert [line for line in lines if line.endswith("...")] == []
    for name, home in COMMANDS.items():
        assert f"  {name:<9}  {home.help}" in lines

"""Messages of the command line: the option and its value as they were typed."""

import typing

import pytest
import typer

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


@pytest.mark.parametrize("name", COMMANDS)
def test_words_in_the_place_of_numbers(monkeypatch, capsys, name):
    for command, option, allowed in NUMBERS:
        if command == name:
            for word in ("abc", "", "1,5", *(["1.5"] if allowed == "a whole number" else [])):
                said = refused(monkeypatch, capsys, command, f"--{option}={word}")
                assert said == f"refdof: {option}: got '{word}'; allowed is {allowed}\n"

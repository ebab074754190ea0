"""The command of one picture, from the command of all."""

import shlex
from dataclasses import replace

import click
import pytest
from typer.main import get_command

from refdof.cli import app
from refdof.report.commands import FLAGS, picture_command
from tests.fake_comparison import comparison

ROW = comparison(methods=("scatter",)).rows[0]


@pytest.mark.parametrize(
    ("command", "expected"),
    [
        ("refdof compare", "refdof compare --methods scatter --out out-scatter"),
        (
            "refdof compare fence --size 320x240 --methods scatter,mipmap --preset best,paper --wide --no-vignetting",
            "refdof compare fence --size 320x240 --no-vignetting --methods scatter --out out-scatter",
        ),
        (
            "refdof compare 'a b.glb' town --out 'a b' --focus=3 --set scatter.order=a --json --set mipmap.delta=1",
            "refdof compare town --focus=3 --set scatter.order=a --methods scatter --out 'a b-scatter'",
        ),
        (
            "refdof filter --color frame.exr --fov 40 --out=results --set=scatter.order=a --set=mipmap.delta=1",
            "refdof filter --color frame.exr --fov 40 --set=scatter.order=a --methods scatter --out results-scatter",
        ),
        ("python my_script.py", ""),
        ("", ""),
        ("refdof studio town", ""),
        ("refdof compare fence --eye -1,2,3", "refdof compare fence --eye -1,2,3 --methods scatter --out out-scatter"),
    ],
)
def test_only_one_scene_and_method_are_left(command, expected):
    assert picture_command(command, ROW, 1) == expected


def test_a_preset_is_said():
    found = shlex.split(picture_command("refdof compare fence --preset best,paper", replace(ROW, preset="paper")))
    assert found[3:] == ["--methods", "scatter", "--preset", "paper", "--out", "out-scatter--paper"]


@pytest.mark.parametrize("name", ["compare", "filter"])
def test_flags_are_the_options_without_value(name):
    """Read from the command line itself: an option that is new and not listed here would take a scene for its value."""
    command = get_command(app)
    found = command.get_command(click.Context(command), name)
    flags = {text for option in found.params if getattr(option, "is_flag", False) for text in option.opts}
    assert flags - {"--help"} <= set(FLAGS)
    takers = {text for option in found.params if not getattr(option, "is_flag", True) for text in option.opts}
    assert not takers & set(FLAGS)

"""docs/lenses.md lists the lenses of data/lenses with their numbers, and its examples are lenses."""

import re
import tomllib
from pathlib import Path

import pytest

from refdof.optics.systems.lens_toml import parse_toml
from refdof.optics.systems.paraxial import f_number, focal_length
from refdof.optics.systems.prescription import LENSES, load_lens

pytestmark = pytest.mark.fast

ROOT = next(folder for folder in Path(__file__).parents if (folder / "pyproject.toml").exists())
PAGE = (ROOT / "docs" / "lenses.md").read_text()


def row(name):
    system = load_lens(name)
    source = " ".join(system.source.split())
    numbers = f"{len(system.surfaces)} | {focal_length(system):.2f} | {f_number(system):.2f}"
    return f"| `{name}` | {system.name} | {numbers} | {source} |"


def test_the_table_is_that_of_the_files():
    listed = [line for line in PAGE.splitlines() if line.startswith("| `")]
    assert listed == [row(name) for name in LENSES]


def test_the_example_is_a_lens():
    text = re.search(r"```toml\n(.*?)```", PAGE, re.DOTALL)[1]
    assert tomllib.loads(text)["unit"] == "mm"
    assert parse_toml("example.toml", text).surfaces == load_lens("biconvex").surfaces

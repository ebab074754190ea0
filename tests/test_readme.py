"""README, registry, bibliography and command line speak of the same things."""

import re
import tomllib
from pathlib import Path

from refdof import METHODS

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text()


def test_method_table_agrees_with_the_modules():
    table = README.split("<!-- methods -->")[1].split("<!-- end -->")[0]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in table.strip().splitlines()]
    # On Markdown renderers a table is one block: head, rule and rows, with nothing between them.
    head, rule, *rows = rows
    assert head == ["method", "source", "what it needs", "promises"]
    assert set("".join(rule)) == {"-"}
    assert [row[0].strip("`") for row in rows] == list(METHODS)
    for name, source, inputs, promises in rows:
        record = METHODS[name.strip("`")].METHOD
        assert source == record.origin
        assert tuple(inputs.split(", ")) == record.inputs
        assert tuple(promises.split(", ")) == record.promises


def test_every_dependency_has_its_reason():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    wanted = list(project["dependencies"])
    for extra in project["optional-dependencies"].values():
        wanted += extra
    table = README.split("## Dependencies")[1].split("\n## ")[0].lower()
    for requirement in wanted:
        name = re.match(r"[\w-]+", requirement).group().lower()
        assert name in table, name
        assert re.search(r">=\d", requirement), requirement


def test_opens_with_the_two_commands_and_a_picture():
    head = README[:700]
    assert head.index("make compare") < head.index("make test") < head.index("![")
    assert (ROOT / re.search(r"!\[.*?\]\((.*?)\)", head).group(1)).exists()


def test_packages_are_all_installed():
    setuptools = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]
    folders = {path.parent.relative_to(ROOT).as_posix() for path in (ROOT / "refdof").rglob("*.py")}
    assert {name.replace(".", "/") for name in setuptools["packages"] if ".data" not in name} == folders

"""README, registry, packages and files say the same; the README renders, and its Python runs."""

import re
import runpy
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

from markdown_it import MarkdownIt

import refdof
from refdof import METHODS
from refdof.report.table import columns

ROOT = next(folder for folder in Path(__file__).parents if (folder / "pyproject.toml").exists())
README = (ROOT / "README.md").read_text(encoding="utf-8")
MARKDOWN = MarkdownIt("commonmark").enable("table")  # as GitHub reads tables


def tables(text):
    """Every table that a renderer finds, as rows of cells, the header first."""
    found, row = [], []
    for token in MARKDOWN.parse(text):
        if token.type == "table_open":
            found.append([])
        elif token.type == "tr_open":
            row = []
        elif token.type == "inline" and found and token.level >= 3:
            row.append(token.content.strip())
        elif token.type == "tr_close":
            found[-1].append(row)
    return found


def table_with(text, *head):
    return next(rows[1:] for rows in tables(text) if tuple(rows[0][: len(head)]) == head)


def between(start):
    return README.split(f"<!-- {start} -->")[1].split("<!-- end -->")[0]


def test_a_comment_inside_a_table_is_noticed():
    whole = "| a | b |\n|---|---|\n| 1 | 2 |\n"
    assert tables(whole) == [[["a", "b"], ["1", "2"]]]
    assert tables(whole.replace("| 1", "<!-- x -->\n| 1")) == [[["a", "b"]]]


def test_method_table_renders_and_agrees_with_the_modules():
    rows = table_with(between("methods"), "method", "source")
    assert [row[0].strip("`") for row in rows] == list(METHODS)
    for name, source, inputs, promises in rows:
        record = METHODS[name.strip("`")].METHOD
        assert source == record.origin
        assert tuple(inputs.split(", ")) == record.inputs
        assert tuple(promises.split(", ")) == record.promises


def test_compare_table_renders():
    """A new method is missing until `make readme` has run."""
    rows = table_with(between("compare table"), "method", *(column.heading for column in columns()))
    assert [row[0] for row in rows] == [name for name in METHODS if name in {row[0] for row in rows}]
    assert len(rows) >= 10
    assert all(float(row[1]) > 10 for row in rows)  # a PSNR [dB], not an empty cell


def test_make_readme_replaces_what_compare_printed(tmp_path):
    (tmp_path / ".ci").mkdir()
    shutil.copy(ROOT / ".ci" / "readme_table.py", tmp_path / ".ci")
    (tmp_path / "README.md").write_text("a\n<!-- compare table -->\nold\n<!-- end -->\nb\n<!-- end -->\n")
    (tmp_path / "table.md").write_text(
        "### fence\n\n| new |\n| --- |\n\nReference: 1 s.\n\n| second |\n| --- |\n\nPSNR is\n"
    )
    script = [sys.executable, str(tmp_path / ".ci" / "readme_table.py"), str(tmp_path / "table.md")]
    subprocess.run(script, check=True, timeout=60)
    text = (tmp_path / "README.md").read_text()
    assert text == "a\n<!-- compare table -->\n\n| new |\n| --- |\n\nReference: 1 s.\n<!-- end -->\nb\n<!-- end -->\n"


def test_the_python_runs(tmp_path, capsys):
    code = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    assert len(code) == 1
    assert "(320, 240)" in code[0]
    script = tmp_path / "readme.py"
    script.write_text(code[0].replace("(320, 240)", "(40, 30)"))
    names = runpy.run_path(str(script))
    assert names["image"].shape == names["result"].image.shape == (30, 40, 3)
    assert len(capsys.readouterr().out.splitlines()) == 3


def test_is_short_and_opens_with_the_two_commands_and_a_picture():
    assert len(README.splitlines()) - 2 * len(METHODS) <= 100  # two tables have a row for each method
    head = README[:700]
    assert head.index("make compare") < head.index("make test") < head.index("![")


def test_every_link_leads_to_a_file():
    for name in ("README.md", "CONTRIBUTING.md"):
        for link in re.findall(r"\]\(([^)#]+)", (ROOT / name).read_text(encoding="utf-8")):
            assert (ROOT / link).exists(), f"{name}: {link}"


def test_the_line_that_runs_one_test_names_a_test():
    tests = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("test_*.py"))
    for name in ("README.md", "CONTRIBUTING.md"):
        (word,) = re.findall(r"pytest -k (\w+)", (ROOT / name).read_text(encoding="utf-8"))
        assert f"def test_{word}" in tests


def test_every_dependency_has_its_reason():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    wanted = list(project["dependencies"])
    for extra in project["optional-dependencies"].values():
        wanted += extra
    told = {
        name
        for rows in tables((ROOT / "docs" / "dependencies.md").read_text(encoding="utf-8"))
        for cells in rows[1:]
        for name in cells[0].lower().split(", ")
        if cells[1]
    }
    for requirement in wanted:
        if requirement.startswith("refdof["):  # other extras, listed themselves
            continue
        assert re.match(r"[\w-]+", requirement).group().lower() in told
        assert re.search(r">=\d", requirement), requirement


def test_packages_and_their_files_are_found():
    """setup.py finds folders with an __init__.py; other files of a package must be named in pyproject.toml."""
    data = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["package-data"]
    for path in (ROOT / "refdof").rglob("*"):
        if path.is_dir() or "__pycache__" in path.parts:
            continue
        package = path.parent.relative_to(ROOT)
        assert (ROOT / package / "__init__.py").exists(), path
        patterns = ["*.py", *data.get(".".join(package.parts), [])]
        assert any(path.match(pattern) for pattern in patterns), path


def test_one_version():
    assert "version" in tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["dynamic"]
    newest = re.search(r"^## (\S+)", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE).group(1)
    assert newest == refdof.__version__

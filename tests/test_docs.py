"""The documentation speaks of what is there: pages of methods, listed modules, names and examples in the text."""

import doctest
import os
import re
import subprocess
import sys
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest

import refdof
from refdof.methods._contract import BASES, PROMISES

ROOT = next(folder for folder in Path(__file__).parents if (folder / "pyproject.toml").exists())
DOCS = ROOT / "docs"
PAGES = sorted(DOCS.glob("*.md"))
WITH_EXAMPLES = [page for page in PAGES if "\n```pycon\n>>>" in page.read_text()]

pytestmark = pytest.mark.fast


@pytest.fixture
def extension(monkeypatch):
    monkeypatch.syspath_prepend(DOCS)
    return import_module("extension")


def test_every_method_has_a_page(extension, tmp_path):
    extension.method_pages.write(tmp_path, render=False)
    table = (tmp_path / "methods" / "table.inc").read_text()
    for name, module in refdof.METHODS.items():
        page = (tmp_path / "methods" / f"{name}.rst").read_text()
        assert f"</methods/{name}>" in table
        for heading in ("Steps", "Known defects", "Parameters", "Stages", "Promises", "References"):
            assert f"\n{heading}\n---" in page, (name, heading)
        for field in module.Params.__dataclass_fields__:
            assert f"\n``{field}`` = ``" in page, (name, field)
        assert module.METHOD.source in page
        assert "one of `" not in page  # the words themselves, not the name of a constant


def test_the_glossary_explains_every_promise():
    glossary = (DOCS / "glossary.md").read_text()
    for name, meaning in PROMISES.items():
        assert f"  - {name}: {meaning}\n" in glossary


def test_the_page_on_testing_lists_every_promise():
    from refdof.testing import PROMISES

    rows = re.findall(
        r"^\| (\w+) \| (.*) \|$", (DOCS / "testing.md").read_text().split("<!-- promises -->")[1], re.MULTILINE
    )
    assert rows[1:] == list(PROMISES.items())


def test_the_glossary_explains_what_methods_are_written_after():
    glossary = " ".join((DOCS / "glossary.md").read_text().split())
    for name, meaning in BASES.items():
        after = "" if name == "reconstruction" else "written after "
        assert f" {name} : A method {after}{meaning}." in glossary


def test_listed_modules_import_and_none_of_raster_is_left_out(extension):
    listed = extension.api_pages.modules()
    assert len(set(listed)) == len(listed)
    assert {"refdof.metrics", "refdof.oracle"} <= set(listed)
    for name in listed:
        assert import_module(name).__doc__, name
    files = (ROOT / "refdof" / "raster").rglob("*.py")
    stages = {".".join(path.relative_to(ROOT).with_suffix("").parts) for path in files if path.stem != "__init__"}
    assert len(stages) > 10
    assert stages <= set(listed)


def test_public_names_have_a_page(extension, tmp_path):
    extension.api_pages.write(tmp_path)
    text = (tmp_path / "api" / "refdof.rst").read_text()
    for name in refdof.__all__:
        assert re.search(rf":: {name}\n|``refdof\.{name}``", text), name


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_names_in_the_text_exist(page):
    text = page.read_text()
    for module in re.findall(r"^from (refdof\.\S+) import ", text, flags=re.MULTILINE):
        import_module(module)
    for name in set(re.findall(r"(?<![\w/.])refdof(?:\.[A-Za-z_]\w*)+", text)):
        value, path = refdof, "refdof"
        for part in name.split(".")[1:]:
            path = f"{path}.{part}"
            if isinstance(value, ModuleType):
                with suppress(ModuleNotFoundError):
                    import_module(path)
            assert hasattr(value, part), name
            value = getattr(value, part)
            if isinstance(value, dict | tuple):
                break


@pytest.mark.parametrize("source", sorted((ROOT / "refdof").rglob("*.py")), ids=lambda path: path.stem)
def test_names_in_docstrings_exist(source):
    for name in set(re.findall(r"`(refdof(?:\.[A-Za-z_]\w*)+)`", source.read_text())):
        module, _, attribute = name.rpartition(".")
        try:
            import_module(name)
        except ModuleNotFoundError:
            assert hasattr(import_module(module), attribute), name


@pytest.mark.parametrize("page", WITH_EXAMPLES, ids=lambda page: page.stem)
def test_examples_give_what_they_say(page):
    blocks = re.findall(r"```pycon\n(.*?)```", page.read_text(), flags=re.DOTALL)
    test = doctest.DocTestParser().get_doctest("".join(blocks), {}, page.stem, str(page), 0)
    said: list[str] = []
    flags = doctest.ELLIPSIS | doctest.IGNORE_EXCEPTION_DETAIL
    result = doctest.DocTestRunner(optionflags=flags).run(test, out=said.append)
    assert result.attempted > 0
    assert result.failed == 0, "".join(said)


def test_offline_check_finds_what_is_loaded_from_elsewhere(tmp_path):
    import importlib.util

    spec = importlib.util.spec_from_file_location("check_offline", DOCS / "check_offline.py")
    check = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(check)
    (tmp_path / "page.html").write_text(
        '<a href="https://example.org">link</a><img src="here.png"><script src="https://example.org/a.js"></script>'
        '<link rel="stylesheet" href="//example.org/b.css"><style>'
        "body { background: url(https://example.org/c.png) }</style>"
    )
    (tmp_path / "style.css").write_text('@import "https://example.org/d.css"; a { background: url(e.png) }')
    found = " ".join(check.remote_parts(tmp_path))
    assert [letter for letter in "abcde" if f"/{letter}." in found] == ["a", "b", "c", "d"]


@pytest.mark.slow
@pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="takes hours without compiling")
def test_tutorial_runs(tmp_path):
    """Every command of the tutorial, in order; the first Python block is the file that the text says to save.

    Of a quarter of the size, since what is tried are the commands: no figure of the text is looked at.
    """
    text = (DOCS / "tutorial.md").read_text()
    assert "320x240" in text
    blocks = re.findall(r"```(python|bash)\n(.*?)```", text.replace("320x240", "80x60"), flags=re.DOTALL)
    assert [kind for kind, _ in blocks].count("bash") >= 4
    (tmp_path / "make_model.py").write_text(blocks[0][1])
    python = ""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    environment = {**os.environ, "PATH": path, "PYTHONPATH": str(ROOT)}
    for kind, text in blocks[1:]:
        if kind == "bash":
            subprocess.run(["bash", "-ec", text], cwd=tmp_path, env=environment, check=True, capture_output=True)
        else:
            python += text
    subprocess.run([sys.executable, "-c", python], cwd=tmp_path, env=environment, check=True, capture_output=True)
    for name in ("balls.glb", "look.png", "out/balls/report.html", "out/balls/overview.png", "out/cheaper/table.md"):
        assert (tmp_path / name).stat().st_size > 0

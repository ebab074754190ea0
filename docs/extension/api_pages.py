"""API pages: one for what refdof exports, one for each module in `api_modules.txt`, and an index by group."""

from importlib import import_module
from inspect import isclass, isroutine
from pathlib import Path
from pkgutil import walk_packages

import refdof
from extension import method_pages
from extension.docstrings import escape, first_sentence

__all__ = ["groups", "modules", "write"]

_LIST = Path(__file__).parent.parent / "api_modules.txt"


def groups() -> dict[str, list[str]]:
    """Module names by group, in the order of the list. Comments end with the first blank line."""
    found: dict[str, list[str]] = {}
    heading = ""
    for line in _LIST.read_text().split("\n\n", 1)[1].splitlines():
        if line.startswith("# "):
            heading = line[2:].strip()
            found[heading] = []
        elif line.endswith(".*"):
            for name in _public(line[:-2]):
                folder = name.removeprefix(line[:-1]).rpartition(".")[0]
                found.setdefault(f"{heading}: {folder}" if folder else heading, []).append(name)
        elif line.strip():
            found[heading].append(line.strip())
    return {heading: names for heading, names in found.items() if names}


def _public(package: str) -> list[str]:
    """The public modules under a package, without packages and without what has a page among the methods."""
    below = walk_packages(import_module(package).__path__, f"{package}.")
    names = [found.name for found in below if not found.ispkg and "._" not in found.name]
    return [name for name in names if name not in method_pages.modules()]


def modules() -> list[str]:
    """Every module of the list."""
    return [name for names in groups().values() for name in names]


def write(source: Path) -> None:
    """Write `api/` under the folder of the sources."""
    folder = source / "api"
    folder.mkdir(exist_ok=True)
    wanted = {"index.rst": _index(), "refdof.rst": _package()}
    stages = [names for heading, names in groups().items() if heading.startswith("Raster stages")]
    wanted["stages.inc"] = "\n".join(table([name for names in stages for name in names])) + "\n"
    for name in modules():
        wanted[f"{name}.rst"] = f"{_heading(name)}\n.. automodule:: {name}\n   :members:\n"
    for old in folder.glob("*.rst"):
        if old.name not in wanted:
            old.unlink()
    for name, text in wanted.items():
        path = folder / name
        if not path.exists() or path.read_text() != text:
            path.write_text(text)


def _index() -> str:
    lines = [
        _heading("API"),
        "Everything here comes from the docstrings. The names on the page :doc:`refdof` are the public interface. The",
        "modules below it are for those who port a stage or write a method; they may change between versions.",
        "",
        ".. toctree::",
        "   :hidden:",
        "",
        "   refdof",
        *(f"   {name}" for name in modules()),
        "",
    ]
    for heading, names in groups().items():
        lines += [heading, "-" * len(heading), "", *table(names), ""]
    return "\n".join(lines)


def table(names: list[str]) -> list[str]:
    """Rows of modules and what each is, as a list table."""
    lines = [".. list-table::", "   :widths: 30 70", ""]
    for name in names:
        lines += [
            f"   * - :doc:`{name} </api/{name}>`",
            f"     - {escape(first_sentence(import_module(name).__doc__))}",
        ]
    return lines


def _package() -> str:
    """The page of what refdof exports: functions, then classes, each with its own docstring."""
    public = {name: getattr(refdof, name) for name in refdof.__all__}
    functions = [name for name, value in public.items() if isroutine(value)]
    classes = [name for name, value in public.items() if isclass(value)]
    lines = [
        _heading("refdof"),
        ".. currentmodule:: refdof",
        "",
        f"``refdof.METHODS`` is a dict of the methods by name: {_words(refdof.METHODS)}. See :doc:`/methods`.",
        "",
        f"``refdof.SCENES`` are the names of the built-in scenes: {_words(refdof.SCENES)}.",
        "",
        "``refdof.metrics`` are the scores, see :doc:`refdof.metrics`.",
        "",
        "``refdof.cluster`` hands tasks to other machines, see :doc:`refdof.cluster`.",
        "",
    ]
    for heading, names, directive in (("Functions", functions, "autofunction"), ("Classes", classes, "autoclass")):
        lines += [heading, "-" * len(heading), ""]
        for name in names:
            lines += [f".. {directive}:: {name}", *(["   :members:"] if directive == "autoclass" else []), ""]
    return "\n".join(lines)


def _words(names: object) -> str:
    return ", ".join(f"``{name}``" for name in names)  # type: ignore[attr-defined]


def _heading(text: str) -> str:
    return f"{text}\n{'=' * len(text)}\n"

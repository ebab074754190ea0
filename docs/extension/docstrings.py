"""Docstrings taken apart: title, sections, and the entries of a list of parameters."""

import re
from inspect import cleandoc
from typing import NamedTuple

__all__ = ["Entry", "Parts", "entries", "escape", "first_sentence", "take_apart"]

_CODE = re.compile(r"(``.+?``|:[a-z:]+:`[^`]+`|`[^`\n]+`)", re.DOTALL)


class Entry(NamedTuple):
    """One entry of a numpydoc list: the names before the colon, the type behind it, and what stands beneath."""

    names: tuple[str, ...]
    kind: str
    text: str


class Parts(NamedTuple):
    """A method's docstring: title, paragraphs before the first heading, and text by heading."""

    title: str
    paragraphs: tuple[str, ...]
    sections: dict[str, str]


def escape(text: str) -> str:
    """The text with bars, stars and trailing underscores as they are outside code, where RST has uses for them."""
    pieces = _CODE.split(text)
    for k in range(0, len(pieces), 2):
        pieces[k] = re.sub(r"\|", r"\\|", pieces[k])
        pieces[k] = re.sub(r"(?<=\w)_(?=\W|$)", r"\\_", pieces[k])
        pieces[k] = re.sub(r"(?<![*\\\w])\*(?=[^\s*][^*\n]*$)", r"\\*", pieces[k], flags=re.MULTILINE)
    return "".join(pieces)


def take_apart(docstring: str) -> Parts:
    """The parts of a module's docstring."""
    text = cleandoc(docstring)
    head, *rest = re.split(r"^(\S.*)\n-{3,}\n", text, flags=re.MULTILINE)
    title, *paragraphs = re.split(r"\n\s*\n", head.strip())
    sections = {rest[k]: rest[k + 1].strip() for k in range(0, len(rest), 2)}
    return Parts(" ".join(title.split()), tuple(paragraphs), sections)


def entries(docstring: str) -> list[Entry]:
    """The parameters of a class, from its numpydoc list."""
    found: list[Entry] = []
    for line in take_apart(docstring).sections.get("Parameters", "").splitlines():
        if line.startswith(" ") or not line.strip():
            found[-1] = found[-1]._replace(text=f"{found[-1].text} {line.strip()}".strip())
        else:
            names, _, kind = line.partition(" : ")
            found.append(Entry(tuple(name.strip() for name in names.split(",")), kind.strip(), ""))
    return found


def first_sentence(docstring: str | None) -> str:
    """The first paragraph on one line."""
    return take_apart(docstring or "").title

"""A row: one change of a port's text, and what is wrong with the result.

The truth is said from what the change does, never from what a diagnosis says of it.
"""

from pathlib import Path
from typing import NamedTuple

from tests.ports.cases import mutated

__all__ = ["TEXTS", "Row", "text_of"]

_ROOT = Path(__file__).parents[3]

TEXTS = {
    "c": _ROOT / "ports" / "c" / "singlepass.c",
    "glsl": _ROOT / "ports" / "glsl" / "singlepass.frag",
    "wgsl": _ROOT / "ports" / "wgsl" / "singlepass.wgsl",
    "host": Path(__file__).parent / "host.py",
}
"""What rows change: the ports, and a host of the GLSL port."""


class Row(NamedTuple):
    """A wrong port: `old`, which stands once in the port's text, is replaced by `new`.

    stage: the first of the loop's that is off, as `refdof.oracle.diagnosis.causes` has them
    cause: a key of the same; "A or B" where both say one thing; "unexplained" where none does; "error", and no stage,
    where there is no picture
    """

    port: str
    name: str
    stage: str
    cause: str
    old: str
    new: str

    @property
    def text(self) -> str:
        """The changed text."""
        return text_of(self.port, (self.old, self.new))


def text_of(port: str, *changes: tuple[str, str]) -> str:
    """A port's text with some changes, old to new; each old one has to stand in it exactly once."""
    text = TEXTS[port].read_text(encoding="utf-8")
    for old, new in changes:
        text = mutated(text, old, new)
    return text

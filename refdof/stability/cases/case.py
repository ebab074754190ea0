"""A case: an extreme, the view that shows it, and what must hold."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from typing import Any

from refdof.methods import METHODS
from refdof.stability.checks import Check
from refdof.view import View

__all__ = ["FEW_LAYERS", "GROUPS", "Case", "Skip"]

FEW_LAYERS: Mapping[str, Mapping[str, Any]] = {"multiview": {"layers": 16}}
"""For circles of so many px that layers of 1 px would be too many: see the case `layers-too-many`."""

GROUPS: dict[str, str] = {
    "depth": "Depth",
    "lens": "Focus, lens and lens samples",
    "light": "Light",
    "size": "Size, unit and number of layers",
    "geometry": "Geometry",
    "stored": "Depth and circles as a GPU stores them",
}


@dataclass(frozen=True)
class Case:
    """An extreme.

    Attributes
    ----------
    name : lower case with hyphens
    group : one of `GROUPS`
    says : what is extreme, as a sentence's part
    view : what is rendered; may raise
    checks : besides that finite input gives finite pictures, and that float32 errs by roundings only
    params : fields of a method's `Params`
    refused : how the message begins with which this is refused, of all methods or of some; "": it is not
    skip : methods that the case says nothing about, and why
    finite : whether what goes in is finite
    """

    name: str
    group: str
    says: str
    view: Callable[[], View]
    checks: tuple[Check, ...] = ()
    params: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    refused: str | Mapping[str, str] = ""
    skip: Mapping[str, str] = field(default_factory=dict)
    finite: bool = True

    def refusal(self, method: str) -> str:
        """How the message begins with which this is refused to a method; "": it is not."""
        return self.refused if isinstance(self.refused, str) else self.refused.get(method, "")


class Skip:
    """Methods that many cases say nothing about."""

    NO_TRIANGLES: Mapping[str, str] = {
        name: "takes triangles, and a frame has none" for name in ("accumulation", "multiview")
    }
    NO_SAMPLES: Mapping[str, str] = {
        name: "has no lens samples"
        for name, module in METHODS.items()
        if "samples" not in {entry.name for entry in fields(module.Params)}
    }

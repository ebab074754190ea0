"""Facts of a method: where it comes from, what it needs, what it costs, read from its module.

A module has `SOURCE` (authors and year), `INPUTS` (raster products in words) and `RECONSTRUCTION` (True where its
source was not at hand and the steps are pieced together), and `PAPER` (parameters in which its source differs from the
defaults). `fetch_units(params, width, height)` counts texture reads,
see `refdof.fetches`; a method whose work depends on the scene has none.
"""

from dataclasses import dataclass
from types import ModuleType
from typing import Any

__all__ = ["MethodFacts", "facts_of"]


@dataclass(frozen=True)
class MethodFacts:
    """What `refdof methods` tells of a method.

    Attributes
    ----------
    fetch_units : float or None
        Texture reads per pixel with the default parameters; None: depends on the scene.
    paper : {parameter: value}
        What the preset "paper" sets.
    """

    source: str
    reconstruction: bool
    inputs: tuple[str, ...]
    fetch_units: float | None
    paper: dict[str, Any]

    @property
    def fetches(self) -> str:
        """`fetch_units` in words."""
        if self.fetch_units is None:
            return "reads depend on the scene"
        return f"{self.fetch_units:.2f} fetch units" if self.fetch_units else "no textures"


def facts_of(module: ModuleType, width: int, height: int) -> MethodFacts:
    """Facts of a method for a picture of this size [px]."""
    count = getattr(module, "fetch_units", None)
    return MethodFacts(
        str(getattr(module, "SOURCE", module.CITATION)),
        bool(getattr(module, "RECONSTRUCTION", False)),
        tuple(getattr(module, "INPUTS", ())),
        None if count is None else float(count(module.Params(), width, height)),
        dict(module.PAPER),
    )

"""Case: one picture, one method, one set of parameters."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from refdof.stages import Stages

__all__ = ["LEVELS", "SIZES", "Case", "in_file_order"]

LEVELS = ("core", "full", "extreme")
SIZES = ((256, 192), (320, 240), (317, 239))


@dataclass(frozen=True)
class Case:
    """One case of a pack.

    Attributes
    ----------
    name : str
        Its folder: lower-case letters, digits and "_".
    method : str
    input : one of `refdof.oracle.inputs.INPUTS`
    size : (width, height) [px]
    params : {name: value}
        What differs from the method's defaults.
    rows : "down" or "up"
        "up": files begin with the bottom row of the picture.
    stages : Stages or None
        Stages of the case; None: the final picture only.
    tags : words
        What a port needs for it: it may declare some as not supported.
    origin : str
        Where the case comes from, if not from its input.
    """

    name: str
    method: str
    input: str
    size: tuple[int, int]
    params: Mapping[str, Any] = field(default_factory=dict)
    rows: str = "down"
    stages: Stages | None = None
    tags: tuple[str, ...] = ()
    origin: str = ""


def in_file_order(params: Any, rows: str) -> Any:
    """Parameters with which rows as they are stored give the picture as it is stored: a port turns no rows round."""
    return replace(params, row_order="down" if params.row_order == rows else "up")

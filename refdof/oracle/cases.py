"""Cases of packs: which input, at which size, with which parameters, by level.

"core" is small enough to live beside code; it has full widths and full heights of sizes with ties as strips. "full"
has every input at every size of `SIZES`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from refdof._check import as_choice
from refdof.methods import METHODS
from refdof.stages import Stages

__all__ = ["LEVELS", "SIZES", "Case", "cases_of", "with_cases"]

LEVELS = ("core", "full")
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
    """

    name: str
    method: str
    input: str
    size: tuple[int, int]
    params: Mapping[str, Any] = field(default_factory=dict)
    rows: str = "down"
    stages: Stages | None = None
    tags: tuple[str, ...] = ()


def _singlepass(level: str) -> list[Case]:
    up, mirrored = {"row_order": "up"}, ("mirrored_spiral",)
    steps = Stages((1, 16))

    def case(name: str, source: str, size: tuple[int, int], *more: Any, **words: Any) -> Case:
        return Case(f"singlepass_{name}", "singlepass", source, size, *more, **words)

    if level == "full":
        return [
            case(f"{source}_{width}x{height}{'_up' if rows == 'up' else ''}", source, (width, height), params, rows)
            for source in ("ramp", "impulses", "constant", "cards", "bar", "hdr", "noise", "scene")
            for width, height in SIZES
            for params, rows in (({}, "down"), (up, "up"))
        ]
    finer, smaller = {"rad_scale": 0.4, "max_blur_size": 12.0}, {"max_blur_size": 6.0}
    coarser = {"rad_scale": 1.0, "behind_factor": 1.0}
    return [
        case("ramp", "ramp", (64, 48)),
        case("impulses", "impulses", (72, 60)),
        case("constant", "constant", (40, 30)),
        case("cards", "cards", (64, 48), stages=steps),
        case("cards_rows_up", "cards", (64, 48), up, "up"),
        case("cards_mirrored", "cards", (64, 48), up, tags=mirrored),
        case("bar", "bar", (64, 48)),
        case("hdr", "hdr", (64, 48)),
        case("scene", "scene", (80, 60)),
        case("noise_256_wide", "noise", (256, 14)),
        case("noise_320_wide", "noise", (320, 13)),
        case("noise_317_wide", "noise", (317, 13)),
        case("noise_239_high", "noise", (15, 239)),
        case("noise_rows_up", "noise", (61, 47), up, "up"),
        case("cards_finer", "cards", (48, 36), finer, tags=("params",)),
        case("noise_coarser", "noise", (48, 36), coarser, tags=("params",)),
        case("hdr_smaller", "hdr", (48, 36), smaller, tags=("params",)),
    ]


_CASES = {"singlepass": _singlepass}


def with_cases() -> list[str]:
    """The methods that packs have cases for: each declares its stages."""
    return [name for name in METHODS if name in _CASES]


def cases_of(level: str, methods: list[str] | None = None) -> list[Case]:
    """All cases of a level, by method.

    Raises
    ------
    InputError
        If the level or a method is not known, or has no cases.
    """
    as_choice("level", level, LEVELS)
    names = with_cases() if methods is None else [as_choice("method", name, with_cases()) for name in methods]
    return [case for name in dict.fromkeys(names) for case in _CASES[name](level)]

"""Cases of the Poisson disc filter, and what a pack says of it."""

from dataclasses import replace
from typing import Any

import numpy as np

from refdof._check import Float
from refdof.methods.poisson import Params
from refdof.oracle.case import SIZES, Case
from refdof.stages import Stages

__all__ = ["FILTER", "GUIDE", "STAGES", "cases", "numbers", "of_circles"]

STAGES = ("coc", "code", "small", "mean *")
FILTER = (
    2e-4,
    "texture coordinates in float32, times the size, move taps by up to 4e-5 px of 320: a tap's colour by as much, its "
    "blur by twice that, which both blends and weighs it",
)
GUIDE = """## poisson

After the listing of Scheuermann (2004), "Advanced Depth of Field". Colour and `code`, its blur, go through together:

    code "linear":     z = depth; n, p, f = near_plane, focus_plane, far_plane
                       b = min((z - p) / (f - p), far_limit) behind p, max((z - p) / (p - n), -1) before it
    code "thin_lens":  b = coc / max_radius, cut at -1 and far_limit
    code = (1 + b) / 2:  0 full blur in front, 1/2 sharp, 1 full blur behind

    small picture: colour and code, means of 2 x 2 texels, log2(small_size) times, odd rests left out;
    then 3 x 3 weights of 1 2 1 each way, / 16, clamped to the edge

    radius = |2 code - 1| max_radius, of the pixel
    for each of tap_count taps, tap_K_0 across and row_step tap_K_1 down:
        sharp = picture at pixel + tap * radius
        soft = small picture at pixel + tap * radius * small_radius * small_size
        tap = mix(sharp, soft, |2 code of sharp - 1|)
        weight = 1 if code of tap >= code of pixel, else |2 code of tap - 1|
    image = sum of weight * color of tap / sum of weights; the pixel's own colour where that is 0 / 0

Pictures are read bilinearly, clamped to the edge, at places in 0 .. 1: a place in the full picture [px] over its size.
So a texel of the small picture spans width / (its width) pixels, which is more than small_size where that does not
divide the width.

Codes within 1e-4 of the pixel's own may count as either: image and means have bounds there. A plane that faces the
camera is such a tie everywhere, unless it is at full blur.

Stages, where a case has them: `coc`, `code`, `small` (h w 4) and `mean_K`, the image after K taps.
"""

_UP = {"row_order": "up"}
_STEPS = Stages((1, 4))
_TABLES = "public ports: four tap tables, eight taps in six of 11 families"
_CONSTANTS = "public ports: another scale of the low-resolution picture in 3 families, and other planes"
_PLANES = {"near_plane": 1.0, "focus_plane": 2.0, "far_plane": 6.0}
# One depth is at full blur, for codes alike tie everywhere else.
_FLAT = {"ramp": {**_PLANES, "far_plane": 4.0}, "impulses": _PLANES}


def _case(name: str, source: str, size: tuple[int, int], params: dict[str, Any] | None = None, **words: Any) -> Case:
    planes = _FLAT.get(source, _PLANES)
    return Case(f"poisson_{name}", "poisson", source, size, {**planes, **(params or {})}, **words)


def cases(level: str) -> list[Case]:
    """The cases of a level."""
    return _LEVELS[level]()


def numbers(params: Params, rows: str) -> dict[str, Any]:
    """The tap table as numbers, before rows count, and where its second number points to."""
    table = replace(params, row_order="down").table
    return {"row_step": 1 if params.row_order == rows else -1, "tap_count": len(table), "tap": table.tolist()}


def of_circles(stage: str, low: Float, high: Float, params: Params) -> tuple[Float, Float] | None:
    """Bounds of the code where that is made of circles."""
    if stage != "code" or params.code != "thin_lens":
        return None
    least, greatest = (0.5 + 0.5 * np.clip(c / params.max_radius, -1.0, params.far_limit) for c in (low, high))
    return least, greatest


def _core() -> list[Case]:
    changed = ("params",)
    return [
        _case("ramp", "ramp", (32, 24)),
        _case("impulses", "impulses", (32, 32)),
        _case("cards", "cards", (32, 24)),
        _case("hdr", "hdr", (32, 24), stages=_STEPS),
        _case("noise_odd", "noise", (37, 29)),
        _case("noise_rows_up", "noise", (31, 22), _UP, rows="up"),
        _case("noise_thin_lens", "noise", (31, 22), {"code": "thin_lens"}, tags=changed),
        _case("noise_eight", "noise", (24, 20), {"taps": "eight"}, tags=changed, origin=_TABLES),
        _case("noise_four", "noise", (24, 20), {"taps": "eight", "max_taps": 4}, tags=changed, origin=_TABLES),
        _case("noise_half", "noise", (24, 20), {"small_size": 2, "small_radius": 0.5}, tags=changed, origin=_CONSTANTS),
        _case("noise_limit", "noise", (24, 20), {"far_limit": 0.5, "max_radius": 8.0}, tags=changed, origin=_CONSTANTS),
    ]


def _full() -> list[Case]:
    found = [
        _case(f"{source}_{width}x{height}{'_up' if params else ''}", source, (width, height), params, rows=rows)
        for source in ("ramp", "impulses", "constant", "cards", "bar", "hdr", "noise", "scene")
        for width, height in SIZES
        for params, rows in (({}, "down"), (_UP, "up"))
    ]
    for table in ("eight", "twelve_close", "nine_grid"):
        name = f"noise_320x240_{table}"
        found.append(_case(name, "noise", SIZES[1], {"taps": table}, tags=("params",), origin=_TABLES))
    found.append(_case("hdr_stages", "hdr", SIZES[0], stages=Stages((1, 2, 4, 8))))
    return found


def _extreme() -> list[Case]:
    found = [
        _case(f"noise_{width}x{height}", "noise", (width, height), tags=("extreme",))
        for width, height in ((1, 1), (2, 2), (3, 3), (1, 40), (40, 1), (3, 130))
    ]
    for source in ("bright", "dim", "distances"):
        found.append(_case(source, source, (36, 27), tags=("extreme",)))
    for source in ("huge", "tiny", "pinhole"):
        found.append(_case(source, source, (36, 27), {"code": "thin_lens"}, tags=("extreme",)))
    return found


_LEVELS = {"core": _core, "full": _full, "extreme": _extreme}

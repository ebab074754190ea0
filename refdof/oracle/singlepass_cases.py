"""Cases of the single pass, and what a pack says of it."""

from typing import Any

from refdof._check import Float
from refdof.methods.singlepass import Params
from refdof.oracle import extremes
from refdof.oracle.case import SIZES, Case
from refdof.oracle.circles import size_bounds
from refdof.stages import Stages

__all__ = ["FILTER", "GUIDE", "STAGES", "cases", "numbers", "of_circles"]

STAGES = ("coc", "size", "limit", "mean *")  # what else a tap reads has ties without bounds
FILTER = (
    2e-5,
    "texture coordinates near 1 in float32 are rounded to 2^-24, 2e-5 px of 320, and the first tap has a share of 1/2; "
    "hundreds of sums in float32 add 1e-6",
)
GUIDE = """## singlepass

The loop of Gustafsson (2018), "Bokeh Depth of Field in a Single Pass". `size(c) = min(|c|, max_blur_size)`:

    color, total, radius, angle = color of the pixel, 1, radius_start, angle_start
    while radius < loop_bound:
        tap at pixel + scale * radius * (cos angle, row_step * sin angle)
        its color: bilinear, clamped to the edge; its depth and coc: of the nearest texel, clamped to the edge
        s = size(coc of tap); if depth of tap > depth of pixel: s = min(s, behind_factor * size(coc of pixel))
        m = smoothstep(radius - 0.5, radius + 0.5, s)
        color += mix(color / total, color of tap, m);  total += 1
        angle += angle_step;  radius += rad_scale / radius
    image = color / total

Pixel and taps are places [px]: the pixel is its centre, (x + 0.5, y + 0.5). `scale` is (scale_x, scale_y), 1 in all
cases of the core pack, as shift_x and shift_y, added to every place, are 0. smoothstep(a, b, s) is t t (3 - 2 t) with
t = (s - a) / (b - a) cut to 0 .. 1. `loop_bound` is max_blur_size and `radius_start` rad_scale where case.json has
null. `row_order` is that of the spiral on the screen; a port needs `row_step` only. `max_taps`, where it stands, ends
the loop.

The spiral turns, so the order of rows matters. `row_step` in `params.txt` is where the sine of a tap's angle points to
in the files: +1 to later rows, -1 to earlier ones. A texture whose row 0 is texture coordinate 0 has +1: with rows "up"
that is a bottom-up upload as OpenGL's. The cases tagged `mirrored_spiral` have -1: what a host makes of rows "down"
that turns them over on the way in and on the way out.

`depth_filter` "bilinear" blends 1 / depth and coc, as a linearly filtered z-buffer does, and "bilinear_depth" blends
depth, as a linearly filtered texture of linear depth does.

Stages, where a case has them: `coc`; `size`; `limit` = behind_factor * size; and `mean_K`, color / total after K taps.
"""

_UP = {"row_order": "up"}
_STEPS = Stages((1, 16))
_MIRRORED = ("mirrored_spiral",)
_ROWS = "OpenGL's bottom-up rows mirror the spiral: another picture, as correct, 41 to 51 dB away"
_CONSTANTS = "public ports: RAD_SCALE from 0.1 to 3 in 19 of 32 families, MAX_BLUR_SIZE in as many"
_FILTERS = "public ports have depth at the nearest texel, linearly filtered z-buffers, and filtered linear depth"


def _case(name: str, source: str, size: tuple[int, int], *more: Any, **words: Any) -> Case:
    return Case(f"singlepass_{name}", "singlepass", source, size, *more, **words)


def cases(level: str) -> list[Case]:
    """The cases of a level."""
    return _LEVELS[level]()


def numbers(params: Params, rows: str) -> dict[str, Any]:
    """What the loop needs beside its parameters, and those that follow from others."""
    step = 1 if params.row_order == rows else -1
    return {"row_step": step, "loop_bound": params.bound, "radius_start": params.first_radius}


def of_circles(stage: str, low: Float, high: Float, params: Params) -> tuple[Float, Float] | None:
    """Bounds of the stages that are made of the circles of pixels."""
    if stage not in ("size", "limit"):
        return None
    least, greatest = size_bounds(low, high, params.max_blur_size)
    factor = params.behind_factor if stage == "limit" else 1.0
    return factor * least, factor * greatest


def _core() -> list[Case]:
    finer, smaller = {"rad_scale": 0.4, "max_blur_size": 12.0}, {"max_blur_size": 6.0}
    coarser = {"rad_scale": 1.0, "behind_factor": 0.5}  # below 1, a cut before the factor and ">=" for ">" show
    return [
        _case("ramp", "ramp", (48, 36)),
        _case("impulses", "impulses", (48, 48)),
        _case("constant", "constant", (40, 30)),
        _case("cards", "cards", (56, 42), stages=_STEPS),
        _case("cards_rows_up", "cards", (56, 42), _UP, "up", origin=_ROWS),
        _case("cards_mirrored", "cards", (56, 42), _UP, tags=_MIRRORED, origin=_ROWS),
        _case("bar", "bar", (48, 36)),
        _case("hdr", "hdr", (48, 36)),
        _case("scene", "scene", (64, 48)),
        _case("noise_256_wide", "noise", (256, 10)),
        _case("noise_320_wide", "noise", (320, 9)),
        _case("noise_317_wide", "noise", (317, 9)),
        _case("noise_239_high", "noise", (11, 239)),
        _case("noise_rows_up", "noise", (53, 41), _UP, "up", origin=_ROWS),
        _case("cards_finer", "cards", (48, 36), finer, tags=("params",), origin=_CONSTANTS),
        _case("noise_coarser", "noise", (48, 36), coarser, tags=("params",), origin=_CONSTANTS),
        _case("hdr_smaller", "hdr", (48, 36), smaller, tags=("params",), origin=_CONSTANTS),
    ]


def _full() -> list[Case]:
    plain = ("ramp", "impulses", "constant", "cards", "bar", "hdr", "noise", "scene")
    found = [
        _case(f"{source}_{width}x{height}{'_up' if rows == 'up' else ''}", source, (width, height), params, rows)
        for source in plain
        for width, height in SIZES
        for params, rows in (({}, "down"), (_UP, "up"))
    ]
    for source in ("cards", "noise"):
        for width, height in SIZES:
            name = f"{source}_{width}x{height}"
            found.append(_case(f"{name}_mirrored", source, (width, height), _UP, tags=_MIRRORED, origin=_ROWS))
        found.append(_case(f"{source}_stages", source, SIZES[0], stages=Stages((1, 4, 16, 64))))
        for word, params in (("6", {"max_blur_size": 6.0}), ("coarse", {"rad_scale": 1.0})):
            found.append(
                _case(f"{source}_320x240_{word}", source, SIZES[1], params, tags=("params",), origin=_CONSTANTS)
            )
        for word in ("bilinear", "bilinear_depth"):
            found += [
                _case(
                    f"{source}_{width}x{height}_{word}", source, (width, height), {"depth_filter": word},
                    tags=("depth_filter",), origin=_FILTERS,
                )
                for width, height in SIZES[1:]
            ]  # fmt: skip
    return found


def _extreme() -> list[Case]:
    some = ("extreme", "params")
    return [
        *(_case(made.__name__, made.__name__, (36, 27), tags=("extreme",)) for made in extremes.INPUTS),
        *(
            _case(f"noise_{width}x{height}", "noise", (width, height), tags=("extreme",))
            for width, height in ((1, 1), (2, 2), (1, 40), (40, 1), (3, 130))
        ),
        _case("noise_no_taps", "noise", (20, 15), {"max_taps": 0}, tags=some),
        _case("noise_uncut", "noise", (36, 27), {"max_blur_size": 1e6, "loop_bound": 20.0}, tags=some),
        _case("noise_nothing_behind", "noise", (36, 27), {"behind_factor": 0.0}, tags=some),
    ]


_LEVELS = {"core": _core, "full": _full, "extreme": _extreme}

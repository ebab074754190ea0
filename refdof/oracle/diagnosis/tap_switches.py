"""Tap switches: mistakes of where taps lie and of what is read there."""

import math
from dataclasses import replace
from itertools import pairwise, product
from typing import Any

from refdof.methods.singlepass.params import GOLDEN_ANGLE
from refdof.oracle.diagnosis.emulate import spiral_of
from refdof.oracle.diagnosis.model import Model
from refdof.oracle.diagnosis.samples import Shot
from refdof.oracle.diagnosis.switches import Change, Switch, expecting, setting

__all__ = ["tap_switches"]

_SHIFTS = {
    "all reads are": ("shift_color", "shift_depth", "shift_center_color", "shift_center_depth"),
    "taps are": ("shift_color", "shift_depth"),
    "colour is": ("shift_color", "shift_center_color"),
    "depth is": ("shift_depth", "shift_center_depth"),
    "colour of taps is": ("shift_color",),
    "depth of taps is": ("shift_depth",),
    "the pixel itself is": ("shift_center_color", "shift_center_depth"),
}
_SIZES = (
    (1920, 1080), (1280, 720), (1024, 768), (800, 600), (640, 480), (512, 512), (256, 256), (1024, 1024),
)  # fmt: skip


def tap_switches(right: Model) -> list[Switch]:
    """Mistakes of the stage taps."""
    return [*_spiral(right), *_loop(right), *_places(), *_readings()]


def _spiral(right: Model) -> list[Switch]:
    scales = (0.1, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.75, 0.8, 1.0, 1.2, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0)
    step, first = right.angle_step, right.radius_start
    advanced = first + right.rad_scale / first

    def start(shot: Shot, value: float) -> dict[str, Any]:
        words = ": it is advanced first" if value == shot.right.angle_step else ""
        return {"value": value, "expected": shot.right.angle_start, "words": words}

    starts = (step, *(k * math.pi / 4 for k in range(-3, 5) if k))
    axes = {
        "sc": "sine and cosine instead of cosine and sine: the spiral is transposed",
        "ss": "the sine in x and in y: taps lie on a line",
        "cc": "the cosine in x and in y: taps lie on a line",
        "-cs": "mirrored left to right",
    }
    growth = {"constant": "RAD_SCALE", "ratio": "itself"}
    radii = (advanced, 2.0 * first, 0.01, 0.1, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0)
    rad_scale = expecting("rad_scale")
    return [
        Switch("rad_scale", setting("rad_scale", "radius_start"), scales, rad_scale, fits=True),
        Switch("rad_scale", setting("rad_scale"), scales, rad_scale, fits=True),
        Switch("angle_step", setting("angle_step"), _angles(step), expecting("angle_step"), fits=True),
        Switch("angle_start", setting("angle_start"), starts, start, fits=True),
        Switch("radius_start", setting("radius_start"), radii, expecting("radius_start"), fits=True),
        Switch("radius_growth", setting("growth"), tuple(growth), lambda s, v: {"words": growth[v]}),
        Switch("row_order", lambda model, value: replace(model, row_step=value * model.row_step), [-1]),
        Switch("row_order", setting("row_step"), [1, -1]),
        Switch("axes_swapped", setting("axes"), tuple(axes), lambda s, v: {"words": axes[v]}),
    ]


def _angles(step: float) -> list[float]:
    """Wrong digits and swapped digits of a step, short forms of it, and what else ports have."""
    digits, found = f"{step:.8f}", []
    places = [k for k, letter in enumerate(digits) if letter.isdigit()]
    for k in places:
        found += [digits[:k] + other + digits[k + 1 :] for other in "0123456789" if other != digits[k]]
        found.append(digits[:k] + digits[k + 1 :])
    for a, b in pairwise(places):
        swapped = list(digits)
        swapped[a], swapped[b] = swapped[b], swapped[a]
        found.append("".join(swapped))
    found += [f"{step:.{k}f}" for k in range(1, 8)]
    others = (
        GOLDEN_ANGLE, 137.508, 137.5, 1.618033989, 0.618033989, 2.618033989, math.pi / 2, math.pi / 4, 1.0,
    )  # fmt: skip
    return [*dict.fromkeys(float(text) for text in found if float(text) != step), *others]


def _loop(right: Model) -> list[Switch]:
    count = len(spiral_of(right))

    def ends(shot: Shot, value: int) -> dict[str, Any]:
        more = spiral_of(replace(shot.right, bound=math.inf, max_taps=value + 1))
        all_taps = len(spiral_of(shot.right))
        return {"value": more[-1, 2], "expected": shot.right.bound, "count": value, "counts": all_taps}

    def bound(shot: Shot, value: float) -> dict[str, Any]:
        all_taps, taps = (len(spiral_of(model)) for model in (shot.right, replace(shot.right, bound=value)))
        return {"value": value, "expected": shot.right.bound, "count": taps, "counts": all_taps}

    gone = {"what": "missing"}
    few = sorted({int(count * k / 24) for k in range(1, 24)} | {1, 4, 8, 16, 32, 64, 100, 128, 200, 256, 300})
    fewer = [k for k in few if 0 < k < count] + [count - 2, count - 1]
    more = [count + 1, count + 2, *(int(count * k / 8) for k in range(9, 17)), 3 * count, 4 * count]

    def longer(model: Model, value: int) -> Model:
        return replace(model, bound=math.inf, max_taps=value)

    return [
        Switch("loop_cut", setting("max_taps"), fewer, ends, fits=True, whole=True),
        Switch("loop_long", longer, more, ends, fits=True, whole=True),
        Switch("loop_long", setting("bound"), [1.1 * right.bound, 2.0 * right.bound, 20.0, 30.0, 40.0], bound),
        _faulty_tap(0, "missing"),
        _faulty_tap(2, "taken twice"),
        Switch(
            "tap_missing",
            setting("tap_stride"),
            (2, 3, 4),
            lambda s, v: {"words": f"every tap but each {v}. one", **gone},
        ),
    ]


def _faulty_tap(times: int, words: str) -> Switch:
    return Switch(
        "tap_missing",
        lambda model, value: replace(model, tap_fault=(value - 1, times)),
        tuple(range(1, 13)),
        lambda s, v: {"words": f"tap {v}", "what": words},
    )


def _places() -> list[Switch]:
    one = [pair for pair in product((-1.0, 0.0, 1.0), repeat=2) if pair != (0.0, 0.0)]
    steps = [(length * x, length * y) for length in (0.5, 1.0) for x, y in one]

    def added(names: tuple[str, ...]) -> Change:
        def change(model: Model, value: tuple[float, float]) -> Model:
            moved: dict[str, Any] = {}
            for name in names:
                x, y = getattr(model, name)
                moved[name] = (x + value[0], y + value[1])
            return replace(model, **moved)

        return change

    def size(shot: Shot, value: tuple[int, int]) -> dict[str, Any]:
        own = shot.depth.shape[1], shot.depth.shape[0]
        width, height = (own[part] if part in (0, 1) else part for part in value)
        words = f": its pixel size is that of {width} x {height}"
        return {"x": own[0] / width, "y": own[1] / height, "words": words}

    def spans(x: bool, y: bool) -> Switch:
        return Switch(
            "pixel_size",
            lambda model, value: replace(
                model, scale=(model.scale[0] * (value if x else 1.0), model.scale[1] * (value if y else 1.0))
            ),
            (0.25, 0.5, 0.75, 0.9, 1.1, 1.25, 1.5, 2.0),
            lambda s, v: {"x": v if x else 1.0, "y": v if y else 1.0, "words": ""},
            fits=True,
        )

    def shifted(what: str, names: tuple[str, ...]) -> Switch:
        return Switch("shift", added(names), steps, lambda s, v: {"words": what, "x": v[0], "y": v[1]}, fits=True)

    return [
        *(shifted(what, names) for what, names in _SHIFTS.items()),
        Switch("pixel_size", setting("pixel_size"), ((0, 0), (1, 1), (1, 0), *_SIZES), size),
        spans(True, True),
        spans(True, False),
        spans(False, True),
    ]


def _readings() -> list[Switch]:
    filters = {
        "nearest": "at the nearest texel", "bilinear": "by a blend of four texels",
        "bilinear_x": "by a blend along x only", "bilinear_y": "by a blend along y only",
        "bilinear_depth": "by a blend of four depths",
    }  # fmt: skip

    def reading(name: str, values: tuple[str, ...]) -> Switch:
        return Switch(
            name,
            setting(name),
            values,
            lambda s, v: {"words": filters[v], "expected": filters[getattr(s.right, name)]},
        )

    borders = {"repeat": "wraps round", "mirror": "is mirrored", "black": "is black"}

    def beyond(names: tuple[str, ...], what: str) -> Switch:
        return Switch("border", setting(*names), tuple(borders), lambda s, v: {"words": f"{what} {borders[v]}"})

    return [
        reading("color_filter", ("nearest", "bilinear", "bilinear_x", "bilinear_y")),
        reading("depth_filter", ("nearest", "bilinear", "bilinear_depth")),
        beyond(("border_color", "border_depth"), "the picture"),
        beyond(("border_color",), "colour"),
        beyond(("border_depth",), "depth"),
    ]

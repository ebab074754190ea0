"""Switches: every known mistake, as a change of a model, with the values that are tried.

`switches` of taps, colours and the picture are in `tap_switches` and `image_switches`.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from refdof.oracle.diagnosis.model import Model
from refdof.oracle.diagnosis.samples import Shot

__all__ = ["Switch", "setting", "size_switches"]

Change = Callable[[Model, Any], Model]
Words = Callable[[Shot, Any], dict[str, Any]]


def _value(shot: Shot, value: Any) -> dict[str, Any]:
    return {"value": value}


class Switch(NamedTuple):
    """A mistake.

    key : one of `refdof.oracle.diagnosis.causes.CAUSES`
    change : what it makes of a model, for a value
    values : what is tried
    words : what completes the sentence, for a picture and a value
    fits : whether numbers between the values are tried, too
    whole : whether only whole numbers are
    """

    key: str
    change: Change
    values: Sequence[Any]
    words: Words = _value
    fits: bool = False
    whole: bool = False


def setting(*names: str) -> Change:
    """A change that sets parameters to its value."""

    def change(model: Model, value: Any) -> Model:
        values: dict[str, Any] = dict.fromkeys(names, value)
        return replace(model, **values)

    return change


def expecting(name: str) -> Words:
    """Words for a value beside the one of a right port."""
    return lambda shot, value: {"value": value, "expected": getattr(shot.right, name)}


def size_switches() -> list[Switch]:
    """Mistakes of the stages coc, size and limit, and of weights and means.

    Of several that give the same, such as no limit and depths that are behind everything, the first is named.
    """
    return [*_circles(), *_limits(), *_sizes(), *_weights(), *_means(), *_depths()]


def _circles() -> list[Switch]:
    factors = (2.0, 0.5, 4.0, 0.25, 1.5, 0.75, 0.1, 10.0, 0.05)

    def words(shot: Shot, value: float) -> dict[str, Any]:
        said = {2.0: ": diameters are taken for radii", 0.5: ": radii are taken for diameters"}
        return {"value": value, "words": said.get(value, "")}

    def scaled(model: Model, value: float) -> Model:
        return replace(model, coc_scale=model.coc_scale * value)

    def scaled_after(model: Model, value: float) -> Model:
        return replace(model, coc_scale=model.coc_scale * value, size_cap=model.size_cap * value)

    def law(name: str) -> Change:
        return lambda model, value: replace(model, law=name, law_scale=value)

    def focus(shot: Shot, value: float) -> dict[str, Any]:
        return {"value": shot.focus * value, "expected": shot.focus}

    slopes = (1.0, 2.0, 0.5, 0.25, 0.1, 0.03, 4.0, 10.0)

    def one_side(name: str, side: str) -> Switch:
        said = f" {side} the focal plane"
        return Switch("coc_scale", setting(name), factors, lambda s, v: {"value": v, "words": said}, fits=True)

    return [
        Switch("coc_scale", scaled, factors, words, fits=True),
        one_side("near_scale", "before"),
        one_side("far_scale", "behind"),
        Switch("coc_scale", scaled_after, factors, words, fits=True),
        Switch("coc_near_lost", setting("near_scale"), [0.0]),
        Switch("coc_far_lost", setting("far_scale"), [0.0]),
        Switch("coc_unclamped", setting("size_cap"), [math.inf]),
        Switch("coc_linear", law("linear"), slopes, fits=True),
        Switch("coc_linear", law("linear_far"), slopes, fits=True),
        Switch("coc_smoothstep", law("smoothstep"), slopes, fits=True),
        Switch("depth_constant", law("constant"), (20.0, 10.0, 5.0, 2.0, 1.0, 0.5), fits=True),
        Switch("focus", setting("focus_factor"), (0.5, 0.75, 0.9, 1.1, 1.25, 1.5, 2.0, 4.0), focus, fits=True),
        Switch("focus_from_near", setting("focus_add"), [1.0]),
    ]


def _depths() -> list[Switch]:
    ratios = (0.0, 0.01, 0.1, 0.5, 0.9, 1.1, 2.0, 10.0, 100.0)
    words = {0.0: ": it is not multiplied by the far plane"}

    def scale(shot: Shot, value: float) -> dict[str, Any]:
        return {"value": value or 1.0 / shot.far, "words": words.get(value, "")}

    def radial(circles: bool) -> Change:
        return lambda model, value: replace(model, depth="radial", radial=value, depth_of_circles=circles)

    both, tap, center = ("depth_scale_tap", "depth_scale_center"), ("depth_scale_tap",), ("depth_scale_center",)

    def scaled(names: tuple[str, ...], circles: bool) -> Change:
        change = setting(*names)
        return lambda model, value: replace(change(model, value), depth_of_circles=circles)

    rounded = {"half_float": "half floats", "half_share": "half floats of depth / far"}
    rounded.update({"8 bits": "8 bits of depth / far", "16 bits": "16 bits of depth / far"})
    reversed_as = ("reversed", "reversed_from_far", "reversed_device", "inverse")
    tangents = (0.3, 0.4142, 0.5, 0.57735, 0.7, 1.0)
    return [
        Switch("depth_reversed", setting("depth"), reversed_as),
        Switch("depth_device", setting("depth"), ("device", "decoded")),
        Switch("depth_radial", radial(True), tangents, fits=True),
        Switch("depth_radial", radial(False), tangents, fits=True),
        Switch("depth_scale", scaled(both, True), ratios, scale, fits=True),
        Switch("depth_scale_tap", scaled(tap, True), ratios, scale, fits=True),
        Switch("depth_scale_tap", scaled(tap, False), ratios, scale),
        Switch("depth_scale_center", scaled(center, True), ratios, scale, fits=True),
        Switch("depth_scale_center", scaled(center, False), ratios, scale),
        Switch("depth_quantized", setting("depth"), tuple(rounded), lambda s, v: {"words": rounded[v]}),
        Switch("depth_flipped", setting("depth_flip"), ("y", "x"), lambda s, v: {"words": f"in {v}"}),
    ]


def _sizes() -> list[Switch]:
    caps = (2.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 15.0, 16.0, 18.0, 19.0, 20.0, 21.0, 22.0, 25.0, 30.0, 32.0, 40.0, 50.0)

    def wider(model: Model, value: float) -> Model:
        ratio = value / model.size_cap
        return replace(model, size_cap=value, bound=value, coc_scale=model.coc_scale * ratio)

    def larger(model: Model, value: float) -> Model:
        return replace(model, size_cap=value, coc_scale=model.coc_scale * value / model.size_cap)

    cap, said = expecting("size_cap"), {"center": "the pixel's own", "min": "the smaller of the tap's and the pixel's"}
    said.update({"max": "the larger of the tap's and the pixel's", "mean": "the mean of the tap's and the pixel's"})
    return [
        Switch("max_blur_size", setting("size_cap", "bound"), caps, cap, fits=True),
        Switch("max_blur_size", wider, caps, cap, fits=True),
        Switch("max_blur_size", larger, caps, cap, fits=True),
        Switch("size_cap", setting("size_cap"), caps, cap, fits=True),
        Switch("size_rule", setting("size_rule"), tuple(said), lambda s, v: {"words": said[v]}),
        Switch("size_floor", setting("size_floor"), (0.5, 1.0, 1.5, 2.0, 4.0), fits=True),
    ]


def _limits() -> list[Switch]:
    taps = {
        "behind": "taps behind the pixel", "front": "taps before the pixel", "always": "all taps",
        "differs": "taps before or behind the pixel", "size": "taps with a larger circle",
        "size_below": "taps with a smaller circle", "signed_size": "taps with a greater signed circle",
    }  # fmt: skip
    factors = (0.0, 0.25, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0, 10.0, math.inf)

    def factor(shot: Shot, value: float) -> dict[str, Any]:
        said = ["any number of" if one == math.inf else one for one in (value, shot.right.behind_factor)]
        return {"value": said[0], "expected": said[1]}

    def order(shot: Shot, value: str) -> dict[str, Any]:
        return {"words": taps[value], "expected": taps[shot.right.order]}

    return [
        Switch("behind_factor", setting("behind_factor"), factors, factor, fits=True),
        Switch("order_rule", setting("order"), tuple(taps), order),
        Switch("coc_sign", setting("order"), ["signed_size_flipped"]),
    ]


def _weights() -> list[Switch]:
    shapes = {"linear": "linear", "step": "a step at the radius", "step_low": "a step half a pixel before the radius"}
    shapes["from_zero"] = "a smoothstep from 0 to the radius"
    rules = {
        "all": "fully, whether its disc reaches or not",
        "inverse": "where its disc does not reach",
        "square": "by the square of its cover",
        "area": "by its cover over its area",
    }
    return [
        Switch("smoothstep_width", setting("rim_width"), (0.01, 0.1, 0.25, 0.5, 1.5, 2.0, 3.0, 4.0), fits=True),
        Switch("smoothstep_offset", setting("rim_offset"), (-2.0, -1.0, -0.5, -0.25, 0.25, 0.5, 1.0, 2.0), fits=True),
        Switch("smoothstep_shape", setting("rim_shape"), tuple(shapes), lambda s, v: {"words": shapes[v]}),
        Switch("weight_rule", setting("weight_rule"), tuple(rules), lambda s, v: {"words": rules[v]}),
    ]


def _means() -> list[Switch]:
    rules = {
        "nothing": "nothing", "sum": "the sum so far", "weighted": "nothing, and does not count",
        "next_total": "the sum over a total that counts it already", "center": "the pixel's own colour",
    }  # fmt: skip
    divisors = {"taps": "one too few", "next": "one too many", "none": "nothing"}

    def no_center(model: Model, value: float) -> Model:
        return replace(model, center_share=0.0, initial_total=value)

    return [
        Switch("initial_total", setting("initial_total"), (1e-6, 1e-4, 1e-3, 0.01, 0.1, 0.5, 2.0, 10.0), fits=True),
        Switch("mean_rule", setting("mean_rule"), tuple(rules), lambda s, v: {"words": rules[v]}),
        Switch("center_missing", no_center, (1.0, 1e-6, 1e-4, 1e-3, 0.01)),
        Switch("divisor", setting("divisor"), tuple(divisors), lambda s, v: {"words": divisors[v]}),
    ]

"""Causes: what may be wrong with a port of the single pass: a key, the stage that it belongs to, and a sentence.

Stages, in the order of the loop:

    coc      depth, as it is decoded, and the circle of confusion made of it
    size     the size of a pixel's or a tap's circle, after the cut at the largest blur
    limit    the cut of taps from behind
    taps     where taps lie, how many there are, and how colour and depth are read there
    weight   how far a tap counts
    mean     the running mean, its start and its divisor
    image    what is done to colours before or after, and to the picture as a whole

A sentence is completed with the values that were fitted, by `refdof.oracle.diagnosis.wording`.
"""

from typing import NamedTuple

from refdof._check import InputError

__all__ = ["CAUSES", "NONE", "STAGES", "UNEXPLAINED", "Cause", "cause_of"]

STAGES = ("coc", "size", "limit", "taps", "weight", "mean", "image")


class Cause(NamedTuple):
    """One mistake.

    `sentence` has places {…} for fitted values; right: places with what a right port has there, where that is not said.
    """

    key: str
    stage: str
    sentence: str
    right: tuple[tuple[str, float], ...] = ()


_ONE, _ZERO = (("value", 1.0),), (("value", 0.0),)


NONE = Cause("none", "", "no difference: the results are within the bounds of all cases that were compared")
UNEXPLAINED = Cause(
    "unexplained", "", "unexplained: none of the known mistakes, nor two or three together, gives this output"
)

CAUSES = (
    # The circle of confusion, and depth before it.
    Cause("coc_scale", "coc", "circles are {value:.4g} times as large{words}", _ONE),
    Cause("coc_near_lost", "coc", "circles before the focal plane are lost: near objects stay sharp"),
    Cause("coc_far_lost", "coc", "circles behind the focal plane are lost: far objects stay sharp"),
    Cause("coc_sign", "coc", "the sign of circles decides the order, and is flipped"),
    Cause("coc_linear", "coc", "circles are linear in depth instead of in 1 / depth"),
    Cause("coc_smoothstep", "coc", "circles are a smoothstep of depth instead of linear in 1 / depth"),
    Cause("focus", "coc", "the focal plane is at a depth of {value:.4g} instead of {expected:.4g}"),
    Cause("focus_from_near", "coc", "focus is measured from the near plane instead of the lens"),
    Cause("depth_reversed", "coc", "depth is taken in reverse: near is far"),
    Cause("depth_device", "coc", "device depth (of a z-buffer) is taken as linear depth"),
    Cause("depth_radial", "coc", "depth is the distance from the eye instead of along the axis"),
    Cause("depth_quantized", "coc", "depth is rounded to {words}"),
    Cause("depth_scale", "coc", "depth is {value:.4g} times as large{words}", _ONE),
    Cause("depth_scale_tap", "coc", "a tap's depth is {value:.4g} times as large, the pixel's own is not", _ONE),
    Cause("depth_scale_center", "coc", "the pixel's own depth is {value:.4g} times as large, the taps' are not", _ONE),
    Cause("depth_constant", "coc", "depth is the same everywhere: one size of {value:.4g} px for all pixels"),
    Cause("depth_flipped", "coc", "depth is flipped {words} against colour"),
    # Sizes.
    Cause("coc_unclamped", "size", "circles are not cut at the largest blur"),
    Cause("max_blur_size", "size", "MAX_BLUR_SIZE is {value:.4g} px instead of {expected:.4g}"),
    Cause("size_cap", "size", "circles are cut at {value:.4g} px instead of {expected:.4g}, the loop is not"),
    Cause("size_rule", "size", "the size that decides is {words} instead of the tap's own"),
    Cause("size_floor", "size", "no circle is smaller than {value:.4g} px", _ZERO),
    # The limit from behind.
    Cause(
        "behind_factor",
        "limit",
        "taps from behind count up to {value:.4g} times the pixel's own size instead of {expected:.4g}",
    ),
    Cause("order_rule", "limit", "the limit of the pixel's own size holds for {words} instead of {expected}"),
    # Places of taps, and what is read there.
    Cause("rad_scale", "taps", "RAD_SCALE is {value:.4g} instead of {expected:.4g}"),
    Cause("angle_step", "taps", "the angle between taps is {value:.9g} instead of {expected:.9g}"),
    Cause("angle_start", "taps", "the spiral starts at an angle of {value:.6g} instead of {expected:.4g}{words}"),
    Cause("radius_start", "taps", "the first tap is at a radius of {value:.4g} px instead of {expected:.4g}"),
    Cause("radius_growth", "taps", "the radius grows by {words} instead of RAD_SCALE / radius"),
    Cause(
        "loop_cut", "taps", "the loop stops at radius {value:.3g} px of {expected:.4g}, after {count} taps of {counts}"
    ),
    Cause(
        "loop_long",
        "taps",
        "the loop runs to radius {value:.3g} px instead of {expected:.4g}, {count} taps instead of {counts}",
    ),
    Cause("row_order", "taps", "rows are taken the other way round: the spiral is mirrored"),
    Cause("axes_swapped", "taps", "the directions of taps are {words}"),
    Cause(
        "pixel_size", "taps", "a radius of 1 spans {x:.4g} px in x and {y:.4g} px in y{words}", (("x", 1.0), ("y", 1.0))
    ),
    Cause("shift", "taps", "{words} shifted by {x:+.2f} px in x and {y:+.2f} px in y", (("x", 0), ("y", 0))),
    Cause("color_filter", "taps", "colour is read {words} instead of {expected}"),
    Cause("depth_filter", "taps", "depth is read {words} instead of {expected}"),
    Cause("border", "taps", "beyond the border {words} instead of repeating the edge"),
    Cause("tap_missing", "taps", "{words} of the spiral is {what}"),
    Cause("angle_noise", "taps", "the spiral is turned by another angle at every pixel"),
    Cause("in_place", "taps", "the picture is read and written in place: taps read pixels that are blurred already"),
    # Weights of taps.
    Cause("smoothstep_width", "weight", "the rim of a disc is {value:.4g} px wide instead of 1", _ONE),
    Cause("smoothstep_offset", "weight", "the rim of a disc is moved by {value:+.3g} px", _ZERO),
    Cause("smoothstep_shape", "weight", "the rim of a disc is {words} instead of a smoothstep"),
    Cause("weight_rule", "weight", "a tap counts {words} instead of as far as its disc covers the pixel"),
    # The running mean.
    Cause("initial_total", "mean", "the total starts at {value:.4g} instead of 1", _ONE),
    Cause("mean_rule", "mean", "a tap that misses adds {words} instead of the mean so far"),
    Cause("center_missing", "mean", "the pixel's own colour is not counted"),
    Cause("divisor", "mean", "the sum is divided by {words} instead of the number of taps and the pixel"),
    # The picture as a whole.
    Cause("gamma", "image", "{words}{value:.4g}", _ONE),
    Cause("tone_map", "image", "colours are tone mapped ({words})"),
    Cause("clamp", "image", "colours are clamped to {value:.4g}{words}"),
    Cause("gain", "image", "colours are multiplied by {value:.4g}", _ONE),
    Cause("offset", "image", "{value:+.4g} is added to colours", _ZERO),
    Cause("channels", "image", "channels are in the order {words} instead of RGB"),
    Cause("flipped", "image", "the picture is flipped {words}"),
    Cause(
        "image_shift",
        "image",
        "the finished picture is shifted by {x:+d} px in x and {y:+d} px in y",
        (("x", 0), ("y", 0)),
    ),
    Cause("half_resolution", "image", "the picture is made at half its resolution"),
    Cause("quantized", "image", "colours are rounded to {words}"),
    Cause("early_out", "image", "pixels {words} are left as they are: nothing spreads over them"),
    Cause("no_blur", "image", "the picture is the input, not blurred"),
    Cause("constant", "image", "the picture is one colour"),
    Cause("not_finite", "image", "some values are NaN or infinite"),
    Cause("other_case", "image", "the results are those of the case {words}"),
)

_BY_KEY = {cause.key: cause for cause in (*CAUSES, NONE, UNEXPLAINED)}


def cause_of(key: str) -> Cause:
    """The cause with this key.

    Raises
    ------
    InputError
        If there is none.
    """
    if key not in _BY_KEY:
        raise InputError(f"key: got {key!r}; allowed are {', '.join(_BY_KEY)}")
    return _BY_KEY[key]

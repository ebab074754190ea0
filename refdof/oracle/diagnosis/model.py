"""Model: a port of the single pass with everything in it that ports have wrong, as parameters.

The defaults are the listing's loop. `emulate` runs a model at some pixels; `switches` lists what is tried.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from refdof.methods.singlepass.params import GOLDEN_ANGLE

__all__ = ["Model", "model_of"]

Pair = tuple[float, float]
Operations = tuple[tuple[str, float], ...]
_NOWHERE: Pair = (0.0, 0.0)


@dataclass(frozen=True)
class Model:
    """One port. A right one has the defaults, with the constants of its case.

    Parameters
    ----------
    depth : "planar", "reversed", "reversed_from_far", "reversed_device", "inverse", "device", "decoded", "radial",
        "half_float", "half_share", "8 bits", "16 bits"
        What the port takes for depth. `radial` is the tangent of half of the height, for "radial".
    depth_of_circles : bool
        Whether circles are made of that depth, too; else they are as given.
    depth_scale_tap, depth_scale_center : float
        Of depth as a tap, and the pixel itself, read it; 0: 1 / far.
    depth_flip : "", "x" or "y"
        Of depth and circles against colour.
    law : "lens", "linear", "linear_far", "smoothstep", "constant"
        How circles are made of depth; `law_scale` is a factor of their slope, or the circle itself [px].
    focus_factor, focus_add : float
        The port's focus is focus_factor * focus + focus_add * near.
    coc_scale : float
    near_scale, far_scale : float
        Of circles before and behind the focal plane.
    size_cap : float
        Largest size [px]; inf: none.
    size_floor : float
        Least size [px].
    size_rule : "tap", "center", "min", "max", "mean"
        Which size decides.
    behind_factor : float
    order : "behind", "front", "always", "differs", "size", "size_below", "signed_size", "signed_size_flipped"
        For which taps the limit holds.
    rad_scale, angle_step, angle_start, radius_start, bound : float
    max_taps : int
    growth : "over_radius", "constant", "ratio"
    row_step : +1 or -1
        Where the sine points to in the files.
    axes : "cs", "sc", "ss", "cc", "-cs"
        Cosine or sine of the angle, for x and for y.
    scale : (x, y)
    pixel_size : (width, height) or None
        The size of another picture that uPixelSize is of; 0 and 1 stand for the picture's own width and height.
    shift_color, shift_depth, shift_center_color, shift_center_depth : (x, y)
        Added to the place that a tap, or the pixel itself, reads [px], in the direction of rows in files.
    color_filter, depth_filter : as Params of the single pass
    border_color, border_depth : "clamp", "repeat", "mirror", "black"
    tap_fault : (index, times) or None
        One tap, counted from 0, is taken 0 times or twice.
    tap_stride : int
        Of the spiral's taps, every so many-th is taken.
    rim_width, rim_offset : float
        Of the smoothstep [px].
    rim_shape : "smoothstep", "linear", "step", "step_low", "from_zero"
    weight_rule : "cover", "all", "inverse", "square", "area"
    initial_total : float
    mean_rule : "mean", "nothing", "sum", "weighted", "next_total", "center"
    center_share : float
        Of the pixel's own colour at the start.
    divisor : "total", "taps", "next" or "none"
    before, after : ((name, value), ...)
        What is done to input and output colours, one after another; see `color_operations`.
    flip : "", "x", "y", "xy"
    image_shift : (x, y) int
        Of the finished picture [px].
    half : bool
        The picture is made of one pixel of four.
    early_out : (name, value)
        ("sharp", size [px]), ("sky", depth) or ("", 0): pixels that are left as they are.
    """

    depth: str = "planar"
    radial: float = 0.0
    depth_of_circles: bool = True
    depth_scale_tap: float = 1.0
    depth_scale_center: float = 1.0
    depth_flip: str = ""
    law: str = "lens"
    law_scale: float = 1.0
    focus_factor: float = 1.0
    focus_add: float = 0.0
    coc_scale: float = 1.0
    near_scale: float = 1.0
    far_scale: float = 1.0
    size_cap: float = 20.0
    size_floor: float = 0.0
    size_rule: str = "tap"
    behind_factor: float = 2.0
    order: str = "behind"
    rad_scale: float = 0.5
    angle_step: float = GOLDEN_ANGLE
    angle_start: float = 0.0
    radius_start: float = 0.5
    bound: float = 20.0
    max_taps: int = 4096
    growth: str = "over_radius"
    row_step: int = 1
    axes: str = "cs"
    scale: Pair = (1.0, 1.0)
    pixel_size: tuple[int, int] | None = None
    shift_color: Pair = _NOWHERE
    shift_depth: Pair = _NOWHERE
    shift_center_color: Pair = _NOWHERE
    shift_center_depth: Pair = _NOWHERE
    color_filter: str = "bilinear"
    depth_filter: str = "nearest"
    border_color: str = "clamp"
    border_depth: str = "clamp"
    tap_fault: tuple[int, int] | None = None
    tap_stride: int = 1
    rim_width: float = 1.0
    rim_offset: float = 0.0
    rim_shape: str = "smoothstep"
    weight_rule: str = "cover"
    initial_total: float = 1.0
    mean_rule: str = "mean"
    center_share: float = 1.0
    divisor: str = "total"
    before: Operations = ()
    after: Operations = ()
    flip: str = ""
    image_shift: tuple[int, int] = (0, 0)
    half: bool = False
    early_out: tuple[str, float] = ("", 0.0)


def model_of(params: Mapping[str, Any], rows: str) -> Model:
    """The right port of a case, from its `params` in case.json and the order of its rows."""

    def number(name: str, otherwise: float) -> float:
        value = params.get(name)
        return otherwise if value is None else float(value)

    rad_scale, largest = number("rad_scale", 0.5), number("max_blur_size", 20.0)
    shift = number("shift_x", 0.0), number("shift_y", 0.0)
    border = str(params.get("border") or "clamp")
    order = {"depth": "behind", "size": "signed_size", "always": "always"}[str(params.get("order") or "depth")]
    most = params.get("max_taps")
    return Model(
        size_cap=largest,
        behind_factor=number("behind_factor", 2.0),
        order=order,
        rad_scale=rad_scale,
        angle_step=number("angle_step", GOLDEN_ANGLE),
        angle_start=number("angle_start", 0.0),
        radius_start=number("radius_start", rad_scale),
        bound=number("loop_bound", largest),
        max_taps=4096 if most is None else int(most),
        row_step=1 if str(params.get("row_order") or "down") == rows else -1,
        scale=(number("scale_x", 1.0), number("scale_y", 1.0)),
        shift_color=shift,
        shift_depth=shift,
        shift_center_color=shift,
        shift_center_depth=shift,
        color_filter=str(params.get("color_filter") or "bilinear"),
        depth_filter=str(params.get("depth_filter") or "nearest"),
        border_color=border,
        border_depth=border,
    )

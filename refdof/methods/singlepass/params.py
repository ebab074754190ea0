"""Params of the single pass: what the article leaves open, and every constant of its listing that ports change.

The defaults are the listing's, but for the filters, which it leaves to the host.
"""

from dataclasses import dataclass

from refdof._check import InputError, as_choice, as_integer, as_number

__all__ = [
    "BORDERS",
    "COLOR_FILTERS",
    "DEPTH_FILTERS",
    "GOLDEN_ANGLE",
    "MAX_BLUR_SIZE",
    "ORDERS",
    "PRECISIONS",
    "RAD_SCALE",
    "ROW_ORDERS",
    "Params",
]

COLOR_FILTERS = ("bilinear", "nearest")
DEPTH_FILTERS = ("nearest", "bilinear", "bilinear_depth")
ROW_ORDERS = ("down", "up")
ORDERS = ("depth", "size", "always")
BORDERS = ("clamp", "repeat", "mirror")
PRECISIONS = ("float64", "float32")

GOLDEN_ANGLE = 2.39996323  # [1] of `method`, listing
MAX_BLUR_SIZE = 20.0  # px, the same
RAD_SCALE = 0.5  # the same: smaller is nicer, larger is faster
_BEHIND = 2.0  # the same
_LARGEST_REACH = 256.0  # px: bounds the margin of padded planes
_MOST_TAPS = 65536  # of a pixel; the default radius scale makes as many within the largest reach
_LARGEST_SIZE = 1e6  # px: larger than any picture, for ports that do not clamp
_LARGEST_ANGLE = 1e6
_LEAST = 1e-6  # px, px^2: its quotients stay in float32


@dataclass(frozen=True)
class Params:
    """What the article leaves open, and the constants of its listing.

    Parameters
    ----------
    depth_filter : one of `refdof.methods.singlepass.params.DEPTH_FILTERS`
        How taps read depth: from the nearest texel; by a blend of inverse depths, as of a z-buffer; or by a blend of
        depths, as of a texture of linear depth. The last needs circles that are a - b / depth, as every thin lens has.
    color_filter : one of `refdof.methods.singlepass.params.COLOR_FILTERS`
        How taps read colour.
    rad_scale : float
        RAD_SCALE: the radius grows by this over itself [px^2], 1e-6 .. 256.
    max_blur_size : float
        MAX_BLUR_SIZE: circles are cut at this radius [px], 1e-6 .. 1e6.
    behind_factor : float
        A tap from behind counts up to this many times the pixel's own size; 0 .. 1e6.
    angle_start, angle_step : float
        Angle of the first tap and GOLDEN_ANGLE, the step to the next [radians]. Ports that step first start at a step.
    radius_start : float or None
        Radius of the first tap [px], 1e-6 .. 256. None: `rad_scale`.
    loop_bound : float or None
        The loop runs while the radius is below this [px], 1e-6 .. 256. None: `max_blur_size`.
    max_taps : int or None
        The loop ends after so many taps, 0 .. 65536. None: at its bound.
    row_order : one of `refdof.methods.singlepass.params.ROW_ORDERS`
        Where the listing's second texture coordinate grows to: "up" mirrors the spiral, as OpenGL's rows do.
    scale_x, scale_y : float
        Pixels that a radius of 1 spans, -4 .. 4; where a port's uPixelSize is of another picture, not 1.
    shift_x, shift_y : float
        What is added to every texture coordinate [px, right and down], the pixel's own included; -16 .. 16.
    order : one of `refdof.methods.singlepass.params.ORDERS`
        What tells that a tap lies behind: a greater depth; a greater signed size; nothing, all are held back.
    border : one of `refdof.methods.singlepass.params.BORDERS`
        What lies beyond the border, for colour and depth: OpenGL's wrap modes.
    precision : one of `refdof.methods.singlepass.params.PRECISIONS`
        The type in which angle and radius are added up. Shaders have "float32", which is less than 0.0007 px off with
        the listing's constants, but up to some pixels with thousands of taps.
    """

    depth_filter: str = "nearest"
    color_filter: str = "bilinear"
    rad_scale: float = RAD_SCALE
    max_blur_size: float = MAX_BLUR_SIZE
    behind_factor: float = _BEHIND
    angle_start: float = 0.0
    angle_step: float = GOLDEN_ANGLE
    radius_start: float | None = None
    loop_bound: float | None = None
    max_taps: int | None = None
    row_order: str = "down"
    scale_x: float = 1.0
    scale_y: float = 1.0
    shift_x: float = 0.0
    shift_y: float = 0.0
    order: str = "depth"
    border: str = "clamp"
    precision: str = "float64"

    def __post_init__(self) -> None:
        for name, words in _WORDS.items():
            as_choice(name, getattr(self, name), words)
        for name, (least, greatest) in _NUMBERS.items():
            number = as_number(name, getattr(self, name), minimum=least, maximum=greatest)
            object.__setattr__(self, name, number)
        for name in ("radius_start", "loop_bound"):
            if getattr(self, name) is not None:
                number = as_number(name, getattr(self, name), minimum=_LEAST, maximum=_LARGEST_REACH)
                object.__setattr__(self, name, number)
        if self.max_taps is not None:
            most = as_integer("max_taps", self.max_taps, minimum=0, maximum=_MOST_TAPS)
            object.__setattr__(self, "max_taps", most)
        if self.bound > _LARGEST_REACH:
            raise InputError(
                f"max_blur_size: got {self.max_blur_size:g}; allowed without a loop_bound is at most {_LARGEST_REACH:g}"
            )
        taps = self.bound**2 / (2.0 * self.rad_scale)  # r^2 grows by more than 2 rad_scale a tap
        if taps > _MOST_TAPS and self.max_taps is None:
            raise InputError(
                f"rad_scale: got {self.rad_scale:g}, up to {taps:.0f} taps within {self.bound:g} px; allowed are at "
                f"most {_MOST_TAPS}: a larger rad_scale, or max_taps"
            )

    @property
    def bound(self) -> float:
        """The radius at which the loop ends [px]."""
        return self.max_blur_size if self.loop_bound is None else self.loop_bound

    @property
    def first_radius(self) -> float:
        """The radius of the first tap [px]."""
        return self.rad_scale if self.radius_start is None else self.radius_start


_WORDS = {
    "depth_filter": DEPTH_FILTERS,
    "color_filter": COLOR_FILTERS,
    "row_order": ROW_ORDERS,
    "order": ORDERS,
    "border": BORDERS,
    "precision": PRECISIONS,
}
_NUMBERS = {  # least, greatest
    "rad_scale": (_LEAST, _LARGEST_REACH),
    "max_blur_size": (_LEAST, _LARGEST_SIZE),
    "behind_factor": (0.0, _LARGEST_SIZE),
    "angle_start": (-_LARGEST_ANGLE, _LARGEST_ANGLE),
    "angle_step": (-_LARGEST_ANGLE, _LARGEST_ANGLE),
    "scale_x": (-4.0, 4.0),
    "scale_y": (-4.0, 4.0),
    "shift_x": (-16.0, 16.0),
    "shift_y": (-16.0, 16.0),
}

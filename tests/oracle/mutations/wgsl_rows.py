"""Wrong ports in WGSL, drawn by refdof itself."""

from tests.oracle.mutations.row import Row

__all__ = ["ROWS"]

_TURN = "vec2f(cos(angle), sin(angle))"
_MIX = "mix(color / total, colorAt(place), m)"
_OUT = "vec4f(depthOfField(position.xy * settings.uPixelSize), 1.0)"

_ROWS = (
    ("diameters for radii", "coc", "coc_scale",
     "* settings.focusScale, -1.0", "* 2.0 * settings.focusScale, -1.0"),
    ("circles before the focus are lost", "coc", "coc_near_lost",
     "focusScale, -1.0, 1.0)", "focusScale, 0.0, 1.0)"),
    ("the other side is limited", "limit", "order_rule",
     "tapDepth > centerDepth", "tapDepth < centerDepth"),
    ("the factor from behind is the listing's", "limit", "behind_factor",
     "centerSize * settings.uBehindFactor", "centerSize * 2.0"),
    ("the loop ends at half its bound", "taps", "loop_cut",
     "radius < settings.uMaxBlurSize;", "radius < 0.5 * settings.uMaxBlurSize;"),
    ("the spiral is mirrored", "taps", "row_order",
     _TURN, "vec2f(cos(angle), -sin(angle))"),
    ("the angle is advanced first", "taps", "angle_start",
     "var angle = 0.0;", "var angle = GOLDEN_ANGLE;"),
    ("the pixel at its corner", "taps", "shift",
     "position.xy * settings.uPixelSize", "floor(position.xy) * settings.uPixelSize"),
    ("taps wrap", "taps", "border",
     _MIX, "mix(color / total, colorAt(fract(place)), m)"),
    ("a hard rim", "weight", "smoothstep_shape",
     "smoothstep(radius - 0.5, radius + 0.5, tapSize)", "step(radius, tapSize)"),
    ("no mean where a tap misses", "mean", "mean_rule",
     _MIX, "colorAt(place) * m"),
    ("the total starts at 2", "mean", "initial_total",
     "var total = 1.0;", "var total = 2.0;"),
    ("colours are cut at 1", "image", "clamp",
     _OUT, f"min({_OUT}, vec4f(1.0))"),
)  # fmt: skip

ROWS = tuple(Row("wgsl", *row) for row in _ROWS)

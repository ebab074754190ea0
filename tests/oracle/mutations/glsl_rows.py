"""Wrong ports in GLSL, which make circles of depth by themselves."""

from tests.oracle.mutations.row import Row

__all__ = ["ROWS"]

_CIRCLE = "clamp((1.0 / focusPoint - 1.0 / depth) * focusScale, -1.0, 1.0)"
_START = "float radius = uRadScale;"
_BOUND = "radius < uMaxBlurSize;"
_TURN = "vec2(cos(angle), sin(angle))"
_AT = "gl_FragCoord.xy * uPixelSize)"
_LIMIT = "centerSize * uBehindFactor"
_RIM = "smoothstep(radius - 0.5, radius + 0.5, tapSize)"
_MIX = "mix(color / total, tapColor, m)"
_TAP_COLOR = "texture(uTexture, place).rgb"
_TAP_DEPTH = "texture(uDepth, place).r * uFar"
_OUT = "fragColor = vec4(depthOfField(gl_FragCoord.xy * uPixelSize), 1.0);"
_DRAWN = "depthOfField(gl_FragCoord.xy * uPixelSize)"
_TEXEL = "clamp(ivec2(floor(place / uPixelSize)), ivec2(0), textureSize(uTexture, 0) - 1)"
_RANDOM = "fract(sin(dot(gl_FragCoord.xy, vec2(12.9898, 78.233))) * 43758.5453)"

_ROWS = (
    # Depth, and circles of it
    ("circles are linear in depth", "coc", "coc_linear",
     "(1.0 / focusPoint - 1.0 / depth)", "((depth - focusPoint) / focusPoint)"),
    ("circles are a smoothstep of depth", "coc", "coc_smoothstep",
     _CIRCLE, "smoothstep(0.0, 4.0, abs(depth - focusPoint))"),
    ("circles before the focus are lost", "coc", "coc_near_lost",
     "focusScale, -1.0, 1.0)", "focusScale, 0.0, 1.0)"),
    ("circles behind the focus are lost", "coc", "coc_far_lost",
     "focusScale, -1.0, 1.0)", "focusScale, -1.0, 0.0)"),
    ("the focus is at depth 1", "coc", "focus",
     "1.0 / focusPoint - 1.0", "1.0 - 1.0"),
    ("circles are not cut", "size", "coc_unclamped",
     _CIRCLE, "(1.0 / focusPoint - 1.0 / depth) * focusScale"),
    ("diameters for radii", "coc", "coc_scale",
     "abs(coc) * uMaxBlurSize", "2.0 * abs(coc) * uMaxBlurSize"),
    ("MAX_BLUR_SIZE of circles is the listing's", "size", "max_blur_size",
     "abs(coc) * uMaxBlurSize", "abs(coc) * 20.0"),
    ("no circle is smaller than a pixel", "size", "size_floor",
     "return abs(coc) * uMaxBlurSize;", "return max(abs(coc) * uMaxBlurSize, 1.0);"),
    ("a tap's depth is not scaled", "coc", "depth_scale_tap",
     _TAP_DEPTH, "texture(uDepth, place).r"),
    ("the pixel's depth is not scaled", "coc", "depth_scale_center",
     "texture(uDepth, texCoord).r * uFar", "texture(uDepth, texCoord).r"),
    # The spiral
    ("the loop ends at half its bound", "taps", "loop_cut",
     _BOUND, "radius < 0.5 * uMaxBlurSize;"),
    ("the loop ends by an angle", "taps", "loop_cut",
     _BOUND, "radius < uMaxBlurSize && angle < 600.0;"),
    ("RAD_SCALE is twice as large", "taps", "rad_scale",
     "uniform float uRadScale = 0.5;", "uniform float unused; const float uRadScale = 1.0;"),
    ("MAX_BLUR_SIZE is the listing's", "size", "max_blur_size",
     "uniform float uMaxBlurSize = 20.0;", "uniform float unused; const float uMaxBlurSize = 20.0;"),
    ("the radius grows by a constant", "taps", "radius_growth",
     "radius += uRadScale / radius;", "radius += uRadScale;"),
    ("the spiral is mirrored", "taps", "row_order",
     _TURN, "vec2(cos(angle), -sin(angle))"),
    ("the spiral is transposed", "taps", "axes_swapped",
     _TURN, "vec2(sin(angle), cos(angle))"),
    ("a wrong digit of the golden angle", "taps", "angle_step",
     "2.39996323", "2.39966323"),
    ("the golden ratio for the golden angle", "taps", "angle_step",
     "2.39996323", "1.61803399"),
    ("the angle is advanced first", "taps", "angle_start",
     "float angle = 0.0;", "float angle = GOLDEN_ANGLE;"),
    ("the spiral is turned by noise", "taps", "angle_noise",
     "float angle = 0.0;", f"float angle = 6.2831853 * {_RANDOM};"),
    ("the ellipse of a scalar pixel size", "taps", "pixel_size",
     "* uPixelSize * radius", "* uPixelSize.x * radius"),
    ("the pixel size of a fixed picture", "taps", "pixel_size",
     "* uPixelSize * radius", "/ vec2(1920.0, 1080.0) * radius"),
    ("the pixel at its corner", "taps", "shift",
     _AT, "floor(gl_FragCoord.xy) * uPixelSize)"),
    ("half a pixel added", "taps", "shift",
     _AT, "(gl_FragCoord.xy + 0.5) * uPixelSize)"),
    ("half a pixel added to taps", "taps", "shift",
     "texCoord + vec2(cos(angle)", "texCoord + 0.5 * uPixelSize + vec2(cos(angle)"),
    # What a tap reads
    ("colour at the nearest texel", "taps", "color_filter",
     _TAP_COLOR, f"texelFetch(uTexture, {_TEXEL}, 0).rgb"),
    ("taps wrap", "taps", "border",
     "vec3 tapColor = texture(uTexture, place)", "vec3 tapColor = texture(uTexture, fract(place))"),
    ("taps beyond the border are black", "taps", "border",
     _TAP_COLOR, f"{_TAP_COLOR} * float(place == clamp(place, 0.0, 1.0))"),
    ("the tap's depth is read at the pixel", "size", "size_rule",
     _TAP_DEPTH, "texture(uDepth, texCoord).r * uFar"),
    ("the tap's colour is the pixel's", "image", "no_blur",
     _TAP_COLOR, "texture(uTexture, texCoord).rgb"),
    # Who may spread over whom
    ("the factor from behind is the listing's", "limit", "behind_factor",
     _LIMIT, "centerSize * 2.0"),
    ("no limit from behind", "limit", "behind_factor or order_rule",
     _LIMIT, "uMaxBlurSize"),
    ("the limit of the article's text", "limit", "behind_factor",
     _LIMIT, "centerSize"),
    ("the order is by size", "limit", "order_rule",
     "tapDepth > centerDepth", "tapSize > centerSize"),
    ("the other side is limited", "limit", "order_rule",
     "tapDepth > centerDepth", "tapDepth < centerDepth"),
    ("the smaller of both sizes", "size", "size_rule",
     "if (tapDepth > centerDepth)", "tapSize = min(tapSize, centerSize); if (false)"),
    ("a bias in the comparison of depths", "limit", "unexplained",
     "tapDepth > centerDepth", "tapDepth > centerDepth + 1.0"),
    # Weights and the mean
    ("a hard rim", "weight", "smoothstep_shape",
     _RIM, "step(radius, tapSize)"),
    ("the radius grows before the rim is found", "weight", "smoothstep_offset",
     "(radius - 0.5, radius + 0.5,", "(radius + 0.5, radius + 1.5,"),
    ("a rim of three pixels", "weight", "smoothstep_width",
     "(radius - 0.5, radius + 0.5,", "(radius - 1.5, radius + 1.5,"),
    ("the pixel's size decides", "size", "size_rule",
     "radius + 0.5, tapSize)", "radius + 0.5, centerSize)"),
    ("no mean where a tap misses", "mean", "mean_rule",
     _MIX, "tapColor * m"),
    ("the mean is the sum", "mean", "mean_rule",
     _MIX, "mix(color, tapColor, m)"),
    ("the mean is the pixel's colour", "mean", "mean_rule",
     _MIX, "mix(texture(uTexture, texCoord).rgb, tapColor, m)"),
    ("the arguments of mix are swapped", "weight", "weight_rule",
     _MIX, "mix(tapColor, color / total, m)"),
    ("the total starts at nothing", "mean", "initial_total",
     "float total = 1.0;", "float total = 1e-6;"),
    ("nothing over nothing", "mean", "not_finite or initial_total",
     "float total = 1.0;", "float total = 0.0;"),
    # The picture, and what was left in
    ("sharp pixels are left as they are", "image", "early_out",
     _START, f"if (centerSize < 0.5) return color; {_START}"),
    ("the sky is left as it is", "image", "early_out",
     _START, f"if (centerDepth >= uFar) return color; {_START}"),
    ("an early return is left in", "image", "no_blur",
     _START, f"{_START} if (radius > 0.0) return color;"),
    ("circles are shown", "image", "unexplained",
     "return color / total;", "return vec3(centerSize / uMaxBlurSize);"),
    ("colours are cut at 1", "image", "clamp",
     _OUT, f"fragColor = min(vec4({_DRAWN}, 1.0), 1.0);"),
    ("gamma in the pass", "image", "gamma",
     _OUT, f"fragColor = vec4(pow({_DRAWN}, vec3(1.0 / 2.2)), 1.0);"),
    ("a tone map in the pass", "image", "tone_map",
     _OUT, f"vec3 seen = {_DRAWN}; fragColor = vec4(seen / (1.0 + seen), 1.0);"),
    ("dither is added", "image", "unexplained",
     _OUT, f"fragColor = vec4({_DRAWN} + ({_RANDOM} - 0.5) / 255.0, 1.0);"),
    ("it does not compile", "", "error",
     "float total = 1.0;", "float total = 1.0"),
)  # fmt: skip

ROWS = tuple(Row("glsl", *row) for row in _ROWS)

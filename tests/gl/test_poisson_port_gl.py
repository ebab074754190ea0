"""The Poisson disc filter as fragment shaders, all five passes: each stage, the picture, and planted faults."""

import numpy as np
import pytest

from refdof.methods import poisson
from tests.gl.port import drawn, is_caught, source_of, with_fault
from tests.ports.cases import mutated

pytestmark = pytest.mark.gl

SOURCES = {name: source_of(name) for name in ("poisson_code", "poisson_half", "poisson_smooth", "poisson")}
MAX_RADIUS = 4.0

# Of values in [0, 1]. A code is a quotient of differences of depths, rounded to 2^-24 of up to 4 times their size.
# Means of four and of sixteen add a few roundings. Places of taps are rounded to 2^-24 of the picture, 3e-6 px of 50,
# and radii to 4e-6 px by their code: as much of a step from texel to texel, in two textures.
CODE, SMALL, PICTURE = 1e-6, 1.5e-6, 2e-5
TIE = 4e-6  # of a tap's code to its centre's: which is the larger one is not certain

FAULTS = {
    "blur in front is behind": ("poisson_code", "? (depth - uFocus) /", "? (uFocus - depth) /"),
    "one plane for both sides": ("poisson_code", "(uFar - uFocus)", "(uFocus - uNear)"),
    "planes of full blur are distances": ("poisson_code", "/ (uFar - uFocus)", "/ uFar"),
    "blur is not cut": ("poisson_code", "clamp(blur, -1.0, 1.0)", "max(blur, -1.0)"),
    "the circle of confusion": ("poisson_code", "(depth - uFocus) / (uFar - uFocus)", "(1.0 - uFocus / depth)"),
    "every second texel": ("poisson_half", "min(first + 1,", "min(first,"),
    "a texel late": ("poisson_half", "= 2 * ivec2(gl_FragCoord.xy)", "= 2 * ivec2(gl_FragCoord.xy) + 1"),
    "the sum for the mean": ("poisson_half", "0.25 * (upper + lower)", "0.5 * (upper + lower)"),
    "a box for the Gaussian": ("poisson_smooth", "float((2 - abs(i)) * (2 - abs(j))) / 16.0", "1.0 / 9.0"),
    "outside is black": ("poisson_smooth", "clamp(here + ivec2(i, j), ivec2(0), last)", "here + ivec2(i, j)"),
    "codes are not smoothed": (
        "poisson_smooth",
        "small = sum;",
        "small = vec4(sum.rgb, texelFetch(uQuarter, here, 0).a);",
    ),
    "taps are mirrored": (
        "poisson",
        "place + TAPS[k] * radius / uSize",
        "place + vec2(1, -1) * TAPS[k] * radius / uSize",
    ),
    "a digit of a tap": ("poisson", "vec2(0.519456, 0.767022)", "vec2(0.519456, 0.761022)"),
    "diameters": ("poisson", "blurOf(center.a) * uMaxRadius", "2.0 * blurOf(center.a) * uMaxRadius"),
    "the radius is the listing's": ("poisson", "blurOf(center.a) * uMaxRadius", "blurOf(center.a) * 5.0"),
    "near blur is lost": (
        "poisson",
        "float radius = blurOf(center.a)",
        "float radius = max(center.a * 2.0 - 1.0, 0.0)",
    ),
    "one radius for both pictures": ("poisson", "radius * SMALL_RADIUS * SMALL;", "radius;"),
    "pixels for texels": ("poisson", "radius * SMALL_RADIUS * SMALL;", "radius * SMALL_RADIUS;"),
    "the blend is upside down": ("poisson", "mix(high, low, blurOf(high.a))", "mix(low, high, blurOf(high.a))"),
    "the centre's blur blends": ("poisson", "mix(high, low, blurOf(high.a))", "mix(high, low, blurOf(center.a))"),
    "the small picture is not used": ("poisson", "mix(high, low, blurOf(high.a))", "high"),
    "codes are not blended": ("poisson", "tap.a >= center.a", "high.a >= center.a"),
    "what is nearer counts": ("poisson", "tap.a >= center.a", "tap.a <= center.a"),
    "all taps count": ("poisson", "? 1.0 : blurOf(tap.a)", "? 1.0 : 1.0"),
    "sharp taps do not count": ("poisson", "? 1.0 : blurOf(tap.a)", "? 1.0 : 0.0"),
    "divided by twelve": ("poisson", "sum.rgb / sum.a,", "sum.rgb / 12.0,"),
    "nothing is black": ("poisson", ": center;", ": vec4(0.0);"),
}


REWRITES = {
    "a blend with one product": ("mix(high, low, blurOf(high.a))", "high + blurOf(high.a) * (low - high)"),
    "texels for places": ("place + TAPS[k] * radius / uSize", "(gl_FragCoord.xy + TAPS[k] * radius) / uSize"),
}


def scene(height, width):
    """Colour, depth and circle of a slope, a slanted near card, a sharp one with a hole, background and noise."""
    random = np.random.default_rng(5)
    y, x = np.indices((height, width))
    depth = 2.2 + 0.11 * x + 0.013 * y
    depth[: height // 4] = np.inf
    depth[height // 8 : height // 2, width // 3 : width // 2] = (1.0 + 0.02 * x + 0.007 * y)[
        height // 8 : height // 2, width // 3 : width // 2
    ]
    depth[height // 3 : 2 * height // 3, 2 * width // 3 : 2 * width // 3 + 12] = FOCUS
    depth[height // 2, 2 * width // 3 + 6] = np.inf  # all its taps are in front of it, and sharp
    depth[-height // 4 :] = random.uniform(0.9, 9.0, depth[-height // 4 :].shape)
    depth = depth.astype(np.float32)
    coc = 9.0 * (1.0 / FOCUS - 1.0 / depth.astype(np.float64))
    return random.random((height, width, 3), dtype=np.float32), depth, coc.astype(np.float32)


FOCUS = 2.0
CASES = [scene(37, 50), scene(24, 32)]


def passes(context, color, depth, sources=SOURCES):
    """Code (H, W), small (h, w, 4) and picture (H, W, 3) as the shaders make them."""
    height, width = depth.shape
    planes = {"uNear": depth.min(), "uFocus": FOCUS, "uFar": depth[np.isfinite(depth)].max()}
    (coded,) = drawn(context, sources["poisson_code"], depth.shape, {"uColor": color, "uDepth": depth}, **planes)
    small = coded
    for _ in range(2):
        half = max(1, small.shape[0] // 2), max(1, small.shape[1] // 2)
        (small,) = drawn(context, sources["poisson_half"], half, {"uFine": small})
    (small,) = drawn(context, sources["poisson_smooth"], small.shape[:2], {"uQuarter": small})
    (picture,) = drawn(
        context, sources["poisson"], depth.shape, {"uSharp": coded, "uSmall": small}, linear=("uSharp", "uSmall"),
        uSize=(width, height), uMaxRadius=MAX_RADIUS,
    )  # fmt: skip
    return coded[..., 3], small, picture[..., :3]


def expected(color, depth, coc):
    picture, stages = poisson.blur(color, depth, coc, poisson.Params(max_radius=MAX_RADIUS), stages=True)
    return stages["code"], stages["small"], picture


EXPECTED = []


def answers():
    """What `expected` gives of all cases, made once."""
    if not EXPECTED:
        EXPECTED.extend(expected(*case) for case in CASES)
    return EXPECTED


def read(image, x, y):
    """Bilinear reads (H, W, C) at places in texels from the corner."""
    x, y = (np.clip(place - 0.5, 0, size - 1) for place, size in ((x, image.shape[1]), (y, image.shape[0])))
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    right, below = np.minimum(i + 1, image.shape[1] - 1), np.minimum(j + 1, image.shape[0] - 1)
    u, v = (x - i)[..., None], (y - j)[..., None]
    upper, lower = (image[row, i] * (1 - u) + image[row, right] * u for row in (j, below))
    return upper * (1 - v) + lower * v


def tied(code, small):
    """Pixels (H, W) with a tap that counts in part and whose code is its centre's, but for roundings."""
    height, width = code.shape
    y, x = np.indices(code.shape) + 0.5
    radius = np.abs(2 * code - 1) * MAX_RADIUS
    found = np.zeros(code.shape, bool)
    for u, v in poisson.TAPS:
        high = read(code[..., None], x + u * radius, y + v * radius)[..., 0]
        wide = 1.6 * radius
        low = read(small[..., 3:], (x + u * wide) * small.shape[1] / width, (y + v * wide) * small.shape[0] / height)
        blend = np.abs(2 * high - 1)
        tap = high * (1 - blend) + low[..., 0] * blend
        found |= (np.abs(tap - code) < TIE) & (np.abs(2 * tap - 1) < 1 - TIE) & (radius > TIE)
    return found


def outside(found, answer):
    """How many tolerances each stage is off at its worst: code, small and picture, but where taps are tied."""
    code, small, picture = answer
    free = ~tied(code.astype(np.float64), small.astype(np.float64))
    return (
        np.abs(found[0] - code).max() / CODE,
        np.abs(found[1] - small).max() / SMALL,
        np.abs(found[2] - picture)[free].max() / PICTURE,
    )


def test_every_stage_and_pixel(context):
    for (color, depth, _), answer in zip(CASES, answers(), strict=True):
        found = outside(passes(context, color, depth), answer)
        print(f"{found} tolerances")
        assert max(found) <= 1.0
        assert tied(answer[0].astype(np.float64), answer[1].astype(np.float64)).mean() < 0.01


@pytest.mark.parametrize("rewrite", REWRITES)
def test_a_right_port_may_round_otherwise(rewrite, context):
    sources = SOURCES | {"poisson": mutated(SOURCES["poisson"], *REWRITES[rewrite])}
    for (color, depth, _), answer in zip(CASES, answers(), strict=True):
        assert max(outside(passes(context, color, depth, sources), answer)) <= 1.0


@pytest.mark.parametrize("fault", FAULTS)
def test_no_planted_fault_passes(fault, context):
    sources = with_fault(SOURCES, FAULTS[fault])
    worst = [
        outside(passes(context, *case[:2], sources), answer) for case, answer in zip(CASES, answers(), strict=True)
    ]
    print(f"{fault}: {np.max(worst, axis=0)} tolerances")
    assert is_caught(worst)

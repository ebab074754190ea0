"""Mipmap interpolation as fragment shaders: each level, the picture, and planted faults."""

import functools

import numpy as np
import pytest

from refdof.methods.mipmap import Params
from refdof.methods.mipmap.anisotropic import begin, downsample, foreground_blur, new_chain
from refdof.methods.mipmap.method import _blur, _last_level
from refdof.stages import StageRecorder
from tests.gl.port import drawn, is_caught, source_of, with_fault

pytestmark = pytest.mark.gl

SOURCES = {name: source_of(name) for name in ("mipmap_level", "mipmap_picture")}

# Places are rounded to 2^-24 of the picture, 3e-6 px of 50, in the level, the circle and nine reads, where colours
# differ by 1 and circles by 20 px from texel to texel; the level of a blur is off by as much as the blur, and log2 by
# 6e-7 levels on llvmpipe.
COLOR, CIRCLE, SIGMA = 2e-5, 1e-4, 2e-4

FAULTS = {
    "a box for the Gaussian": ("mipmap_level", "exp(-0.5 * float(i * i + j * j))", "1.0"),
    "a Gaussian half as wide": ("mipmap_level", "exp(-0.5 *", "exp(-2.0 *"),
    "taps a coarser texel apart": ("mipmap_level", "1.0 / vec2(textureSize(uColor, 0))", "1.0 / uCoarse"),
    "the level at its corner": ("mipmap_level", "gl_FragCoord.xy / uCoarse", "floor(gl_FragCoord.xy) / uCoarse"),
    "sharper taps count": ("mipmap_level", "continue;", ";"),
    "the offset is left out": ("mipmap_level", "tap.y + uDelta", "tap.y"),
    "the offset is half a pixel": ("mipmap_level", "tap.y + uDelta", "tap.y + 0.5"),
    "foregrounds leave taps out, too": ("mipmap_level", " && p.x > 0.0)", ")"),
    "the order is by circles": ("mipmap_level", "p.y > tap.y + uDelta", "p.x > tap.x + uDelta"),
    "circles without sharper taps": (
        "mipmap_level",
        "circle = vec4(circleSum.xy / isotropic,",
        "circle = vec4(circleSum.xy / anisotropic,",
    ),
    "the degree of the mean circle": ("mipmap_level", "nearer, 0.0);", "nearer, 0.0); circle.y = abs(circle.x);"),
    "neighbours behind focus count": ("mipmap_level", "tap.x < 0.0 && tap.x < p.x", "tap.x < p.x"),
    "all in front of focus count": ("mipmap_level", "tap.x < 0.0 && tap.x < p.x", "tap.x < 0.0"),
    "the neighbours' mean": ("mipmap_level", "nearer = max(nearer, tap.y);", "nearer += weight * tap.y;"),
    "a level too coarse": ("mipmap_picture", "min(max(m - 1.0, 0.0), uLast)", "min(m, uLast)"),
    "the whole level": ("mipmap_picture", "min(max(m - 1.0, 0.0), uLast)", "min(floor(max(m - 1.0, 0.0)), uLast)"),
    "a circle of one pixel": ("mipmap_picture", "exp2(lod) * min(m, 1.0)", "min(m, 1.0)"),
    "small blurs are not small": ("mipmap_picture", "exp2(lod) * min(m, 1.0)", "exp2(lod)"),
    "diagonals stay in the square": (
        "mipmap_picture",
        "vec2(1, 1) * sqrt(0.5), vec2(-1, 1) * sqrt(0.5)",
        "vec2(1, 1), vec2(-1, 1)",
    ),
    "diagonals weigh as axes": ("mipmap_picture", "(k < 5 ? exp(-0.5) : exp(-1.0))", "exp(-0.5)"),
    "the blur is not smoothed": ("mipmap_picture", "min(coarse, uLast)).y", "0.0).y"),
    "the neighbours' blur is the pixel's": (
        "mipmap_picture",
        "float m = levelOf(sigma)",
        "float m = levelOf(rho / total)",
    ),
    "the blur of the level before": (
        "mipmap_picture",
        "exp2(uLast) / uSize, uLast).z",
        "exp2(uLast) / uSize, uLast - 1.0).z",
    ),
    "five points a pixel away": ("mipmap_picture", "CIRCLE[k] * exp2(uLast)", "CIRCLE[k]"),
    "the points are the paper's": ("mipmap_picture", "k < uPoints", "k < 5"),
    "a wrong scale of levels": ("mipmap_picture", "K_SIGMA = 2.0 / 3.0", "K_SIGMA = 1.0"),
    "levels of diameters": ("mipmap_picture", "1.0 + log2(K_SIGMA * sigma)", "2.0 + log2(K_SIGMA * sigma)"),
}


def scene(height, width, seed):
    """Colour and circle of a noisy background with a sharp bar, a near card, and a band of noise of either sign."""
    random = np.random.default_rng(seed)
    y, x = np.indices((height, width))
    coc = 4.0 + 0.09 * x + random.uniform(0.0, 1.0, (height, width))
    coc[: height // 2, width // 4 : width // 4 + 5] = 0.0
    card = slice(height // 8, 3 * height // 4), slice(2 * width // 5, -width // 8)
    coc[card] = -9.0 + 0.01 * y[card]
    coc[-height // 4 :] = random.uniform(-10.0, 10.0, coc[-height // 4 :].shape)
    return random.random((height, width, 3), dtype=np.float32), coc.astype(np.float32)


CASES = [(*scene(37, 50, 1), 0.5, 5), (*scene(32, 48, 2), 1.25, 9), (*scene(9, 14, 3), 0.5, 0)]


@functools.cache
def expected(number):
    """Levels 1 .. M of colour (h, w, 3) and circles (h, w, 3), the smoothed blur (H, W) and the picture (H, W, 3)."""
    color, coc, delta, points = CASES[number]
    recorder = StageRecorder(True)
    picture = _blur(color, coc, Params(delta=delta, foreground_points=points), recorder)
    last = last_of(coc)
    colors, circles = (new_chain((*coc.shape, channels), last, np.float32) for channels in (4, 2))
    begin(color, coc, colors.level(0), circles.level(0))
    sides = []
    for k in range(last):
        downsample(colors.level(k), circles.level(k), delta, colors.level(k + 1), circles.level(k + 1))
        height, width = circles.level(k + 1).shape[:2]
        nearer = foreground_blur(circles.level(k), height, width)
        sides.append(np.concatenate([circles.level(k + 1), nearer[..., None]], axis=-1))
    return [recorder.stages[f"color {k}"] for k in range(1, last + 1)], sides, recorder.stages["smoothed"], picture


def last_of(coc):
    return _last_level(float(np.abs(coc).max()), *coc.shape[::-1])


def passes(context, number, sources=SOURCES):
    """The same as the shaders make it."""
    color, coc, delta, points = CASES[number]
    (height, width), last = coc.shape, last_of(coc)
    colors = [np.concatenate([color, np.ones_like(color[..., :1])], axis=-1)]
    circles = [np.stack([coc, np.abs(coc), 0 * coc, 0 * coc], axis=-1)]
    for k in range(1, last + 1):
        shape = max(1, height >> k), max(1, width >> k)
        textures = {"uColor": colors[-1], "uCircle": circles[-1]}
        finer, side = drawn(
            context, sources["mipmap_level"], shape, textures, 2, ("uColor", "uCircle"),
            uCoarse=shape[::-1], uDelta=delta,
        )  # fmt: skip
        colors.append(finer)
        circles.append(side)
    (picture,) = drawn(
        context, sources["mipmap_picture"], (height, width), {"uColors": colors, "uCircles": circles},
        uSize=(width, height), uLast=float(last), uPoints=points,
    )  # fmt: skip
    return [c[..., :3] for c in colors[1:]], [c[..., :3] for c in circles[1:]], picture[..., 3], picture[..., :3]


def outside(context, number, sources=SOURCES):
    """How many tolerances colours of levels, their circles, the smoothed blur and the picture are off at worst."""
    found, answer = passes(context, number, sources), expected(number)
    colors, circles = (
        max(np.abs(a - b).max() for a, b in zip(found[side], answer[side], strict=True)) for side in (0, 1)
    )
    smoothed, picture = (np.abs(found[side] - answer[side]).max() for side in (2, 3))
    return np.array([colors / COLOR, circles / CIRCLE, smoothed / SIGMA, picture / COLOR])


@pytest.mark.parametrize("number", range(len(CASES)))
def test_every_level_and_pixel(number, context):
    worst = outside(context, number)
    print(f"{worst} tolerances")
    assert (worst <= 1.0).all()


@pytest.mark.parametrize("fault", FAULTS)
def test_no_planted_fault_passes(fault, context):
    sources = with_fault(SOURCES, FAULTS[fault])
    assert is_caught(outside(context, number, sources) for number in range(len(CASES)))

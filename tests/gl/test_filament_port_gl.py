"""Filament as fragment shaders, all passes: each stage, the picture, and planted faults."""

from functools import partial

import numpy as np
import pytest

from refdof.methods import filament
from tests.gl import engine_ports
from tests.gl.port import drawn, is_caught, tolerances_off, with_fault

pytestmark = pytest.mark.gl

SOURCES = engine_ports.SOURCES["filament"]
# Colours and alpha in [0, 1]; circles and tiles have the same bits. A halved colour is a quotient of sums of four. Sums
# of 81 taps, and quotients of such sums, add their roundings, 81 * 2^-24 = 5e-6. A distance is rounded to 2^-24 of 32
# px, 2e-6 px, which is as much of a tap's share. Bilinear places are rounded as much.
HALF, GATHERED, PICTURE = 3e-7, 5e-6, 5e-6
STAGES = {"half": HALF, "least": 1e-30, "greatest": 1e-30, "gathered": GATHERED, "median": GATHERED, "image": PICTURE}
EDGE = 2e-5  # texels, from the edge between two: which is the nearest one is not certain; and of a level, the same

FAULTS = {
    "a plain mean": ("filament_half", "1.0 / (1.0 + max(", "1.0 / (9.0 + max("),
    "by green": ("filament_half", "max(color.r, max(color.g, color.b))", "color.g"),
    "one of four circles": ("filament_half", "min(nearest, texelFetch(uCircle, pixel, 0).r)",
                            "texelFetch(uCircle, pixel, 0).r"),
    "not cut in front": ("filament_half", "max(nearest, -uLargest)", "nearest"),
    "small circles stay": ("filament_half", "abs(nearest) < 1.0", "abs(nearest) < 0.5"),
    "filled with black": ("filament_half", "ivec2(k % 2, k / 2), last)", "ivec2(k % 2, k / 2), last + 1)"),
    "the greatest circle": ("filament_level", "min(min(a.a, b.a), min(c.a, d.a))", "max(max(a.a, b.a), max(c.a, d.a))"),
    "the mean circle": ("filament_level", "min(min(a.a, b.a), min(c.a, d.a))", "0.25 * (a.a + b.a + c.a + d.a)"),
    "three of four": ("filament_level", "0.25 * (a.rgb + b.rgb + c.rgb + d.rgb)", "(a.rgb + b.rgb + c.rgb) / 3.0"),
    "half of a tile": ("tiles", "min(first + uSide, ", "min(first + uSide / 2, "),
    "around in a row": ("around", "int y = -1; y <= 1", "int y = 0; y <= 0"),
    "a ring more": ("filament_gather", "ceil(0.5 * circle + 0.5)", "ceil(0.5 * circle + 1.5)"),
    "levels rounded down": ("filament_gather", "log2(0.5 * apart) + 0.5", "log2(0.5 * apart)"),
    "finest level": ("filament_gather", "+ 0.5)), 0, 3)", "+ 0.5)), 0, 0)"),
    "light of a level's area": ("filament_gather", "float(2 << level)", "float(2 << (2 * level))"),
    "reach of a pixel": ("filament_gather", "/ float(1 << level) + 0.5, 0.0", "/ 1.0 + 0.5, 0.0"),
    "taps in pixels": ("filament_gather", "(place + 0.5 * apart * float(ring) * uPoints[k])",
                       "(place + apart * float(ring) * uPoints[k])"),
    "one alpha": ("filament_gather", "alpha = clamp(circle - 1.0, 0.0, 1.0);", "alpha = 1.0;"),
    "alpha left out": ("filament_gather", "float(k + 1) * alpha, alpha", "float(k + 1), alpha"),
    "not alike": ("filament_gather", "<= 0.05 * abs(tile.y)) {", "<= 0.01 * abs(tile.y)) {"),
    "no noise": ("filament_gather", "vec2 moved = texelFetch(uMoved, here, 0).xy;", "vec2 moved = vec2(0.0);"),
    "noise mirrored": ("filament_gather", "texelFetch(uMoved, here, 0).xy;", "texelFetch(uMoved, here, 0).yx;"),
    "inside out": ("filament_gather", "before = ring == rings - 1 ?", "before = ring == 0 ?"),
    "no layers": ("filament_gather", "clamp(tap.a - border + 0.5, 0.0, 1.0)", "1.0"),
    "the ring's middle": ("filament_gather", "float border = apart * (float(ring) + 0.5)",
                          "float border = apart * float(ring)"),
    "what is hidden stays": ("filament_gather", "float hidden = 1.0 - missed / float(count)", "float hidden = 0.0"),
    "all is hidden": ("filament_gather", "float hidden = 1.0 - missed / float(count)", "float hidden = 1.0"),
    "circles not kept": ("filament_gather", "outerCircle *= kept", "outerCircle *= 1.0"),
    "a hard start": ("filament_gather", "* smoothstep(1.0, 2.0, circle)", "* step(1.0, circle)"),
    "a taller background": ("filament_gather", "lightOf(circle * (float(rings) + 0.5) / float(rings), level);",
                            "lightOf(circle, level);"),
    "rings of the circle": ("filament_gather", "int rings = ringsOf(greatest)", "int rings = ringsOf(circle)"),
    "circles not shared": ("filament_gather", "float circle = min(one.a, two.a)", "float circle = one.a"),
    "one side": ("filament_gather", "nearestTo(place - offset, level)", "nearestTo(place + offset, level)"),
    "the centre twice": ("filament_gather", "weight *= 0.5;", "weight *= 1.0;"),
    "one layer": ("filament_gather", "clamp(0.5 * (circle - least - 2.0), 0.0, 1.0)", "0.0"),
    "layers close": ("filament_gather", "circle - least - 2.0", "circle - least - 1.0"),
    "back over front": ("filament_gather", "backAlpha * (1.0 - frontAlpha)", "backAlpha"),
    "weights not by count": ("filament_gather", "(2 * rings - 1) * (2 * rings - 1)", "4 * rings * (rings - 1)"),
    "no fill": ("filament_gather", "float filled = max(alpha, clamp(abs(circleHere) - 1.0, 0.0, 1.0))",
                "float filled = alpha"),
    "filled always": ("filament_gather", "alpha < 1.0 && behind.a == 0.0", "alpha < 1.0"),
    "background in front": ("filament_gather", "+ (1.0 - alpha) * behind;", "+ behind;"),
    "median of rows": ("median", "order(texels[1], texels[4], texels[7])", "order(texels[1], texels[4])"),
    "alone from 1 px": ("filament", "abs(tile.x) >= 2.0", "abs(tile.x) >= 1.0"),
    "mixed": ("filament", "soft.rgb + (1.0 - soft.a)", "soft.a * soft.rgb + (1.0 - soft.a)"),
    "half a pixel": ("filament", "gl_FragCoord.xy / (2.0", "floor(gl_FragCoord.xy) / (2.0"),
    "of the picture's size": ("filament", "2.0 * vec2(textureSize(uSoft, 0))", "vec2(textureSize(uColor, 0))"),
}  # fmt: skip


def scene(height, width, circles):
    random = np.random.default_rng(5)
    color = random.random((height, width, 3), dtype=np.float32)
    blocks = np.kron(random.uniform(0.0, 1.0, (height // 5 + 1, width // 5 + 1)), np.ones((5, 5)))[:height, :width]
    coc = circles(blocks) * random.uniform(0.99, 1.01, (height, width))
    return color, np.ones_like(color[..., 0]), coc.astype(np.float32)


def beside_focus(blocks):
    """In focus at the left or at the top, then all sorts, some of more than is allowed, and strips hardly blurred."""
    coc = 76.0 * blocks - 38.0
    coc[:, ::9] = 0.8
    tall = coc.shape[0] > coc.shape[1]
    coc[(np.s_[:58] if tall else np.s_[:, :58])] = 0.3
    return coc


CASES = [
    (*scene(19, 107, beside_focus), filament.Params()),
    (*scene(91, 20, beside_focus), filament.Params(rings=3)),
    (*scene(18, 21, lambda blocks: 1.2 + 9.0 * blocks), filament.Params()),  # all behind
    (*scene(16, 25, lambda blocks: -1.2 - 9.0 * blocks), filament.Params()),  # all in front
    (*scene(16, 16, lambda blocks: 6.0 + 0.0 * blocks), filament.Params()),  # alike
    (*scene(16, 16, lambda blocks: -1.5 + 0.0 * blocks), filament.Params()),  # and hardly blurred
    (*scene(16, 16, lambda blocks: 28.0 + 0.0 * blocks), filament.Params(rings=2, largest_px=20.0)),  # 20 px for all
]


@pytest.fixture(scope="module")
def answers():
    found = []
    for case in CASES:
        answer = filament.blur(*case, stages=True)
        found.append((answer, tied(answer.stages, case[3].rings)))
    return found


def tied(stages, most_rings):
    """Texels of half the size, (h, w), with a tap or a level that a rounding chooses."""
    circle = stages["half"][..., 3].astype(np.float64)
    least, greatest = (np.kron(stages[name], np.ones((8, 8))) for name in ("least", "greatest"))
    moved = engine_ports.interleaved_noise(*circle.shape).astype(np.float64)
    found = np.zeros(circle.shape, bool)
    sorts = {"behind": (np.abs(circle), greatest, greatest > 0), "before": (-least, -least, least < 0)}
    for reach, for_rings, takes_part in sorts.values():
        rings = np.clip(np.ceil(for_rings / 2 + 0.5), 1, most_rings)
        apart = np.maximum(reach, 1e-9) / (rings - 0.5)
        level = np.log2(apart / 2) + 0.5
        close = (np.abs(level - np.rint(level)) < EDGE) & (np.rint(level) > 0)
        side = 2.0 ** np.clip(np.floor(level), 0, 3)
        for ring in range(1, most_rings):
            for point in engine_ports.ring_points(ring, np.ones(ring))[-8 * ring :]:
                for axis in (0, 1):
                    at = np.indices(circle.shape)[1 - axis] + 0.5
                    place = (at + 0.5 * apart * (moved[..., axis] + ring * point[axis])) / side
                    close |= (np.abs(place - np.rint(place)) < EDGE) & (ring < rings)
        found |= close & takes_part
    return found & (greatest - least > 0.05 * np.abs(greatest))


def outside(context, case, answer, sources=SOURCES):
    """How many tolerances each stage is off at its worst. What follows takes the method's number of a tied texel."""
    answer, chosen = answer

    def settled(gathered):
        return np.where(chosen[..., None], answer.stages["gathered"], gathered)

    stages, picture = engine_ports.filament(partial(drawn, context), *case, sources, settled)
    stages["gathered"] = settled(stages["gathered"])
    return tolerances_off((stages, picture), answer, STAGES)


def test_every_stage_and_pixel(context, answers):
    for case, answer in zip(CASES, answers, strict=True):
        worst = outside(context, case, answer)
        print(f"{np.round(worst, 2)} tolerances, {answer[1].mean():.4f} tied")
        assert max(worst) <= 1.0
        assert answer[1].mean() < 0.01


@pytest.mark.parametrize("fault", FAULTS)
def test_no_planted_fault_passes(fault, context, answers):
    sources = with_fault(SOURCES, FAULTS[fault])
    assert is_caught(outside(context, *pair, sources) for pair in zip(CASES, answers, strict=True))

"""The hexagon as a fragment shader, both passes: each stage, the picture, and planted faults."""

from functools import partial

import numpy as np
import pytest

from refdof.methods import hexagon
from tests.gl import engine_ports
from tests.gl.port import drawn, is_caught, with_fault

pytestmark = pytest.mark.gl

SOURCES = engine_ports.SOURCES["hexagon"]
# Of values in [0, 1]. Places of reads are rounded to 2^-24 of the picture, 3e-6 px of 50: as much of a step from texel
# to texel, of 1 at most; up to 9 reads add as many roundings. The second pass reads the first one's results.
FIRST, PICTURE = 5e-6, 1e-5

FAULTS = {
    "a step is missing": ("steps + 1;", "max(steps, 1);"),
    "halves round up": ("roundEven(min(circle, uLargest))", "floor(min(circle, uLargest) + 0.5)"),
    "diameters": ("roundEven(min(circle, uLargest))", "roundEven(min(2.0 * circle, uLargest))"),
    "not cut": ("min(circle, uLargest)", "circle"),
    "upwards": ("uFirst ? vec2(0.0, 1.0)", "uFirst ? vec2(0.0, -1.0)"),
    "mirrored": ("vec2(-COS, -0.5)", "vec2(COS, 0.5)"),
    "sixty degrees": ("COS = 0.8660254037844386", "COS = 0.5"),
    "no abs": ("float circle = abs(", "float circle = ("),
    "one rhombus": ("second = uEqual ? one + two : 0.5 * (one + two)", "second = two"),
    "swapped": ("vec4 two = mean(uBoth,", "vec4 two = mean(uDown,"),
    "half a step": ("uEqual && steps > 0 ? 0.5", "steps > 0 ? 0.5"),
    "half a pixel": ("(gl_FragCoord.xy + (float(k)", "(floor(gl_FragCoord.xy) + (float(k)"),
    "equal: half a step": ("uEqual && steps > 0 ? 0.5", "uEqual && steps > 9 ? 0.5"),
    "equal: halved": ("(one + two) / 3.0", "(one + two) / 2.0"),
    "equal: mean": ("uEqual ? one + two :", "uEqual ? 0.5 * (one + two) :"),
    "equal: a step more": ("uEqual ? max(steps, 1)", "uEqual ? steps + 1"),
}  # fmt: skip


def scene(height, width):
    random = np.random.default_rng(7)
    color = random.random((height, width, 3), dtype=np.float32)
    coc = random.integers(-18, 19, (height, width)) / np.float32(2)  # halves, and more than is allowed
    return color, coc.astype(np.float32)


CASES = [(*scene(37, 50), False), (*scene(24, 32), True)]


def params(equal):
    return hexagon.Params(largest_px=8.0, rhombi="equal" if equal else "engine")


def passes(context, color, coc, equal, sources=SOURCES):
    stages, picture = engine_ports.hexagon(partial(drawn, context), color, None, coc, params(equal), sources)
    return stages["down"], stages["both"], picture


@pytest.fixture(scope="module")
def answers():
    found = []
    for color, coc, equal in CASES:
        staged = hexagon.blur(color, np.ones_like(coc), coc, params(equal), stages=True)
        found.append((staged.stages["down"], staged.stages["both"], staged.image))
    return found


def outside(found, answer):
    """How many tolerances each stage is off at its worst."""
    return [np.abs(a - b).max() / t for a, b, t in zip(found, answer, (FIRST, 2 * FIRST, PICTURE), strict=True)]


def test_every_stage_and_pixel(context, answers):
    for case, answer in zip(CASES, answers, strict=True):
        worst = outside(passes(context, *case), answer)
        print(f"{worst} tolerances")
        assert max(worst) <= 1.0


@pytest.mark.parametrize("fault", FAULTS)
def test_no_planted_fault_passes(fault, context, answers):
    sources = with_fault(SOURCES, ("hexagon", *FAULTS[fault]))
    assert is_caught(outside(passes(context, *case, sources), a) for case, a in zip(CASES, answers, strict=True))

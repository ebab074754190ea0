"""The circular method as fragment shaders, both passes: parts and picture, and planted faults."""

from functools import partial

import numpy as np
import pytest

from refdof.methods import circular
from tests.gl import engine_ports
from tests.gl.port import drawn, is_caught, with_fault

pytestmark = pytest.mark.gl

SOURCES = engine_ports.SOURCES["circular"]
# Of values in [0, 1] that are summed with weights of up to 2 in sum: 17 taps twice. Places are rounded to 2^-24 of the
# picture, 3e-6 px of 50: as much of a step from texel to texel.
PARTS, PICTURE = 5e-6, 5e-6

FAULTS = {
    "diameters": ("circular_across", "uLargest) * uStep", "uLargest) * 2.0 * uStep"),
    "not cut": ("circular_across", ".r), uLargest)", ".r), 99.0)"),
    "no abs": ("circular_across", "min(abs(", "min(("),
    "a tap less": ("circular_across", "j <= 8", "j <= 7"),
    "the centre twice": ("circular_across", "uTaps[abs(j)]", "uTaps[(abs(j) + 1) % 9]"),
    "down in the first pass": ("circular_across", "vec2(float(j) * apart, 0.0)", "vec2(0.0, float(j) * apart)"),
    "no imaginary part": ("circular_across", "tap.y * read", "tap.x * read"),
    "half a pixel": ("circular_across", "(gl_FragCoord.xy + vec2(", "(floor(gl_FragCoord.xy) + vec2("),
    "the sign of i squared": ("circular_down", "tap.x * re - tap.y * im", "tap.x * re + tap.y * im"),
    "conjugated": ("circular_down", "tap.x * im + tap.y * re", "tap.x * im - tap.y * re"),
    "real parts alone": ("circular_down", "realPart + uWeights.y * imaginaryPart", "realPart"),
    "weights swapped": ("circular_down", "uWeights.x * realPart + uWeights.y", "uWeights.y * realPart + uWeights.x"),
    "rows again": ("circular_down", "vec2(0.0, float(j) * apart)", "vec2(float(j) * apart, 0.0)"),
    "another step": ("circular_down", "uLargest) * uStep", "uLargest) * 1.1 * uStep"),
    "second pass: a tap less": ("circular_down", "int j = -8", "int j = -7"),
}  # fmt: skip
PARAMS = circular.Params(components=2, transition=0.2, largest_px=6.0)


def scene(height, width):
    random = np.random.default_rng(9)
    color = random.random((height, width, 3), dtype=np.float32)
    return color, random.uniform(-8.0, 8.0, (height, width)).astype(np.float32)


CASES = [scene(37, 50), scene(13, 18)]


def passes(context, color, coc, sources=SOURCES):
    """Parts (H, W, 6 n) and picture (H, W, 3) as the shaders make them."""
    stages, picture = engine_ports.circular(partial(drawn, context), color, None, coc, PARAMS, sources)
    return stages["parts"], picture


@pytest.fixture(scope="module")
def answers():
    staged = [circular.blur(color, np.ones_like(coc), coc, PARAMS, stages=True) for color, coc in CASES]
    return [(found.stages["parts"], found.image) for found in staged]


def outside(found, answer):
    """How many tolerances parts and picture are off at their worst."""
    return [np.abs(a - b).max() / t for a, b, t in zip(found, answer, (PARTS, PICTURE), strict=True)]


def test_every_stage_and_pixel(context, answers):
    for case, answer in zip(CASES, answers, strict=True):
        worst = outside(passes(context, *case), answer)
        print(f"{np.round(worst, 2)} tolerances")
        assert max(worst) <= 1.0


@pytest.mark.parametrize("fault", FAULTS)
def test_no_planted_fault_passes(fault, context, answers):
    sources = with_fault(SOURCES, FAULTS[fault])
    assert is_caught(outside(passes(context, *case, sources), a) for case, a in zip(CASES, answers, strict=True))

"""The half-resolution method as fragment shaders, all passes: each stage, the picture, and planted faults."""

from functools import partial

import numpy as np
import pytest

from refdof.methods import halfres
from tests.gl import engine_ports
from tests.gl.port import drawn, is_caught, with_fault

pytestmark = pytest.mark.gl

SOURCES = engine_ports.SOURCES["halfres"]
LARGEST = 6.0
# Of values in [0, 1]. Weights of a Gaussian and angles are rounded by the device's exp, sin and cos; places to 2^-24 of
# the picture and of 192 radians, 1e-5 px of 6: as much of a step from texel to texel. Passes read what others made.
BLUR, MEAN, PICTURE = 1e-6, 3e-5, 6e-5

FAULTS = {
    "a tap less": ("halfres_near", "i <= 6", "i <= 5"),
    "a wider Gaussian": ("halfres_near", "(7.0 / 3.0) * (7.0 / 3.0)", "(7.0 / 3.0) * 7.0"),
    "a sum": ("halfres_near", "sum / total", "sum"),
    "the edge is black": ("halfres_near", "+ i * uAxis, ivec2(0)", "+ i * uAxis, ivec2(-1)"),
    "all points": ("halfres_mean", "i % 5 == 0", "i % 81 == 80"),
    "the other points": ("halfres_mean", "i % 5 == 0", "i % 5 == 1"),
    "radii without root": ("halfres_mean", "sqrt(float(i) / 80.0)", "float(i) / 80.0"),
    "a digit of the angle": ("halfres_mean", "2.39996323", "2.39966323"),
    "mirrored": ("halfres_mean", "sin(angle)", "-sin(angle)"),
    "pixels of the half": ("halfres_mean", "blur / vec2(textureSize(uColor, 0))", "blur / uHalf"),
    "diameters": ("halfres_mean", "uLargest * blur", "2.0 * uLargest * blur"),
    "eighty": ("halfres_mean", "sum / 64.0", "sum / 80.0"),
    "no blur kept": ("halfres_mean", "64.0, blur)", "64.0, 1.0)"),
    "least values": ("halfres_brightest", "most = max(most", "most = min(most"),
    "points of the mean": ("halfres_brightest", "i = 0; i < 80", "i = 1; i < 80"),
    "reach in texels": ("halfres_brightest", "own.a / uFull", "own.a / vec2(textureSize(uMean, 0))"),
    "one reach": ("halfres_brightest", "uLargest * own.a", "uLargest"),
    "near below far": ("halfres", "mix(color, near.rgb, 2.0 *", "mix(near.rgb, color, 2.0 *"),
    "not twice": ("halfres", "far.rgb, 2.0 * min(far.a, 0.5)", "far.rgb, min(far.a, 0.5)"),
    "no limit": ("halfres", "2.0 * min(far.a, 0.5)", "2.0 * far.a"),
    "swapped": ("halfres", "vec4 far = texture(uFar", "vec4 far = texture(uNear"),
    "half a pixel": ("halfres", "place = gl_FragCoord.xy /", "place = floor(gl_FragCoord.xy) /"),
}  # fmt: skip


def scene(height, width):
    random = np.random.default_rng(8)
    color = random.random((height, width, 3), dtype=np.float32)
    coc = random.uniform(-8.0, 8.0, (height, width)).astype(np.float32)
    coc[: height // 3] = 0.0
    coc[-2:] = 9.0
    return color, coc


CASES = [scene(22, 30), scene(13, 17)]  # an odd size's half is rounded up


def passes(context, color, coc, sources=SOURCES):
    draw = partial(drawn, context)
    stages, picture = engine_ports.halfres(draw, color, None, coc, halfres.Params(LARGEST), sources)
    return list(stages.values()), picture


@pytest.fixture(scope="module")
def answers():
    found = []
    for color, coc in CASES:
        staged = halfres.blur(color, np.ones_like(coc), coc, halfres.Params(LARGEST), stages=True)
        names = ("near_mean", "far_mean", "near_brightest", "far_brightest")
        found.append(([staged.stages[name] for name in names], staged.image))
    return found


def outside(found, answer):
    """How many tolerances each stage is off at its worst: blurs, colours and the picture."""
    worst = []
    for a, b in zip(found[0], answer[0], strict=True):
        worst += [np.abs(a - b)[..., 3].max() / BLUR, np.abs(a - b)[..., :3].max() / MEAN]
    return [*worst, np.abs(found[1] - answer[1]).max() / PICTURE]


def test_every_stage_and_pixel(context, answers):
    for case, answer in zip(CASES, answers, strict=True):
        worst = outside(passes(context, *case), answer)
        print(f"{np.round(worst, 2)} tolerances")
        assert max(worst) <= 1.0


@pytest.mark.parametrize("fault", FAULTS)
def test_no_planted_fault_passes(fault, context, answers):
    sources = with_fault(SOURCES, FAULTS[fault])
    assert is_caught(outside(passes(context, *case, sources), a) for case, a in zip(CASES, answers, strict=True))

"""N-buffers as fragment shaders: every level bit for bit, and planted faults."""

import numpy as np
import pytest

from refdof.raster.filters.n_buffer import n_buffer
from tests.gl.port import drawn, source_of, with_fault

pytestmark = pytest.mark.gl

SOURCES = {name: source_of(name) for name in ("nbuffer_bottom", "nbuffer")}

FAULTS = {
    "the next texel, not the next square": ("nbuffer", "min(here + uSide,", "min(here + 1,"),
    "squares overlap by a texel": ("nbuffer", "min(here + uSide,", "min(here + max(uSide - 1, 1),"),
    "squares begin at their far corner": ("nbuffer", "min(here + uSide,", "max(here - uSide, 0); there = min(there,"),
    "the picture wraps": (
        "nbuffer",
        "min(here + uSide, textureSize(uBefore, 0) - 1)",
        "(here + uSide) % textureSize(uBefore, 0)",
    ),
    "outside is nothing": ("nbuffer", "min(here + uSide, textureSize(uBefore, 0) - 1)", "here + uSide"),
    "the square across is left out": ("nbuffer", "min(min(a.x, b.x), min(c.x, d.x))", "min(min(a.x, b.x), c.x)"),
    "rows only": ("nbuffer", "max(max(a.y, b.y), max(c.y, d.y))", "max(a.y, b.y)"),
    "sides are swapped": ("nbuffer", "extremes = vec4(least, greatest,", "extremes = vec4(greatest, least,"),
    "the last row of a picture is left out": (
        "nbuffer_bottom",
        "textureSize(uDepth, 0));",
        "textureSize(uDepth, 0) - 1);",
    ),
    "nothing is at 0": (
        "nbuffer_bottom",
        "float least = infinity, greatest = -infinity;",
        "float least = infinity, greatest = 0.0;",
    ),
    "the background is a surface": ("nbuffer_bottom", "if (abs(depth[k]) < infinity) {", "if (depth[k] > -infinity) {"),
    "the first layer only": ("nbuffer_bottom", "k < 4;", "k < 1;"),
    "a block's first texel only": ("nbuffer_bottom", "x < end.x; ++x", "x < end.x; x += uBlock"),
    "blocks overlap": ("nbuffer_bottom", "min(first + uBlock,", "min(first + uBlock + 1,"),
}


def layers(shape, seed):
    """Four layers (H, W, 4) with empty texels of either sign, an empty corner, and neither 0 nor denormals."""
    random = np.random.default_rng(seed)
    packed = random.normal(size=(*shape, 4)).astype(np.float32)
    packed[random.random(packed.shape) < 0.3] = -np.inf
    packed[random.random(packed.shape) < 0.1] = np.inf
    packed[-3:, -3:] = -np.inf
    return packed


CASES = [(layers((13, 21), 0), 1), (layers((13, 22), 1), 2), (layers((1, 9), 2), 3)]


def levels_of(context, packed, block, count, sources=SOURCES):
    """Levels (count, h, w, 2) as the shaders make them."""
    shape = -(-packed.shape[0] // block), -(-packed.shape[1] // block)
    levels = drawn(context, sources["nbuffer_bottom"], shape, {"uDepth": packed}, uBlock=block)
    for k in range(1, count):
        levels += drawn(context, sources["nbuffer"], shape, {"uBefore": levels[-1][..., :2]}, uSide=2 ** (k - 1))
    return np.stack(levels)[..., :2]


def wrong(context, sources=SOURCES):
    """(case, level) of the first level that has another bit than refdof's, or None."""
    for number, (packed, block) in enumerate(CASES):
        expected = n_buffer(packed.transpose(2, 0, 1), block=block)
        found = levels_of(context, packed, block, len(expected.lowest), sources)
        for level, sides in enumerate(zip(expected.lowest, expected.highest, strict=True)):
            if not np.array_equal(found[level].view(np.uint32), np.stack(sides, axis=-1).view(np.uint32)):
                return number, level
    return None


def test_every_level_has_the_same_bits(context):
    assert wrong(context) is None
    assert len(n_buffer(CASES[0][0].transpose(2, 0, 1)).lowest) == 6


@pytest.mark.parametrize("fault", FAULTS)
def test_no_planted_fault_passes(fault, context):
    found = wrong(context, with_fault(SOURCES, FAULTS[fault]))
    print(f"{fault}: {found}")
    assert found is not None

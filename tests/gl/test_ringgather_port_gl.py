"""The ring gather as fragment shaders, all passes: each stage, the picture, and planted faults."""

from functools import partial

import numpy as np
import pytest

from refdof.methods import ringgather
from tests.gl import engine_ports
from tests.gl.port import drawn, is_caught, tolerances_off, with_fault

pytestmark = pytest.mark.gl

SOURCES = engine_ports.SOURCES["ringgather"]
# Colours and alpha in [0, 1]; circles and tiles have the same bits. Places of reads are rounded to 2^-24 of the
# picture, 8e-6 px of 140: as much of a step from texel to texel. Sums of 49 taps that are divided by one another add
# roundings, 49 * 2^-24 = 3e-6 at most. Passes read what others made.
FILTERED, RINGS, PICTURE = 1e-5, 1.5e-5, 1.5e-5
STAGES = {"circle": 1e-30, "least": 1e-30, "nearest": 1e-30, "greatest": 1e-30, "filtered": FILTERED, "rings": RINGS,
          "median": RINGS, "image": PICTURE}  # fmt: skip
EDGE = 2e-5  # px: of a place, from the edge between two texels, where the nearest texel is not certain

FAULTS = {
    "diameters": ("ringgather_circle", "0.5 * circle", "circle"),
    "not cut": ("ringgather_circle", "min(abs(", "max(abs("),
    "signed": ("ringgather_circle", "min(abs(texelFetch(uCircle, pixel, 0).r)",
               "min((texelFetch(uCircle, pixel, 0).r)"),
    "half of a tile": ("tiles", "min(first + uSide, ", "min(first + uSide / 2, "),
    "tiles begin late": ("tiles", "uSide * ivec2(gl_FragCoord.xy)", "uSide * ivec2(gl_FragCoord.xy) + 1"),
    "not around": ("around", "int x = -1; x <= 1", "int x = 0; x <= 0"),
    "least and greatest": ("around", "max(tile.zw, other.zw)", "min(tile.zw, other.zw)"),
    "eight of nine": ("ringgather_prefilter", "sum / 9.0", "sum / 8.0"),
    "the whole circle": ("ringgather_prefilter", "0.5 * own.r * uPoints", "own.r * uPoints"),
    "no depths": ("ringgather_prefilter", "min(2.0 * abs(planesAt(place).g - own.g), 1.0)", "0.0"),
    "one unit": ("ringgather_prefilter", "2.0 * abs(planesAt", "1.0 * abs(planesAt"),
    "mirrored": ("ringgather_prefilter", "own.r * uPoints[k]", "own.r * vec2(1, -0.5) * uPoints[k]"),
    "the texel above": ("ringgather_prefilter", "(2 * here + 1) *", "(2 * here) *"),
    "linear": ("ringgather_prefilter", "smoothstep(0.0, 1.0, (own.g - nearest) / uForeground)",
               "clamp((own.g - nearest) / uForeground, 0.0, 1.0)"),
    "before is behind": ("ringgather_prefilter", "light * behind, light * (1.0 - behind)",
                         "light * (1.0 - behind), light * behind"),
    "no area": ("ringgather_prefilter", "1.0 / max(PI * own.r * own.r", "1.0 / max(PI * own.r"),
    "no least area": ("ringgather_prefilter", "PI * 0.7071 * 0.7071)", "0.01)"),
    "no early exit": ("ringgather_rings", "most < 1.0)", "most < 0.0)"),
    "no cheap tiles": ("ringgather_rings", "most - tile.x < 1.0", "most - tile.x < 0.0"),
    "cheap tiles of two": ("ringgather_rings", "most - tile.x < 1.0", "most - tile.x < 2.0"),
    "opaque cheap tiles": ("ringgather_rings", "sum / count, 0.0)", "sum / count, 1.0)"),
    "the centre not counted": ("ringgather_rings", "(2 * used + 1) * (2 * used + 1)", "4 * used * (used + 1)"),
    "two rings": ("ringgather_rings", "place = gl_FragCoord.xy + reach * uPoints[k]",
                  "place = gl_FragCoord.xy + reach * uPoints[k % 24]"),
    "hard rings": ("ringgather_rings", "- float(ring) + 1.0", "- float(ring) + 0.5"),
    "the first ring not squared": ("ringgather_rings", "ring == 1", "ring == 0"),
    "its own circle": ("ringgather_rings", "covers = clamp(tap.x *", "covers = clamp(own.x *"),
    "no gain": ("ringgather_rings", "uGain / count", "1.0 / count"),
    "far over near": ("ringgather_rings", "mix(far.rgb / max(1e-5, far.a), near.rgb / max(1e-5, near.a), alpha)",
                      "mix(near.rgb / max(1e-5, near.a), far.rgb / max(1e-5, far.a), alpha)"),
    "the mean": ("median", "order(low, texels[4], high);", "texels[4] = (low + texels[4] + high) / 3.0;"),
    "a lower one": ("median", "vec4 high = min(texels[2], min(", "vec4 high = min(texels[1], min("),
    "five of nine": ("median", "ivec2(k % 3, k / 3) - 1", "ivec2(k % 3, 1) - 1"),
    "nearest upside down": ("ringgather", "1.0 - (own.g - tile.y)", "own.g - tile.y"),
    "the tile's circle": ("ringgather", "mix(tile.z, own.r, near)", "tile.z"),
    "no alpha": ("ringgather", "clamp(mix(own.r, reach, soft.a)", "clamp(own.r"),
    "half tiles": ("ringgather", "pixel / 32", "min(pixel / 16, textureSize(uTiles, 0) - 1)"),
    "half a pixel": ("ringgather", "texture(uSoft, gl_FragCoord.xy /", "texture(uSoft, floor(gl_FragCoord.xy) /"),
}  # fmt: skip


def scene(height, width, circles):
    random = np.random.default_rng(SEED)
    color, depth = random.random((height, width, 3), dtype=np.float32), random.uniform(1.0, 2.0, (height, width))
    depth[: height // 5] = 9.0
    return color, depth.astype(np.float32), circles(random, (height, width)).astype(np.float32)


def varied(random, shape):
    """Hardly any blur in the first tiles, then what varies, and a strip of more than is allowed."""
    coc = random.uniform(-9.0, 9.0, shape)
    coc[:, :64] *= 0.2
    coc[-2:, 100:] = 11.0
    return coc


def wide(random, shape):
    return random.uniform(-9.0, 9.0, shape)


def like(random, shape):
    """Circles that differ by 1.5 px: cheap tiles."""
    return -5.0 - random.uniform(0.0, 1.5, shape)


SEED = 8  # with others some tap is on an edge between texels
CASES = [
    (*scene(21, 140, varied), ringgather.Params(largest_px=8.0)),
    (*scene(14, 15, wide), ringgather.Params(largest_px=8.0, gain=0.5, fill=True, foreground=1.3)),
    (*scene(12, 17, like), ringgather.Params()),
    (*scene(12, 17, lambda *about: 1.7 * like(*about)), ringgather.Params()),
]


@pytest.fixture(scope="module")
def answers():
    return [ringgather.blur(*case, stages=True) for case in CASES]


def outside(context, case, answer, sources=SOURCES):
    """How many tolerances each stage is off at its worst."""
    return tolerances_off(engine_ports.ringgather(partial(drawn, context), *case, sources), answer, STAGES)


def test_every_stage_and_pixel(context, answers):
    for case, answer in zip(CASES, answers, strict=True):
        worst = outside(context, case, answer)
        print(f"{np.round(worst, 2)} tolerances")
        assert max(worst) <= 1.0


@pytest.mark.parametrize("fault", FAULTS)
def test_no_planted_fault_passes(fault, context, answers):
    sources = with_fault(SOURCES, FAULTS[fault])
    assert is_caught(outside(context, *pair, sources) for pair in zip(CASES, answers, strict=True))


def least_distance(size, circle, most, fill):
    """Least distance [px] of a tap from an edge: `size` (H, W); circle and greatest one, (h, w), of half of it."""
    points = engine_ports.ring_points(3, np.arange(1, 4) / (3.0 if fill else 4.0))
    found = []
    for axis in (0, 1):
        at = np.arange(circle.shape[axis]).reshape((-1, 1) if axis == 0 else (1, -1)) + 0.5
        along = np.array([point[1 - axis] for point in points])[:, None, None]
        places = [at + most * along, (at + 0.5 * circle * along[:8]) * (size[axis] / circle.shape[axis])]
        for place in places:
            inside = (place > 0.0) & (place < size[axis])
            found.append(np.abs(place - np.rint(place))[inside].min())
    return min(found)


def test_no_place_is_on_an_edge(answers):
    """The cases have no tap whose nearest texel a rounding would choose."""
    for (_, _, coc, params), answer in zip(CASES, answers, strict=True):
        half = [np.arange((side + 1) // 2) for side in coc.shape]
        texels = [(2 * at + 1) * side // (2 * len(at)) for at, side in zip(half, coc.shape, strict=True)]
        circle, most = answer.stages["circle"][np.ix_(*texels)], answer.stages["greatest"]
        most = most[np.ix_(*(at // 16 for at in half))]
        assert least_distance(coc.shape, circle.astype(np.float64), most.astype(np.float64), params.fill) > EDGE

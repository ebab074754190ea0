"""One view of the multiview method as a fragment shader: what the ray of every pixel hits, and its colour."""

import functools
from dataclasses import dataclass

import numpy as np
import pytest

from refdof.methods.multiview.fields import Search, fields_of
from refdof.methods.multiview.gather import trace_hits
from tests.gl.port import drawn, source_of
from tests.gl.rays import hits_off, one_point, share_tied
from tests.ports.cases import mutated

pytestmark = pytest.mark.gl

SOURCE = source_of("multiview")
BACKGROUND = (0.25, 0.5, 0.75)
MOST = 32

PLACE = 1e-5  # px of c: a border's place is rounded to 2^-24 of 30 px, over a slope of 1/3 and more
SHAKE = 1e-5  # of the lens point, heights and walls: what a ray hits then, too, is a right answer

FAULTS = {
    "the lens is mirrored": ("vec2 v = vec2(uLens.x, -uLens.y);", "vec2 v = vec2(uLens.x, uLens.y);"),
    "rays turn at focus": (
        "gl_FragCoord.xy - enter * vec2(uLens.x, -uLens.y)",
        "gl_FragCoord.xy - abs(enter) * vec2(uLens.x, -uLens.y)",
    ),
    "all rays begin at the pixel": (
        "vec2 place = gl_FragCoord.xy - enter * vec2(uLens.x, -uLens.y)",
        "vec2 place = gl_FragCoord.xy",
    ),
    "texels end at the other side": ("v.x > 0.0 ? texel.x : texel.x + 1,", "v.x > 0.0 ? texel.x + 1 : texel.x,"),
    "outside is something": ("clamp(texel, ivec2(0), size - 1)", "texel"),
    "corner to corner": ("? ivec2(pace.x, 0) : ivec2(0, pace.y)", "? pace : pace"),
    "a texel is left late": ("return min(min(at.x, at.y), last);", "return min(max(at.x, at.y), last);"),
    "the layer alone goes on": ("k < textureSize(uHeights, 0).z && uEnds[k].x <= high", "k < layer + 1"),
    "the farther layers alone go on": ("for (int k = layer; k", "for (int k = layer + 1; k"),
    "no lower end of what goes on": ("low <= height && height <= high", "height <= high"),
    "empty texels go on": ("low <= height && height <= high", "low <= height"),
    "walls of no height": ("height + uWall)", "height)"),
    "walls of any height": ("height + uWall)", "INFINITY)"),
    "the layer ends at its end": ("(uWall < INFINITY ? uWall : 0.0)", "0.0"),
    "the walk begins in the middle": (
        "float enter = uEnds[layer].x,",
        "float enter = 0.5 * (uEnds[layer].x + uEnds[layer].y),",
    ),
    "no tops": ("if (height <= leaves)", "if (height <= enter)"),
    "tops of the texel after": ("if (height <= leaves)", "if (height <= last)"),
    "heights are where they are met": ("return vec3(here, height);", "return vec3(here, enter);"),
    "no walls": ("before.x < 0 || (here != before && goesOn(", "before.x < 0 || (false && goesOn("),
    "all walls": ("(here != before && goesOn(", "(here != before || goesOn("),
    "nothing goes on behind edges": ("else if (seenHeight <= leaves)", "else if (false)"),
    "the edge's own texel": ("return vec3(seen, seenHeight);", "return vec3(here, seenHeight);"),
    "edges forget what they hid": ("            seenHeight = height;", "            seenHeight = last;"),
    "the texel before is the pixel's": ("        before = here;", "        before = ivec2(gl_FragCoord.xy);"),
    "back to front": ("vec3 found = walk(layer);", "vec3 found = walk(textureSize(uHeights, 0).z - 1 - layer);"),
    "the first layer only": ("if (found.x >= 0.0) {", "if (found.x >= 0.0 || layer > 0) {"),
    "colours of the pinhole": ("ivec3(found.xy, layer), 0).rgb", "ivec3(gl_FragCoord.xy, layer), 0).rgb"),
}


REWRITES = {
    "a product for a quotient": ("(gl_FragCoord[k] - edge[k]) / v[k]", "(gl_FragCoord[k] - edge[k]) * (1.0 / v[k])"),
    "two quotients": ("(gl_FragCoord[k] - edge[k]) / v[k]", "gl_FragCoord[k] / v[k] - edge[k] / v[k]"),
}


@dataclass(frozen=True)
class Case:
    """Layers by their seed, one lens point, x right, y up, and the highest wall that is surface [px]."""

    seed: int
    lens: tuple[float, float]
    wall: float


CASES = [
    Case(1, (0.62, -0.41), 1.0),
    Case(2, (-0.35, 0.83), 0.5),
    Case(3, (0.0, -0.9), 1.0),
    Case(2, (0.8, 0.5), np.inf),
]


@functools.cache
def layers(seed, height=19, width=26):
    """Heights (4, H, W) float32, least and greatest c (4,) and colours (4, H, W, 3).

    A slope, a slanted card with holes, bars and noise, in four layers that overlap by 0.6 px.
    """
    random = np.random.default_rng(seed)
    y, x = np.indices((height, width))
    surfaces = np.full((4, height, width), np.inf)
    surfaces[0] = 5.9 - 0.13 * x - 0.04 * y
    surfaces[0, -6:] = (5.6 - 0.44 * x + 0.07 * y)[-6:]  # from layer to layer in steps wider than their overlap
    surfaces[1, 3:12, 5:19] = (-5.5 + 0.11 * x + 0.05 * y)[3:12, 5:19]
    surfaces[2, ::5] = -4.0 + 0.02 * x[::5]
    surfaces[3] = np.where(random.random((height, width)) < 0.15, random.uniform(-6.0, 6.0, (height, width)), np.inf)
    surfaces[:2][random.random((2, height, width)) < 0.06] = np.inf
    surfaces[:, : height // 3, -width // 5 :] = np.inf
    bounds = np.array([-6.0, -4.0, -1.8, 1.0, 6.0])
    near, far = (bounds[:-1] - 0.3).astype(np.float32), (bounds[1:] + 0.3).astype(np.float32)
    surfaces = surfaces.astype(np.float32)
    held = [np.where((surfaces >= a) & (surfaces < b), surfaces, np.inf) for a, b in zip(near, far, strict=True)]
    return np.min(held, axis=1).astype(np.float32), near, far, random.random((4, height, width, 3), dtype=np.float32)


def hits(case, lens=1.0, height=1.0, wall=1.0):
    """Layer, column, row and c (H, W, 4) of what rays hit, by the method; lens point, heights and walls scaled."""
    coc, near, far, _ = layers(case.seed)
    highest = wall * case.wall
    fields = fields_of(coc * np.float32(height), near, far, 1.0, 0.0, highest)
    search = Search(middle=False, steps=3, bisections=5, wall=highest, march=True, culling=False, discard=False)
    found = trace_hits(fields, one_point(lens * np.array(case.lens)), search)
    layer, texel, c = found.layer[..., 0], found.texel[..., 0], found.coc[..., 0]
    met = layer >= 0
    row, column = np.divmod(np.where(met, texel, 0), coc.shape[2])
    return np.stack([layer, column, row, np.where(met, c, 0.0)], axis=-1)


expected = functools.cache(hits)


@functools.cache
def answers(case):
    """Hits (H, W, 3) of rays that are shaken a little: where they differ, rays meet a border."""
    return [
        hits(case, **{name: 1.0 + step})[..., :3] for name in ("lens", "height", "wall") for step in (-SHAKE, SHAKE)
    ]


def picture_of(context, case, source=SOURCE):
    """Hit and colour (H, W, 4) as the shader finds them."""
    coc, near, far, color = layers(case.seed)
    ends = [(float(a), float(b)) for a, b in zip(near, far, strict=True)] + [(0.0, 0.0)] * (MOST - len(near))
    return drawn(
        context, source, coc.shape[1:], {"uHeights": coc[..., None], "uColors": color}, 2,
        uEnds=ends, uLens=case.lens, uWall=case.wall, uBackground=BACKGROUND,
    )  # fmt: skip


def complaint(case, picture):
    """What is wrong with a picture, or None."""
    (found, color), hit = picture, expected(case)
    same, wrong = hits_off(found[..., :3], hit[..., :3], lambda: answers(case))
    if wrong:
        return f"hits of {wrong} pixels"
    if not np.abs(found[..., 3] - hit[..., 3])[same].max() <= PLACE:
        return "places of hits"
    layer, column, row = (np.maximum(found[..., k], 0).astype(int) for k in range(3))
    seen = np.where(found[..., :1] >= 0, layers(case.seed)[3][layer, row, column], np.array(BACKGROUND, np.float32))
    return None if np.array_equal(color[..., :3], seen) else "colours"


def complaints(context, source):
    """What is wrong with the picture of each case, one after another, or None."""
    for case in CASES:
        found = complaint(case, picture_of(context, case, source))
        print(found)
        yield found


@pytest.mark.parametrize("case", CASES, ids=str)
def test_every_ray(case, context):
    picture = picture_of(context, case)
    hit = expected(case)
    differ = (picture[0][..., :3] != hit[..., :3]).any(axis=-1).sum()
    print(f"{differ} rays meet a border, out of {hit[..., 0].size}")
    print(f"hits of layers -1 .. 3: {[int((hit[..., 0] == k).sum()) for k in range(-1, 4)]}")
    assert complaint(case, picture) is None
    assert differ <= 2


def test_few_rays_meet_a_border():
    """Else the other answers would excuse faults."""
    for case in CASES:
        assert share_tied(hits(case)[..., :3], answers(case)) < 0.02


@pytest.mark.parametrize("rewrite", REWRITES)
def test_a_right_port_may_round_otherwise(rewrite, context):
    assert not any(complaints(context, mutated(SOURCE, *REWRITES[rewrite])))


@pytest.mark.parametrize("fault", FAULTS)
def test_no_planted_fault_passes(fault, context):
    assert any(complaints(context, mutated(SOURCE, *FAULTS[fault])))

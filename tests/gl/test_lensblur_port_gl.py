"""One lens ray of every pixel as a fragment shader: the depths left to it, what it hits and the colour there.

The method itself tells what its rays hit: one ray a pixel sees colours that number the samples.
"""

import functools
from dataclasses import dataclass

import numpy as np
import pytest

from refdof import ThinLens, View
from refdof.methods.lensblur.layer_trace import Choices, new_stack, trace_layers
from refdof.raster.filters.n_buffer import n_buffer
from tests import flat_scene
from tests.gl.port import drawn, source_of
from tests.gl.rays import hits_off, one_point, share_tied
from tests.ports.cases import mutated

pytestmark = pytest.mark.gl

SOURCE = source_of("lensblur")
BACKGROUND = (0.25, 0.5, 0.75)

# Places and crossings are rounded to 2^-24 of 30 px and of 12 px of parallax over a slope of 1/3 and more: 1e-5. A
# colour moves by as much, in two directions.
PLACE, COLOR = 2e-5, 4e-5
SHAKE = 1e-5  # of the lens point and the focal plane: what a ray hits then, too, is a right answer

FAULTS = {
    "the lens is mirrored": (
        "vec2 a = gl_FragCoord.xy - uFocus * uLens, w = uLens,",
        "vec2 a = gl_FragCoord.xy + uFocus * uLens, w = -uLens,",
    ),
    "the pixel at its corner": ("vec2 a = gl_FragCoord.xy -", "vec2 a = floor(gl_FragCoord.xy) -"),
    "a level too fine": ("while ((2 << level) < side)", "while ((4 << level) < side)"),
    "the last square is at the first": ("max(last + 1 - (1 << level), first)", "first"),
    "another pack's N-buffer": ("int k = pack * uLevels + level", "int k = level"),
    "a footprint of the near end": ("max(abs(near - uFocus), abs(far - uFocus))", "abs(near - uFocus)"),
    "pixels for blocks": ("extremesIn(pack, first / uBlock, last / uBlock)", "extremesIn(pack, first, last)"),
    "nothing is something": ("if (found.x > found.y)", "if (found.x < found.y)"),
    "extensions are cut off": ("max(far, found.x - uExtension)", "max(far, found.x)"),
    "cut once": ("n < uIterations;", "n < 1;"),
    "texels are entered where they are left": ("entry = w > 0.0 ? 1.0 : 0.0", "entry = w > 0.0 ? 0.0 : 1.0"),
    "the walk goes up": ("ivec2(mix(vec2(0.0), -sign(w), moves))", "ivec2(mix(vec2(0.0), sign(w), moves))"),
    "rows first": ("crossings.x > crossings.y ?", "crossings.x < crossings.y ?"),
    "texels at a depth step of one pixel": ("? ivec2(pace.x, 0) : ivec2(0, pace.y)", "? pace : pace"),
    "the first layer only": ("k < 4 && samples[k] >= leave", "k < 1 && samples[k] >= leave"),
    "samples below the ray's exit": ("samples[k] >= leave;", "samples[k] >= end;"),
    "no walls": ("if (!first && sampleBetween", "if (false && sampleBetween"),
    "all walls": ("begin) >= 0)", "begin) >= -1)"),
    "walls are not extended": ("samples[k] - uExtension, begin)", "samples[k], begin)"),
    "walls are met at their top": ("met = min(samples[k], begin);", "met = samples[k];"),
    "the texel before is not kept": ("        before = texel;", "        before = ivec2(0);"),
    "the first pack hides all": ("slot >= 0 && met > nearest", "slot >= 0 && layer < 0"),
    "packs of three": ("layer = 4 * pack + slot;", "layer = 3 * pack + slot;"),
    "rays come in from outside": ("        border = -INFINITY;", "        border = border;"),
    "rays begin outside": ("min(depths.x, border), end", "depths.x, end"),
    "rays that leave see the background": ("border < 0.0 || !ends || full", "border < 0.0 || full"),
    "all layers are known": ("border < 0.0 || !ends || full", "border < 0.0 || !ends"),
    "colours at the nearest texel": ("vec2 share = min(abs(from), 0.5);", "vec2 share = vec2(0.0);"),
    "colours bleed between surfaces": (
        "other < 0 ? ivec3(texel, layer) : ivec3(side, other)",
        "ivec3(side, max(other, 0))",
    ),
    "colours of a layer, not of a surface": (
        "other < 0 ? ivec3(texel, layer) : ivec3(side, other)",
        "ivec3(side, layer)",
    ),
    "colours toward the other side": ("from.x > 0.0 ? 1 : -1", "from.x > 0.0 ? -1 : 1"),
    "a surface of a pixel's parallax": ("SAME_SURFACE = 0.5", "SAME_SURFACE = 1.0"),
}


REWRITES = {
    "a quotient for a product": ("(vec2(texel) + ahead - a) * inverse", "(vec2(texel) + ahead - a) / w"),
    "places from the focal plane": (
        "(vec2(texel) + ahead - a) * inverse",
        "(vec2(texel) + ahead - gl_FragCoord.xy) * inverse + uFocus",
    ),
    "blends with one product": (
        "return mix(upper, lower, share.y);",
        "return upper + share.y * (lower - upper);",
    ),
}


@dataclass(frozen=True)
class Case:
    """Layers by their seed, some or all of them, and one lens point, x right, y up."""

    seed: int
    lens: tuple[float, float]
    complete: bool
    extension: float
    block: int

    @property
    def focus(self):
        return 4.0 + 0.3 * self.seed


CASES = [
    Case(1, (0.62, -0.41), True, 1.25, 2),
    Case(2, (-0.35, 0.83), False, 0.75, 2),
    Case(3, (0.0, -0.9), True, 0.25, 1),
    Case(1, (0.0, 0.0), False, 1.25, 4),
]


@functools.cache
def layers(seed, height=19, width=26):
    """u of six layers (6, H, W) float32, front to back, and colours (6, H, W, 3): slopes, cards with holes, noise."""
    random = np.random.default_rng(seed)
    y, x = np.indices((height, width))
    u = np.full((6, height, width), -np.inf)
    u[0] = 1.0 + 0.13 * x + 0.04 * y
    u[1, 3:12, 5:19] = (9.0 - 0.11 * x - 0.05 * y)[3:12, 5:19]
    u[2, 6:, 12:] = (6.5 + 0.31 * y - 0.17 * x)[6:, 12:]
    u[3, ::4] = 11.0 + 0.02 * x[::4]
    u[4:] = random.uniform(0.2, 10.0, (2, height, width))
    u[(random.random(u.shape) < 0.25)] = -np.inf
    u[:, : height // 3, -width // 4 :] = -np.inf
    u[:, 4:6, 22:24] = np.linspace(11.0, 8.0, 6)[:, None, None]  # all layers, with nothing around them
    color = random.random((6, height, width, 3), dtype=np.float32)
    return -np.sort(-u, axis=0).astype(np.float32), color


def stack_of(case):
    return new_stack(layers(case.seed)[0], case.extension, case.complete, case.block)


def traced(case, color, focus=1.0, lens=1.0, linear=False):
    """The method's own answer for colours (6, H, W, 3), with the focal plane and the lens point scaled."""
    _, height, width, _ = color.shape
    shot = flat_scene.camera(width, height, 8.0)
    view = View(flat_scene.scene_of([], shot, background=BACKGROUND), shot, ThinLens(1.0, 1.0))
    return trace_layers(
        stack_of(case), color, view.surfaces(), view.projection(), focus * case.focus,
        one_point(lens * np.array(case.lens)),
        np.zeros((height, width, 3), np.float32), Choices(misses="black", linear=linear),
    )  # fmt: skip


def hits(case, **scales):
    """Layer, column and row (H, W, 3) of what rays hit: layer -1 the background, -2 not known."""
    shape = layers(case.seed)[0].shape
    numbered = np.stack(np.indices(shape)[[0, 2, 1]], axis=-1).astype(np.float32) + np.float32(1)
    found = traced(case, numbered, **scales)
    hit = found.image - 1.0
    hit[(found.image == np.array(BACKGROUND, np.float32)).all(axis=-1)] = (-1, 0, 0)
    hit[found.missed > 0] = (-2, 0, 0)
    return hit


@functools.cache
def expected(case):
    """Depths (H, W, 4) of the first and the last pack, hits (H, W, 3) and colours (H, W, 3)."""
    answer = traced(case, layers(case.seed)[1], linear=True)
    depths = np.stack([answer.near[0], answer.far[0], answer.near[-1], answer.far[-1]], axis=-1)
    return depths, hits(case), answer.image


@functools.cache
def answers(case):
    """Hits of rays that are shaken a little: where they differ, rays meet a border."""
    return [hits(case, **{name: 1.0 + step}) for name in ("focus", "lens") for step in (-SHAKE, SHAKE)]


def picture_of(context, case, source=SOURCE):
    """Hit, colour and depths (H, W, 4) as the shader finds them."""
    parallax, color = layers(case.seed)
    stack = stack_of(case)
    buffers = [n_buffer(pack.transpose(2, 0, 1), block=case.block) for pack in stack.packs]
    extremes = np.concatenate([np.stack([b.lowest, b.highest], axis=-1) for b in buffers])
    right, up = case.lens
    return drawn(
        context, source, parallax.shape[1:], {"uPacks": stack.packs, "uColors": color, "uExtremes": extremes}, 3,
        uLevels=len(buffers[0].lowest), uBlock=case.block, uIterations=3, uFocus=case.focus, uLens=(right, -up),
        uExtension=case.extension, uLast=-1 if case.complete else len(parallax) - 1, uBackground=BACKGROUND,
    )  # fmt: skip


def complaint(case, picture):
    """What is wrong with a picture, or None."""
    (found, color, depths), (own_depths, hit, own_color) = picture, expected(case)
    if not np.array_equal(depths, own_depths):
        return f"depths of {(depths != own_depths).any(axis=-1).sum()} pixels"
    same, wrong = hits_off(found[..., :3], hit, lambda: answers(case))
    if wrong:
        return f"hits of {wrong} pixels"
    met = same & (hit[..., 0] >= 0)
    if not np.abs(found[..., 3] - height_of(case, hit))[met].max() <= PLACE:
        return "places of hits"
    known = same & (hit[..., 0] >= -1)
    if not np.abs(color[..., :3] - own_color)[known].max() <= COLOR:
        return "colours"
    return None if (color[..., 3] == (found[..., 0] >= -1)).all() else "weights"


def complaints(context, source):
    """What is wrong with the picture of each case, one after another, or None."""
    for case in CASES:
        found = complaint(case, picture_of(context, case, source))
        print(found)
        yield found


def height_of(case, hit):
    """u (H, W) of hits: the sample's, or where the ray comes into its texel, if that is lower."""
    parallax, _ = layers(case.seed)
    layer, column, row = (np.maximum(hit[..., k], 0).astype(int) for k in range(3))
    enter = np.full(hit.shape[:2], np.inf)
    y, x = np.indices(layer.shape)
    for at, pixels, w in ((column, x, case.lens[0]), (row, y, -case.lens[1])):
        if w != 0.0:
            enter = np.minimum(enter, (at + (w > 0) - (pixels + 0.5 - case.focus * w)) / w)
    return np.minimum(parallax[layer, row, column], enter)


@pytest.mark.parametrize("case", CASES, ids=str)
def test_every_ray(case, context):
    picture = picture_of(context, case)
    _, hit, _ = expected(case)
    differ = (picture[0][..., :3] != hit).any(axis=-1).sum()
    known = [int((hit[..., 0] == k).sum()) for k in range(-2, 6)]
    print(f"{differ} rays meet a border, out of {hit[..., 0].size}; hits of layers -2 .. 5: {known}")
    assert complaint(case, picture) is None
    assert differ <= 2


def test_few_rays_meet_a_border():
    """Else the four answers of a ray would excuse faults."""
    for case in CASES[:3]:
        assert share_tied(hits(case), answers(case)) < 0.02


@pytest.mark.parametrize("rewrite", REWRITES)
def test_a_right_port_may_round_otherwise(rewrite, context):
    assert not any(complaints(context, mutated(SOURCE, *REWRITES[rewrite])))


@pytest.mark.parametrize("fault", FAULTS)
def test_no_planted_fault_passes(fault, context):
    assert any(complaints(context, mutated(SOURCE, *FAULTS[fault])))

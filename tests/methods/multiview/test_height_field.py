"""Rays through height fields by hand: borders of texels and of the image, each step of the search, what culling skips.

Fields are rows of texels, empty but for a few. Through lens point (1, 0) the ray of pixel x is over x + 1/2 - c at
height c.
"""

import numpy as np
import pytest

from refdof._jit import tile_kernel
from refdof.methods.multiview.fields import Ray, Search, fields_of
from refdof.methods.multiview.gather import culled_layers, trace_hits
from refdof.methods.multiview.height_field import first_texel, step
from refdof.optics.pixel_samples import LensPointSets

pytestmark = pytest.mark.fast
SEARCH = Search(middle=False, steps=3, bisections=5, wall=0.0, march=False, culling=False, discard=False, holes=False)


def one_set(*points):
    return LensPointSets(np.array(points, float)[None], np.ones((1, len(points))), np.zeros((1, 1), np.int32))


def field(width, heights):
    """One row (1, 1, width) of {column: height}."""
    coc = np.full((1, 1, width), np.inf)
    for column, height in heights.items():
        coc[0, 0, column] = height
    return coc


def hit(heights, near, far, pixel, lens=(1.0, 0.0), width=12, upright=False, **words):
    """(column, c) that the ray of a pixel meets, or None; `upright` swaps rows and columns, and x and y of the lens."""
    coc, point = field(width, heights), lens
    if upright:  # y is up in the lens and down in the image
        coc, point = coc.transpose(0, 2, 1), (lens[1], -lens[0])
    ends = np.array([float(near)]), np.array([float(far)])
    found = trace_hits(fields_of(coc, *ends, 1.0), one_set(point), SEARCH._replace(**words))
    layer, texel, c = (getattr(found, name).reshape(-1)[pixel] for name in ("layer", "texel", "coc"))
    return (int(texel), float(c)) if layer == 0 else {-1: None, -2: "left"}[int(layer)]


# --- the search, step by step


def test_two_steps_of_false_position():
    # From 0 to 8 over texels 10 .. 2; texel 2 is 4 high, all before it are empty: heights count as 8.
    # 8 * 8 / (8 + 4) = 5 1/3, over texel 5; then 5 1/3 + 8/3 * (8/3) / (8/3 + 4) = 6.4, over texel 4.
    heights = {4: 6.3, 2: 4.0}
    assert hit(heights, 0, 8, 10, steps=2) == (4, 6.3)
    # One step only: halving from 5 1/3 on sees texels 3 and 2.
    assert hit(heights, 0, 8, 10, steps=1) is None


def test_halving_a_known_number_of_times():
    # The middle, 4, lies over texel 6, 1 high: the ray is behind it. 2, 3 and 3.5 are still over empty texels, 3.75 and
    # 3.625 over texel 6 again. A wall of any height is surface here.
    words = {"middle": True, "wall": np.inf}
    assert hit({6: 1.0}, 0, 8, 10, bisections=5, **words) == (6, 3.625)
    assert hit({6: 1.0}, 0, 8, 10, bisections=4, **words) == (6, 3.75)
    assert hit({6: 1.0}, 0, 8, 10, bisections=0, **words) == (6, 4.0)
    # A surface in front of the ray is left behind, and the part after it is halved: 2 is in front of texel 8.
    assert hit({8: 2.6, 6: 1.0}, 0, 8, 10, bisections=1, **words) == (6, 4.0)


def test_the_middle_is_looked_at_first():
    # Texel 10 is under the near end, texel 6 under the middle.
    both = {10: 0.2, 6: 4.1}
    assert hit(both, 0, 8, 10) == (10, 0.2)
    assert hit(both, 0, 8, 10, middle=True) == (6, 4.1)
    # A middle behind its surface: only the half in front of it is searched, and the near end is not looked at.
    assert hit({10: 0.2, 6: 1.0}, 0, 8, 10, middle=True) is None
    # An empty middle tells nothing: both ends are looked at.
    assert hit({10: 0.2}, 0, 8, 10, middle=True) == (10, 0.2)


def test_a_middle_in_front_of_its_surface_begins_the_rest():
    # 4 is over texel 6, which is 5 high, but at 5 the ray is beyond that texel. The ends are not looked at: the far one
    # counts as 8 px too low. So 4 + 4 * 1 / (1 + 8) = 4.44, still over texel 6, then 4.44 + 3.56 * 0.56 / 8.56 = 4.67.
    heights = {6: 5.0, 5: 4.7, 2: 3.0}
    assert hit(heights, 0, 8, 10, middle=True, steps=2) == (5, 4.7)
    assert hit(heights, 0, 8, 10, middle=True, steps=1) is None


# --- borders of texels


@pytest.mark.parametrize("march", [False, True])
@pytest.mark.parametrize("upright", [False, True])
def test_a_texel_holds_its_left_and_upper_border(march, upright):
    # Through (1/2, 0), pixel 2 is over 2.5 - c / 2: over the border between texels 1 and 2 at c = 1.
    words = {"lens": (0.5, 0.0), "width": 5, "march": march, "upright": upright}
    assert hit({2: 1.0}, 0, 2, 2, **words) == (2, 1.0)


@pytest.mark.parametrize("upright", [False, True])
def test_a_ray_on_a_border_is_over_both_texels(upright):
    # At c = -1 pixel 2 is over 3.0, from texel 3 to texel 2. A little lower, texel 2 is below all of the ray.
    words = {"lens": (0.5, 0.0), "width": 5, "upright": upright}
    assert hit({2: -1.0}, -1, 0, 2, **words) == (2, -1.0)
    assert hit({2: -1.001}, -1, 0, 2, **words) is None
    assert hit({3: -1.0}, -1, 0, 2, **words) == (3, -1.0)
    assert hit({2: -0.75}, -1, 0, 2, **words) == (2, -0.75)


@pytest.mark.parametrize("march", [False, True])
@pytest.mark.parametrize("upright", [False, True])
def test_the_first_and_the_last_texel_go_on_for_ever(march, upright):
    words = {"width": 3, "march": march, "upright": upright}
    assert hit({0: 5.0}, 0, 8, 1, **words) == (0, 5.0)  # over -3.5
    assert hit({2: -5.0}, -8, 0, 1, **words) == (2, -5.0)  # over 6.5
    assert hit({1: 5.0}, 0, 8, 1, **words) is None


# --- borders of the image


@pytest.mark.parametrize("march", [False, True])
@pytest.mark.parametrize("upright", [False, True])
def test_a_ray_leaves_the_image_at_its_right_and_lower_border(march, upright):
    words = {"lens": (0.5, 0.0), "width": 3, "discard": True, "march": march, "upright": upright}
    # Pixel 2 at c = -1 is over 3.0, the image's end; at -0.75 over 2.875.
    assert hit({2: -0.5}, -1, 0, 2, **words) == "left"
    assert hit({2: -0.5}, -0.75, 0, 2, **words) == (2, -0.5)
    # Pixel 0 at c = 1 is over 0.0, which is inside, at 1.25 over -0.125.
    assert hit({0: 0.5}, 0, 1, 0, **words) == (0, 0.5)
    assert hit({0: 0.5}, 0, 1.25, 0, **words) == "left"
    # The same at the end that comes second.
    assert hit({2: -0.5}, -1, -0.25, 2, **words) == "left"


@pytest.mark.parametrize("order", [1, -1])
@pytest.mark.parametrize("culling", [False, True])
def test_a_ray_may_leave_within_any_layer(order, culling):
    # One layer of 3 px of blur, through which the outer pixels' rays leave, and one of 1/4 px.
    coc = np.full((2, 9, 8), np.inf)
    near, far = np.array([-3.0, -0.25])[::order], np.array([-2.75, 0.25])[::order]
    coc[0 if order == 1 else 1], coc[1 if order == 1 else 0] = np.inf, 0.0
    coc[0 if order == 1 else 1, 0, 4] = -2.9  # in no ray's way: rays do not leave within a layer that holds nothing
    search = SEARCH._replace(discard=True, culling=culling)
    found = trace_hits(fields_of(coc, near, far, 1.0), one_set((1.0, 0.0)), search).layer[4, :, 0]
    # Over x + 1/2 + 3 at the first: inside up to pixel 4. A ray that meets something before it leaves stays.
    still = 1 if order == 1 else 0
    np.testing.assert_array_equal(found, [still] * 5 + ([-2] * 3 if order == 1 else [0] * 3))


# --- culling


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("march", [False, True])
def test_culling_changes_no_bit_where_the_border_goes_on(seed, march):
    random = np.random.default_rng([seed, 7])
    near, far = np.array([-3.0, -1.0, 1.0]), np.array([-1.0, 1.0, 3.0])
    coc = near[:, None, None] + 2.0 * random.random((3, 9, 14))
    coc[0, :, :9] = coc[1, :, 5:] = coc[2, :, 2:8] = np.inf
    coc[random.random(coc.shape) < 0.3] = np.inf
    fields = fields_of(coc, near, far, 1.0)
    pattern = one_set((0.9, 0.1), (-0.5, 0.7), (0.0, -1.0), (-1.0, 0.0))
    on = SEARCH._replace(culling=True, march=march, wall=0.5)
    assert 0.05 < culled_layers(fields, on).mean() < 0.9
    for a, b in zip(
        trace_hits(fields, pattern, on), trace_hits(fields, pattern, on._replace(culling=False)), strict=True
    ):
        np.testing.assert_array_equal(a, b)


def test_only_layers_out_of_reach_are_culled():
    # One texel, at circle of confusion 2: rays of pixels up to 2 px away can meet it. Blocks of 4 px and the bound's
    # own pixel may keep more, up to 3 + 1 px on either side.
    coc = np.full((1, 1, 24), np.inf)
    coc[0, 0, 12] = 2.0
    culled = culled_layers(
        fields_of(coc, np.array([2.0]), np.array([2.0]), 1.0, wall=0.0), SEARCH._replace(culling=True)
    )[0, 0]
    assert not culled[10:15].any()
    assert culled[: 12 - 2 - 4].all()
    assert culled[12 + 2 + 4 + 1 :].all()


@pytest.mark.parametrize(
    ("near", "far", "largest", "widening", "least"),
    [
        (-2.5, 1.0, 1.0, 0.0, 2.5),
        (-1.0, 2.5, 1.0, 0.0, 2.5),
        (-2.5, 1.0, 0.5, 0.0, 1.25),
        (-2.0, 1.0, 0.5, 1.5, 4.0),  # cones read beside their middle ray
        (-6.0, 1.0, 1.0, 0.0, 6.0),  # the image's longer side is 9 px, its shorter one 3
        (-1e30, 1.0, 1.0, 0.0, 9.0),  # farther than the whole image need not be looked
    ],
)
def test_reach_holds_the_blur_and_little_more(near, far, largest, widening, least):
    fields = fields_of(np.full((1, 3, 9), np.inf), np.array([near]), np.array([far]), largest, widening, 0.0)
    assert least <= fields.reach[0] <= least + 2.0


# --- ambiguous rays


def ambiguous(heights, far, pixel=2, near=0.0, width=5, **words):
    search = SEARCH._replace(wall=0.5, **words)
    fields = fields_of(field(width, heights), np.array([near]), np.array([float(far)]), 1.0)
    return bool(trace_hits(fields, one_set((0.5, 0.0)), search).ambiguous[0, pixel, 0])


def test_numbers_too_close_to_call_are_ambiguous():
    # Pixel 2 leaves texel 2 at c = 1 and texel 1 at c = 3.
    assert not ambiguous({2: 0.9, 1: 0.2, 0: 0.2}, 3)
    assert not ambiguous({2: 1.1, 1: 0.2, 0: 0.2}, 3)
    assert ambiguous({2: 1.0005, 1: 0.2, 0: 0.2}, 3)
    assert ambiguous({2: 0.9995, 1: 0.2, 0: 0.2}, 3)


def test_what_blocks_and_then_is_free_is_ambiguous():
    assert ambiguous({2: 0.9}, 3)
    # A ray that leaves the image for certain is not: nothing else is asked of it. At c = 8 it is over -1.5.
    assert not ambiguous({2: 0.9}, 8, discard=True)
    assert ambiguous({2: 0.9}, 8, discard=False)


def test_rays_along_the_images_border_are_ambiguous():
    # Pixel 3 of 4 ends over 3.5 - near / 2, and the image at 4.
    words = {"heights": {3: -0.5}, "far": 0, "pixel": 3, "width": 4, "march": True, "discard": True}
    assert ambiguous(near=-1.0 - 2e-4, **words)
    assert ambiguous(near=-1.0 + 2e-4, **words)
    assert not ambiguous(near=-1.2, **words)


# --- steps


@tile_kernel
def stepped(px, py, vx, vy, x, y):
    return step(Ray(px, py, vx, vy), x, y, 99.0, 8, 8)


@tile_kernel
def first_of(c):
    return first_texel(Ray(1.5, 0.5, 1.0, 0.5), c, 6, 4)


def test_a_walk_begins_beside_the_image_if_the_ray_does():
    # Over (1.5 - c, 0.5 + c / 2), in an image of 6 x 4 texels.
    assert [first_of(c) for c in (0.0, 1.75, 2.0, 99.0)] == [(1, 0), (-1, 1), (-1, 1), (-1, 4)]
    assert [first_of(c) for c in (-1.25, -4.5, -99.0)] == [(2, -1), (6, -1), (6, -1)]


def test_at_a_corner_a_ray_goes_to_the_texel_beside():
    # From (4, 4): texel (4, 4) at c = 0, its corners half a pixel of c away; (px - c vx, py + c vy).
    for vx, vy, wanted in ((1, 1, (0.5, 3, 4)), (-1, 1, (0.5, 5, 4)), (1, -1, (0.5, 3, 4)), (-1, -1, (0.5, 5, 4))):
        assert stepped(4.5, 4.5, float(vx), float(vy), 4, 4) == wanted
    assert stepped(4.5, 4.5, 1.0, 1.125, 4, 4) == (0.5 / 1.125, 4, 5)
    assert stepped(4.5, 4.5, 1.0, 0.875, 4, 4) == (0.5, 3, 4)

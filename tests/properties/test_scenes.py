"""Properties that every method has, on any scene of a few cards: what is done to the scene is done to the picture.

Where the other properties are tested stands in `test_table.py`.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from refdof import METHODS, Camera, ThinLens, render
from refdof.kernel_shape import kernel_shape
from tests import flat_scene as flat

WIDTH, HEIGHT, PIXELS = 9, 7, 16.0
FOCUS = 2.0
LENS = ThinLens(0.25, FOCUS)  # circles of 4 (1 / 2 - 1 / depth) px
SHOT = flat.camera(WIDTH, HEIGHT, PIXELS)
SAMPLED = {"accumulation", "lensblur", "multiview"}
FEW = settings(max_examples=5)  # of some ten renders each

values = st.sampled_from([0.0, 0.25, 1.0, 3.0])
colors = st.tuples(values, values, values)
# Edges lie between pixels, as they do in the pinhole picture.
places = st.integers(-WIDTH, 2 * WIDTH)
cards = st.tuples(places, places, places, places, st.sampled_from([1.0, FOCUS, 4.0, 16.0]))
layouts = st.lists(cards, min_size=1, max_size=3)


def part(card, color):
    """A card between columns and rows of the pinhole picture."""
    x0, x1, y0, y1, depth = card
    x0, x1 = sorted(((x0 - WIDTH / 2), (x1 - WIDTH / 2)))
    y0, y1 = sorted(((HEIGHT / 2 - y0), (HEIGHT / 2 - y1)))
    per_pixel = depth / PIXELS
    return flat.rectangle(x0 * per_pixel, (x1 + 1) * per_pixel, y0 * per_pixel, (y1 + 1) * per_pixel, depth, color)


def scene(layout, paints, background, lens=LENS, shot=SHOT):
    parts = [part(card, tuple(map(float, color))) for card, color in zip(layout, paints, strict=False)]
    return flat.scene_of(parts, shot, lens, tuple(map(float, background)))


def rendered(name, made):
    return render(name, made, **({"samples": 16} if name in SAMPLED else {})).image.astype(np.float64)


paints = st.lists(colors, min_size=4, max_size=4)


@pytest.mark.parametrize("name", METHODS)
@FEW
@given(layout=layouts, first=paints, second=paints, factor=st.sampled_from([0.5, 1.0, 4.0]))
def test_light_adds_up(name, layout, first, second, factor):
    both = [tuple(a + factor * b for a, b in zip(*pair, strict=True)) for pair in zip(first, second, strict=True)]
    one, other, added = (rendered(name, scene(layout, colors, colors[3])) for colors in (first, second, both))
    # Sums of up to 400 float32 terms round by less than 1e-5 of the brightest, 3 + 4 * 3.
    np.testing.assert_allclose(added, one + factor * other, rtol=0, atol=15e-5)


@pytest.mark.parametrize("name", METHODS)
@FEW
@given(layout=layouts, paint=paints, order=st.permutations(range(3)))
def test_channels_do_not_mix(name, layout, paint, order):
    image = rendered(name, scene(layout, paint, paint[3]))
    turned = [tuple(color[c] for c in order) for color in paint]
    np.testing.assert_array_equal(rendered(name, scene(layout, turned, turned[3])), image[..., order])


@pytest.mark.parametrize("name", METHODS)
@FEW
@given(layout=layouts, paint=paints, exponent=st.sampled_from([-20, -1, 1, 20]))
def test_the_unit_of_length_changes_no_bit(name, layout, paint, exponent):
    unit = 2.0**exponent
    plain = scene(layout, paint, paint[3])
    shot = Camera.look_at((0, 0, 0), (0, 0, -1), fov_y=SHOT.fov_y, size=SHOT.size)
    lens = ThinLens(LENS.radius * unit, FOCUS * unit)
    other = replace(plain, vertices=plain.vertices * unit, camera=shot, lens=lens)
    np.testing.assert_array_equal(rendered(name, other), rendered(name, plain))


@pytest.mark.parametrize("name", METHODS)
@FEW
@given(layout=layouts, paint=paints, wall=colors, depth=st.sampled_from([1.5, FOCUS, 3.0]))
def test_what_a_wall_hides_changes_nothing(name, layout, paint, wall, depth):
    hidden = [(*card[:4], 16.0 * card[4]) for card in layout]
    out = 10 * WIDTH
    front = part((-out, out, -out, out, depth), wall)
    with_them = flat.scene_of([front, *(part(c, p) for c, p in zip(hidden, paint, strict=False))], SHOT, LENS)
    alone = flat.scene_of([front], SHOT, LENS)
    # A wall of one colour is that colour; sums round as above.
    for made in (with_them, alone):
        np.testing.assert_allclose(rendered(name, made), np.broadcast_to(wall, (HEIGHT, WIDTH, 3)), rtol=1e-5)


@pytest.mark.parametrize("name", METHODS)
@FEW
@given(layout=layouts, paint=paints, cut=places)
def test_a_card_cut_in_two_is_the_card(name, layout, paint, cut):
    """Along a column of pixels, so that both halves share an edge."""
    parts = [part(card, p) for card, p in zip(layout, paint, strict=False)]
    halves = []
    for card, p in zip(layout, paint, strict=False):
        x0, x1 = sorted(card[:2])
        for a, b in ((x0, min(cut, x1 + 1) - 1), (max(cut, x0), x1)):
            if a <= b:
                halves.append(part((a, b, *card[2:]), p))
    background = paint[3]
    whole = rendered(name, flat.scene_of(parts, SHOT, LENS, background))
    split = rendered(name, flat.scene_of(halves, SHOT, LENS, background))
    np.testing.assert_allclose(split, whole, rtol=0, atol=3e-5)


@pytest.mark.parametrize("name", METHODS)
def test_a_wider_aperture_blurs_no_less(name):
    radii = [circle * kernel_shape(name, circle=circle, light=2).radius for circle in (2.0, 4.0, 8.0)]
    print(name, radii)
    assert all(math.isfinite(radius) for radius in radii)
    assert radii == sorted(radii)

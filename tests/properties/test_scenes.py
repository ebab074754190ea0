"""Properties that every method has, on any scene of a few cards: what is done to the scene is done to the picture.

Where the other properties are tested stands in `test_table.py`.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from refdof import METHODS, Camera, ThinLens, reference, render
from refdof._jit import thread_count, use_threads
from refdof.kernel_shape import kernel_shape
from refdof.optics.systems.system_lens import SystemLens
from tests import flat_scene as flat
from tests.optics.systems.lenses import double_gauss
from tests.unlike import IN_ONE_UNIT, NONLINEAR

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


@pytest.mark.parametrize("name", [name for name in METHODS if name not in NONLINEAR])
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


@pytest.mark.parametrize("name", [name for name in METHODS if name not in IN_ONE_UNIT])
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
@given(layout=layouts, paint=paints, walls=st.tuples(colors, colors), depth=st.sampled_from([1.5, FOCUS, 3.0]))
def test_what_a_wall_hides_changes_nothing(name, layout, paint, walls, depth):
    """The wall has two colours, whose edge is blurred."""
    out = 10 * WIDTH
    front = [part((-out, 3, -out, out, depth), walls[0]), part((4, out, -out, out, depth), walls[1])]
    hidden = [part((*card[:4], 16.0 * card[4]), p) for card, p in zip(layout, paint, strict=False)]
    alone = rendered(name, flat.scene_of(front, SHOT, LENS))
    with_them = rendered(name, flat.scene_of([*front, *hidden], SHOT, LENS))
    np.testing.assert_allclose(with_them, alone, rtol=0, atol=3e-5)


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


# Poisson's blur goes from the nearest to the farthest surface, whatever their circles.
@pytest.mark.parametrize("name", [name for name in METHODS if name != "poisson"])
def test_a_wider_aperture_blurs_no_less(name):
    narrow, wide = (circle * kernel_shape(name, circle=circle, light=2).radius for circle in (2.0, 4.0))
    assert 0.0 < narrow < wide


CARDS = ((-9, 3, -9, 4, 1.0), (2, 20, -2, 30, FOCUS), (-20, 30, 5, 40, 4.0))
PAINTS = ((3.0, 0.25, 0.0), (0.25, 1.0, 0.5), (1.0, 0.0, 0.25), (0.5, 0.5, 1.0))


@pytest.mark.parametrize("name", METHODS)
def test_threads_change_no_bit(name):
    made = scene(CARDS, PAINTS, PAINTS[3])
    threads = thread_count()
    try:
        use_threads(1)
        one = rendered(name, made)
    finally:
        use_threads(threads)
    np.testing.assert_array_equal(rendered(name, made), one)


def test_more_samples_are_no_worse():
    """Of accumulation, against 64 times as many of other points."""
    made = scene(CARDS, PAINTS, PAINTS[3])
    truth = reference(made, samples=4096, seed=1).image
    errors = [np.sqrt(((render("accumulation", made, samples=n).image - truth) ** 2).mean()) for n in (4, 16, 64, 256)]
    # An error of n even points falls as n^-0.75 or better: from one to the next by 2.8; half as much leaves room.
    assert all(after < before / 1.4 for before, after in pairwise(errors)), errors


@pytest.mark.parametrize(
    ("name", "words"), [("accumulation", "samples"), ("lensblur", "samples"), ("multiview", "samples")]
)
def test_a_cheaper_setting_keeps_the_radius(name, words):
    few, many = (kernel_shape(name, circle=4.0, light=2, params={words: n}).radius for n in (16, 64))
    # 16 even points of a disc have its second moment within some per cent.
    assert few == pytest.approx(many, rel=0.05)


def test_cut_bokeh_turns_round_at_the_focal_plane():
    """Off the axis a barrel cuts one side of the bokeh: behind focus the other side than in front of it."""
    shot = flat.camera(193, 33, 200.0)
    shifts = []
    for depth in (10.0, 1000.0):  # circles of 200 * 0.625 / 20 px, or a little less
        side = 2.0 * depth / 200.0
        lamp = flat.rectangle(0.36 * depth - side, 0.36 * depth, -side, side, depth)
        columns = []
        for vignetting in (True, False):
            lens = SystemLens(double_gauss(), 20.0, 2.0, mm_per_unit=20.0, vignetting=vignetting)
            image = reference(flat.scene_of([lamp], shot, lens), samples=256).image.sum(axis=(0, 2), dtype=np.float64)
            columns.append((image * np.arange(193)).sum() / image.sum())
        shifts.append(columns[0] - columns[1])
    assert shifts[0] * shifts[1] < 0.0
    assert min(map(abs, shifts)) > 0.1

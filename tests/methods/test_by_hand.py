"""Single steps of the methods by hand, where pictures do not tell."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from refdof import ThinLens, View
from refdof.methods import poisson
from refdof.methods.cascaded.layers import filter_layers
from refdof.methods.lensblur import method as lensblur
from refdof.methods.pyramidal import method as pyramidal
from tests import flat_scene
from tests.methods.scatter.discs import covered

pytestmark = pytest.mark.fast


@pytest.mark.parametrize(("circle", "steps"), [(0.9, 0), (1.0, 0), (1.1, 1)])
@pytest.mark.parametrize("side", [-1, 1])
def test_cascaded_adds_a_layer_where_a_circle_is_beyond_the_anchor(circle, steps, side):
    # The anchor behind focus: half-way between radii of 0 and of 2 deviations, 2 sqrt(1) px.
    layering = filter_layers(min(side * circle, 0.0), max(side * circle, 0.0), 50.0, 1.0, 1.0, 1000.0)
    assert len(layering.deviation) == 1 + steps


@pytest.mark.parametrize(("largest", "steps"), [(1.0, 1), (4.5, 3), (5.0, 4), (1000.0, 6)])
def test_cascaded_adds_no_layer_beyond_the_largest_blur(largest, steps):
    # Deviations 0, 1, sqrt 5, sqrt 14, sqrt 30, sqrt 55, sqrt 91 and so on: anchors at 1, 3.24, 5.98, 9.22, 12.9, 17,
    # 21.4 px. Circles of 20 px need six steps, those that are blurred as one of twice the largest deviation fewer.
    layering = filter_layers(0.0, 20.0, 50.0, 1.0, 1.0, largest)
    assert_allclose(layering.deviation, np.sqrt([0, 1, 5, 14, 30, 55, 91])[: steps + 1], rtol=1e-15)


@pytest.mark.parametrize(("peel", "extension"), [("plain", 0.0), ("umbra", 0.5 + 0.25), ("extended", 1.0 + 0.25)])
def test_lensblur_extends_samples_as_far_as_they_hide_others(peel, extension):
    # An umbra ends where the lens sees past half a pixel, or past a whole one; a quarter of a pixel more closes slits.
    projection, lens = flat_scene.camera(4, 3, 4.0), ThinLens(0.5, 1.0)
    view = View(flat_scene.scene_of([flat_scene.rectangle(-9, 9, -9, 9, 2.0)], projection, lens), projection, lens)
    stack = lensblur._stack(view, view.layers(1), lensblur.Params(peel=peel, layers=1), np.float32)
    assert stack.extension == extension
    assert stack.last == 0  # more layers may lie behind
    assert_allclose(stack.packs[..., 0], 4.0 * 0.5 / 2.0, rtol=1e-6)  # px of parallax, float32
    assert (stack.packs[..., 1:] == -np.inf).all()


def test_lensblur_bounds_all_rays_or_every_fourth():
    assert lensblur.FOOTPRINTS == {"closed": 0, "rays": 1, "quarter": 4}


@pytest.mark.parametrize(
    ("largest", "images"), [(0.0, 0), (0.85, 0), (0.86, 1), (2.54, 1), (2.56, 2), (5.09, 2), (5.11, 3), (1e9, 8)]
)
def test_pyramidal_needs_another_sub_image_beyond_a_border(largest, images):
    # Nominal radii of 0, 1.7, 3.4, 6.8 px; borders half-way, at 0.85, 2.55, 5.1 px, which belong to the sharper one.
    assert pyramidal._side(largest, pyramidal.Params()) == images


@pytest.mark.parametrize(
    ("i", "j", "radius"), [(26, 1, 25.5049014897137), (32, 1, 31.50396800404673), (16, 37, 39.654760117796705)]
)
def test_a_disc_that_ends_at_a_pixel_covers_none_of_it(i, j, radius):
    # The disc ends within a rounding of the pixel's nearest corner or side. Its area is a difference of areas of
    # 1000 px^2: 1e-12 of roundings, but none below 0, which would be a share of less than nothing.
    assert abs(math.hypot(i - 0.5, j - 0.5) - radius) < 1e-3
    assert 0.0 <= covered(i, j, radius) < 1e-2


def test_poisson_blurs_what_is_at_infinity_in_full():
    # In focus at 3, beyond all that is not at infinity: circles are 1/3 - 1/d. Before it the code falls to 0 at the
    # nearest depth: 1/2 + 1/2 (d / 3 - 1) / (1 - 1 / 3).
    depth = np.array([[1.0, 2.0, np.inf]])
    assert_allclose(poisson.code_of(depth, 1.0 / 3.0 - 1.0 / depth, poisson.Params()), [[0.0, 0.25, 1.0]], atol=1e-15)

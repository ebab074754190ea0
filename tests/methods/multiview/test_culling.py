"""What early culling may skip: as far as rays stray and cones read; and how wide cones are."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from refdof import ThinLens, View, render
from refdof.methods.multiview.method import Params, cone_width
from refdof.optics.lens_samples import lens_samples
from tests import flat_scene

pytestmark = pytest.mark.fast


def scene(width, height, coc):
    """A card of 1 px in the texel of column 8 and row 6, `coc` px in front of focus, and nothing else; and its lens."""
    projection, lens = flat_scene.camera(width, height, 16.0), ThinLens(0.5, 1.0)
    depth = 1.0 / (1.0 + coc / (16.0 * 0.5))
    x, y = 8.5 - width / 2, height / 2 - 6.5
    card = flat_scene.rectangle(
        *(np.array([x - 0.4, x + 0.4, y - 0.4, y + 0.4]) * depth / 16.0), depth, (1.0, 0.5, 0.25)
    )
    return flat_scene.scene_of([card], projection, lens)


@pytest.mark.parametrize("samples", [2, 3, 8, 13])
def test_what_is_skipped_is_beyond_the_farthest_lens_point(samples):
    width, height = 24, 20
    result = render("multiview", scene(width, height, 4.0), stages=True, samples=samples, cones="none")
    points, coc, interval = (result.stages[name] for name in ("lens_points", "layer_coc", "layer_interval"))
    assert coc.shape[0] == 1
    assert_allclose(coc[np.isfinite(coc)], -4.0, rtol=1e-5)
    assert_array_equal(np.argwhere(np.isfinite(coc[0])), [[6, 8]])
    # The card lies in the block of columns 8 .. 11, rows 4 .. 7. A ray strays as far as its lens point is from the
    # middle, times the layer's largest circle or one of a wall of 1 px; one more pixel is looked at.
    largest = max(math.hypot(*point) for point in points.reshape(-1, 2))
    reach = math.ceil(max(abs(interval[0, 0]), abs(interval[0, 1] + 1.0)) * largest) + 1
    y, x = np.mgrid[:height, :width]
    near = (x + reach >= 8) & (x - reach <= 11) & (y + reach >= 4) & (y - reach <= 7)
    assert_array_equal(result.stages["culled"][0], ~near)
    assert not near.all()


@pytest.mark.parametrize(("samples", "coc"), [(3, 5.0), (4, 5.0), (6, 6.0), (8, 7.0)])
def test_culling_changes_no_bit_of_wide_cones(samples, coc):
    # Cones of few points are about as wide as the circle, and read up to six times their width beside it.
    words = {"samples": samples, "cones": "text"}
    culled, whole = (
        render("multiview", scene(48, 20, coc), culling=culling, **words).image for culling in (True, False)
    )
    assert_array_equal(culled, whole)
    # Cones see the card from beyond its circle, its block of 4 px and one pixel more.
    assert (whole[:, 12 + int(coc) + 1 :] > 0).any()


@pytest.mark.parametrize(("cones", "share"), [("paper", 0.5), ("text", 1.0)])
def test_cones_are_as_wide_as_neighbours_are_apart(cones, share):
    projection, lens = flat_scene.camera(8, 6, 8.0), ThinLens(0.5, 1.0)
    view = View(flat_scene.scene_of([], projection, lens), projection, lens)
    points = lens_samples(11, "vogel", 1, lens.aperture)[0]
    nearest = [min(math.dist(p, q) for j, q in enumerate(points) if j != i) for i, p in enumerate(points)]
    assert_allclose(cone_width(view, Params(samples=11, cones=cones)), share * np.mean(nearest), rtol=1e-12)

"""Footprints by hand: bounds of a pixel's rays, and what they leave of the rays' range; depths in px of parallax."""

import numpy as np
import pytest

from refdof._jit import tile_kernel
from refdof.methods.lensblur.footprint import narrow, ray_bounds, thin_lens_bounds
from refdof.methods.lensblur.layer_trace import Stack
from refdof.raster.filters.n_buffer import n_buffer

pytestmark = pytest.mark.fast


@tile_kernel
def lens_bounds_of(x, y, focus, near, far):
    return thin_lens_bounds(x, y, focus, near, far)


@tile_kernel
def bounds_of(rays, stride, near, far):
    return ray_bounds(rays, stride, near, far)


@tile_kernel
def narrowed(stack, rays, stride, center, near, far, iterations):
    return narrow(stack, 0, rays, stride, center, near, far, iterations)


def test_a_thin_lens_is_bounded_by_the_larger_circle():
    # In focus at 2: at 5 the circle's radius is 3, at 1 and 3 it is 1, at 0 it is 2.
    assert lens_bounds_of(10.0, 20.0, 2.0, 5.0, 1.0) == (7.0, 17.0, 13.0, 23.0)
    assert lens_bounds_of(10.0, 20.0, 2.0, 3.0, 0.0) == (8.0, 18.0, 12.0, 22.0)


def test_rays_are_bounded_at_both_ends():
    # At u = 4 and 1: x = 1 + 2 u and 5 - u are 9 and 3, 1 and 4; y = 2 - u and 3 u are -2 and 1, 12 and 3.
    rays = np.array([[1.0, 5.0, 0.0], [2.0, 0.0, 50.0], [2.0, -1.0, 0.0], [-1.0, 3.0, 0.0]])
    assert bounds_of(rays[:, :2].copy(), 1, 4.0, 1.0) == (1.0, -2.0, 9.0, 12.0)
    assert bounds_of(rays, 1, 4.0, 1.0) == (0.0, -2.0, 9.0, 50.0)
    assert bounds_of(rays, 2, 4.0, 1.0) == (0.0, -2.0, 9.0, 50.0)  # the first and the third
    assert bounds_of(rays, 3, 4.0, 1.0) == (3.0, -2.0, 9.0, 1.0)  # the first


def left_of(heights, column, focus, near=10.0, far=0.0, extension=0.0, iterations=1, upright=False, rays=False):
    """What is left of far .. near for a pixel in a row of 5 texels {column: u}; `upright`: in a column."""
    parallax = np.full((1, 5), -np.inf)
    for k, u in heights.items():
        parallax[0, k] = u
    center = (column + 0.5, 0.5, focus)
    directions = np.array([[1.0, 0.0], [-1.0, 0.0]])
    if upright:
        parallax, center, directions = parallax.T.copy(), (0.5, column + 0.5, focus), directions[:, ::-1]
    buffer = n_buffer(parallax)
    lens = np.concatenate([np.array(center[:2])[:, None] - focus * directions.T, directions.T])
    stack = Stack(np.empty((1, *parallax.shape, 4)), buffer.lowest[None], buffer.highest[None], 1, extension, -1)
    return narrowed(stack, lens, int(rays), center, near, far, iterations)


@pytest.mark.parametrize("upright", [False, True])
@pytest.mark.parametrize("rays", [False, True])
def test_the_range_is_cut_to_what_lies_below(upright, rays):
    words = {"upright": upright, "rays": rays}
    heights = {0: 8.0, 2: 3.0, 4: 2.0}
    # From 4.25 to 3 the circle around the middle pixel is up to 1.25 px wide: columns 1 .. 3, of which one holds 3.
    assert left_of(heights, 2, 3.0, near=4.25, far=3.0, **words) == (3.0, 3.0)
    assert left_of(heights, 2, 3.0, near=4.25, far=2.5, extension=0.25, **words) == (3.0, 2.75)
    # From 5.5 on it is 2.5 px wide and more, up to the first and the last texel.
    assert left_of(heights, 2, 3.0, near=9.0, far=1.0, **words) == (8.0, 2.0)
    assert left_of(heights, 2, 3.0, near=2.5, far=1.0, **words) == (2.5, 2.0)
    # The range never grows: what lies outside it is not let in.
    assert left_of(heights, 2, 3.0, near=4.0, far=2.5, **words) == (3.0, 3.0)
    # A second look finds less: from 5 to 3 there is nothing but 3.
    assert left_of({0: 5.0, 2: 3.0}, 2, 3.0, near=9.0, far=3.0, iterations=1, **words) == (5.0, 3.0)
    assert left_of({0: 5.0, 2: 3.0}, 2, 3.0, near=9.0, far=3.0, iterations=3, **words) == (5.0, 3.0)
    assert left_of({0: 4.0, 2: 3.0}, 2, 3.0, near=9.0, far=3.0, iterations=3, **words) == (3.0, 3.0)


@pytest.mark.parametrize("upright", [False, True])
@pytest.mark.parametrize("column", [0, 4])
def test_the_first_and_the_last_texel_belong_to_the_picture(upright, column):
    assert left_of({column: 3.0}, column, 3.0, upright=upright) == (3.0, 3.0)
    assert left_of({column: 3.0}, column, 3.0, near=3.0, far=3.0, upright=upright) == (3.0, 3.0)
    # Rays that are all beyond the border are bounded by its texel.
    assert left_of({column: 3.0}, column + (9 if column else -9), 3.0, near=3.0, far=3.0, upright=upright) == (3.0, 3.0)


def test_nothing_below_leaves_nothing():
    near, far = left_of({0: 8.0}, 4, 3.0, near=4.0, far=2.5)
    assert near < far


@pytest.mark.parametrize("upright", [False, True])
@pytest.mark.parametrize("rays", [False, True])
@pytest.mark.parametrize("column", [0, 4])
def test_texels_a_hundredth_beyond_the_bounds_are_looked_at(upright, rays, column):
    # From 4.495 to 3 the middle pixel's circle is 1.495 px wide: up to 1.005 and 3.995, next to the outer texels.
    words = {"far": 3.0, "upright": upright, "rays": rays}
    assert left_of({2: 3.0, column: 4.0}, 2, 3.0, near=4.495, **words) == (4.0, 3.0)
    assert left_of({2: 3.0, column: 4.0}, 2, 3.0, near=4.485, **words) == (3.0, 3.0)

"""The walk through texels, begun and ended where it cannot meet anything else: it meets the same samples.

All numbers are small binary fractions, so that rays often cross the border of two texels, or a corner, just where the
walk is cut. What an uncut walk meets is asked of every sample by itself, and held against where the ray is.
"""

import numpy as np
import pytest

from refdof._jit import tile_kernel
from refdof.methods.lensblur.texel_walk import PACK, Hit, Ray, enter_picture, first_hit, neighbours, pack_layers

pytestmark = pytest.mark.fast
SIZE = 4


@tile_kernel
def walk(packs, ax, ay, wx, wy, near, far):
    return first_hit(packs, 0, Ray(ax, ay, wx, wy), near, far, 0.0)


@tile_kernel
def border(width, height, ax, ay, wx, wy):
    return enter_picture(width, height, Ray(ax, ay, wx, wy))


def met(parallax, ray, entry, near, far):
    """The greatest u in far .. near of a sample that an uncut walk meets when it is alone; -inf: none."""
    best = -np.inf
    for k, y, x in np.argwhere(np.isfinite(parallax)):
        u = parallax[k, y, x]
        alone = np.full(parallax.shape, -np.inf)
        alone[0, y, x] = u
        hit = walk(pack_layers(alone), *ray, entry, 0.0)[0] >= 0
        over_x, over_y = ray[0] + u * ray[2] - x, ray[1] + u * ray[3] - y
        inside = 0.0 < over_x < 1.0 and 0.0 < over_y < 1.0
        beside = 0.0 <= over_x <= 1.0 and 0.0 <= over_y <= 1.0
        assert (inside and u <= entry) <= hit <= (beside and u <= entry)
        if hit and far <= u <= near:
            best = max(best, u)
    return best


def test_a_cut_walk_meets_what_lies_at_its_ends():
    rng = np.random.default_rng(7)
    tied = 0
    for _ in range(60):
        parallax = -np.sort(-rng.integers(1, 17, (PACK, SIZE, SIZE)) / 4.0, axis=0)
        parallax[rng.random(parallax.shape) < 0.7] = -np.inf
        parallax = -np.sort(-parallax, axis=0)
        ax, ay = rng.integers(0, 4 * SIZE, 2) / 4.0
        wx, wy = rng.choice([-1.0, -0.5, 0.0, 0.25, 0.5, 1.0], 2)
        ray = ax, ay, wx, wy
        entry = min(border(SIZE, SIZE, *ray), 4.0)
        packs = pack_layers(parallax)
        levels = np.unique(parallax[np.isfinite(parallax)])
        for near in levels[levels <= entry]:
            for far in levels[levels <= near]:
                slot, x, y, u, _ = walk(packs, *ray, near, far)
                wanted = met(parallax, ray, entry, near, far)
                assert (u if slot >= 0 else -np.inf) == wanted
                if slot >= 0:
                    assert parallax[slot, y, x] == u
                    tied += u in (near, far) and (ax + u * wx) % 1.0 == 0.0
    assert tied > 50  # the walk was cut on a border


def test_where_rays_come_into_the_picture():
    # 4 x 3 texels: the left and upper borders belong to the picture, the right and lower ones do not.
    assert border(4, 3, 0.0, 1.0, 0.0, 0.0) == np.inf
    assert border(4, 3, 4.0, 1.0, 0.0, 0.0) == -np.inf
    assert border(4, 3, 1.0, 0.0, 0.0, 0.0) == np.inf
    assert border(4, 3, 1.0, 3.0, 0.0, 0.0) == -np.inf
    # Over (u - 2, 2 - u): in the picture's first corner at u = 2, and nowhere else; one higher up passes it by.
    assert border(4, 3, -2.0, 2.0, 1.0, -1.0) == 2.0
    assert border(4, 3, -2.0, 1.5, 1.0, -1.0) == -np.inf
    # Over -u: at the border in the end.
    assert border(4, 3, 0.0, 1.5, -1.0, 0.0) == 0.0


def test_a_walk_begun_on_a_border_begins_in_the_texel_that_the_ray_leaves():
    # Over 4 - u: at u = 2 from texel 1 into texel 2; a sample of texel 1 is at 2, too. The same along y.
    packs = pack_layers(np.where(np.indices((1, SIZE, SIZE)).sum(axis=0) == 2, 2.0, -np.inf))  # texel (1, 1) and beside
    assert walk(packs, 4.0, 1.5, -1.0, 0.0, 2.0, 0.0)[:4] == (0, 1, 1, 2.0)
    assert walk(packs, 1.5, 4.0, 0.0, -1.0, 2.0, 0.0)[:4] == (0, 1, 1, 2.0)


def test_a_ray_through_a_corner_passes_the_texel_above_or_below():
    # Over (u, u) from 3.5 down: through the corner of four texels at u = 2, out of texel (2, 2) and into (1, 1).
    parallax = np.full((1, SIZE, SIZE), -np.inf)
    for x, y, wanted in ((1, 2, False), (2, 1, True)):
        parallax[:] = -np.inf
        parallax[0, y, x] = 2.0
        assert (walk(pack_layers(parallax), 0.0, 0.0, 1.0, 1.0, 3.5, 0.0)[0] == 0) == wanted
    # The other way, over (4 - u, 4 - u): into (2, 2).
    for x, y, wanted in ((2, 1, False), (1, 2, True)):
        parallax[:] = -np.inf
        parallax[0, y, x] = 2.0
        assert (walk(pack_layers(parallax), 4.0, 4.0, -1.0, -1.0, 3.5, 0.0)[0] == 0) == wanted


@tile_kernel
def beside(packs, right, down):
    return neighbours(packs, Hit(0, 1, 1, 2.0), right, down)


def test_no_neighbour_counts_for_more_than_half():
    # A place that a rounding puts beyond its texel's border is on the border.
    packs = pack_layers(np.full((1, 3, 3), 2.0))
    assert beside(packs, 0.25, -0.125) == ((0, 2, 1), (0, 1, 0), (0, 2, 0), 0.25, 0.125)
    assert beside(packs, -0.625, 0.75) == ((0, 0, 1), (0, 1, 2), (0, 0, 2), 0.5, 0.5)

"""The walk through texels, begun and ended where it cannot meet anything else: it meets the same samples.

All numbers are small binary fractions, so that rays often cross the border of two texels, or a corner, just where the
walk is cut. What an uncut walk meets is asked of every sample by itself, and held against where the ray is.
"""

import numpy as np
import pytest

from refdof._jit import tile_kernel
from refdof.methods.lensblur.texel_walk import PACK, Ray, enter_picture, first_hit, pack_layers

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

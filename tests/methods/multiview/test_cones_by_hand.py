"""Cones and rays through one flat layer, against a twin that reads pyramids of 2 x 2 means tent by tent."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from refdof import ThinLens, View
from refdof.methods.multiview.cones import FOOTPRINT, gather_cones, mip_chain
from refdof.methods.multiview.fields import Search, fields_of
from refdof.methods.multiview.gather import gather, trace_hits
from refdof.optics.pixel_samples import LensPointSets
from tests import flat_scene

pytestmark = pytest.mark.fast
SIZE, WIDENING, BACKGROUND = 8, 0.8, (0.1, 0.2, 0.9)
SEARCH = Search(False, 3, 5, 0.5, True, True, False)
POINTS = np.array([[0.13, -0.41], [-0.77, 0.29], [0.58, 0.66], [-0.31, -0.87]])
WEIGHTS = np.array([0.5, 1.25, 1.5, 0.75])


def read(image, u, v, diameter):
    """Trilinear mean (C,) of an image (SIZE, SIZE, C) over `diameter` [px] around (u, v), its border repeated."""
    detail = math.log2(max(diameter, 1.0))
    total = 0.0
    for _ in range(int(detail) + 2):
        side = len(image)
        x, y = (np.clip(place * side / SIZE - 0.5, 0.0, side - 1.0) for place in (u, v))
        across, down = (np.maximum(0.0, 1.0 - abs(place - np.arange(side))) for place in (x, y))
        share = max(0.0, 1.0 - abs(detail))
        total = total + share * np.einsum("y,x,yxc->c", down, across, image)
        image = image.reshape(side // 2, 2, side // 2, 2, -1).mean(axis=(1, 3))
        detail -= 1.0
    return total


def twin(color, filled, copied, c, closes):
    """Mean over the lens (SIZE, SIZE, 3) of a flat layer at circle of confusion c [px]."""
    own = (filled & ~copied)[..., None].astype(float)
    parts = np.concatenate([color * own, own, filled[..., None]], axis=-1)
    out = np.zeros((SIZE, SIZE, 3))
    for y, x in np.ndindex(SIZE, SIZE):
        for (vx, vy), weight in zip(POINTS, WEIGHTS, strict=True):
            u, v = x + 0.5 - c * vx, y + 0.5 + c * vy
            found = read(parts, u, v, WIDENING * abs(c))
            cover, copies = found[3], found[4] - found[3]
            share = min(1.0, cover / (1.0 - copies)) if cover > 0.0 else 0.0  # of what is free of copies
            light = found[:3] / max(cover, 1e-9)
            met = filled[int(np.clip(v, 0, SIZE - 1)), int(np.clip(u, 0, SIZE - 1))]
            if closes and met and share < 1.0 - 1e-6:  # the layer with its holes filled; of one layer, its own texels
                whole = read(np.where(filled[..., None], color, 0.0), u, v, WIDENING * abs(c))
                light = whole / found[4]
            out[y, x] += weight * (share * light + (1.0 - share) * np.array(BACKGROUND))
    return out / WEIGHTS.sum()


@pytest.mark.parametrize("closes", [False, True])
@pytest.mark.parametrize("holes", [0.0, 0.2])
@pytest.mark.parametrize("c", [3.3, -3.3, -0.9])
def test_a_flat_layer_is_its_twin(c, holes, closes):
    random = np.random.default_rng(3)
    color = random.random((1, SIZE, SIZE, 3)).astype(np.float32)
    filled, copied = random.random((SIZE, SIZE)) >= holes, random.random((SIZE, SIZE)) < 0.25
    coc = np.where(filled, c, np.inf)[None].astype(np.float32)
    bounds = np.array([c], np.float32)
    projection = flat_scene.camera(SIZE, SIZE, 8.0)
    view = View(flat_scene.scene_of([], projection), projection, ThinLens(0.1, 1.0))
    pattern = LensPointSets(POINTS[None], WEIGHTS[None], np.zeros((1, 1), np.int32))
    reach = np.array([1.0]) if closes else None
    chain = mip_chain(color, coc, (copied & filled)[None], WIDENING * abs(c), reach)
    fields = fields_of(coc, bounds, bounds, 1.0, FOOTPRINT * WIDENING, 0.5)
    image = gather_cones(fields, chain, WIDENING, pattern, SEARCH, view.projection(), view.surfaces(), BACKGROUND)
    wanted = twin(color[0].astype(float), filled, copied & filled, float(np.float32(c)), closes)
    # Texels, points and heights are float32: 6e-8 of places up to 12 px, where colours change by 1 per px, and a
    # quotient of two such means.
    assert_allclose(image, wanted, atol=2e-5)


@pytest.mark.parametrize("c", [3.3, -2.4])
def test_rays_of_two_sets_are_weighed(c):
    # Pixels of odd x in even rows take the second set. Weights have no mean of 1, as if rays had been dropped.
    sets = np.array([[0, 1], [0, 0]], np.int32)
    points, weights = np.stack([POINTS, POINTS[:, ::-1] * 0.6]), np.stack([WEIGHTS, 3.0 * WEIGHTS[::-1]])
    color = np.random.default_rng(4).random((1, SIZE, SIZE, 3)).astype(np.float32)
    bounds = np.array([c], np.float32)
    projection = flat_scene.camera(SIZE, SIZE, 8.0)
    view = View(flat_scene.scene_of([], projection), projection, ThinLens(0.1, 1.0))
    fields = fields_of(np.full((1, SIZE, SIZE), c, np.float32), bounds, bounds, 1.0, 0.0, 0.5)
    pattern = LensPointSets(points, weights, sets)
    image = gather(fields, color, pattern, SEARCH, view.projection(), view.surfaces(), BACKGROUND)
    texels = trace_hits(fields, pattern, SEARCH).texel
    wanted, met = np.zeros((SIZE, SIZE, 3)), np.zeros(texels.shape, int)
    for y, x in np.ndindex(SIZE, SIZE):
        k = int(y % 2 == 0 and x % 2 == 1)
        column = np.clip(np.floor(x + 0.5 - c * points[k, :, 0]), 0, SIZE - 1).astype(int)
        row = np.clip(np.floor(y + 0.5 + c * points[k, :, 1]), 0, SIZE - 1).astype(int)
        wanted[y, x] = weights[k] @ color[0, row, column].astype(float) / weights[k].sum()
        met[y, x] = row * SIZE + column
    assert_allclose(image, wanted, rtol=1e-6)  # float32
    assert_array_equal(texels, met)

"""Rays of a pixel taken together: the picture is the mean of what its rays, one after the other, meet."""

import numpy as np
import pytest

from refdof import ThinLens, View
from refdof.methods.multiview.fields import Search, fields_of
from refdof.methods.multiview.gather import gather, trace_hits
from refdof.optics.pixel_samples import LensPointSets
from tests import flat_scene

pytestmark = pytest.mark.fast
SEARCH = Search(middle=False, steps=3, bisections=5, wall=0.5, march=False, culling=True, discard=False)
HEIGHT, WIDTH, BACKGROUND = 11, 14, (0.1, 0.7, 0.4)


def layers(seed, kind):
    """Heights (3, H, W) in three intervals, slanted and rough, with holes; and the intervals' ends."""
    random = np.random.default_rng([seed, 3])
    near, far = (np.array(ends).astype(kind) for ends in ([-4.0, -1.0, 1.0], [-1.0, 1.0, 5.0]))
    across = np.linspace(0.0, 1.0, WIDTH)[None, None]
    coc = near[:, None, None] + (far - near)[:, None, None] * np.clip(
        across + random.normal(0.0, 0.1, (3, HEIGHT, WIDTH)), 0.0, 1.0
    )
    coc[:2, 3:8, 4:11] = np.inf
    coc[random.random(coc.shape) < 0.2] = np.inf
    return fields_of(coc.astype(kind), near, far, 1.0)


@pytest.mark.parametrize("kind", [np.float32, np.float64])
@pytest.mark.parametrize(
    "words",
    [
        {},
        {"steps": 0},
        {"steps": 1, "bisections": 0, "wall": np.inf},
        {"wall": np.inf, "culling": False},
        {"discard": True},
        {"middle": True},
        {"march": True},
    ],
)
def test_the_picture_is_the_mean_of_what_single_rays_meet(words, kind):
    search, fields = SEARCH._replace(**words), layers(1, kind)
    random = np.random.default_rng(2)
    colors = random.random((3, HEIGHT, WIDTH, 3)).astype(np.float32)
    angle, reach = random.uniform(0.0, 2.0 * np.pi, (2, 19)), np.sqrt(random.random((2, 19)))
    points, weights = np.stack([reach * np.cos(angle), reach * np.sin(angle)], axis=-1), random.random((2, 19))
    weights[0, 3] = 0.0
    pattern = LensPointSets(points, weights, np.array([[0, 1], [1, 1]], np.int32))
    camera = flat_scene.camera(WIDTH, HEIGHT, 8.0)
    view = View(flat_scene.scene_of([], camera), camera, ThinLens(0.1, 1.0))
    image = gather(fields, colors, pattern, search, view.projection(), view.surfaces(), BACKGROUND)
    hits = trace_hits(fields, pattern, search)
    assert (np.bincount(hits.layer.ravel() + 2, minlength=5)[1:] > 10).all()  # the background and every layer
    for y, x in np.ndindex(HEIGHT, WIDTH):
        own, layer = weights[pattern.set[y % 2, x % 2]], hits.layer[y, x]
        met = colors.reshape(3, -1, 3)[np.maximum(layer, 0), np.maximum(hits.texel[y, x], 0)].astype(float)
        met[layer == -1] = BACKGROUND
        own = np.where(layer == -2, 0.0, own)
        if own.sum() > 0.0:
            np.testing.assert_allclose(image[y, x], own @ met / own.sum(), rtol=1e-6)  # float32

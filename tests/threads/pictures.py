"""What the tests of bug threads share: the filters of one picture, and small pictures and scenes with known answers."""

import numpy as np

from refdof import METHODS, ThinLens
from tests import flat_scene

FILTERS = {name: module for name, module in METHODS.items() if hasattr(module, "blur")}
"""Methods that blur one picture by its depth. `poisson` blurs by depth in its own code, all others by circles."""

# A camera with P = 100 px per unit tangent, and a lens of radius 0.1 focused at 2: circles of 10 (1 / 2 - 1 / d) px.
CAMERA = flat_scene.camera(9, 7, 100.0)
LENS = ThinLens(0.1, 2.0)


def filtered(name, color, depth, coc, **params):
    """One picture blurred by a method, in float64. Circles here are 6 px at most: no tap need be farther away."""
    module = FILTERS[name]
    params = {"max_blur_size": 6.0} | params if name == "singlepass" else params
    return module.blur(np.asarray(color, dtype=float), depth, coc, module.Params(**params))


def even(shape, depth=4.0, circle=2.0):
    """Depth and circles (H, W) that are the same everywhere."""
    return np.full(shape, depth), np.full(shape, circle)


def point(shape, value=1.0, at=None):
    """A black picture (H, W, 3) with one bright pixel, in the middle unless said."""
    picture = np.zeros((*shape, 3))
    picture[at or (shape[0] // 2, shape[1] // 2)] = value
    return picture


def noise(shape, seed=0):
    """A random picture (H, W, 3) in 0 .. 1."""
    return np.random.default_rng(seed).random((*shape, 3))


def spread(image):
    """Second moments of a picture's light about its middle pixel, along x and y [px^2]: r^2 / 4 of a disc."""
    light = image.sum(axis=-1)
    y, x = np.indices(light.shape)
    y, x = y - light.shape[0] // 2, x - light.shape[1] // 2
    return (light * x * x).sum() / light.sum(), (light * y * y).sum() / light.sum()


def wall(depth, color, x0=-9.0, x1=9.0):
    """An upright rectangle that fills the height of every camera here, from tangent x0 to x1."""
    return flat_scene.rectangle(x0 * depth, x1 * depth, -9.0 * depth, 9.0 * depth, depth, color)

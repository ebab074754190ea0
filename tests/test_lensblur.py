"""Lens blur against its naive twin, closed forms, the reference, and what the paper promises."""

import naive_lensblur as naive
import numpy as np
import pytest
import stage
from hypothesis import given
from hypothesis import strategies as st

from refdof import InputError, ThinLens, View
from refdof.lens_pattern import LensPattern
from refdof.methods.lensblur import FOOTPRINTS, Params
from refdof.raster.layer_trace import new_stack, trace_layers
from refdof.rendering import make_params, render_view

BACKGROUND = (0.25, 0.5, 0.75)
SIZES = [(7, 5), (1, 1), (1, 6), (9, 1), (8, 6)]


def empty_view(width, height):
    shot = stage.camera(width, height, 10.0)
    return View(stage.scene_of([], shot, background=BACKGROUND), shot, ThinLens(1.0, 1.0))


def random_layers(random, count, width, height, nearest):
    """Layers (N, H, W) of parallax, front to back, from touching to far apart, slanted, with holes and open stacks."""
    step = nearest / (count + 1) * random.choice([0.1, 1.0, 3.0], (count, height, width))
    slant = 0.3 * np.arange(width) * random.normal()
    parallax = nearest + slant - np.cumsum(step * random.random(step.shape), axis=0)
    return np.where((parallax > 0.0) & (random.random((height, width)) < 0.9), parallax, -np.inf)


def random_pattern(random, rays, reach):
    points = random.normal(size=(4, rays, 2))
    points *= reach * np.sqrt(random.random((4, rays, 1))) / np.linalg.norm(points, axis=-1, keepdims=True)
    points[:, 0] = [[0.0, 0.0], [reach, 0.0], [0.0, -reach], [-reach, 0.0]]  # along the axes, and none at all
    weights = random.random((4, rays))
    weights[1] = 1.0
    return LensPattern(points, weights, random.integers(0, 4, (3, 3)).astype(np.int32))


def picture(seed, size, dtype=np.float64, **words):
    """A random stack traced, the twin's picture, and where the twin's answer hangs on a rounding."""
    random = np.random.default_rng([seed, 5])
    width, height = size
    count = int(random.integers(0, 10))
    nearest = float(random.choice([0.5, 3.0, 12.0]))
    parallax = random_layers(random, count, width, height, nearest).astype(dtype)
    color = random.random((count, height, width, 3)).astype(np.float32)
    pinhole = random.random((height, width, 3)).astype(np.float32)
    pattern = random_pattern(random, 6, float(random.choice([0.1, 0.6, 1.0])))
    focus, extension = nearest * random.random(), float(random.choice([0.0, 0.5, 1.0]))
    complete = bool(random.integers(2))
    view = empty_view(width, height)
    stack = new_stack(parallax, extension, complete, int(random.integers(1, 4)))
    ours = trace_layers(stack, color, view.surfaces(), view.shot(), focus, pattern, pinhole, **words)

    sets = pattern.set[np.arange(height)[:, None] % 3, np.arange(width) % 3]
    facts = (color, BACKGROUND, pinhole, focus, pattern.points[sets], pattern.weights[sets], extension, complete)
    if count == 0:  # the twin wants a layer
        facts = (np.zeros((1, height, width, 3)), *facts[1:])
        parallax, complete = np.full((1, height, width), -np.inf), complete
    image, hit = naive.trace(parallax.astype(np.float64), *facts)
    edge = np.zeros((height, width), dtype=bool)
    slip = 1e-9 if dtype == np.float64 else 1e-4  # some 100 roundings of a place of up to 20 px
    for shift in np.array([(1, 0.3, 0), (-1, -0.3, 0), (-0.3, 1, 0), (0.3, -1, 0), (0, 0, 1), (0, 0, -1)]) * slip:
        edge |= (naive.trace(parallax.astype(np.float64), *facts, shift=shift)[1] != hit).any(axis=-1)
    return ours, image, edge


@given(st.integers(0, 10**6), st.sampled_from(SIZES), st.sampled_from(["closed", "rays"]), st.integers(0, 4))
def test_every_ray_meets_what_an_exhaustive_march_meets(seed, size, footprint, iterations):
    ours, image, edge = picture(seed, size, stride=FOOTPRINTS[footprint], iterations=iterations)
    # Colours are float32 and so is the picture: half an ulp of 1, and sums in another order.
    np.testing.assert_allclose(ours.image[~edge], image[~edge], atol=2e-7)
    assert edge.mean() <= 0.5 or edge.size < 10  # rays through borders of texels, by making

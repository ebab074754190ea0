"""Lens blur through lens systems: its thin lens in the paraxial limit, and the reference through the same lens.

Not among the fast tests, which are interpreted: the exit pupil's bounds take hundreds of thousands of rays.
"""

import numpy as np
import pytest

import refdof
from refdof import Camera, ThinLens, View, metrics, reference
from refdof.methods.lensblur.layer_trace import trace_layers
from refdof.methods.lensblur.method import Params, prepare
from refdof.optics.pixel_samples import LensPointSets
from refdof.optics.systems.glass import Glass
from refdof.optics.systems.lens_map import lens_map_rays
from refdof.optics.systems.prescription import load_lens
from refdof.optics.systems.system import ThickLens
from refdof.optics.systems.system_lens import SystemLens
from refdof.rendering import render_view
from tests.flat_scene import camera, rectangle, scene_of
from tests.methods.lensblur import naive
from tests.optics.systems.lenses import double_gauss

FOCUS, BACKGROUND = 20.0, (0.1, 0.2, 0.3)
DEPTHS = (8.0, 14.0, 20.0, 35.0)


def cards(seed, shot, lens):
    """Cards before, in and behind the plane in focus, their edges at random places of the picture."""
    random, parts = np.random.default_rng([seed, 7]), []
    for depth in DEPTHS:
        low, size = random.uniform(-0.5, 0.2, 2), random.uniform(0.2, 0.6, 2)
        scale = depth / shot.pixels_per_tangent * np.array(shot.size)
        (x0, y0), (x1, y1) = low * scale, (low + size) * scale
        parts.append(rectangle(x0, x1, y0, y1, depth, tuple(random.uniform(0.2, 1.0, 3))))
    return scene_of(parts, shot, lens, BACKGROUND)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("layers", [0, 2])
def test_in_the_paraxial_limit_every_ray_meets_what_the_thin_lenss_meets(seed, layers):
    """A lens of 0.02 mm, f/2500, with circles of some pixels: the same rays through both, pixel by pixel.

    A pixel is left out if a shift of rays or samples by 1e-4 px changes what any of its rays meets, in the naive twin.
    Aberrations are 1e-7 of the circle, less than roundings of float32.
    """
    tiny = ThickLens(50.0, -50.0, 0.01, 0.02, Glass("plain", 1.5)).system()
    real = SystemLens(tiny, FOCUS, mm_per_unit=20.0)
    thin, focus = ThinLens(real.radius, FOCUS), 6.0  # parallax of the plane in focus [px]
    shot = camera(16, 12, focus * FOCUS / real.radius)
    system, plain = (View(cards(seed, shot, lens), shot, lens) for lens in (real, thin))
    prepared = prepare(system, Params(samples=24, layers=layers))

    # The system turns its points with the place in the picture: each pixel has its own.
    y, x = (grid.ravel() for grid in np.mgrid[:12, :16])
    places = np.stack([x, y], axis=1).repeat(24, axis=0) + 0.5
    rays, weights = lens_map_rays(system.ray_map().system, places, np.tile(prepared.pattern.points[0], (192, 1)))
    points = (rays[:, :2] / system.projection().lens_radius).reshape(192, 24, 2)
    passed = (weights > 0.0).astype(float).reshape(192, 24)
    assert 0.7 < passed.mean() < 0.9  # a disc in its square
    own = LensPointSets(np.pad(points, ((0, 64), (0, 0), (0, 0))), np.pad(passed, ((0, 64), (0, 0))), _SETS)

    found, expected = (
        trace_layers(
            prepared.stack, prepared.values, view.surfaces(), view.projection(), focus, pattern, view.pinhole().color,
            prepared.choices, view.ray_map(),
        ).image
        for view, pattern in ((system, prepared.pattern), (plain, own))
    )  # fmt: skip
    found = found / weights.reshape(12, 16, 24).mean(axis=-1)[..., None]  # a system is as bright as its rays' weights
    unsure = _unsure(prepared, plain, focus, points.reshape(12, 16, 24, 2), passed.reshape(12, 16, 24), layers == 0)
    assert unsure.mean() < 0.2
    np.testing.assert_allclose(found[~unsure], expected[~unsure], atol=1e-6)  # colours are float32
    assert np.abs(expected - plain.pinhole().color).mean() > 0.05  # there is blur


_SETS = np.arange(256, dtype=np.int32).reshape(16, 16)


def _unsure(prepared, view, focus, points, weights, complete):
    """Where what a ray of a pixel meets hangs on 1e-4 px, as `test_lensblur` has it."""
    empty = prepared.layers.triangle < 0
    parallax = np.where(empty, -np.inf, focus * FOCUS / np.where(empty, 1.0, prepared.layers.depth))
    facts = parallax.astype(np.float32).astype(float), prepared.values, BACKGROUND, view.pinhole().color, focus
    facts += points, weights, prepared.stack.extension, complete
    _, hit = naive.trace(*facts)
    unsure = np.zeros(hit.shape[:2], dtype=bool)
    for shift in np.array([(1, 0.3, 0), (-1, -0.3, 0), (-0.3, 1, 0), (0.3, -1, 0), (0, 0, 1), (0, 0, -1)]) * 1e-4:
        unsure |= ((naive.trace(*facts, shift=shift)[1] != hit) & (weights > 0.0)).any(axis=-1)
    return unsure


def on_cards(k):
    """Scene, camera and lens; k picks the size of the picture."""
    shot = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=20.0, size=(32 * k, 24 * k))
    lens = SystemLens(double_gauss(), FOCUS, mm_per_unit=20.0)
    return cards(1, shot, lens), shot, lens


def on_lights(k):
    """The same of the built-in scene, through a lens with the pupil of its thin lens."""
    scene = refdof.load_scene("lights")
    system, distance = load_lens("double_gauss"), scene.lens.focus_distance
    scale = 1000.0 * SystemLens(system, distance).radius / scene.lens.radius
    lens = SystemLens(system, distance, mm_per_unit=scale)
    return scene, lens.seen_by(scene.camera.with_size((48 * k, 36 * k))), lens


def errors(stage, k, chosen):
    """RMSE of `lensblur` with each of some parameters beside the reference through the same lens."""
    scene, shot, lens = stage(k)
    truth = reference(scene, shot, lens, samples=512).image
    view = View(scene, shot, lens)
    return [metrics.rmse(truth, render_view("lensblur", view, **words).image) for words in chosen]


@pytest.mark.slow
@pytest.mark.parametrize("stage", [on_cards, on_lights])
def test_it_converges_to_the_reference_through_the_same_lens(stage):
    """With rays, layers and pixels: a texel is a pixel, so what is left is half a pixel of edges and of lamps.

    Measured RMSE, on cards: 4, 16, 64 rays 0.080, 0.036, 0.017; 1, 2 layers 0.046, 0.018; a picture three times as
    large 0.0074 instead of 0.022. On lights, whose lamps shine at up to 90: 0.84, 0.39, 0.26; 0.266, 0.264; 0.21
    instead of 0.54.
    """
    more_rays = [{"samples": count, "layers": 0} for count in (4, 16, 64)]
    *rays, one, two = errors(stage, 2, [*more_rays, *({"samples": 64, "layers": count} for count in (1, 2))])
    (coarse,), (fine,) = (errors(stage, k, [{"samples": 256, "layers": 0}]) for k in (1, 3))
    assert rays[0] > 1.3 * rays[1] > 1.3 * rays[2]
    assert one > two
    assert coarse > 1.5 * fine

"""Umbra peeling against the paper's numbers and against a lens made of points."""

import numpy as np
import pytest

from refdof import Camera, InputError, ThinLens
from refdof.raster.rays.umbra import survivors, umbra_step, worst_case_layers

pytestmark = pytest.mark.fast

# The paper's worst case: 30 degrees, from 1 m on, lens radius 9 mm, 600 rows.
CAMERA = Camera((0, 0, 0), (0, 0, -1), fov_y=30.0, size=(800, 600))
LENS = ThinLens(0.009, 2.0)
FLOORS = [1.0, 1.110, 1.248, 1.424, 1.658, 1.985, 2.472, 3.275, 4.853, 9.360, 131.66]


def stack(depths):
    return np.array(depths, dtype=float)[:, None, None]


def test_the_papers_worst_case():
    assert worst_case_layers(CAMERA, LENS, 1.0) == 11
    assert worst_case_layers(CAMERA, LENS, 1.0, 131.6) == 10
    assert worst_case_layers(CAMERA, LENS, 1.0, 131.8) == 11
    assert worst_case_layers(CAMERA, LENS, 1.0, extent_px=1) == 21


def test_depths_at_which_the_next_layer_may_start():
    inverse = 1.0 - umbra_step(CAMERA, LENS) * np.arange(11)
    # Printed to four digits, the last to five; its inverse is a small difference, which magnifies the rounding.
    np.testing.assert_allclose(1.0 / inverse, FLOORS, rtol=4e-4)


@pytest.mark.parametrize(("extent", "expected"), [(2, 11), (1, 21)])
def test_a_dense_stack_needs_the_worst_case_and_no_more(extent, expected):
    inverse = np.linspace(1.0, 1e-6, 20_000)
    kept = survivors(stack(1.0 / inverse), CAMERA, LENS, extent)
    assert len(kept) == expected
    near = survivors(stack(1.0 / inverse[inverse > 1 / 131.0]), CAMERA, LENS, extent)
    assert len(near) == expected - 1  # 131 m is nearer than the last floor, 131.66 m, of either extent


def test_an_adversary_just_beyond_every_floor():
    depths = [1.0]
    step = umbra_step(CAMERA, LENS)
    while 1.0 / depths[-1] > step:
        depths.append(1.0001 / (1.0 / depths[-1] - step))
    assert len(survivors(stack(depths), CAMERA, LENS)) == len(depths) >= 10


def test_nothing_is_lost_that_a_lens_sees_past_an_isolated_pixel():
    """A blocker as large as its pixel, and points behind it on the pixel's axis; the lens is a grid of points."""
    u, v = np.meshgrid(np.linspace(-1, 1, 201), np.linspace(-1, 1, 201))
    lens = np.stack([u, v], axis=-1)[u**2 + v**2 <= 1.0] * LENS.radius
    rng = np.random.default_rng(3)
    lost = kept_all = 0
    for _ in range(300):
        d = rng.uniform(1.0, 20.0)
        z = 1.0 / (1.0 / d - rng.uniform(0.2, 1.8) * umbra_step(CAMERA, LENS, 1))
        if not z > d:
            continue
        half = d / (2.0 * CAMERA.pixels_per_tangent)
        # The line from lens point l to (0, 0, z) passes depth d at l (1 - d / z).
        seen = (np.abs(lens * (1.0 - d / z)).max(axis=1) > half).any()
        kept = len(survivors(stack([d, z]), CAMERA, LENS, 1)) == 2
        lost += seen and not kept
        kept_all += kept and not seen
    assert lost == 0
    assert kept_all <= 10  # only where the square blocker hides a little more than the disc inside it


def test_empty_pixels_equal_depths_and_pinholes():
    depth = np.full((3, 1, 3), np.inf)
    depth[:, 0, 0] = 2.0  # three coplanar surfaces: one layer
    depth[0, 0, 1], depth[1, 0, 1] = 1.0, 50.0
    kept = survivors(depth, CAMERA, LENS)
    np.testing.assert_array_equal(kept[:, 0], [[0, 0, -1], [-1, 1, -1]])
    assert len(survivors(depth, CAMERA, ThinLens(0.0, 1.0))) == 1  # a pinhole's umbra has no end
    assert worst_case_layers(CAMERA, ThinLens(0.0, 1.0), 1.0) == 1
    assert survivors(np.full((2, 3, 4), np.inf), CAMERA, LENS).shape == (0, 3, 4)


def test_a_surface_at_the_umbras_very_end_is_still_hidden():
    # A step of 1/4 in inverse depth: what is at 1 hides up to 3/4, and only what lies beyond is seen.
    lens = ThinLens(1.0, 2.0)
    camera = Camera((0, 0, 0), (0, 0, -1), fov_y=2.0 * np.degrees(np.arctan(0.25)), size=(2, 2))
    assert umbra_step(camera, lens) == 0.25  # 1 / (P E), with P = 2 / (2 / 4)
    depths = [1.0, 4.0 / 3.0, 2.0, 4.0, 8.0]  # 1, 3/4, 1/2, 1/4, 1/8
    np.testing.assert_array_equal(survivors(stack(depths), camera, lens)[:, 0, 0], [0, 2, 4])
    np.testing.assert_array_equal(survivors(stack([1.0, 1.375]), camera, lens)[:, 0, 0], [0, 1])


def test_some_layer_is_always_needed():
    assert worst_case_layers(CAMERA, LENS, 3.0, 3.0) == 1


@pytest.mark.parametrize(
    ("depth", "extent", "message"),
    [
        (stack([2.0, 1.0]), 2, "depth: layers are not ordered"),
        (stack([0.0, 1.0]), 2, "depth: smallest value is 0"),
        (stack([np.nan, 1.0]), 2, "depth: has 1 NaN"),
        (np.ones((2, 2)), 2, "depth: got shape"),
        (stack([1.0, 2.0]), 3, "extent_px: got 3"),
        (stack([1.0, 2.0]), 0, "extent_px: got 0"),
    ],
)
def test_bad_input(depth, extent, message):
    with pytest.raises(InputError, match=message):
        survivors(depth, CAMERA, LENS, extent)


def test_depths_at_the_smallest_numbers():
    np.testing.assert_array_equal(survivors(stack([1e-320, 1.0, 2.0]), CAMERA, LENS)[0, 0], [0])
    assert worst_case_layers(CAMERA, ThinLens(0.0, 1.0), 1e-320) == 1
    with pytest.raises(InputError, match="near: got"):
        worst_case_layers(CAMERA, LENS, 1e-320)

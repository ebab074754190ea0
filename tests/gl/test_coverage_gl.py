"""Which pixels a triangle covers, against Mesa's llvmpipe: every bit, for thousands of triangles."""

import numpy as np
import pytest

from refdof import Camera
from refdof.raster.gpu.gpu_model import LLVMPIPE
from refdof.raster.gpu.rasterize import rasterize
from tests.gl import geometry

pytestmark = pytest.mark.gl

SIZE = (32, 32)
CAMERA = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=90.0, size=SIZE)
COUNT = 2000  # triangles of each kind


def anywhere(random):
    return random.uniform(0.0, 32.0, (COUNT, 3, 2))


def on_pixel_centres(random):
    return random.integers(0, 32, (COUNT, 3, 2)) + 0.5


def on_the_grid(random):
    return random.integers(0, 32 * 256 + 1, (COUNT, 3, 2)) / 256.0


def halfway_between_grid_points(random):
    return (random.integers(0, 32 * 256, (COUNT, 3, 2)) + 0.5) / 256.0


def small(random):
    return random.uniform(2.0, 30.0, (COUNT, 1, 2)) + random.uniform(-1.0, 1.0, (COUNT, 3, 2))


@pytest.mark.parametrize("kind", [anywhere, on_pixel_centres, on_the_grid, halfway_between_grid_points, small])
def test_coverage_is_bit_equal(context, kind):
    # Both are given the float32 window positions that OpenGL computes; memory's lowest row is our top row.
    clip = (kind(np.random.default_rng(7)) / 16.0 - 1.0).astype(np.float32)
    window = geometry.window_positions(clip, SIZE).astype(np.float64)
    x = (window[..., 0] - 16.0) / CAMERA.pixels_per_tangent
    y = (16.0 - window[..., 1]) / CAMERA.pixels_per_tangent
    vertices = np.stack([x, y, np.full_like(x, -1.0)], axis=-1)
    different = covered = 0
    for corners, theirs in zip(vertices, geometry.coverage(context, clip, SIZE), strict=True):
        ours = rasterize(corners, np.array([[0, 1, 2]]), CAMERA, model=LLVMPIPE).triangle == 0
        different += (ours != theirs).any()
        covered += theirs.any()
    assert covered > COUNT / 5  # else nothing was drawn; a small triangle meets a centre one time in four
    assert different == 0

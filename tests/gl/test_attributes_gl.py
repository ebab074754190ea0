"""Depth and attributes of perspective triangles, against Mesa's llvmpipe."""

import numpy as np
import pytest

from refdof import Camera
from refdof.raster.gpu.gpu_model import D3D11, LLVMPIPE
from refdof.raster.gpu.rasterize import rasterize
from tests.gl import geometry

pytestmark = pytest.mark.gl

SIZE = (64, 48)
CAMERA = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=60.0, size=SIZE)
NEAR, FAR = 0.5, 20.0


def triangles(count, seed):
    """Corners (T, 3, 3) inside the picture, as whole float32 numbers: x right, y down, depth."""
    random = np.random.default_rng(seed)
    pixels, depth = random.uniform([0, 0], SIZE, (count, 3, 2)), random.uniform(1.0, 10.0, (count, 3, 1))
    place = (pixels - np.asarray(SIZE) / 2.0) / CAMERA.pixels_per_tangent * depth
    return np.concatenate([place, depth], axis=-1).astype(np.float32).astype(np.float64)


def ours_and_theirs(context, corners, model, depth_format="unorm24"):
    vertices = corners.reshape(-1, 3) * [1.0, -1.0, -1.0]
    faces = np.arange(len(vertices)).reshape(-1, 3)
    ours = rasterize(vertices, faces, CAMERA, near=NEAR, far=FAR, model=model, depth_format=depth_format)
    return ours, geometry.attributes(context, corners, CAMERA.pixels_per_tangent, SIZE, (NEAR, FAR))


def screen_area(corners):
    """Area of a triangle (3, 3) on the picture [px^2]."""
    (ax, ay), (bx, by), (cx, cy) = corners[:, :2] / corners[:, 2:] * CAMERA.pixels_per_tangent
    return 0.5 * abs((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))


def largest_errors(context, model):
    """Over 300 triangles alone: of the weights, and of z in units of its 24 bits; and how many pixels were compared."""
    weight = code = 0.0
    count = 0
    for corners in triangles(300, 2):
        ours, (picture, stored) = ours_and_theirs(context, corners[None], model)
        both = (ours.triangle == 0) & (picture[..., 3] > 0)
        # Window positions go through float32 matrices in one and not the other: a corner may snap to another step.
        if ((ours.triangle == 0) != (picture[..., 3] > 0)).any() or not both.any():
            continue
        if screen_area(corners) < 20.0:  # slivers magnify the float32 roundings of window positions
            continue
        weight = max(weight, np.abs(ours.barycentric - picture[..., :2])[both].max())
        z = FAR / (FAR - NEAR) * (1.0 - NEAR / ours.depth[both])
        code = max(code, np.abs(z - stored[both].astype(np.float64)).max() * (2**24 - 1))
        count += both.sum()
    return weight, code, count


def test_weights_and_depth(context):
    weight, code, count = largest_errors(context, LLVMPIPE)
    print(f"weights differ by {weight:.1e}, depth by {code:.2f} of 2^24 - 1, over {count} pixels")
    assert count > 20_000
    # Window positions below 64 px have steps of 2^-18 px; over heights of 1 px and more that is 4e-6, and perspective,
    # up to 1 to 10 in depth, magnifies it.
    assert weight <= 2e-5
    # The same in depth: z falls by up to 2^24 (1 - NEAR) codes over a triangle's height of some px; typically 2 codes.
    assert code <= 16.0


def test_set_up_from_snapped_corners_is_not_what_llvmpipe_does(context):
    weight, _, _ = largest_errors(context, D3D11)
    assert weight > 1e-4  # 1/512 px of triangles tens of pixels wide


def test_the_nearest_of_many_triangles(context):
    corners = triangles(60, 5)
    ours, (picture, stored) = ours_and_theirs(context, corners, LLVMPIPE)
    drawn = (ours.triangle >= 0) & (picture[..., 3] > 0)
    z = FAR / (FAR - NEAR) * (1.0 - NEAR / ours.depth[drawn])
    same = np.abs(z - stored[drawn]) * (2**24 - 1) <= 16.0  # as above
    # Elsewhere a corner snapped to another step, and an edge went over a centre.
    assert drawn.mean() > 0.7
    assert same.mean() >= 0.998

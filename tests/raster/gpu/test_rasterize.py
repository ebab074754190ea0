"""Rasterised triangles against whole numbers and fractions, closed surfaces, hand-made cuts and cast rays."""

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from refdof import Camera, InputError, View, load_scene
from refdof._jit import thread_count, use_threads
from refdof.raster.gpu.ambiguity import ambiguous_pixels
from refdof.raster.gpu.depth_peeling import peel_raster
from refdof.raster.gpu.gpu_model import LLVMPIPE, GpuModel
from refdof.raster.gpu.rasterize import rasterize
from refdof.raster.rays.umbra import survivors, umbra_step
from tests.raster.gpu import naive_raster as naive

CAMERA = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=60.0, size=(12, 9))
ALONE = np.array([[0, 1, 2]])


def placed(pixels, depth, camera=CAMERA):
    """Camera-space points (N, 3) seen at `pixels` (N, 2), y down, from the picture's corner."""
    pixels, depth = np.asarray(pixels, dtype=float), np.asarray(depth, dtype=float)
    x = (pixels[:, 0] - camera.width / 2) * depth / camera.pixels_per_tangent
    y = (camera.height / 2 - pixels[:, 1]) * depth / camera.pixels_per_tangent
    return np.stack([x, y, np.broadcast_to(-depth, x.shape)], axis=1)


def soup(random, count, step):
    """Triangles whose corners lie on a grid of `step` px, some outside the picture: vertices, faces."""
    pixels = np.round(random.uniform(-3.0, 15.0, (3 * count, 2)) / step) * step
    return placed(pixels, random.uniform(1.0, 2.0, 3 * count)), np.arange(3 * count).reshape(-1, 3)


def cover_counts(vertices, faces, camera=CAMERA, signed=False):
    """How many faces cover each pixel; `signed`: those that turn one way less those that turn the other.

    Every face is moved behind the one before by a power of two, which moves no corner on the picture; then peeled.
    """
    turns = [naive.turn([naive.on_grid(vertices[v], camera) for v in face]) for face in faces]
    weights = np.array([*turns, 0] if signed else [1] * len(faces) + [0])  # the last one: no face
    apart = (vertices[faces] * 8.0 ** np.arange(len(faces))[:, None, None]).reshape(-1, 3)
    alone = np.arange(len(apart)).reshape(-1, 3)
    counts, previous = np.zeros((camera.height, camera.width), dtype=int), None
    while True:
        layer = rasterize(apart, alone, camera, near=1e-3, previous_depth=previous)
        if (layer.triangle < 0).all():
            return counts
        counts += weights[layer.triangle]
        previous = layer.depth


@pytest.mark.parametrize("step", [0.5, 0.25, 1 / 256, 1 / 512, 1e-6])
@pytest.mark.parametrize("seed", range(3))
def test_twin(step, seed):
    vertices, faces = soup(np.random.default_rng(seed), 12, step)
    depth, triangle, weight = naive.draw(vertices, faces, CAMERA)
    ours = rasterize(vertices, faces, CAMERA)
    assert (triangle >= 0).sum() > 20
    np.testing.assert_array_equal(ours.triangle, triangle)
    # A plane seen at a flat angle loses digits as its area over its length: 1e-12 allows for a few hundred.
    np.testing.assert_allclose(ours.depth, depth, rtol=1e-12)
    np.testing.assert_allclose(ours.barycentric, weight, rtol=1e-9, atol=1e-10)


@pytest.mark.parametrize("bits", [4, 8])
def test_twin_on_coarse_grids(bits):
    vertices, faces = soup(np.random.default_rng(bits), 12, 2.0**-bits / 2)
    triangle = naive.draw(vertices, faces, CAMERA, bits, np.float32)[1]
    ours = rasterize(vertices, faces, CAMERA, model=GpuModel(subpixel_bits=bits))
    np.testing.assert_array_equal(ours.triangle, triangle)


def test_left_and_top_edges_belong_to_the_triangle():
    # Corners on the centres of pixels (2, 1), (5, 1) and (2, 4); the slanted edge is a right one.
    ours = rasterize(placed([(2.5, 1.5), (5.5, 1.5), (2.5, 4.5)], 1.0), ALONE, CAMERA)
    assert [tuple(p) for p in np.argwhere(ours.triangle == 0)] == [(1, 2), (1, 3), (1, 4), (2, 2), (2, 3), (3, 2)]
    # At (2, 1) it is the first corner, one column right a third of the way to the second.
    np.testing.assert_allclose(ours.barycentric[1, 2:4], [(0.0, 0.0), (1 / 3, 0.0)], atol=1e-14)  # a few roundings


corner_shift = st.integers(-256, 256)


@given(st.lists(corner_shift, min_size=50, max_size=50), st.sampled_from([1.0, 128.0]))
def test_a_grid_covers_every_pixel_once(shifts, unit):
    # Five by five corners from -6 to 18 px; inner ones are moved, by whole grid steps or half pixels, folds included.
    row, column = np.mgrid[0:5, 0:5]
    pixels = np.stack([column * 6.0 - 6.0, row * 6.0 - 6.0], axis=-1)
    moved = np.array(shifts).reshape(5, 5, 2)[1:4, 1:4] * unit / 256
    pixels[1:4, 1:4] += np.clip(moved, -20.0, 20.0)
    corner = np.arange(25).reshape(5, 5)
    a, b, c, d = corner[:-1, :-1].ravel(), corner[:-1, 1:].ravel(), corner[1:, 1:].ravel(), corner[1:, :-1].ravel()
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    vertices = placed(pixels.reshape(-1, 2), np.linspace(1.0, 2.0, 25))
    assert (cover_counts(vertices, faces, signed=True) == 1).all()
    if unit == 1.0:  # moved by less than a sixth of a cell: no folds
        assert (cover_counts(vertices, faces) == 1).all()


@given(st.integers(0, 11), st.integers(0, 8), st.integers(3, 12), st.floats(0.0, 6.0))
def test_a_fan_round_a_pixel_centre_covers_it_once(x, y, count, start):
    angle = start + np.arange(count) * (2 * np.pi / count)
    rim = np.stack([x + 0.5 + 4 * np.cos(angle), y + 0.5 + 4 * np.sin(angle)], axis=1)
    vertices = placed(np.concatenate([[(x + 0.5, y + 0.5)], rim]), np.linspace(1.0, 2.0, count + 1))
    ring = np.arange(count)
    counts = cover_counts(vertices, np.stack([0 * ring, 1 + ring, 1 + (ring + 1) % count], axis=1))
    assert counts[y, x] == 1
    assert counts.max() == 1


@given(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.booleans())
def test_a_sphere_is_entered_as_often_as_left(x, y, on_centres):
    sphere = trimesh.creation.icosphere(subdivisions=1)
    vertices = sphere.vertices + np.array([x, y, -3.0])
    if on_centres:
        pixels = np.array([naive.on_grid(v, CAMERA) for v in vertices]) // 256 + 0.5
        vertices = placed(pixels, -vertices[:, 2])
    assert (cover_counts(vertices, sphere.faces, signed=True) == 0).all()
    if not on_centres:
        assert set(np.unique(cover_counts(vertices, sphere.faces))) == {0, 2}


def crossing(count):
    """Random triangles that reach through the near plane at depth 1, and some wholly behind it."""
    random = np.random.default_rng(count)
    vertices = random.uniform((-3.0, -3.0, -4.0), (3.0, 3.0, 2.0), (3 * count, 3))
    return vertices, np.arange(3 * count).reshape(-1, 3)


def test_cut_at_the_near_plane():
    camera = CAMERA.with_size((32, 24))
    vertices, faces = crossing(15)
    compared = 0
    for face in faces:
        ours = rasterize(vertices, face[None], camera, near=1.0)
        for y, x in np.ndindex(camera.height, camera.width):
            t, u, v = (float(k) for k in naive.ray_meets(vertices[face], naive.ray_of(camera, x, y)))
            # Left out: rays that pass an edge, or the cut, nearer than any corner's rounding could move it here.
            if min(abs(u), abs(v), abs(1 - u - v)) < 1e-2 or abs(t - 1.0) < 1e-2:
                continue
            inside = min(u, v, 1 - u - v) > 0 and t > 1.0
            assert inside == (ours.triangle[y, x] == 0)
            compared += inside
            if inside:
                np.testing.assert_allclose(ours.depth[y, x], t, rtol=1e-12)  # some hundred roundings
                np.testing.assert_allclose(ours.barycentric[y, x], (u, v), atol=1e-11)
    assert compared > 200


def test_a_floor_under_the_eye_reaches_far_beyond_the_picture():
    # y = -1, cut at the default near plane: the bottom of the picture shows depth 1 / tan, every row below the middle
    # is covered, and the cut corners lie millions of pixels outside.
    floor = np.array([(-1e3, -1.0, 10.0), (1e3, -1.0, 10.0), (1e3, -1.0, -1e3), (-1e3, -1.0, -1e3)])
    ours = rasterize(floor, np.array([[0, 1, 2], [0, 2, 3]]), CAMERA)
    rows = np.arange(5, 9)
    expected = CAMERA.pixels_per_tangent / (rows + 0.5 - 4.5)
    np.testing.assert_allclose(ours.depth[5:], np.repeat(expected[:, None], 12, axis=1), rtol=1e-12)
    assert (ours.triangle[:4] == -1).all()


@pytest.mark.parametrize(
    "pixels",
    [
        [(3.5, 3.5), (3.5, 3.5), (3.5, 3.5)],  # a point on a centre
        [(1.5, 1.5), (3.5, 3.5), (5.5, 5.5)],  # a line through centres
        [(3.4995, 3.4995), (3.5005, 3.4995), (3.5, 3.5005)],  # round a centre, but all corners snap to it
    ],
)
def test_no_area_after_snapping_draws_nothing(pixels):
    assert (rasterize(placed(pixels, 1.0), ALONE, CAMERA, model=LLVMPIPE).triangle == -1).all()


def test_edge_on_triangle_draws_finite_depth_or_nothing():
    # Through the eye: no area in exact arithmetic, whatever its corners round to.
    vertices = np.array([(0.1, 0.1, -1.0), (0.2, 0.2, -2.0), (0.7, 0.9, -3.0), (0.3, 0.3, -3.0)])
    for face in ([0, 1, 3], [0, 1, 2]):
        ours = rasterize(vertices, np.array([face]), CAMERA)
        drawn = ours.triangle >= 0
        assert ((ours.depth[drawn] >= 1.0) & (ours.depth[drawn] <= 3.0)).all()
        assert np.isfinite(ours.barycentric).all()


def test_equally_near_triangles_give_the_first():
    vertices = placed([(0, 0), (12, 0), (0, 9)], 2.0)
    faces = np.array([[1, 0, 2], [0, 1, 2]])
    assert set(np.unique(rasterize(vertices, faces, CAMERA).triangle)) == {-1, 0}


def test_threads_change_nothing():
    scene = load_scene("branches")
    view = View(scene, scene.camera.with_size((96, 72)), scene.lens)
    before, results = thread_count(), []
    try:
        for count in (1, 2):
            use_threads(count)
            results.append(rasterize(*view.triangles(), view.camera))
    finally:
        use_threads(before)
    for one, two in zip(*results, strict=True):
        np.testing.assert_array_equal(one, two)


def test_a_power_of_two_in_length_changes_nothing_else():
    vertices, faces = soup(np.random.default_rng(5), 20, 1 / 256)
    one = rasterize(vertices, faces, CAMERA, precision="float32")
    tiny = rasterize(vertices * 2.0**-90, faces, CAMERA, precision="float32")
    np.testing.assert_array_equal(tiny.depth, one.depth * np.float32(2.0**-90))
    np.testing.assert_array_equal(tiny.barycentric, one.barycentric)


@pytest.mark.parametrize("model", [GpuModel(subpixel_bits=8), GpuModel(subpixel_bits=8, attributes_from_snapped=True)])
def test_attributes_are_set_up_from_the_corners_that_the_model_says(model):
    vertices, faces = soup(np.random.default_rng(9), 12, 1e-6)
    ours = rasterize(vertices, faces, CAMERA, model=model)
    if model.attributes_from_snapped:
        grid = np.array([naive.on_grid(v, CAMERA, 8, np.float32) for v in vertices]) / 256.0 + 0.5
        vertices = placed(grid, -vertices[:, 2])
    depth, triangle, weight = naive.draw(vertices, faces, CAMERA, 8, np.float32)
    np.testing.assert_array_equal(ours.triangle, triangle)
    # Float32; snapping by 1/512 px of triangles some px wide would show as 1e-3.
    seen = (triangle >= 0) & (weight.min(axis=-1) > -0.1) & (weight.sum(axis=-1) < 1.1)
    np.testing.assert_allclose(ours.barycentric[seen], weight[seen], atol=2e-5)
    np.testing.assert_allclose(ours.depth[seen], depth[seen], rtol=2e-5)


def test_umbra_peeling_keeps_what_survives_of_the_exact_layers():
    scene = load_scene("foliage")
    view = View(scene, scene.camera.with_size((80, 60)), scene.lens)
    vertices, faces = view.triangles()
    rays = view.layers()
    kept = survivors(rays.depth, view.camera, view.lens)
    expected = np.where(kept >= 0, np.take_along_axis(rays.triangle, np.maximum(kept, 0), axis=0), -1)
    ours = peel_raster(vertices, faces, view.camera, umbra=umbra_step(view.camera, view.lens))
    clear = ~ambiguous_pixels(vertices, faces, view.camera, rays.depth)
    assert clear.mean() > 0.9
    assert len(ours.triangle) == len(kept) < len(rays.triangle) / 2
    np.testing.assert_array_equal(ours.triangle[:, clear], expected[:, clear])


def test_only_the_layers_that_a_scene_has_are_made():
    vertices = placed([(0, 0), (40, 0), (0, 40)] * 3, [1, 1, 1, 2, 2, 2, 3, 3, 3])
    faces = np.arange(9).reshape(-1, 3)
    assert len(peel_raster(vertices, faces, CAMERA).triangle) == 3
    assert len(peel_raster(vertices, faces, CAMERA, 2).triangle) == 2
    assert len(peel_raster(vertices, faces, CAMERA, 9).triangle) == 3
    assert len(peel_raster(vertices, faces[:0], CAMERA, 9).triangle) == 1
    assert len(peel_raster(vertices, faces, CAMERA, umbra=np.inf).triangle) == 1
    # Umbrae that end just before and just behind depth 2: 1 / 2 = 1 - umbra.
    assert len(peel_raster(vertices, faces, CAMERA, umbra=0.499).triangle) == 2
    assert peel_raster(vertices, faces, CAMERA, umbra=0.501).depth[1].min() == 3.0


def test_planes_as_far_as_numbers_go():
    vertices = placed([(0, 0), (40, 0), (0, 40)], 2.0) * 0.1
    assert (rasterize(vertices, ALONE, CAMERA, far=1.7e308).triangle == 0).all()
    assert (rasterize(vertices, ALONE, CAMERA, near=1e308, far=np.inf).triangle == -1).all()


def test_peeling_brings_its_own_previous_depth():
    with pytest.raises(InputError, match="previous_depth: got a depth"):
        peel_raster(np.zeros((3, 3)), ALONE, CAMERA, previous_depth=np.zeros((9, 12)))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"near": 0.0}, "near: got 0"),
        ({"model": "llvmpipe"}, "model: got str"),
        ({"model": LLVMPIPE, "precision": "float64"}, "precision: got 'float64'"),
        ({"near": 2.0, "far": 1.0}, "far: got 1; allowed are values beyond near, 2"),
        ({"depth_format": "unorm32"}, "depth_format: got 'unorm32'; did you mean 'unorm"),
        ({"previous_depth": np.full((9, 12), np.nan)}, "previous_depth: has 108 NaN"),
        ({"precision": "float16"}, "precision: got 'float16'"),
        ({"previous_depth": np.zeros((2, 2))}, "previous_depth: got shape"),
        ({"camera": None}, "camera: got NoneType"),
        ({"vertices": np.zeros((3, 2))}, "vertices: got shape"),
        ({"faces": np.array([[0, 1, 3]])}, "faces: index 3"),
    ],
)
def test_bad_input_is_named(change, message):
    arguments = {"vertices": np.zeros((3, 3)), "faces": ALONE, "camera": CAMERA, **change}
    with pytest.raises(InputError, match=message):
        rasterize(**arguments)

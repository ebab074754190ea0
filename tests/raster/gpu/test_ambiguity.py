"""Rasterised layers are exact layers, on all built-in scenes and on files, but for pixels published as ambiguous."""

import numpy as np
import pytest
import shapely
import trimesh

from refdof import SCENES, Camera, InputError, View, load_scene
from refdof.raster.gpu.ambiguity import ambiguous_pixels, near_edges, tied_depths
from refdof.raster.gpu.depth_peeling import peel_raster
from refdof.raster.gpu.gpu_model import D3D11, EXACT, LLVMPIPE
from tests.raster.gpu import naive_raster as naive

LAYERS = 6


def gear(path):
    """A cylinder with teeth, its bore, and a slab of coplanar faces: flat, sharp and curved sides."""
    angle = np.linspace(0.0, 2.0 * np.pi, 145)[:-1]
    radius = 1.0 + 0.15 * np.sign(np.sin(12.0 * angle))
    outline = [(float(x), float(y)) for x, y in np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)]
    polygon = shapely.Polygon(outline, [shapely.Point(0, 0).buffer(0.4).exterior.coords])
    vertices, faces = _extruded(polygon)
    trimesh.Trimesh(vertices, faces, process=False).export(path)


def _extruded(polygon):
    """Side walls of a polygon's rings from z = -0.3 to 0.3, two triangles for each side."""
    vertices, faces = [], []
    for ring in (polygon.exterior, *polygon.interiors):
        points = np.asarray(ring.coords)[:-1]
        first, count = len(vertices), len(points)
        vertices += [(x, y, z) for x, y in points for z in (-0.3, 0.3)]
        for k in range(count):
            a, b = first + 2 * k, first + 2 * ((k + 1) % count)
            faces += [(a, b, b + 1), (a, b + 1, a + 1)]
    return np.array(vertices), np.array(faces)


def torus(path):
    trimesh.creation.torus(1.0, 0.35, major_sections=96, minor_sections=48).export(path)


def crowd(path):
    """Capsules, balls and boxes that pass through each other: many layers, many intersections."""
    random = np.random.default_rng(3)
    bodies = []
    for k in range(24):
        kinds = (trimesh.creation.capsule, trimesh.creation.icosphere, trimesh.creation.box)
        body = kinds[k % 3]()
        body.apply_transform(trimesh.transformations.random_rotation_matrix(random.random(3)))
        body.apply_translation(random.normal(0.0, 1.5, 3))
        bodies.append(body)
    trimesh.Scene(bodies).export(path)


FILES = {"gear.obj": gear, "torus.ply": torus, "crowd.glb": crowd}


def compared(scene, model):
    """Shares of ambiguous, and counts of different pixels outside them."""
    view = View(scene, scene.camera.with_size((160, 120)), scene.lens)
    rays = view.layers(LAYERS + 1)
    ours = peel_raster(*view.triangles(), view.camera, LAYERS, model=model)
    mask = ambiguous_pixels(*view.triangles(), view.camera, rays.depth, model)
    made = len(ours.triangle)
    different = (ours.triangle != rays.triangle[:made]).any(axis=0) | (rays.triangle[made:LAYERS] >= 0).any(axis=0)
    filled = (ours.triangle >= 0) & ~(mask | different)
    return mask, different & ~mask, ours.depth[filled], rays.depth[:made][filled]


@pytest.mark.parametrize("name", SCENES)
def test_scenes(name):
    mask, different, ours, rays = compared(load_scene(name), EXACT)
    assert not different.any()
    np.testing.assert_allclose(ours, rays, rtol=1e-10)  # float64, magnified by planes seen at flat angles
    assert mask.mean() < 0.2  # windows painted on walls are ties; edges alone stay below 1 in 15


@pytest.mark.parametrize("name", FILES)
def test_files(name, tmp_path):
    FILES[name](tmp_path / name)
    mask, different, ours, rays = compared(load_scene(str(tmp_path / name)), EXACT)
    assert not different.any()
    np.testing.assert_allclose(ours, rays, rtol=1e-10)
    assert len(ours) > 3000
    assert mask.mean() < 0.05


@pytest.mark.parametrize("model", [LLVMPIPE, D3D11], ids=["llvmpipe", "d3d11"])
def test_graphics_models(model):
    mask, different, ours, rays = compared(load_scene("branches"), model)
    # Two surfaces nearer to each other than single precision at the edge of a thin triangle: see the next bound.
    assert different.mean() < 1e-3
    # Float32 depth of thin triangles; d3d11 also moves the corners by up to 1/512 px, along slopes of up to 100 depths
    # per picture height or so.
    np.testing.assert_allclose(ours, rays, rtol=1e-3 if model == D3D11 else 2e-5)
    assert mask.mean() < 0.1


def test_edges_twin():
    random = np.random.default_rng(6)
    camera = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=60.0, size=(40, 30))
    vertices = random.normal(0.0, 1.0, (60, 3)) - [0.0, 0.0, 1.0]  # some behind the eye
    faces = random.integers(0, 60, (25, 3))
    for reach in (0.01, 0.3, 1.7):
        ours = near_edges(vertices, faces, camera, reach)
        np.testing.assert_array_equal(ours, naive.near_an_edge(vertices, faces, camera, reach))
        assert ours.any()


def test_ties():
    depth = np.array([[1.0, 1.0, np.inf], [1.0, 2.0, np.inf], [3.0, 2.0 + 1e-12, np.inf]])[:, None]
    assert tied_depths(depth).tolist() == [[True, True, False]]


@pytest.mark.parametrize(
    ("change", "message"),
    [({"camera": None}, "camera: got NoneType"), ({"model": "exact"}, "model: got str")],
)
def test_bad_input(change, message):
    camera = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=60.0, size=(4, 3))
    arguments = {"vertices": np.zeros((3, 3)), "faces": [[0, 1, 2]], "camera": camera, "depth": np.ones((1, 3, 4))}
    with pytest.raises(InputError, match=message):
        ambiguous_pixels(**(arguments | change))
    with pytest.raises(InputError, match="reach_px: got nan"):
        near_edges(np.zeros((3, 3)), [[0, 1, 2]], camera, np.nan)

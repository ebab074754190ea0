"""Numbers of glTF files that are stored in other ways than as plain floats: they are what the specification says."""

import json
import math

import numpy as np
import pytest

from refdof import InputError
from refdof.scene.mesh_file import load_mesh
from tests.mesh_fixtures import QUAD, UV_UP, gltf, png, uri, write

pytestmark = pytest.mark.fast
BASE = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}
UV_DOWN = np.stack([UV_UP[:, 0], 1.0 - UV_UP[:, 1]], axis=1)  # as glTF has them
COMPONENTS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}


def stored(header, values, kind, normalized=False, stride=None):
    """Put an accessor with these values into a header; returns its number."""
    values = np.asarray(values)
    code = values.dtype.str[1:]
    row = values.reshape(len(values), -1)
    size = row.shape[1] * row.itemsize
    step = size if stride is None else stride
    data = b"".join(line.tobytes().ljust(step, b"\xee") for line in row)
    header["buffers"].append({"byteLength": len(data), "uri": uri("application/octet-stream", data)})
    view = {"buffer": len(header["buffers"]) - 1, "byteLength": len(data)}
    header["bufferViews"].append(view | ({} if stride is None else {"byteStride": stride}))
    entry = {"bufferView": len(header["bufferViews"]) - 1, "componentType": COMPONENTS[code], "count": len(values)}
    header["accessors"].append(entry | {"type": kind, "normalized": normalized})
    return len(header["accessors"]) - 1


def header_of(*more, **words):
    return json.loads(gltf([{"mesh": 0}], *more, **words))


def corners(tmp_path, header):
    """Vertices and texture coordinates (v upwards) of the quad's corners in the order of QUAD."""
    scene = load_mesh(write(tmp_path, "a.gltf", json.dumps(header)))
    order = [int(np.argmin(np.abs(scene.vertices - corner).sum(axis=1))) for corner in QUAD]
    return scene.vertices[order], scene.uv[order]


def attributes(header):
    return header["meshes"][0]["primitives"][0]["attributes"]


@pytest.mark.parametrize("code", ["u1", "u2"])
@pytest.mark.parametrize("stride", [None, 8])
def test_normalised_texture_coordinates(tmp_path, code, stride):
    header = header_of([BASE], uri("image/png", png()))
    largest = np.iinfo(code).max
    shares = UV_DOWN * 0.6
    whole = np.rint(shares * largest).astype(code)
    attributes(header)["TEXCOORD_0"] = stored(header, whole, "VEC2", True, stride)
    _, found = corners(tmp_path, header)
    np.testing.assert_allclose(found[:, 0], whole[:, 0] / largest, atol=1e-7)  # float32
    np.testing.assert_allclose(1.0 - found[:, 1], whole[:, 1] / largest, atol=1e-7)


@pytest.mark.parametrize("code", ["i1", "i2", "u2"])
@pytest.mark.parametrize("normalized", [False, True])
def test_whole_numbers_as_places(tmp_path, code, normalized):
    low = QUAD.min(axis=0)
    whole = np.rint((QUAD - low) * 3.0).astype(code)
    header = header_of()
    attributes(header)["POSITION"] = stored(header, whole, "VEC3", normalized, 8)
    scene = load_mesh(write(tmp_path, "a.gltf", json.dumps(header)))
    factor = float(np.iinfo(code).max) if normalized else 1.0
    expected = np.unique(whole.astype(float) / factor, axis=0)
    np.testing.assert_allclose(np.unique(scene.vertices, axis=0), expected, rtol=1e-6, atol=1e-9)  # float32


@pytest.mark.parametrize("with_base", [True, False])
def test_sparse_places(tmp_path, with_base):
    """Two corners are put elsewhere; without a base, all others are 0."""
    header = header_of()
    moved = np.array([[9.0, 1.0, 2.0], [-3.0, 5.0, 4.0]], dtype="f4")
    indices, values = stored(header, np.array([1, 2], dtype="u2"), "SCALAR"), stored(header, moved, "VEC3")
    accessor = header["accessors"][attributes(header)["POSITION"]]
    accessor["sparse"] = {
        "count": 2,
        "indices": {"bufferView": header["accessors"][indices]["bufferView"], "componentType": 5123},
        "values": {"bufferView": header["accessors"][values]["bufferView"]},
    }
    expected = QUAD.astype(float).copy() if with_base else np.zeros((4, 3))
    expected[[1, 2]] = moved
    if not with_base:
        del accessor["bufferView"]
    scene = load_mesh(write(tmp_path, "a.gltf", json.dumps(header)))
    found = {tuple(place) for place in scene.vertices[scene.faces].reshape(-1, 3).tolist()}
    assert found == {tuple(place) for place in expected.tolist()}


def test_the_set_of_texture_coordinates_that_the_material_names(tmp_path):
    header = header_of(
        [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": 1}}}], uri("image/png", png())
    )
    second = UV_DOWN[::-1].astype("f4")
    attributes(header)["TEXCOORD_1"] = stored(header, second, "VEC2")
    _, found = corners(tmp_path, header)
    np.testing.assert_allclose(found, np.stack([second[:, 0], 1.0 - second[:, 1]], axis=1), atol=1e-7)


@pytest.mark.parametrize(
    ("transform", "place", "becomes"),
    [
        ({"offset": [0.25, -0.5]}, (1.0, 0.0), (1.25, -0.5)),
        ({"scale": [2.0, 3.0]}, (1.0, 1.0), (2.0, 3.0)),
        ({"rotation": math.pi / 2}, (1.0, 0.0), (0.0, -1.0)),  # from right to up: v runs downwards
        ({"rotation": math.pi / 2}, (0.0, 1.0), (1.0, 0.0)),
        ({"offset": [10.0, 20.0], "rotation": math.pi / 2, "scale": [2.0, 3.0]}, (1.0, 1.0), (13.0, 18.0)),
    ],
)
def test_the_transform_of_a_texture(tmp_path, transform, place, becomes):
    texture = {"index": 0, "extensions": {"KHR_texture_transform": transform}}
    header = header_of([{"pbrMetallicRoughness": {"baseColorTexture": texture}}], uri("image/png", png()))
    header |= {"extensionsUsed": ["KHR_texture_transform"], "extensionsRequired": ["KHR_texture_transform"]}
    _, found = corners(tmp_path, header)
    corner = int(np.argmin(np.abs(UV_DOWN - place).sum(axis=1)))
    assert UV_DOWN[corner].tolist() == list(place)
    np.testing.assert_allclose([found[corner, 0], 1.0 - found[corner, 1]], becomes, atol=2e-6)  # float32 of 20


@pytest.mark.parametrize(
    ("transform", "message"),
    [
        ({"offset": [1.0]}, "offset"),
        ({"scale": "big"}, "scale"),
        ({"rotation": "left"}, "rotation"),
        ({"texCoord": -1}, "texCoord"),
    ],
)
def test_bad_transforms_are_named(tmp_path, transform, message):
    texture = {"index": 0, "extensions": {"KHR_texture_transform": transform}}
    header = header_of([{"pbrMetallicRoughness": {"baseColorTexture": texture}}], uri("image/png", png()))
    with pytest.raises(InputError, match=message):
        load_mesh(write(tmp_path, "a.gltf", json.dumps(header)))


@pytest.mark.parametrize(
    ("mode", "order", "faces"),
    [
        (5, [0, 1, 2, 3, 4], [(0, 1, 2), (1, 3, 2), (2, 3, 4)]),  # every second one the other way round
        (6, [4, 0, 1, 2], [(0, 1, 4), (1, 2, 4)]),
        (5, None, [(0, 1, 2), (1, 3, 2), (2, 3, 4)]),
    ],
)
def test_strips_and_fans_beside_triangles(tmp_path, mode, order, faces):
    places = np.array([[0, 0, 1], [1, 0, 1], [0, 1, 2], [1, 1, 2], [0.5, 2, 3]], dtype="f4")
    header = header_of()
    primitive = {"attributes": {"POSITION": stored(header, places, "VEC3")}, "mode": mode}
    if order is not None:
        primitive["indices"] = stored(header, np.array(order, dtype="u2"), "SCALAR")
    header["meshes"][0]["primitives"].append(primitive)
    scene = load_mesh(write(tmp_path, "a.gltf", json.dumps(header)))
    found = {tuple(map(tuple, turned(scene.vertices[face].tolist()))) for face in scene.faces}
    wanted = [*QUAD[[[0, 1, 2], [0, 2, 3]]].tolist(), *places[np.array(faces)].tolist()]
    assert found == {tuple(map(tuple, turned(triangle))) for triangle in wanted}


def turned(triangle):
    """The same triangle from its least corner on: its way round stays."""
    first = triangle.index(min(triangle))
    return triangle[first:] + triangle[:first]


def test_without_normals_every_triangle_is_flat(tmp_path):
    """A roof with a blunt ridge: smooth it would be in a file of another kind."""
    places = np.array([[0, 0, 0], [2, 0, 0], [1, 0.1, -1], [1, 0.1, 1]], dtype="f4")
    header = header_of()
    primitive = {"attributes": {"POSITION": stored(header, places, "VEC3")}}
    primitive["indices"] = stored(header, np.array([0, 3, 2, 1, 2, 3], dtype="u2"), "SCALAR")
    header["meshes"][0]["primitives"] = [primitive]
    scene = load_mesh(write(tmp_path, "a.gltf", json.dumps(header)))
    for face in scene.faces:
        a, b, c = scene.vertices[face]
        flat = np.cross(b - a, c - a)
        np.testing.assert_allclose(scene.normal[face], np.tile(flat / np.linalg.norm(flat), (3, 1)), atol=1e-6)

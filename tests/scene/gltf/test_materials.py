"""Materials of glTF files: alpha, emission, wrapping and specular-glossiness, by hand."""

import numpy as np
import pytest

from refdof import InputError
from refdof.scene.mesh_file import load_mesh
from tests.scene.gltf.card import UV, Card, base

pytestmark = pytest.mark.fast
RED = [[[255, 0, 0]]]
LEAF = [[[255, 0, 0, 255], [0, 255, 0, 51]]]  # alpha 1 and 0.2


def loaded(card, folder, name="a.gltf"):
    return load_mesh(card.write(folder, name))


def material_of(card, folder):
    return loaded(card, folder).materials[0]


@pytest.mark.parametrize("name", ["a.gltf", "a.glb"])
@pytest.mark.parametrize(
    ("words", "opacity", "textured", "cutoff"),
    [
        ({}, 1.0, False, None),
        ({"alphaMode": "OPAQUE", "alphaCutoff": 0.3}, 1.0, False, None),
        ({"alphaMode": "MASK"}, 0.25, True, 0.5),
        ({"alphaMode": "MASK", "alphaCutoff": 0.125}, 0.25, True, 0.125),
        ({"alphaMode": "MASK", "alphaCutoff": 3.0}, 0.0, True, 1.0),  # a hole everywhere
        ({"alphaMode": "BLEND", "alphaCutoff": 0.125}, 0.25, True, None),
    ],
)
def test_alpha_modes(tmp_path, name, words, opacity, textured, cutoff):
    card = Card(base(0, **words), COLOR_0=np.array([[1, 1, 1, 0.5]] * 4, dtype=np.float32))
    card.header["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = [1, 1, 1, 0.25]
    card.picture(LEAF)
    scene = loaded(card, tmp_path, name)
    material = scene.materials[0]
    assert (material.opacity, material.cutoff) == (opacity, cutoff)
    if textured:
        np.testing.assert_allclose(material.opacity_texture, [[1.0, 0.2]], rtol=1e-6)  # float32
        np.testing.assert_array_equal(scene.opacity, 0.5)
    else:
        assert material.opacity_texture is None
        assert scene.opacity is None
    np.testing.assert_array_equal(material.texture, [[[1, 0, 0], [0, 1, 0]]])


def test_an_opaque_picture_has_no_opacity(tmp_path):
    card = Card(base(0, alphaMode="BLEND"), COLOR_0=np.ones((4, 4), dtype=np.float32))
    card.picture([[[255, 0, 0, 255]]])
    scene = loaded(card, tmp_path)
    assert (scene.materials[0].opacity_texture, scene.opacity) == (None, None)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
@pytest.mark.parametrize("columns", [3, 4])
def test_colours_of_vertices_of_several_primitives(tmp_path, dtype, columns):
    """Each primitive keeps its own; one has none."""
    card = Card({"alphaMode": "BLEND"})
    most = 1.0 if dtype == np.float32 else np.iinfo(dtype).max
    whole = card.primitive
    for k, share in enumerate((0.2, 1.0)):
        colors = np.array([[share, 0.0, 1.0, share][:columns]] * 4) * most
        words = {} if dtype == np.float32 else {"normalized": True}
        places = card.numbers(np.array([[0, 0, k + 1], [2, 0, k + 1], [2, 1, k + 1], [0, 1, k + 1]]))
        attributes = {
            **whole["attributes"],
            "POSITION": places,
            "COLOR_0": card.numbers(np.rint(colors) if most > 1 else colors, dtype, **words),
        }
        card.header["meshes"][0]["primitives"].append({**whole, "attributes": attributes})
    scene = loaded(card, tmp_path)
    for z, expected in ((0, [1, 1, 1]), (1, [0.2, 0, 1]), (2, [1, 0, 1])):
        there = scene.vertices[:, 2] == z
        np.testing.assert_allclose(scene.color[there], np.tile(expected, (there.sum(), 1)), rtol=1e-6)
        clear = 0.2 if z == 1 and columns == 4 else 1.0
        np.testing.assert_allclose(np.ones(1) if scene.opacity is None else scene.opacity[there], clear, rtol=1e-6)


def test_emission_and_its_texture(tmp_path):
    card = Card({"emissiveFactor": [1, 0.5, 0.25], "emissiveTexture": {"index": 0}})
    card.header["materials"][0]["extensions"] = {"KHR_materials_emissive_strength": {"emissiveStrength": 8}}
    card.picture([[[255, 0, 188]]])
    material = material_of(card, tmp_path)
    assert material.emission == (8, 4, 2)
    np.testing.assert_allclose(material.emission_texture, [[[1, 0, 0.5029]]], atol=5e-5)  # four digits
    assert material.texture is None


def test_an_emissive_texture_has_the_base_colours_place(tmp_path):
    place = {"index": 0, "texCoord": 1}
    card = Card(
        {"pbrMetallicRoughness": {"baseColorTexture": place}, "emissiveFactor": [1, 1, 1], "emissiveTexture": place},
        TEXCOORD_1=UV * np.float32(0.5),
    )
    card.picture(RED)
    scene = loaded(card, tmp_path)
    assert scene.materials[0].emission_texture is scene.materials[0].texture
    assert scene.uv.min() == 0.0
    assert scene.uv[:, 0].max() == 0.5


@pytest.mark.parametrize(
    "other",
    [
        {"texCoord": 1},
        {"extensions": {"KHR_texture_transform": {"scale": [2, 2]}}},
    ],
)
def test_an_emissive_texture_placed_otherwise_is_told(tmp_path, other):
    words = {"emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 0, **other}}
    card = Card(base(0, **words), TEXCOORD_1=UV)
    card.picture(RED)
    with pytest.warns(UserWarning, match=r"an emissive texture \(it is placed otherwise"):
        material = material_of(card, tmp_path)
    assert (material.emission, material.emission_texture) == ((0, 0, 0), None)


def test_an_emissive_texture_that_wraps_otherwise_is_told(tmp_path):
    card = Card(base(0, emissiveFactor=[1, 1, 1], emissiveTexture={"index": 1}))
    card.picture(RED)
    card.picture([[[0, 255, 0]]], sampler={"wrapS": 33071})
    with pytest.warns(UserWarning, match="the wrapping of an emissive texture"):
        material = material_of(card, tmp_path)
    assert material.wrap == ("repeat", "repeat")
    np.testing.assert_array_equal(material.emission_texture, [[[0, 1, 0]]])


@pytest.mark.parametrize(("s", "u"), [(33071, "clamp"), (33648, "mirror"), (10497, "repeat"), (None, "repeat")])
@pytest.mark.parametrize(("t", "v"), [(33071, "clamp"), (33648, "mirror"), (10497, "repeat"), (None, "repeat")])
def test_wrapping(tmp_path, s, u, t, v):
    card = Card(base(0))
    card.picture(RED, sampler={key: code for key, code in (("wrapS", s), ("wrapT", t)) if code})
    assert material_of(card, tmp_path).wrap == (u, v)


@pytest.mark.parametrize("key", ["magFilter", "minFilter"])
@pytest.mark.parametrize("code", [9728, 9984, 9986, 9729, 9985, 9987])
def test_filters(tmp_path, key, code):
    card = Card(base(0))
    card.picture(RED, sampler={key: code})
    if code in (9728, 9984, 9986):
        with pytest.warns(UserWarning, match="left out: nearest filtering"):
            material_of(card, tmp_path)
    else:
        material_of(card, tmp_path)


def test_specular_glossiness(tmp_path):
    diffuse = {"diffuseFactor": [0.001, 0.5, 0.25, 0.75], "diffuseTexture": {"index": 0}, "glossinessFactor": 0.5}
    card = Card(
        {
            "alphaMode": "BLEND",
            "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 1, 1]},
            "extensions": {"KHR_materials_pbrSpecularGlossiness": diffuse},
        }
    )
    card.picture(RED)
    material = material_of(card, tmp_path)
    assert (material.base_color, material.opacity) == ((0.001, 0.5, 0.25), 0.75)
    np.testing.assert_array_equal(material.texture, [[[1, 0, 0]]])
    assert material.shininess == 7.5  # roughness 0.5: (2 / 0.5^4 - 2) / 4


def test_one_image_is_one_array(tmp_path):
    card = Card(base(0))
    card.header["materials"].append(base(1))
    card.picture(RED)
    card.header["textures"].append({"source": 0})
    card.header["meshes"][0]["primitives"].append({**card.primitive, "material": 1})
    first, second = loaded(card, tmp_path).materials
    assert first.texture is second.texture


def test_a_primitive_without_the_textures_coordinates_is_told(tmp_path):
    card = Card({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": 3}}})
    card.picture(RED)
    with pytest.warns(UserWarning, match=r"texture 0 \(a mesh has no TEXCOORD_3\)"):
        assert material_of(card, tmp_path).texture is None


@pytest.mark.parametrize(
    ("material", "message"),
    [
        ({"alphaMode": "GLASS"}, "alphaMode: got 'GLASS'"),
        ({"alphaMode": "MASK", "alphaCutoff": -1}, "alphaCutoff: got -1"),
        ({"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1]}}, "baseColorFactor: got 3 numbers"),
        ({"pbrMetallicRoughness": {"baseColorTexture": 3}}, "baseColorTexture: got int"),
        ({"pbrMetallicRoughness": {"baseColorTexture": {"index": 7}}}, "textures: index 7"),
        ({"pbrMetallicRoughness": {"roughnessFactor": 2}}, "roughnessFactor: got 2"),
        ({"emissiveTexture": []}, "texture: got list"),
        (base(0), "samplers: wraps by 5"),
        (base(1), "samplers: index 9"),
        (base(2), "images: index 9"),
    ],
)
def test_bad_materials_are_named(tmp_path, material, message):
    card = Card(material)
    card.picture(RED, sampler={"wrapT": 5})
    card.picture(RED)
    card.picture(RED)
    card.header["textures"][1]["sampler"] = 9
    card.header["textures"][2]["source"] = 9
    with pytest.raises(InputError, match=message):
        loaded(card, tmp_path)

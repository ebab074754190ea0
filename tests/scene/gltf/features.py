"""A small file for each row of the tables of docs/scenes.md, and what shows that the row is true.

`FEATURES` has, by a row's name, a maker of a card, and a check of the scene that is read of it. Of what is ignored or
refused, it has the words that name it.
"""

import io
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from PIL import Image

from tests.mesh_fixtures import uri
from tests.scene.formats.reading_fixtures import area_of
from tests.scene.formats.test_pictures import png16
from tests.scene.gltf.card import FACES, PLACES, UV, Card, base

RED = [[[255, 0, 0]]]


class Feature(NamedTuple):
    make: Callable[[], Any]
    shown: Any  # a check of the scene, or words of the warning or the error
    name: str = "a.gltf"


def quad(scene, z=0.0):
    """Whether the scene is the card, at this height."""
    return area_of(scene) == 2.0 and (scene.vertices[:, 2] == z).all()


def changed(card, change):
    change(card)
    return card


def lifted(card):
    """Each node one higher."""
    card.header["nodes"][0]["translation"] = [0, 0, 1]


def rough(**words):
    return {"pbrMetallicRoughness": words}


def with_texture(material, pixels=RED, sampler=None, **attributes):
    card = Card(material, **attributes)
    card.picture(pixels, sampler=sampler)
    return card


def numbers_of_all_types():
    card = Card(COLOR_0=np.ones((4, 4), dtype=np.float32))
    card.primitive["attributes"]["POSITION"] = card.numbers(PLACES * 10, np.int16)
    card.primitive["attributes"]["TEXCOORD_0"] = card.numbers(UV * 255, np.uint8, normalized=True)
    card.primitive["indices"] = card.numbers(np.ravel(FACES), np.uint8)
    return card


def sparse():
    card = Card()
    where, what = card.numbers([0, 1, 2, 3], np.uint16), card.numbers(PLACES + np.float32([0, 0, 3]))
    views = card.header["accessors"]
    views[card.primitive["attributes"]["POSITION"]]["sparse"] = {
        "count": 4,
        "indices": {"bufferView": views[where]["bufferView"], "componentType": 5123},
        "values": {"bufferView": views[what]["bufferView"]},
    }
    return card


def without_numbers():
    card = Card()
    del card.header["accessors"][card.primitive["attributes"]["POSITION"]]["bufferView"]
    return card


def other_scene():
    card = Card()
    card.node(mesh=0, translation=[0, 0, 9])
    card.header["scenes"].append({"nodes": [1]})
    return card


def two_parents():
    card = Card()
    card.header["nodes"] += [{"children": [0]}, {"children": [0]}]
    return card


def in_mode(mode, order):
    card = Card()
    card.primitive.update(mode=mode, indices=card.numbers(order, np.uint16))
    return card


def and_points():
    card = Card()
    card.header["meshes"][0]["primitives"].append({**card.primitive, "mode": 0})
    return card


def skinned():
    """The joint stands at z = 4; the node's own place does not count."""
    joints, weights = np.zeros((4, 4), dtype=np.uint8), np.array([[1, 0, 0, 0]] * 4, dtype=np.float32)
    card = Card()
    card.primitive["attributes"] |= {"JOINTS_0": card.numbers(joints, np.uint8), "WEIGHTS_0": card.numbers(weights)}
    joint = card.node(root=True, translation=[0, 0, 4])
    card.header["skins"] = [{"joints": [joint]}]
    card.header["nodes"][0] |= {"skin": 0, "translation": [9, 9, 9]}
    return card


def morphed(key="POSITION"):
    card = Card()
    card.primitive["targets"] = [{key: card.numbers(np.tile([0, 0, 2.0], (4, 1)))}]
    card.header["meshes"][0]["weights"] = [0.5]
    return card


def moving(count=1):
    card = Card()
    card.move(0, "translation", [0.0, 1.0], [[0, 0, 0], [0, 0, 24]])
    card.header["animations"] *= count
    return card


def seen(*cameras):
    card = Card()
    card.header["cameras"] = list(cameras)
    for k in range(len(cameras)):
        card.node(root=True, camera=k, translation=[1, 0.5, 3])
    return card


def perspective(**planes):
    return {"type": "perspective", "perspective": {"yfov": 0.5, "aspectRatio": 2.0, "znear": 0.1, **planes}}


ORTHOGRAPHIC = {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0.1, "zfar": 9}}


def of_kind(kind, extension=None):
    out = io.BytesIO()
    Image.new("RGB", (8, 8), (255, 0, 0)).save(out, kind, **({"lossless": True} if kind == "webp" else {}))
    card = Card(base(0))
    card.texture(uri(f"image/{kind}", out.getvalue()))
    if extension is not None:
        card.header["textures"][0] = {"extensions": {extension: {"source": 0}}}
        card.uses(extension, required=True)
    return card


def first(scene):
    return scene.materials[0]


def is_red(scene):
    """JPEG and AVIF lose some."""
    return first(scene).texture is not None and np.allclose(first(scene).texture[0, 0], (1, 0, 0), atol=0.03)


def leaf(mode):
    return with_texture(base(0, alphaMode=mode), [[[255, 0, 0, 0], [0, 255, 0, 255]]])


def has_cutout(scene):
    return first(scene).cutoff == 0.5 and first(scene).opacity_texture.tolist() == [[0.0, 1.0]]


def is_clear(scene):
    return first(scene).cutoff is None and first(scene).opacity_texture.tolist() == [[0.0, 1.0]]


def is_opaque(scene):
    return first(scene).opacity_texture is None and first(scene).texture is not None


def missing():
    card = Card(base(0))
    card.texture("nowhere.png")
    return card


def of_16_bits():
    card = Card(base(0))
    card.texture(uri("image/png", png16(np.full((1, 1, 3), 300, dtype=np.uint16))))
    return card


def version_1():
    card = Card()
    card.header["asset"]["version"] = "1.0"
    return card


def glow(**other):
    return {"emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 0, **other}}


def is_close(value, expected):
    return bool(np.allclose(value, expected, rtol=1e-6))  # float32


MIRRORED = [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 1, 1]
FEATURES = {
    "glTF with files beside": Feature(lambda: Card(), quad, "beside.gltf"),
    "glTF with data URIs": Feature(lambda: Card(), quad),
    "GLB": Feature(lambda: Card(), quad, "a.glb"),
    "glTF 1.0": Feature(version_1, "version is 1.0"),
    "accessors of all types": Feature(
        numbers_of_all_types, lambda s: is_close(np.ptp(s.vertices, axis=0), (20, 10, 0))
    ),
    "sparse accessors": Feature(sparse, lambda s: quad(s, 3.0)),
    "accessors without numbers": Feature(without_numbers, "has no bufferView"),
    "default scene": Feature(other_scene, quad),
    "node matrices": Feature(
        lambda: changed(Card(), lambda c: c.header["nodes"][0].update(matrix=MIRRORED)),
        lambda s: quad(s, 1.0) and s.vertices[:, 0].max() == 5.0 and s.vertices[:, 0].min() == 3.0,
    ),
    "translation, rotation, scale": Feature(lambda: changed(Card(), lifted), lambda s: quad(s, 1.0)),
    "nodes that are no trees": Feature(two_parents, "allowed is one parent"),
    "triangles": Feature(lambda: in_mode(4, [0, 1, 2]), lambda s: area_of(s) == 1.0),
    "triangle strips": Feature(lambda: in_mode(5, [0, 1, 3, 2]), quad),
    "triangle fans": Feature(lambda: in_mode(6, [0, 1, 2, 3]), quad),
    "points and lines": Feature(and_points, "points and lines"),
    "normals": Feature(
        lambda: Card(NORMAL=np.array([[0.6, 0, 0.8]] * 4, dtype=np.float32)),
        lambda s: is_close(s.normal, [[0.6, 0, 0.8]] * 4),
    ),
    "texture coordinates": Feature(
        lambda: with_texture(rough(baseColorTexture={"index": 0, "texCoord": 1}), TEXCOORD_1=UV / np.float32(4)),
        lambda s: s.uv[:, 0].max() == 0.25,
    ),
    "vertex colours": Feature(
        lambda: Card(COLOR_0=np.array([[0.5, 0.25, 0]] * 4, dtype=np.float32)),
        lambda s: is_close(s.color, [[0.5, 0.25, 0]] * 4),
    ),
    "further vertex colours": Feature(
        lambda: Card(COLOR_1=np.ones((4, 3), dtype=np.float32)), "sets of colours but the first"
    ),
    "skins": Feature(skinned, lambda s: quad(s, 4.0)),
    "morph targets": Feature(morphed, lambda s: quad(s, 1.0)),
    "morph targets of colours": Feature(lambda: morphed("COLOR_0"), "morph targets of COLOR_0"),
    "first animation": Feature(moving, lambda s: s.frames == (0, 24) and quad(s.at_frame(12), 12.0)),
    "further animations": Feature(lambda: moving(2), "animations but the first"),
    "perspective camera": Feature(lambda: seen(perspective()), lambda s: s.camera.eye == (1, 0.5, 3)),
    "further cameras": Feature(lambda: seen(perspective(), perspective()), "cameras but the first"),
    "orthographic camera": Feature(lambda: seen(ORTHOGRAPHIC), "its camera is orthographic"),
    "znear and zfar": Feature(lambda: seen(perspective(znear=4.0, zfar=9.0)), "its camera's znear"),
    "baseColorFactor": Feature(
        lambda: Card(rough(baseColorFactor=[0.001, 0.003, 0.0137, 1])),
        lambda s: first(s).base_color == (0.001, 0.003, 0.0137),
    ),
    "baseColorTexture": Feature(lambda: of_kind("jpeg"), is_red),
    "metallicFactor": Feature(lambda: Card(rough(metallicFactor=0.5)), "metallicFactor"),
    "roughnessFactor": Feature(lambda: Card(rough(roughnessFactor=0.5)), lambda s: first(s).shininess == 7.5),
    "metallicRoughnessTexture": Feature(
        lambda: with_texture(rough(metallicRoughnessTexture={"index": 0})), "metallic-roughness textures"
    ),
    "normalTexture": Feature(lambda: with_texture({"normalTexture": {"index": 0}}), "normal textures"),
    "occlusionTexture": Feature(lambda: with_texture({"occlusionTexture": {"index": 0}}), "occlusion textures"),
    "emissiveFactor": Feature(
        lambda: Card({"emissiveFactor": [1, 0.5, 0]}), lambda s: first(s).emission == (1, 0.5, 0)
    ),
    "emissiveTexture": Feature(
        lambda: with_texture(glow()), lambda s: first(s).emission_texture.tolist() == [[[1, 0, 0]]]
    ),
    "emissiveTexture placed otherwise": Feature(
        lambda: with_texture(base(0, **glow(texCoord=1)), TEXCOORD_1=UV), "an emissive texture"
    ),
    "alphaMode OPAQUE": Feature(lambda: leaf("OPAQUE"), is_opaque),
    "alphaMode MASK": Feature(lambda: leaf("MASK"), has_cutout),
    "alphaMode BLEND": Feature(lambda: leaf("BLEND"), is_clear),
    "doubleSided": Feature(lambda: Card({"doubleSided": True}), quad),
    "wrapS and wrapT": Feature(
        lambda: with_texture(base(0), sampler={"wrapS": 33071, "wrapT": 33648}),
        lambda s: first(s).wrap == ("clamp", "mirror"),
    ),
    "linear filters": Feature(lambda: with_texture(base(0), sampler={"magFilter": 9729, "minFilter": 9987}), is_red),
    "nearest filters": Feature(lambda: with_texture(base(0), sampler={"magFilter": 9728}), "nearest filtering"),
    "missing images": Feature(missing, r"nowhere\.png"),
    "16-bit images": Feature(of_16_bits, lambda s: is_close(first(s).texture, 300 / 65535 / 12.92)),
}


def extended(name, values, **material):
    """A card whose material uses an extension."""
    return Card({**material, "extensions": {name: values}}).uses(name, required=True)


def strong():
    card = extended("KHR_materials_emissive_strength", {"emissiveStrength": 20.0}, emissiveFactor=[1, 0.5, 0])
    return card


def quantised():
    card = Card().uses("KHR_mesh_quantization", required=True)
    card.primitive["attributes"]["POSITION"] = card.numbers(PLACES * 100, np.int16)
    card.header["nodes"][0]["scale"] = [0.01] * 3
    return card


def hidden():
    card = Card().uses("KHR_node_visibility", required=True)
    card.node(root=True, mesh=0, translation=[0, 0, 5], extensions={"KHR_node_visibility": {"visible": False}})
    return card


def turned():
    place = {"index": 0, "extensions": {"KHR_texture_transform": {"scale": [3, 1]}}}
    return with_texture(rough(baseColorTexture=place)).uses("KHR_texture_transform", required=True)


def twice():
    card = Card().uses("EXT_mesh_gpu_instancing", required=True)
    moves = card.numbers([[0, 0, 0], [0, 0, 6]])
    card.header["nodes"][0]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": moves}}}
    return card


READ_EXTENSIONS = {
    "KHR_materials_emissive_strength": Feature(strong, lambda s: first(s).emission == (20, 10, 0)),
    "KHR_materials_pbrSpecularGlossiness": Feature(
        lambda: extended("KHR_materials_pbrSpecularGlossiness", {"diffuseFactor": [0.001, 0, 1, 1]}),
        lambda s: first(s).base_color == (0.001, 0, 1),
    ),
    "KHR_materials_unlit": Feature(lambda: extended("KHR_materials_unlit", {}), lambda s: first(s).shading == "unlit"),
    "KHR_mesh_quantization": Feature(quantised, lambda s: is_close(np.ptp(s.vertices, axis=0), (2, 1, 0))),
    "KHR_node_visibility": Feature(hidden, quad),
    "KHR_texture_transform": Feature(turned, lambda s: s.uv[:, 0].max() == 3.0),
    "EXT_mesh_gpu_instancing": Feature(twice, lambda s: area_of(s) == 4.0 and s.vertices[:, 2].max() == 6.0),
    "EXT_texture_avif": Feature(lambda: of_kind("avif", "EXT_texture_avif"), is_red),
    "EXT_texture_webp": Feature(lambda: of_kind("webp", "EXT_texture_webp"), is_red),
}

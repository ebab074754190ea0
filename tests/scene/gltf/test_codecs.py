"""Packed glTF files, where the extra `codecs` is installed: made by the packages' encoders, read back by hand."""

import numpy as np
import pytest

from refdof import InputError
from refdof.scene.gltf.codecs import meshopt_bytes
from refdof.scene.limits import Limits
from refdof.scene.mesh_file import load_mesh
from tests.scene.formats.reading_fixtures import area_of, triangles
from tests.scene.gltf.card import FACES, PLACES, UV, Card

MESHOPT, DRACO = "EXT_meshopt_compression", "KHR_draco_mesh_compression"


def draco(places=PLACES, faces=FACES, colors=None, **words):
    """A card whose numbers are in a Draco buffer alone, without loss but for 14 bits of places."""
    packer = pytest.importorskip("DracoPy")
    places_of = {"preserve_order": True, "tex_coord": UV.astype(np.float64), "colors": colors, **words}
    packed = packer.encode(places, np.array(faces, dtype=np.uint32), **places_of)
    kinds = {0: "POSITION", 2: "COLOR_0", 3: "TEXCOORD_0"}
    ids = {kinds[item["attribute_type"]]: item["unique_id"] for item in packer.decode(packed).attributes}
    card = Card(COLOR_0=np.zeros((4, 3), dtype=np.float32)) if colors is not None else Card()
    for index in (*card.primitive["attributes"].values(), card.primitive["indices"]):
        del card.header["accessors"][index]["bufferView"]
    if colors is not None:
        accessor = card.header["accessors"][card.primitive["attributes"]["COLOR_0"]]
        accessor |= {"componentType": 5121, "normalized": True}
    card.primitive["extensions"] = {DRACO: {"bufferView": card.view(packed), "attributes": ids}}
    return card.uses(DRACO, required=True)


def test_draco(tmp_path):
    colors = np.array([[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]], dtype=np.uint8)
    scene = load_mesh(draco(colors=colors).write(tmp_path))
    assert area_of(scene) == pytest.approx(2.0, abs=1e-3)  # 14 bits of an extent of 2
    for vertex, uv, color in zip(scene.vertices, scene.uv, scene.color, strict=True):
        k = int(np.argmin(np.abs(PLACES - vertex).sum(axis=1)))
        np.testing.assert_allclose(vertex, PLACES[k], atol=2 / 2**14)
        assert uv.tolist() in ([0, 0], [UV[k, 0], 1 - UV[k, 1]])  # without a texture, none is asked for
        np.testing.assert_array_equal(color, colors[k] / 255)


@pytest.mark.parametrize("damage", ["cut", "noise", "missing"])
def test_broken_draco_is_refused(tmp_path, damage):
    card = draco()
    view = card.header["bufferViews"][-1]
    if damage == "cut":
        view["byteLength"] //= 2
    elif damage == "noise":
        start = view["byteOffset"]
        card.data = card.data[:start] + bytes(view["byteLength"]) + card.data[start + view["byteLength"] :]
    else:
        card.primitive["extensions"][DRACO]["attributes"]["POSITION"] = 77
    message = "has no attribute 77 for POSITION" if damage == "missing" else "Draco cannot unpack it"
    with pytest.raises(InputError, match=message):
        load_mesh(card.write(tmp_path))


def packed_by(card, encode, view, count, stride, mode, **words):
    """Replace a buffer view by its packed one."""
    place = card.header["bufferViews"][view]
    rows = card.data[place["byteOffset"] : place["byteOffset"] + place["byteLength"]]
    packed = encode(rows)
    says = {"buffer": 0, "byteOffset": 0, "byteLength": len(packed), "byteStride": stride, "mode": mode, "count": count}
    number = card.view(packed)
    says["byteOffset"] = card.header["bufferViews"].pop(number)["byteOffset"]
    place |= {"buffer": 1, "byteOffset": 0, "extensions": {MESHOPT: says | words}}


def meshopt(order=FACES, mode="TRIANGLES"):
    from meshoptimizer import encoder

    card = Card(faces=order)
    attributes = card.primitive["attributes"]
    views = [card.header["accessors"][attributes[key]]["bufferView"] for key in ("POSITION", "TEXCOORD_0")]

    def rows(stride):
        return lambda data: encoder.encode_vertex_buffer(
            np.frombuffer(data, dtype=np.float32).reshape(4, -1), 4, stride
        )

    packed_by(card, rows(12), views[0], 4, 12, "ATTRIBUTES")
    packed_by(card, rows(8), views[1], 4, 8, "ATTRIBUTES")
    encode = encoder.encode_index_buffer if mode == "TRIANGLES" else encoder.encode_index_sequence
    view = card.header["accessors"][card.primitive["indices"]]["bufferView"]
    packed_by(card, lambda data: encode(np.frombuffer(data, dtype="<u2").astype(np.uint32), np.size(order), 4), view,
              np.size(order), 2, mode)  # fmt: skip
    return card.uses(MESHOPT, required=True)


class Packed:
    """A card that is written with the empty buffer which stands for what is packed."""

    def __init__(self, card):
        self.card = card

    def write(self, folder):
        import json

        from tests.mesh_fixtures import uri

        buffers = [
            {"byteLength": len(self.card.data), "uri": uri("application/octet-stream", self.card.data)},
            {"byteLength": 1000, "extensions": {MESHOPT: {"fallback": True}}},
        ]
        path = folder / "a.gltf"
        path.write_text(json.dumps({**self.card.header, "buffers": buffers}))
        return path


@pytest.mark.parametrize("mode", ["TRIANGLES", "INDICES"])
def test_meshopt(tmp_path, mode):
    pytest.importorskip("meshoptimizer")
    scene = load_mesh(Packed(meshopt(mode=mode)).write(tmp_path))
    plain = load_mesh(Card().write(tmp_path, "plain.gltf"))
    assert triangles(scene) == triangles(plain)


@pytest.mark.parametrize("kind", ["OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"])
@pytest.mark.parametrize("stride", [4, 8])
def test_filters_of_meshopt(kind, stride):
    """Against the extension's own formulas, number by number."""
    encoder = pytest.importorskip("meshoptimizer.encoder")
    if (kind, stride) == ("QUATERNION", 4):
        pytest.skip("four numbers of 16 bits each")
    rng = np.random.default_rng(5)
    dtype = np.int8 if stride == 4 else np.int16
    if kind == "EXPONENTIAL":
        mantissa, exponent = rng.integers(-(2**23), 2**23, (9, stride // 4)), rng.integers(-30, 30, (9, stride // 4))
        stored = ((exponent << 24) | (mantissa & 0xFFFFFF)).astype(np.int64).astype(np.uint32).view(np.int32)
        expected, tolerance = mantissa * 2.0**exponent, 0.0  # 24 bits fit a float
    elif kind == "OCTAHEDRAL":
        most = 127 if stride == 4 else 32767
        flat = rng.integers(-most, most + 1, (9, 2))
        stored = np.concatenate([flat, np.tile([most, 7], (9, 1))], axis=1).astype(dtype)
        expected = []
        for x, y in (flat / most).tolist():
            z = 1 - abs(x) - abs(y)
            if z < 0:
                x, y = (1 - abs(y)) * np.copysign(1, x), (1 - abs(x)) * np.copysign(1, y)
            expected.append([*(np.array([x, y, z]) / np.linalg.norm([x, y, z]) * most), 7])
        tolerance = 0.6  # rounded to whole numbers, in float32
    else:
        scale, largest = 1023, rng.integers(0, 4, 9)
        parts = rng.integers(-scale, scale + 1, (9, 3)) // 2
        stored = np.concatenate([parts, (scale & ~3 | largest)[:, None]], axis=1).astype(np.int16)
        expected = []
        for row, k in zip(parts / (scale | 3) * np.sqrt(0.5), largest, strict=True):
            turn = [0.0] * 4
            turn[k] = np.sqrt(max(0.0, 1 - (row**2).sum()))
            for step in range(3):
                turn[(k + 1 + step) % 4] = row[step]
            expected.append(np.array(turn) * 32767)
        tolerance = 0.6
    data = encoder.encode_vertex_buffer(stored.view(np.float32).reshape(9, -1), 9, stride)
    says = {"count": 9, "byteStride": stride, "mode": "ATTRIBUTES", "filter": kind}
    found = np.frombuffer(meshopt_bytes("a", says, data, 1e9), dtype=np.float32 if kind == "EXPONENTIAL" else dtype)
    np.testing.assert_allclose(found.reshape(9, -1), expected, rtol=0, atol=tolerance)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ({"count": 0}, "count: got 0"),
        ({"byteStride": 300}, "byteStride: got 300"),
        ({"mode": "MAGIC"}, "mode: got 'MAGIC'"),
        ({"filter": "MAGIC"}, "filter: got 'MAGIC'"),
        ({"count": 10**9}, "unpacks to 12000000000 bytes; allowed are at most 1073741824, the limit bytes"),
        ({"filter": "QUATERNION"}, "byteStride is 12 for QUATERNION; allowed are 8"),
        ({"byteStride": 10}, "meshopt cannot unpack it"),
        ({"count": 4000}, "meshopt cannot unpack it"),
    ],
)
def test_broken_meshopt_is_refused(words, message):
    encoder = pytest.importorskip("meshoptimizer.encoder")
    data = encoder.encode_vertex_buffer(PLACES, 4, 12)
    says = {"count": 4, "byteStride": 12, "mode": "ATTRIBUTES", **words}
    with pytest.raises(InputError, match=message):
        meshopt_bytes("a", says, data, Limits().bytes)

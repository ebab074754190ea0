"""Pictures of textures: depths, channels and interlacing, against values known by hand and a PNG writer by hand."""

import io
import struct
import zlib

import numpy as np
import pytest
from PIL import Image

from refdof import InputError
from refdof.scene.formats.pictures import Pictures
from refdof.scene.formats.png16 import read_png16
from refdof.scene.limits import Limits, Meter
from refdof.scene.mesh_file import load_mesh
from tests.mesh_fixtures import gltf, uri, write

pytestmark = pytest.mark.fast
PASSES = ((0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2))
KINDS = {1: 0, 2: 4, 3: 2, 4: 6}  # colour type by channels


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def filtered(rows, step):
    """Bytes of rows (h, n) uint8 with filter k % 5 on row k, byte by byte as the specification has it."""
    out = bytearray()
    above = [0] * rows.shape[1]
    for k, row in enumerate(rows.tolist()):
        kind = k % 5
        out.append(kind)
        for x, value in enumerate(row):
            a = row[x - step] if x >= step else 0
            b, c = above[x], above[x - step] if x >= step else 0
            p = a + b - c
            paeth = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
            out.append((value - (0, a, b, (a + b) // 2, paeth)[kind]) % 256)
        above = row
    return bytes(out)


def png16(pixels, interlaced=False, extra=b"", lie=(0, 0)):
    height, width, channels = pixels.shape
    step = 2 * channels
    data = b""
    for x, y, dx, dy in PASSES if interlaced else ((0, 0, 1, 1),):
        part = pixels[y::dy, x::dx]
        if part.size:
            rows = np.frombuffer(part.astype(">u2").tobytes(), dtype=np.uint8).reshape(len(part), -1)
            data += filtered(rows, step)
    head = struct.pack(">IIBBBBB", width + lie[0], height + lie[1], 16, KINDS[channels], 0, 0, int(interlaced))
    body = chunk(b"IHDR", head) + extra + chunk(b"IDAT", zlib.compress(data)) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + body


def pictures(**limits):
    return Pictures(Meter(Limits(**limits)))


@pytest.mark.parametrize("channels", [1, 2, 3, 4])
@pytest.mark.parametrize("interlaced", [False, True])
@pytest.mark.parametrize("size", [(1, 1), (7, 3), (9, 13)])
def test_png_files_of_16_bits_keep_them(channels, interlaced, size):
    pixels = np.random.default_rng(3).integers(0, 65536, (*size, channels), dtype=np.uint16)
    found = read_png16(png16(pixels, interlaced))
    colors = pixels[:, :, :1].repeat(3, axis=2) if channels < 3 else pixels[:, :, :3]
    np.testing.assert_array_equal(found[:, :, :3], colors)
    assert found.shape[2] == 3 + (channels % 2 == 0)
    if channels % 2 == 0:
        np.testing.assert_array_equal(found[:, :, 3], pixels[:, :, -1])


@pytest.mark.parametrize("channels", [1, 3])
def test_the_writer_above_agrees_with_pillow(channels):
    """In the upper 8 bits: Pillow keeps no more of three channels."""
    pixels = np.random.default_rng(4).integers(0, 65536, (6, 11, channels), dtype=np.uint16)
    with Image.open(io.BytesIO(png16(pixels))) as image:
        stored = np.asarray(image)
    np.testing.assert_array_equal(stored.reshape(pixels.shape), pixels if channels == 1 else pixels >> 8)


def test_linear_values_of_16_bits():
    pixels = np.array([[[0, 32768, 65535], [1, 2, 2650]]], dtype=np.uint16)
    picture = pictures().get("a", "a", png16(pixels))
    # IEC 61966-2-1: 0.500008 -> 0.2140482; below 0.04045 (2651 / 65535) values / 12.92.
    expected = [[[0, 0.2140482, 1], [1 / 65535 / 12.92, 2 / 65535 / 12.92, 2650 / 65535 / 12.92]]]
    np.testing.assert_allclose(picture.color, expected, rtol=1e-6)  # float32
    assert picture.opacity is None


def test_a_colour_that_stands_for_nothing():
    pixels = np.array([[[1, 2, 3], [1, 2, 4]]], dtype=np.uint16)
    clear = chunk(b"tRNS", struct.pack(">HHH", 1, 2, 3))
    np.testing.assert_array_equal(pictures().get("a", "a", png16(pixels, extra=clear)).opacity, [[0, 1]])


def test_a_texture_of_16_bits_in_a_file(tmp_path):
    pixels = np.full((2, 2, 3), 257, dtype=np.uint16)  # 1 of 255: 8 bits would do, but
    pixels[0, 0] = 300  # not for this
    base = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}
    scene = load_mesh(write(tmp_path, "a.gltf", gltf([{"mesh": 0}], [base], uri("image/png", png16(pixels)))))
    np.testing.assert_allclose(scene.materials[0].texture[0, :, 0], np.array([300, 257]) / 65535 / 12.92, rtol=1e-6)


@pytest.mark.parametrize("mode", ["RGB", "RGBA", "L", "LA", "P", "PA", "1", "I;16", "CMYK"])
@pytest.mark.parametrize("kind", ["png", "tiff", "webp", "bmp", "tga"])
def test_modes_of_pillow(mode, kind):
    out = io.BytesIO()
    try:
        Image.new("RGBA", (3, 2), (255, 255, 255, 102)).convert(mode).save(out, kind, lossless=True)
    except (OSError, ValueError, KeyError):
        pytest.skip(f"Pillow writes no {kind} of {mode}")
    picture = pictures().get("a", "a", out.getvalue())
    assert picture.color.shape == (2, 3, 3)
    if mode in ("RGBA", "LA") and picture.opacity is not None:
        np.testing.assert_allclose(picture.opacity, 0.4, rtol=1e-6)  # 102 of 255, float32


def test_one_key_is_read_once_and_broken_ones_are_told():
    found = pictures()
    data = png16(np.zeros((1, 1, 3), dtype=np.uint16))
    assert found.get("a", "a", data) is found.get("a", "b", b"")
    assert found.get("c", "c.png", b"nothing") is None
    assert found.broken == {"c.png": "it is no picture"}


@pytest.mark.parametrize("lie", [(1, 0), (0, 1), (4000, 4000)])
def test_png_files_that_lie_about_their_size_are_left_out(lie):
    found = pictures()
    assert found.get("a", "a.png", png16(np.zeros((4, 4, 3), dtype=np.uint16), lie=lie)) is None
    assert "its header says" in found.broken["a.png"]


def test_pictures_count_together():
    found = pictures(pixels=16, total_pixels=20)
    small = png16(np.zeros((4, 4, 3), dtype=np.uint16))
    assert found.get("a", "a.png", small) is not None
    assert found.get("b", "b.png", small) is None
    assert found.get("c", "c.png", png16(np.zeros((5, 4, 3), dtype=np.uint16))) is None
    assert "5 x 4" not in found.broken["b.png"]
    assert "4 x 4 pixels after 16 of others; allowed are at most 20, the limit total_pixels" in found.broken["b.png"]
    assert found.broken["c.png"] == "4 x 5 pixels; allowed are at most 16, the limit pixels"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["pixels"], "limit: got 'pixels'; allowed is a name"),
        (["pixels=many"], "limit: got 'pixels=many'"),
        (["teapots=3"], "limit: got 'teapots'; allowed are pixels, total_pixels, instances"),
        (["bytes=0"], "bytes: got 0"),
        (["seconds=nan"], "seconds: "),
    ],
)
def test_words_that_are_no_limits(words, message):
    with pytest.raises(InputError, match=message):
        Limits().with_words(words)


def test_words_of_limits():
    assert Limits().with_words(["pixels=1e9", " seconds = 5"]) == Limits(pixels=1e9, seconds=5.0)

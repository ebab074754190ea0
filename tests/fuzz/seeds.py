"""Seeds: small right files of each kind, from the repository or as its tests write them."""

import shutil
import tempfile
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from refdof.image.file import save_image
from tests.mesh_fixtures import gltf
from tests.optics.systems.test_prescription import PBRT, ZEMAX

ROOT = Path(__file__).parents[2]
_CUBE = (
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nusemtl a\nf 1/1/1 2/2/1 3/3/1\nf -1 1 2 3\n"
)
_HEADS = ("property float x\nproperty float y\nproperty float z\n", "property list uchar int vertex_indices\n")
_OFF = b"COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 0 255 0 255\n0 1 0 0 0 255 255\n3 0 1 2 1 0 0\n"

_WAIVER = b"""[[waiver]]
case = "a_*"
reason = "a driver"
url = "https://example.org/1"
expires = 2027-01-31
"""
_SCENE = (ROOT / "data" / "scenes" / "fence.toml").read_bytes()
NUMBERS = tuple(tomllib.loads(_SCENE.decode())["numbers"])  # that a scene's generator needs
_FOCUS = b"[[point]]\ntriangle = 3\nbarycentrics = [0.2, 0.3, 0.5]\n"


def files(*patterns: str) -> Callable[[], list[bytes]]:
    return lambda: [path.read_bytes() for pattern in patterns for path in sorted(ROOT.glob(pattern))]


@contextmanager
def _scratch() -> Iterator[Path]:
    folder = Path(tempfile.mkdtemp())
    try:
        yield folder
    finally:
        shutil.rmtree(folder)


def pictures(suffix: str) -> Callable[[], list[bytes]]:
    def seeds() -> list[bytes]:
        image = np.random.default_rng(5).random((3, 4, 3)).astype(np.float32)
        with _scratch() as folder:
            save_image(folder / f"a.{suffix}", image)
            return [(folder / f"a.{suffix}").read_bytes()]

    return seeds


def radiance() -> list[bytes]:
    head = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n-Y 2 +X 8\n"
    row = b"\2\2\0\x08" + b"\x88\x40" * 3 + b"\x08" + b"\x80\x81" * 4
    return [head + row * 2, head + bytes(range(64)) * 1]


def gltf_texts() -> list[bytes]:
    plain = gltf([{"mesh": 0, "translation": [0, 0, 1]}], [{"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}}])
    return [plain.encode(), gltf([{"children": [1]}, {"mesh": 0}], roots=[0]).encode()]


def glb_files() -> list[bytes]:
    found = []
    for text in gltf_texts():
        text += b" " * (-len(text) % 4)
        head = b"glTF" + (2).to_bytes(4, "little") + (20 + len(text)).to_bytes(4, "little")
        found.append(head + len(text).to_bytes(4, "little") + b"JSON" + text)
    return found


def ply_files() -> list[bytes]:
    head = f"element vertex 3\n{_HEADS[0]}element face 1\n{_HEADS[1]}end_header\n"
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype="<f4").tobytes()
    order = b"\3" + np.arange(3, dtype="<i4").tobytes()
    return [
        f"ply\nformat ascii 1.0\n{head}0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n".encode(),
        f"ply\nformat binary_little_endian 1.0\n{head}".encode() + points + order,
    ]


def stl_files() -> list[bytes]:
    facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
    rows = np.zeros(12, dtype="<f4")
    rows[[6, 10]] = 1.0
    return [f"solid a\n{facet}endsolid a\n".encode(), bytes(80) + b"\1\0\0\0" + rows.tobytes() + b"\0\0"]


def settings() -> list[bytes]:
    return [
        b"singlepass.max_blur_size=20\nsinglepass.rad_scale=0.5\nlensblur.layers=4",
        b"poisson.taps=8\nlimit pixels=1e9\nunits mm\npixel 3,4",
        b"multiview.samples=inf\nscatter.background=true\nmipmap.filter=None",
    ]


def obj_files() -> list[bytes]:
    return [_CUBE.encode()]


def off_files() -> list[bytes]:
    return [_OFF]


def scenes() -> list[bytes]:
    return [_SCENE]


def waivers() -> list[bytes]:
    return [_WAIVER]


def pbrt_files() -> list[bytes]:
    return [PBRT.encode()]


def zemax_files() -> list[bytes]:
    return [ZEMAX.encode()]


def focus_files() -> list[bytes]:
    return [_FOCUS]

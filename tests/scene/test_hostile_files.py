"""Hostile files: each is refused, or its part left out, within 5 s and 2 GiB, in a process that may take no more."""

import base64
import json
import os
import re
import struct
import subprocess
import sys
import zlib

import numpy as np
import pytest
from typer.testing import CliRunner

from refdof import InputError
from refdof.cli import app
from refdof.scene.limits import Limits
from refdof.scene.mesh_file import load_mesh
from tests.mesh_fixtures import gltf, uri, write

ORTHOGRAPHIC = {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0.1, "zfar": 10}}
SECONDS = 5.0
BYTES = 2 << 30
# Embree and OpenBLAS reserve address space for threads, which is not memory: what is counted is what is held at most.
RUN = """
import re, sys, time, warnings
import refdof.scene.mesh_file as files
from refdof import InputError
start = time.process_time()  # a busy machine is no fault of a file
try:
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        files.load_mesh(sys.argv[1])
    print("read:", " ".join(str(one.message) for one in told))
except InputError as error:
    print("refused:", error)
# What getrusage tells begins with what the process held that started this one.
with open("/proc/self/status") as status:
    held = int(re.search(r"VmHWM:\\s*(\\d+) kB", status.read())[1]) * 1024
print(time.process_time() - start, held)
"""
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
PAINTED = f"mtllib a.mtl\n{TRIANGLE}usemtl a\nf 1/1 2/2 3/3\n"
BASE = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}


def in_its_own_process(path):
    """What a process says of a file, after checks of time and memory."""
    if not os.path.exists("/proc/self/status"):
        pytest.skip("the memory a process has held is told by Linux only")
    done = subprocess.run(
        [sys.executable, "-c", RUN, str(path)], capture_output=True, text=True, timeout=60, check=True
    )
    *said, figures = done.stdout.splitlines()
    seconds, held = map(float, figures.split())
    assert seconds < SECONDS, said
    assert held < BYTES, said
    assert not done.stderr
    return said[0]


def png(width, height, rows=None, depth=8, kind=0):
    """A picture of zeros; `rows` of them are really there."""

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    channels = {0: 1, 2: 3, 6: 4}[kind]
    row = bytes(1 + width * channels * depth // 8)
    packer, data = zlib.compressobj(9), b""
    for _ in range(height if rows is None else rows):
        data += packer.compress(row)
    head = struct.pack(">IIBBBBB", width, height, depth, kind, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", data + packer.flush()) + chunk(b"IEND", b"")


def nodes_of(count):
    return gltf([{"mesh": 0} for _ in range(count)])


def chained(count):
    """Nodes one below the other."""
    nodes = [{"children": [k + 1]} for k in range(count)] + [{"mesh": 0}]
    return gltf(nodes, roots=[0])


def widening(depth):
    """Each node twice below the one before: 2^depth meshes."""
    nodes = [{"children": [k + 1, k + 1]} for k in range(depth)] + [{"mesh": 0}]
    return gltf(nodes, roots=[0])


def copies_of_large_meshes():
    """A mesh of 30 000 triangles, placed 10 000 times."""
    whole = json.loads(gltf([{"mesh": 0} for _ in range(10_000)]))
    order = np.tile(np.array([0, 1, 2], dtype=np.uint16), 30_000)
    whole["buffers"].append({"byteLength": order.nbytes, "uri": uri("application/octet-stream", order.tobytes())})
    whole["bufferViews"].append({"buffer": 1, "byteLength": order.nbytes})
    whole["accessors"].append({"bufferView": 3, "componentType": 5123, "count": len(order), "type": "SCALAR"})
    whole["meshes"][0]["primitives"][0]["indices"] = 3
    return json.dumps(whole)


def instances(count):
    """One node that asks for so many copies, whose numbers take no room: a sparse accessor of zeros."""
    whole = json.loads(gltf([{"mesh": 0}]))
    zero = {"bufferView": 2, "componentType": 5123}
    sparse = {"count": 1, "indices": zero, "values": {"bufferView": 0}}
    whole["accessors"].append({"componentType": 5126, "count": count, "type": "VEC3", "sparse": sparse})
    extension = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": len(whole["accessors"]) - 1}}}
    return json.dumps({**whole, "nodes": [{"mesh": 0, "extensions": extension}]})


def edited(**lists):
    return json.dumps(json.loads(gltf([{"mesh": 0}])) | lists)


def buffer_of(address):
    return edited(buffers=[{"byteLength": 92, "uri": address}])


def channels():
    """100 000 channels of an animation that all move the same."""
    channel = {"sampler": 0, "target": {"node": 0, "path": "pointer"}}
    return edited(animations=[{"channels": [channel] * 100_000, "samplers": [{}]}])


def texture_numbers():
    """Each face asks for another picture."""
    head = "ply\nformat ascii 1.0\ncomment TextureFile a.png\ncomment TextureFile b.png\nelement vertex 3\n"
    head += "property float x\nproperty float y\nproperty float z\nelement face 100000\n"
    head += "property list uchar int vertex_indices\nproperty int texnumber\nend_header\n0 0 0\n1 0 0\n0 1 0\n"
    return head + "".join(f"3 0 1 2 {k + 2}\n" for k in range(100_000))


def nested(depth):
    return '{"asset": ' + "[" * depth + "]" * depth + "}"


TEXTS = {
    "nodes.gltf": (lambda: nodes_of(100_000), "refused: .*100000 instances; at most 20000, the limit 'instances'"),
    "chain.gltf": (lambda: chained(19_000), "read:"),
    "tree.gltf": (lambda: widening(60), "refused: .*allowed is one parent"),
    "circle.gltf": (lambda: gltf([{"children": [1]}, {"children": [0]}], roots=[0]), "refused: .*its own ancestor"),
    "itself.gltf": (lambda: gltf([{"children": [0], "mesh": 0}], roots=[0]), "refused: .*its own ancestor"),
    "large.gltf": (copies_of_large_meshes, "refused: .*triangles; at most 20000000, the limit 'triangles'"),
    "copies.gltf": (lambda: instances(9_000_000), "refused: .*instances; at most 20000"),
    "zeros.gltf": (lambda: instances(10**12), "refused: .*1000000000001 instances"),
    "nested.gltf": (lambda: nested(100_000), "refused: .*cannot be read"),
    "http.gltf": (
        lambda: edited(buffers=[{"byteLength": 92, "uri": "http://127.0.0.1:9/a.bin"}]),
        "refused: .*it is on another machine",
    ),
    "file.gltf": (lambda: buffer_of("file:///etc/passwd"), "refused: .*another machine"),
    "path.gltf": (lambda: buffer_of("../../../etc/passwd"), "refused: .*outside"),
    "percent.gltf": (lambda: buffer_of("%2e%2e/%2e%2e/etc/passwd"), "refused: .*no such file"),
    "view.gltf": (
        lambda: edited(bufferViews=[{"buffer": 0, "byteLength": 10**11}] * 3),
        "refused: .*|read:",
    ),
    "count.gltf": (
        lambda: edited(accessors=[{"bufferView": 0, "componentType": 5126, "count": 10**11, "type": "VEC3"}] * 3),
        "refused: .*needs",
    ),
    "count.ply": (
        lambda: "ply\nformat binary_little_endian 1.0\nelement vertex 2000000000\nproperty float x\nproperty float y\n"
        "property float z\nelement face 2000000000\nproperty list uchar int vertex_indices\nend_header\n",
        "refused: .*vertex: the file ends",
    ),
    "count.off": (lambda: "OFF\n2000000000 2000000000 0\n0 0 0\n", "refused: .*vertices and"),
    "list.ply": (
        lambda: "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uint int vertex_indices\nend_header\n0 0 0\n4000000000 0\n",
        "refused: .*a list has the length 4e",
    ),
    "materials.obj": (
        lambda: TRIANGLE + "".join(f"usemtl m{k}\nf 1 2 3\n" for k in range(100_000)),
        "refused: .*100000 instances; at most 20000",
    ),
    "channels.gltf": (channels, "read: .*moves 'pointer'"),
    "numbers.ply": (texture_numbers, "read:"),
    "index.obj": (lambda: f"{TRIANGLE}f 1 2 99999999999999999999\n", "refused: "),
}  # fmt: skip


@pytest.mark.parametrize("name", TEXTS)
def test_files_that_ask_for_too_much(tmp_path, name):
    make, expected = TEXTS[name]
    said = in_its_own_process(write(tmp_path, name, make()))
    assert re.match(expected, said), said


PICTURES = {
    "zeros": (lambda: png(13_000, 13_000), r"13000 x 13000 pixels; allowed are at most 67108864, the limit pixels"),
    "zeros of 16 bits": (lambda: png(13_000, 13_000, 200, 16, 2), "13000 x 13000 pixels"),
    "a lie": (lambda: png(13_000, 13_000, 2), "13000 x 13000 pixels"),
    "a lie within the limit": (lambda: png(8_000, 8_000, 2), "its header says"),
    "a lie of 16 bits": (lambda: png(8_000, 8_000, 2, 16, 6), "its header says"),
    "more than it says": (lambda: png(4, 4_000_000, 4), "truncated|header says"),
    "a size beyond all": (lambda: png(2**31 - 1, 2**31 - 1, 0), "pixels; allowed"),
}


@pytest.mark.parametrize("name", PICTURES)
@pytest.mark.parametrize("kind", ["obj", "gltf"])
def test_pictures_that_are_bombs(tmp_path, name, kind):
    make, expected = PICTURES[name]
    write(tmp_path, "bomb.png", make())
    if kind == "obj":
        write(tmp_path, "a.mtl", "newmtl a\nmap_Kd bomb.png\n")
        path = write(tmp_path, "a.obj", PAINTED)
    else:
        path = write(tmp_path, "a.gltf", gltf([{"mesh": 0}], [BASE], "bomb.png"))
    assert re.search(rf"^read: .*left out: bomb\.png \(.*({expected})", in_its_own_process(path))


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="has no pipes")
@pytest.mark.parametrize("text", ["mtllib a.mtl", "mtllib ./a.mtl b.mtl", "mtllib A.MTL"])
def test_a_pipe_in_place_of_a_library(tmp_path, text):
    os.mkfifo(tmp_path / "a.mtl")
    said = in_its_own_process(write(tmp_path, "a.obj", PAINTED.replace("mtllib a.mtl", text)))
    assert "it is no plain file" in said


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="has no pipes")
def test_a_pipe_in_place_of_a_scene(tmp_path):
    os.mkfifo(tmp_path / "a.obj")
    with pytest.raises(InputError, match="it is not a file"):
        load_mesh(tmp_path / "a.obj")


def test_limits_can_be_raised_and_lowered(tmp_path):
    path = write(tmp_path, "a.gltf", nodes_of(30))
    for limits in (Limits(instances=29), Limits(triangles=59), Limits(bytes=100), Limits(seconds=1)):
        if limits.seconds == 1:
            assert len(load_mesh(path, limits=limits).faces) == 60
            continue
        name = next(
            key for key in ("instances", "triangles", "bytes") if getattr(limits, key) != getattr(Limits(), key)
        )
        with pytest.raises(InputError, match=f"the limit '{name}', which can be raised"):
            load_mesh(path, limits=limits)
    assert len(load_mesh(path, limits=Limits(instances=60, triangles=60)).faces) == 60


def test_a_file_beside_counts_its_bytes(tmp_path):
    data = base64.b64decode(json.loads(gltf([{"mesh": 0}]))["buffers"][0]["uri"].partition(",")[2])
    write(tmp_path, "a.bin", data.ljust(5000, b"\0"))
    path = write(tmp_path, "a.gltf", edited(buffers=[{"byteLength": len(data), "uri": "a.bin"}]))
    load_mesh(path)
    with pytest.raises(InputError, match=r"a\.bin: it asks for 5000 bytes; at most 4000"):
        load_mesh(path, limits=Limits(bytes=4000))


def test_limits_and_cameras_on_the_command_line(tmp_path):
    def run(*words):
        path = write(tmp_path, "a.gltf", gltf([{"mesh": 0}, {"camera": 0}], cameras=[ORTHOGRAPHIC]))
        words = ["pick", str(path), "--pixel", "320,240", "--size", "640x480", *words]
        return CliRunner().invoke(app, words, standalone_mode=False).exception

    assert run("--no-file-camera", "--limit", "triangles=2", "--limit", "pixels=9") is None
    for words, said in (
        (("--limit", "triangles=2"), "its camera is orthographic"),
        (("--no-file-camera", "--limit", "triangles=1"), "2 triangles; at most 1, the limit 'triangles'"),
        (("--limit", "teapots=1"), "limit: got 'teapots'"),
    ):
        error = run(*words)
        assert isinstance(error, InputError)
        assert said in str(error)

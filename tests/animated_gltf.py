"""glTF files that move, built by hand: a header and bytes, and no mesh library."""

import base64
import json
import struct

import numpy as np

TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
CODES = {"int8": 5120, "uint8": 5121, "int16": 5122, "uint16": 5123, "uint32": 5125, "float32": 5126}


class Builder:
    """A glTF header that grows, with one buffer."""

    def __init__(self):
        self.header = {
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [],
            "accessors": [], "bufferViews": [],
        }  # fmt: skip
        self.data = b""

    def view(self, data):
        self.data += b"\0" * (-len(self.data) % 4)
        self.header["bufferViews"].append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data)})
        self.data += data
        return len(self.header["bufferViews"]) - 1

    def numbers(self, values, dtype=np.float32, **more):
        """An accessor of (N,) or (N, columns) numbers; matrices (N, 4, 4) are stored by columns."""
        values = np.asarray(values, dtype=dtype)
        if values.ndim == 3:
            values = values.transpose(0, 2, 1).reshape(len(values), 16)
        columns = values.shape[1] if values.ndim == 2 else 1
        self.header["accessors"].append(
            {
                "bufferView": self.view(values.tobytes()), "componentType": CODES[values.dtype.name],
                "count": len(values), "type": TYPES[columns], **more,
            }
        )  # fmt: skip
        return len(self.header["accessors"]) - 1

    def mesh(self, *primitives, **more):
        """A mesh of primitives (vertices, faces, {attribute: accessor or array}, {key: more})."""
        made = []
        for vertices, faces, attributes, words in primitives:
            named = {key: value if isinstance(value, int) else self.numbers(value) for key, value in attributes.items()}
            indices = self.numbers(np.ravel(faces), np.uint16)
            made.append({"attributes": {"POSITION": self.numbers(vertices), **named}, "indices": indices, **words})
        self.header["meshes"].append({"primitives": made, **more})
        return len(self.header["meshes"]) - 1

    def node(self, root=False, **words):
        self.header["nodes"].append(words)
        if root:
            self.header["scenes"][0]["nodes"].append(len(self.header["nodes"]) - 1)
        return len(self.header["nodes"]) - 1

    def move(self, node, path, times, values, kind=None):
        """One more channel of the animation."""
        animation = self.header.setdefault("animations", [{"channels": [], "samplers": []}])[0]
        sampler = {"input": self.numbers(times), "output": self.numbers(values)}
        animation["samplers"].append(sampler if kind is None else {**sampler, "interpolation": kind})
        target = {"node": node, "path": path}
        animation["channels"].append({"sampler": len(animation["samplers"]) - 1, "target": target})

    def text(self):
        """A .gltf file."""
        address = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        return json.dumps({**self.header, "buffers": [{"byteLength": len(self.data), "uri": address}]})

    def glb(self):
        data = self.data + b"\0" * (-len(self.data) % 4)
        text = json.dumps({**self.header, "buffers": [{"byteLength": len(self.data)}]}).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks

    def write(self, folder, name="moving.glb"):
        path = folder / name
        path.write_bytes(self.glb() if name.endswith(".glb") else self.text().encode())
        return path

"""Small mesh files, written without any mesh library."""

import base64
import io
import json

import numpy as np
from PIL import Image

# Upper row red, green; lower row blue, and the grey 188, whose sRGB decoding is 0.5029 (IEC 61966-2-1).
TEXELS = np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [188, 188, 188]]], dtype=np.uint8)
LINEAR = np.array([[[1, 0, 0], [0, 1, 0]], [[0, 0, 1], [0.5029, 0.5029, 0.5029]]])
QUAD = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]], dtype=np.float32)
UV_UP = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=np.float32)  # (0, 0) is the lower left corner


def png():
    out = io.BytesIO()
    Image.fromarray(TEXELS).save(out, "png")
    return out.getvalue()


def uri(kind, data):
    return f"data:{kind};base64,{base64.b64encode(data).decode()}"


def gltf(nodes, materials=({},), image=None, colors=None, **more):
    """A glTF file by hand: one quad, one mesh per material; glTF's v runs downwards."""
    uv = np.stack([UV_UP[:, 0], 1.0 - UV_UP[:, 1]], axis=1)
    blocks = [QUAD.tobytes(), uv.tobytes(), np.array([0, 1, 2, 0, 2, 3], dtype=np.uint16).tobytes()]
    types = [(5126, 4, "VEC3"), (5126, 4, "VEC2"), (5123, 6, "SCALAR")]
    attributes = {"POSITION": 0, "TEXCOORD_0": 1}
    if colors is not None:
        blocks.append(np.asarray(colors, dtype=np.float32).tobytes())
        types.append((5126, 4, "VEC3"))
        attributes["COLOR_0"] = 3
    starts = np.cumsum([0, *(len(b) for b in blocks)]).tolist()
    header = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": more.pop("roots", list(range(len(nodes))))}],
        "nodes": nodes,
        "meshes": [
            {"primitives": [{"attributes": attributes, "indices": 2, "material": k}]} for k in range(len(materials))
        ],
        "materials": list(materials),
        "accessors": [
            {"bufferView": k, "componentType": c, "count": n, "type": t} for k, (c, n, t) in enumerate(types)
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": s, "byteLength": len(b)} for s, b in zip(starts, blocks, strict=False)
        ],
        "buffers": [{"byteLength": starts[-1], "uri": uri("application/octet-stream", b"".join(blocks))}],
        **more,
    }
    if image is not None:
        header |= {"images": [{"uri": image}], "textures": [{"source": 0}, {"source": 0}]}
    return json.dumps(header)


def write(folder, name, content):
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


PLY = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
property uchar red
property uchar green
property uchar blue
element face 1
property list uchar int vertex_indices
end_header
0 0 0 188 255 0
2 0 0 188 255 0
2 1 0 188 255 0
0 1 0 188 255 0
4 0 1 2 3
"""

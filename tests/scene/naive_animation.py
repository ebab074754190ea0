"""A twin of animated glTF files: plain Python, one vertex and one number at a time, straight from the parsed header.

It reads accessors with `struct`, turns vectors by quaternion products instead of matrices, and goes up from a node to
its root instead of down the tree.
"""

import math
import struct
from itertools import pairwise


def accessor(builder, index):
    """Rows of numbers."""
    found = builder.header["accessors"][index]
    view = builder.header["bufferViews"][found["bufferView"]]
    letter, divisor = {5121: ("B", 255), 5123: ("H", 65535), 5126: ("f", 1), 5125: ("I", 1)}[found["componentType"]]
    columns = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}[found["type"]]
    size = struct.calcsize("<" + letter) * columns
    rows = []
    for k in range(found["count"]):
        row = list(struct.unpack_from(f"<{columns}{letter}", builder.data, view["byteOffset"] + k * size))
        rows.append([x / divisor for x in row] if found.get("normalized") else row)
    return rows


def turn(q, v):
    """The vector part of q v q*, for a unit quaternion (x, y, z, w)."""
    x, y, z, w = q
    a, b, c = v
    tw, tx, ty, tz = -x * a - y * b - z * c, w * a + y * c - z * b, w * b + z * a - x * c, w * c + x * b - y * a
    return [
        -tw * x + tx * w - ty * z + tz * y,
        -tw * y + tx * z + ty * w - tz * x,
        -tw * z - tx * y + ty * x + tz * w,
    ]


def between(channel_kind, times, values, path, time):
    """The value of a channel at a time: a list of numbers."""
    cubic = channel_kind == "CUBICSPLINE"
    if time <= times[0]:
        return values[0][1] if cubic else values[0]
    if time >= times[-1]:
        return values[-1][1] if cubic else values[-1]
    k = 0
    while times[k + 1] <= time:
        k += 1
    if channel_kind == "STEP":
        return values[k]
    span = times[k + 1] - times[k]
    t = (time - times[k]) / span
    if cubic:
        out = []
        for c in range(len(values[k][1])):
            p, m, q, n = values[k][1][c], span * values[k][2][c], values[k + 1][1][c], span * values[k + 1][0][c]
            # De Casteljau with the Bezier points of a Hermite cubic.
            points = [p, p + m / 3.0, q - n / 3.0, q]
            while len(points) > 1:
                points = [a + t * (b - a) for a, b in pairwise(points)]
            out.append(points[0])
        return out
    if path != "rotation":
        return [a + t * (b - a) for a, b in zip(values[k], values[k + 1], strict=True)]
    start, end = ([x / math.hypot(*q) for x in q] for q in (values[k], values[k + 1]))
    dot = sum(a * b for a, b in zip(start, end, strict=True))
    if dot < 0.0:
        end, dot = [-b for b in end], -dot
    angle = math.acos(min(dot, 1.0))
    if angle < 1e-6:
        return start
    first, last = math.sin((1.0 - t) * angle) / math.sin(angle), math.sin(t * angle) / math.sin(angle)
    return [first * a + last * b for a, b in zip(start, end, strict=True)]


def moved(builder, node, path, time):
    """A node's translation, rotation, scale or weights at a time; None if neither file nor animation state it."""
    for animation in builder.header.get("animations", [])[:1]:
        for channel in animation["channels"]:
            if channel["target"] == {"node": node, "path": path}:
                sampler = animation["samplers"][channel["sampler"]]
                kind = sampler.get("interpolation", "LINEAR")
                times = [row[0] for row in accessor(builder, sampler["input"])]
                flat = [x for row in accessor(builder, sampler["output"]) for x in row]
                each = len(flat) // len(times)
                values = [flat[each * k : each * (k + 1)] for k in range(len(times))]
                if kind == "CUBICSPLINE":
                    values = [[v[: each // 3], v[each // 3 : 2 * each // 3], v[2 * each // 3 :]] for v in values]
                return between(kind, times, values, path, time)
    return builder.header["nodes"][node].get(path)


def up(builder, node, point, time):
    """A node's point in the world."""
    while node is not None:
        words = builder.header["nodes"][node]
        if "matrix" in words:
            m = words["matrix"]
            point = [sum(m[4 * c + r] * point[c] for c in range(3)) + m[12 + r] for r in range(3)]
        else:
            scale = moved(builder, node, "scale", time) or [1, 1, 1]
            q = moved(builder, node, "rotation", time) or [0, 0, 0, 1]
            length = math.sqrt(sum(x * x for x in q))
            shift = moved(builder, node, "translation", time) or [0, 0, 0]
            point = turn([x / length for x in q], [s * x for s, x in zip(scale, point, strict=True)])
            point = [a + b for a, b in zip(point, shift, strict=True)]
        above = [k for k, other in enumerate(builder.header["nodes"]) if node in other.get("children", [])]
        node = above[0] if above else None
    return point


def corners(builder, node, time):
    """World places of all corners of a node's mesh, in the order of its indices: [[x, y, z], ...]."""
    words = builder.header["nodes"][node]
    mesh = builder.header["meshes"][words["mesh"]]
    found = []
    for primitive in mesh["primitives"]:
        places = accessor(builder, primitive["attributes"]["POSITION"])
        weights = moved(builder, node, "weights", time) or mesh.get("weights")
        for target, much in zip(primitive.get("targets", []), weights or [], strict=False):
            shift = accessor(builder, target["POSITION"])
            places = [[p + much * s for p, s in zip(a, b, strict=True)] for a, b in zip(places, shift, strict=True)]
        if "skin" in words:
            places = [_skinned(builder, words["skin"], primitive, k, p, time) for k, p in enumerate(places)]
        else:
            places = [up(builder, node, p, time) for p in places]
        found += [places[row[0]] for row in accessor(builder, primitive["indices"])]
    return found


def _skinned(builder, skin, primitive, vertex, place, time):
    skin = builder.header["skins"][skin]
    joints = accessor(builder, primitive["attributes"]["JOINTS_0"])[vertex]
    weights = accessor(builder, primitive["attributes"]["WEIGHTS_0"])[vertex]
    total = [0.0, 0.0, 0.0]
    for joint, weight in zip(joints, weights, strict=True):
        m = accessor(builder, skin["inverseBindMatrices"])[joint]
        bound = [sum(m[4 * c + r] * place[c] for c in range(3)) + m[12 + r] for r in range(3)]
        there = up(builder, skin["joints"][joint], bound, time)
        total = [a + weight * b / sum(weights) for a, b in zip(total, there, strict=True)]
    return total

"""Keyframes of a glTF file: what its first animation makes of nodes and of morph weights, at any time.

Steps, straight lines, arcs of quaternions along the shorter way, and cubic Hermite splines; before the first key and
after the last, their values hold.

References
----------
.. [1] Khronos Group (2021), glTF 2.0 Specification: 3.11 (animations), appendix C (interpolation).
"""

import warnings
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float, InputError, as_choice
from refdof.scene.gltf.file import Numbers, member
from refdof.scene.gltf.nodes import PATHS

__all__ = ["Channel", "channels_of", "value_at"]

_KINDS = ("STEP", "LINEAR", "CUBICSPLINE")


class Channel(NamedTuple):
    """What changes a `path` of a node: K keys of C numbers."""

    node: int
    path: str  # one of `PATHS`, or "weights"
    kind: str  # STEP, LINEAR or CUBICSPLINE
    times: Float  # (K,) float32, growing [s]
    values: Float  # (K, C); CUBICSPLINE: (K, 3, C), tangent in, value, tangent out


def channels_of(header: dict[str, Any], numbers: Numbers) -> tuple[Channel, ...]:
    """The channels of the file's first animation; what they do beyond the specification is left out with a warning.

    Raises
    ------
    InputError
        If a channel, its sampler or its node does not exist, or its numbers are not as [1] demands.
    """
    if not header.get("animations"):
        return ()
    animation = member(header, "animations", 0)
    found: list[Channel] = []
    moved: set[tuple[int, str]] = set()
    for index in range(len(animation.get("channels", []))):
        name = f"animation 0, channel {index}"
        channel = member(animation, "channels", index)
        path, node = channel["target"].get("path"), channel["target"].get("node")
        if path not in (*PATHS, "weights") or node is None:
            warnings.warn(f"{name}: moves {str(path)[:40]!r}, which is left out", stacklevel=2)
            continue
        if path in PATHS and "matrix" in member(header, "nodes", node):
            raise InputError(f"{name}: moves node {node}, which has a matrix; allowed are nodes without")
        if (node, path) in moved:
            raise InputError(f"{name}: moves the {path} of node {node} again; allowed is one channel for it")
        moved.add((node, path))
        sampler = member(animation, "samplers", channel.get("sampler"))
        found.append(_channel(name, node, path, sampler, numbers))
    return tuple(found)


def _channel(name: str, node: int, path: str, sampler: dict[str, Any], numbers: Numbers) -> Channel:
    kind = as_choice(f"{name}: interpolation", sampler.get("interpolation", "LINEAR"), _KINDS)
    times = numbers.floats(f"{name}: input", sampler.get("input"), "SCALAR").ravel().astype(np.float32)
    if not (np.diff(times) > 0).all() or not times[0] >= 0:
        raise InputError(f"{name}: input: times do not grow from 0 on; allowed are growing times >= 0")
    columns = {"translation": "VEC3", "rotation": "VEC4", "scale": "VEC3", "weights": "SCALAR"}[path]
    values = numbers.floats(f"{name}: output", sampler.get("output"), columns)
    width = len(PATHS[path]) if path in PATHS else values.size // (len(times) * (3 if kind == "CUBICSPLINE" else 1))
    if path == "rotation" and kind == "LINEAR" and not values.any(axis=1).all():
        raise InputError(f"{name}: output: a quaternion is 0; allowed are those of unit length")
    shape = (len(times), 3, width) if kind == "CUBICSPLINE" else (len(times), width)
    if not width or values.size != np.prod(shape):
        raise InputError(f"{name}: output: has {len(values)} items for {len(times)} keys; allowed is as many for each")
    return Channel(node, path, kind, times, values.reshape(shape))


def value_at(channel: Channel, time: float) -> Float:
    """(C,) at a time [s]."""
    times, values, cubic = channel.times, channel.values, channel.kind == "CUBICSPLINE"
    now = np.float32(time)  # as the file's own times are: a key on a frame is met there
    key = int(np.searchsorted(times, now, side="right")) - 1
    if key < 0 or key == len(times) - 1 or channel.kind == "STEP":
        held = values[max(key, 0)]
        return held[1] if cubic else held
    step = float(times[key + 1]) - float(times[key])
    t = (float(now) - float(times[key])) / step
    if channel.kind == "LINEAR":
        start, end = values[key], values[key + 1]
        return _slerp(start, end, t) if channel.path == "rotation" else (1.0 - t) * start + t * end
    (_, start, leaving), (arriving, end, _) = values[key], values[key + 1]
    return (
        (2 * t**3 - 3 * t**2 + 1) * start
        + step * (t**3 - 2 * t**2 + t) * leaving
        + (3 * t**2 - 2 * t**3) * end
        + step * (t**3 - t**2) * arriving
    )


def _slerp(start: Float, end: Float, t: float) -> Float:
    """From one quaternion to another along the shorter arc; files round their unit length to float32."""
    start, end = start / np.linalg.norm(start), end / np.linalg.norm(end)
    end = -end if start @ end < 0.0 else end
    angle = 2.0 * np.arctan2(np.linalg.norm(end - start), np.linalg.norm(end + start))
    if not angle > 1e-9:  # the arc is a line to a double's last digit
        return (1.0 - t) * start + t * end
    return (np.sin((1.0 - t) * angle) * start + np.sin(t * angle) * end) / np.sin(angle)

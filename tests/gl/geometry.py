"""Triangles on Mesa's rasteriser: which pixels of a small picture each of them covers.

Row 0 of an array is the row of gl_FragCoord.y = 0.5, the lowest row in memory.
"""

from collections.abc import Iterator

import moderngl
import numpy as np

__all__ = ["attributes", "coverage", "window_positions"]

_VERTEX = """
#version 330
in vec2 position;
void main()
{
    gl_Position = vec4(position, 0.0, 1.0);
}
"""

_FRAGMENT = """
#version 330
out float result;
void main()
{
    result = 1.0;
}
"""

_PLACED = """
#version 330
uniform vec2 scale;  // P over half the picture's size
uniform vec2 planes;  // near, far
in vec3 position;  // x right, y down, planar depth
in vec2 weight;
out vec2 barycentric;
void main()
{
    float z = planes.y / (planes.y - planes.x) * (position.z - planes.x);
    gl_Position = vec4(position.xy * scale, 2.0 * z - position.z, position.z);
    barycentric = weight;
}
"""

_RECORD = """
#version 330
in vec2 barycentric;
out vec4 result;
void main()
{
    result = vec4(barycentric, gl_FragCoord.z, 1.0);
}
"""


def window_positions(clip: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """Where OpenGL puts positions (..., 2) in [-1, 1]: (..., 2) [px], every step in float32. size: width, height."""
    half = np.asarray(size, dtype=np.float32) / np.float32(2)
    return np.asarray(clip, dtype=np.float32) * half + half


def coverage(context: moderngl.Context, clip: np.ndarray, size: tuple[int, int]) -> Iterator[np.ndarray]:
    """Draw triangles (T, 3, 2), in [-1, 1], one by one: for each (H, W) bool."""
    width, height = size
    program = context.program(vertex_shader=_VERTEX, fragment_shader=_FRAGMENT)
    corners = context.buffer(np.ascontiguousarray(clip, dtype="f4").tobytes())
    triangles = context.vertex_array(program, [(corners, "2f", "position")])
    target = context.framebuffer([context.texture((width, height), 1, dtype="f4")])
    target.use()
    for k in range(len(clip)):
        target.clear()
        triangles.render(moderngl.TRIANGLES, vertices=3, first=3 * k)
        yield np.frombuffer(target.read(components=1, dtype="f4"), dtype="f4").reshape(height, width) > 0


def attributes(
    context: moderngl.Context, vertices: np.ndarray, pixels_per_tangent: float, size: tuple[int, int], planes: tuple
) -> tuple[np.ndarray, np.ndarray]:
    """Draw triangles (T, 3, 3) (x right, y down, planar depth) into one depth buffer of 24 bits.

    Returns (H, W, 4) float32, the second and third corner's weights, gl_FragCoord.z and 1 where something is, and the
    depth buffer as a reader sees it (H, W) float32. planes: near, far.
    """
    width, height = size
    program = context.program(vertex_shader=_PLACED, fragment_shader=_RECORD)
    program["scale"] = (2.0 * pixels_per_tangent / width, 2.0 * pixels_per_tangent / height)
    program["planes"] = planes
    weight = np.tile(np.array([[0, 0], [1, 0], [0, 1]]), (len(vertices), 1, 1))
    corners = context.buffer(np.concatenate([vertices, weight], axis=-1).astype("f4").tobytes())
    triangles = context.vertex_array(program, [(corners, "3f 2f", "position", "weight")])
    depth = context.depth_texture((width, height))
    target = context.framebuffer([context.texture(size, 4, dtype="f4")], depth)
    target.use()
    target.clear(depth=1.0)
    context.enable(moderngl.DEPTH_TEST)
    triangles.render(moderngl.TRIANGLES)
    context.disable(moderngl.DEPTH_TEST)
    context.finish()
    picture = np.frombuffer(target.read(components=4, dtype="f4"), dtype="f4").reshape(height, width, 4)
    return picture.copy(), np.frombuffer(depth.read(alignment=4), dtype="f4").reshape(height, width).copy()

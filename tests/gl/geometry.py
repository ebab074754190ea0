"""Triangles on Mesa's rasteriser: which pixels of a small picture each of them covers.

Row 0 of an array is the row of gl_FragCoord.y = 0.5, the lowest row in memory.
"""

from collections.abc import Iterator

import moderngl
import numpy as np

__all__ = ["coverage", "window_positions"]

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

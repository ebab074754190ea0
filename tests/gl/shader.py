"""Fragment shaders on Mesa's software renderer: float textures in, float picture out, no window.

Row 0 of an array is the row of gl_FragCoord.y = 0.5 and of texture coordinate 0: y points down everywhere.
"""

import os
from dataclasses import dataclass
from functools import cache
from typing import Any

import moderngl
import numpy as np

__all__ = [
    "GLMissing",
    "Pass",
    "chain_of",
    "draw",
    "generated",
    "new_pass",
    "open_context",
    "read",
    "stored",
    "texture_of",
]

_MESA = {"EGL_PLATFORM": "surfaceless", "LIBGL_ALWAYS_SOFTWARE": "1", "GALLIUM_DRIVER": "llvmpipe"}

_FULL_SCREEN_TRIANGLE = """
#version 330
void main()
{
    vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    gl_Position = vec4(corner, 0.0, 1.0);
}
"""


class GLMissing(RuntimeError):
    """No context on Mesa's llvmpipe can be made here; the message says why."""


@dataclass(frozen=True, eq=False)
class Pass:
    """A compiled fragment shader and the picture that it draws into."""

    program: Any
    triangle: Any
    target: Any
    shape: tuple[int, int, int]


@cache
def open_context() -> moderngl.Context:
    """The one context of this process on llvmpipe, whatever graphics card is there: another would take its place.

    Raises
    ------
    GLMissing
        If there is no EGL, no context, or another renderer answers.
    """
    os.environ.update(_MESA)
    backend: Any = "egl"  # moderngl's own types want a dictionary here
    try:
        context = moderngl.create_context(standalone=True, backend=backend, require=330)
    except Exception as error:  # each layer below has its own kind
        raise GLMissing(f"no OpenGL context (needs Mesa's EGL and DRI drivers): {error}") from None
    if "llvmpipe" not in context.info["GL_RENDERER"]:
        raise GLMissing(f"the renderer is {context.info['GL_RENDERER']!r}; wanted is llvmpipe")
    return context


def texture_of(context: moderngl.Context, image: np.ndarray, *, linear: bool) -> Any:
    """A float32 texture of an image (H, W) or (H, W, C), clamped to the edge, without mipmaps."""
    image = np.ascontiguousarray(np.atleast_3d(image), dtype="f4")
    height, width, components = image.shape
    texture = context.texture((width, height), components, image.tobytes(), alignment=4, dtype="f4")
    texture.repeat_x = texture.repeat_y = False
    chosen = moderngl.LINEAR if linear else moderngl.NEAREST
    texture.filter = (chosen, chosen)
    return texture


def new_pass(context: moderngl.Context, fragment: str, shape: tuple[int, int], components: int = 4) -> Pass:
    """Compile a fragment shader that draws (H, W) pixels of one, two or four floats."""
    program = context.program(vertex_shader=_FULL_SCREEN_TRIANGLE, fragment_shader=fragment)
    height, width = shape
    target = context.framebuffer([context.texture((width, height), components, dtype="f4")])
    return Pass(program, context.vertex_array(program, []), target, (height, width, components))


def draw(work: Pass, textures: dict[str, Any], **uniforms: Any) -> None:
    """Run the shader over the picture and wait until it is done."""
    for unit, (name, texture) in enumerate(textures.items()):
        texture.use(unit)
        work.program[name] = unit
    for name, value in uniforms.items():
        work.program[name] = value
    work.target.use()
    work.triangle.render(moderngl.TRIANGLES, vertices=3)
    work.target.ctx.finish()


def read(work: Pass) -> np.ndarray:
    """The picture: (H, W, C) float32."""
    components = work.shape[2]
    data = work.target.read(components=components, dtype="f4", alignment=4)
    return np.frombuffer(data, dtype="f4").reshape(work.shape).copy()


def stored(context: moderngl.Context, copy: str, image: np.ndarray, internal_format: int) -> np.ndarray:
    """Draw `copy` of an image (H, W, 4) into a target of OpenGL's `internal_format` and read its texels: float32."""
    height, width = image.shape[:2]
    target = context.texture((width, height), 4, internal_format=internal_format)
    target.filter = (moderngl.NEAREST, moderngl.NEAREST)
    first, second = new_pass(context, copy, (height, width)), new_pass(context, copy, (height, width))
    short = Pass(first.program, first.triangle, context.framebuffer([target]), first.shape)
    draw(short, {"a": texture_of(context, image, linear=False)})
    draw(second, {"a": target})
    return read(second)


def chain_of(context: moderngl.Context, levels: list[np.ndarray]) -> Any:
    """A texture of all levels (h, w, 4), float32 or uint8, clamped to the edge, with trilinear filtering."""
    kind = {"f": "f4", "u": "f1"}[levels[0].dtype.kind]
    height, width = levels[0].shape[:2]
    texture = context.texture((width, height), 4, dtype=kind)
    texture.build_mipmaps(0, len(levels) - 1)
    for level, image in enumerate(levels):
        texture.write(np.ascontiguousarray(image).tobytes(), level=level, alignment=4)
    texture.repeat_x = texture.repeat_y = False
    texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
    return texture


def generated(context: moderngl.Context, image: np.ndarray) -> list[np.ndarray]:
    """The driver's own chain of an image (H, W, 4), float32 or uint8."""
    height, width = image.shape[:2]
    texture = context.texture((width, height), 4, image.tobytes(), dtype={"f": "f4", "u": "f1"}[image.dtype.kind])
    count = max(height, width).bit_length()
    texture.build_mipmaps(0, count - 1)
    levels = []
    for level in range(count):
        shape = (max(1, height >> level), max(1, width >> level), 4)
        data = texture.read(level=level, alignment=4)
        levels.append(np.frombuffer(data, dtype=image.dtype).reshape(shape).copy())
    return levels

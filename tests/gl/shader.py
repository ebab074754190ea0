"""Fragment shaders on Mesa's software renderer: float textures in, float picture out, no window.

Row 0 of an array is the row of gl_FragCoord.y = 0.5 and of texture coordinate 0: y points down everywhere.
"""

import os
from dataclasses import dataclass
from typing import Any

import moderngl
import numpy as np

__all__ = ["GLMissing", "Pass", "draw", "new_pass", "open_context", "read", "texture_of"]

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


def open_context() -> moderngl.Context:
    """A context on llvmpipe, whatever graphics card is there.

    Raises
    ------
    GLMissing
        If there is no EGL, no context, or another renderer answers.
    """
    os.environ.update(_MESA)
    try:
        context = moderngl.create_context(standalone=True, backend="egl", require=330)
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

"""GLSL fragment shaders through moderngl, on Mesa's llvmpipe: float32 textures in, a float32 picture out.

The only file that imports moderngl. Always the software renderer, whatever card is there: its filters blend in float32
where cards have 8 bits, it is the same on all machines, and a shader that never ends does not stop a display.
"""

from typing import Any

import moderngl
import numpy as np

from .gl_types import type_name
from .glsl_text import compiler_message, has_initial_value, vertex_shader, whole_fragment
from .slots import COUNTS, Given, ShaderFault, Slot

__all__ = ["GLSL"]

_ALLOWED = "sampler2D, float, int, uint, bool and vectors of these"


class GLSL:
    """A context and, after `compile`, a shader."""

    def __init__(self) -> None:
        backend: Any = "egl"  # moderngl's own types want a dictionary here
        try:
            self._context = moderngl.create_context(standalone=True, backend=backend, require=330)
        except Exception as error:  # each layer below has its own kind
            raise ShaderFault(f"there is no OpenGL (needs Mesa's EGL and its llvmpipe): {error}") from None
        renderer = self._context.info["GL_RENDERER"]
        if "llvmpipe" not in renderer:
            raise ShaderFault(f"the renderer is {renderer}; needed is Mesa's llvmpipe")
        self._idle = self._context.simple_framebuffer((1, 1))

    def compile(self, text: str) -> list[Slot]:
        """Compile a fragment shader and say what it reads."""
        fragment = whole_fragment(text)
        try:
            self._program: Any = self._context.program(
                vertex_shader=vertex_shader(fragment.inputs), fragment_shader=fragment.text
            )
        except moderngl.Error as error:
            raise ShaderFault(compiler_message(str(error))) from None
        self._triangle = self._context.vertex_array(self._program, [])
        slots, self._initial = [], dict[str, Any]()
        for name in self._program:
            found = self._program[name]
            if isinstance(found, moderngl.UniformBlock):
                raise ShaderFault(f"{name}: is a uniform block; allowed are single uniforms")
            if not isinstance(found, moderngl.Uniform):
                continue
            member: Any = found  # moderngl's own types lack gl_type
            kind = type_name(member.gl_type, member.array_length)
            if kind == "sampler2D":
                slots.append(Slot(name, "texture", kind))
                continue
            has_default = has_initial_value(text, name)
            if kind not in COUNTS and not has_default:
                raise ShaderFault(f"{name}: is of type {kind}; allowed are {_ALLOWED}")
            slots.append(Slot(name, "uniform", kind, has_default))
            self._initial[name] = member.value
        return slots

    def draw(self, size: tuple[int, int], given: Given) -> np.ndarray:
        """Draw a picture (H, W, 3) of `size` (W, H). Uniforms without a number have their initial value."""
        held = []
        for name, value in self._initial.items():
            self._program[name].value = _as(value, given.uniforms[name]) if name in given.uniforms else value
        for unit, (name, image) in enumerate(given.textures.items()):
            texture = self._texture(image, linear=given.filters[name] == "linear")
            texture.use(unit)
            self._program[name].value = unit
            held.append(texture)
        target = self._context.texture(size, 4, dtype="f4")
        frame = self._context.framebuffer([target])
        frame.use()
        frame.clear(np.nan, np.nan, np.nan, np.nan)  # a pixel that is not written is no number
        self._triangle.render(moderngl.TRIANGLES, vertices=3)
        data = frame.read(components=4, dtype="f4", alignment=4)
        failed = self._context.error
        self._idle.use()  # moderngl comes back to the frame in use when it makes the next one
        for thing in (frame, target, *held):
            thing.release()
        if failed != "GL_NO_ERROR":
            raise ShaderFault(f"OpenGL says {failed}")
        return np.frombuffer(data, dtype="<f4").reshape(size[1], size[0], 4)[:, :, :3]

    def _texture(self, image: np.ndarray, *, linear: bool) -> Any:
        """A texture of an image (H, W, C), clamped to the edge, without mipmaps."""
        height, width, components = image.shape
        texture = self._context.texture((width, height), components, image.tobytes(), alignment=4, dtype="f4")
        texture.repeat_x = texture.repeat_y = False
        chosen = moderngl.LINEAR if linear else moderngl.NEAREST
        texture.filter = (chosen, chosen)
        return texture


def _as(initial: Any, numbers: list[float]) -> Any:
    """Numbers in the form and type of a uniform's initial value."""
    if isinstance(initial, tuple):
        return tuple(type(part)(number) for part, number in zip(initial, numbers, strict=True))
    return type(initial)(numbers[0])

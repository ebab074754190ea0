"""A host of the GLSL port, as a port's author writes one. Faults of hosts are changes of this text.

1. Read the case            parameters, colour and depth
2. Feed the textures        colour as it is, depth over the far plane's
3. Draw one triangle        over a target of four floats
4. Read back and write      OUT/image.f32
"""

from pathlib import Path
from typing import Any

import moderngl
import numpy as np

from tests.gl.shader import texture_of

_TRIANGLE = """
#version 330
out vec2 vTexCoord;
void main()
{
    vTexCoord = vec2(gl_VertexID == 1 ? 2.0 : 0.0, gl_VertexID == 2 ? 2.0 : 0.0);
    gl_Position = vec4(2.0 * vTexCoord - 1.0, 0.0, 1.0);
}
"""

_frames: dict[tuple[int, ...], list[np.ndarray]] = {}  # what was drawn so far, by shape


def run(context: Any, source: str, case: Path, out: Path) -> None:
    """Draw the shader `source` for a case folder, and write OUT/image.f32."""
    numbers = dict(line.split() for line in (case / "params.txt").read_text().splitlines())
    width, height = int(numbers["width"]), int(numbers["height"])
    far, focus = float(numbers["far"]), float(numbers["focus"])
    blur_size, scale = float(numbers["max_blur_size"]), float(numbers["coc_scale"])
    color = np.fromfile(case / "inputs" / "color.f32", dtype="<f4").reshape(height, width, 3)
    depth = np.fromfile(case / "inputs" / "depth.f32", dtype="<f4").reshape(height, width)
    uniforms = {
        "uPixelSize": (1.0 / width, 1.0 / height),
        "uFar": far,
        "focusPoint": focus,
        "focusScale": scale / blur_size,
        "uMaxBlurSize": blur_size,
        "uRadScale": float(numbers["rad_scale"]),
        "uBehindFactor": float(numbers["behind_factor"]),
    }
    stored = depth / far
    textures = {
        "uTexture": texture_of(context, color, linear=True),
        "uDepth": texture_of(context, stored, linear=False),
    }
    textures["uTexture"].repeat_x = False
    target = context.framebuffer([context.texture((width, height), 4, dtype="f4")])
    program = context.program(vertex_shader=_TRIANGLE, fragment_shader=source)
    for unit, name in enumerate(textures):
        textures[name].use(unit)
        uniforms[name] = unit
    for name in uniforms.keys() & set(program):  # a compiler drops what a shader does not use
        program[name] = uniforms[name]
    target.use()
    triangle = context.vertex_array(program, [])
    triangle.render(moderngl.TRIANGLES, vertices=3)
    texels = np.frombuffer(target.read(components=4, dtype="f4"), dtype="f4").reshape(height, width, 4)
    _frames.setdefault(texels.shape, []).append(texels)
    texels = _frames[texels.shape][-1]
    image = texels[..., :3]
    image.astype("<f4").tofile(out / "image.f32")
    for thing in (*textures.values(), *target.color_attachments, target, triangle, program):
        thing.release()

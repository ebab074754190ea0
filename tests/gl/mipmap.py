"""Mipmap interpolation as the port's fragment shaders: one for every coarser level, one for the picture.

Levels are drawn into textures of their own, and copied into one chain for the last shader.
"""

from dataclasses import dataclass
from typing import Any

import moderngl
import numpy as np

from tests.gl import shader
from tests.gl.port import source_of

__all__ = ["Work", "chains", "draw_levels", "draw_picture", "upload"]

COARSER, PICTURE = source_of("mipmap_level"), source_of("mipmap_picture")


@dataclass(eq=False)
class Work:
    """Textures and shaders for one picture."""

    context: Any
    color: np.ndarray
    circles: np.ndarray
    passes: list[Any]
    sizes: list[tuple[int, int]]
    targets: list[tuple[Any, Any]]
    picture: shader.Pass
    delta: float


def upload(context, color, coc, last, delta=0.5, short=False) -> Work:
    """Prepare everything for levels 1 .. `last`; `short`: circles in render targets of 16 bits."""
    height, width = coc.shape
    color = np.concatenate([color, np.ones_like(color[..., :1])], axis=-1)
    circles = np.stack([coc, np.abs(coc), 0 * coc, 0 * coc], axis=-1)
    if short:  # as a render target cuts them; an upload would round to nearest
        circles = (circles.view("u4") & np.uint32(0xFFFFE000)).view("f4")
    sources = (_texture(context, color, "f4"), _texture(context, circles, "f2" if short else "f4"))
    targets, passes, sizes = [sources], [], []
    program = context.program(vertex_shader=shader._FULL_SCREEN_TRIANGLE, fragment_shader=COARSER)
    triangle = context.vertex_array(program, [])
    for level in range(1, last + 1):
        size = max(1, width >> level), max(1, height >> level)
        pair = context.texture(size, 4, dtype="f4"), context.texture(size, 4, dtype="f2" if short else "f4")
        for texture in pair:
            texture.repeat_x = texture.repeat_y = False
            texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        targets.append(pair)
        passes.append((program, triangle, context.framebuffer(list(pair))))
        sizes.append(size)
    return Work(
        context, color, circles, passes, sizes, targets, shader.new_pass(context, PICTURE, (height, width)), delta
    )


def draw_levels(work: Work) -> None:
    """Draw every level from the one before, and wait until all are done."""
    for (program, triangle, target), size, source in zip(work.passes, work.sizes, work.targets, strict=False):
        source[0].use(0)
        source[1].use(1)
        program["uColor"], program["uCircle"], program["uCoarse"] = 0, 1, size
        program["uDelta"] = work.delta
        target.use()
        triangle.render(moderngl.TRIANGLES, vertices=3)
    work.context.finish()


def chains(work: Work) -> dict[str, Any]:
    """The levels as the chains that the last shader reads."""
    levels = list(zip(*[[_read(texture) for texture in pair] for pair in work.targets], strict=True))
    return {
        name: shader.chain_of(work.context, list(side))
        for name, side in zip(("uColors", "uCircles"), levels, strict=True)
    }


def draw_picture(work: Work, textures: dict[str, Any]) -> None:
    """Draw the picture, colour and smoothed degree of blur, and wait until it is done."""
    height, width = work.color.shape[:2]
    shader.draw(work.picture, textures, uSize=(width, height), uLast=float(len(work.sizes)))


def _texture(context, image, kind):
    height, width = image.shape[:2]
    texture = context.texture((width, height), 4, image.astype(kind).tobytes(), alignment=4, dtype=kind)
    texture.repeat_x = texture.repeat_y = False
    texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
    return texture


def _read(texture):
    width, height = texture.size
    kind = texture.dtype
    return np.frombuffer(texture.read(alignment=4), dtype=kind).reshape(height, width, 4).astype("f4")

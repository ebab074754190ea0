"""Mipmap interpolation (Lee, Kim, Choi 2009) as fragment shaders: one for every coarser level, one for the picture.

Levels are drawn into textures of their own, and copied into one chain for the last shader.
"""

from dataclasses import dataclass
from typing import Any

import moderngl
import numpy as np

from tests.gl import shader

__all__ = ["Work", "draw_levels", "draw_picture", "upload"]

# Steps 2 and 3 at once, as section 6 says: both targets from the same reads.
COARSER = """
#version 330
uniform sampler2D uColor;
uniform sampler2D uCircle;  // signed, degree of blur [px], nearer neighbours' blur
uniform vec2 uCoarse;  // size of the coarser level
uniform float uDelta;
layout(location = 0) out vec4 color;
layout(location = 1) out vec4 circle;

void main()
{
    vec2 place = gl_FragCoord.xy / uCoarse;
    vec2 step_ = 1.0 / vec2(textureSize(uColor, 0));
    vec4 p = textureLod(uCircle, place, 0.0);
    vec4 colorSum = vec4(0.0), circleSum = vec4(0.0);
    float anisotropic = 0.0, isotropic = 0.0, nearer = 0.0;
    for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) {
            vec2 q = place + vec2(i, j) * step_;
            vec4 tap = textureLod(uCircle, q, 0.0);
            float g = exp(-0.5 * float(i * i + j * j));
            circleSum += g * tap;
            isotropic += g;
            if (tap.x < 0.0 && tap.x < p.x)
                nearer = max(nearer, tap.y);
            if (p.y > tap.y + uDelta && p.x > 0.0)
                continue;
            colorSum += g * textureLod(uColor, q, 0.0);
            anisotropic += g;
        }
    color = colorSum / anisotropic;
    circle = vec4(circleSum.xy / isotropic, nearer, 0.0);
}
"""

# Steps 4 and 5.
PICTURE = """
#version 330
uniform sampler2D uColors;
uniform sampler2D uCircles;
uniform vec2 uSize;
uniform float uLast;
out vec4 result;

const float K_SIGMA = 2.0 / 3.0;
const vec2 CIRCLE[9] = vec2[](vec2(0), vec2(1, 0), vec2(-1, 0), vec2(0, 1), vec2(0, -1),
    vec2(1, 1) * sqrt(0.5), vec2(-1, 1) * sqrt(0.5), vec2(1, -1) * sqrt(0.5), vec2(-1, -1) * sqrt(0.5));

float levelOf(float sigma)
{
    return K_SIGMA * sigma <= 0.5 ? 0.0 : 1.0 + log2(K_SIGMA * sigma);
}

void main()
{
    vec2 place = gl_FragCoord.xy / uSize;
    float rho = 0.0, total = 0.0;
    for (int k = 0; k < 5; ++k) {
        float g = k == 0 ? 1.0 : exp(-0.5);
        rho += g * textureLod(uCircles, place + CIRCLE[k] * exp2(uLast) / uSize, uLast).z;
        total += g;
    }
    float sigma = textureLod(uCircles, place, min(levelOf(rho / total), uLast)).y;
    float m = levelOf(sigma);
    float lod = min(max(m - 1.0, 0.0), uLast);
    float radius = exp2(lod) * min(m, 1.0);
    vec4 sum = vec4(0.0);
    total = 0.0;
    for (int k = 0; k < 9; ++k) {
        float g = k == 0 ? 1.0 : (k < 5 ? exp(-0.5) : exp(-1.0));
        sum += g * textureLod(uColors, place + CIRCLE[k] * radius / uSize, lod);
        total += g;
    }
    result = vec4(sum.rgb / total, sigma);
}
"""


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

"""Gustafsson's single pass as the fragment shader that the article prints, and a shader that finds its nearest texels.

References
----------
.. [1] Gustafsson (2018), Bokeh Depth of Field in a Single Pass, Tuxedo Labs.
"""

from typing import Any

import moderngl
import numpy as np

from tests.gl import shader

__all__ = ["foreign_taps", "upload"]

# The listing, but for what its host leaves open: depth comes inverted, and with its circle of confusion in pixels.
SINGLE_PASS = """
#version 330
uniform sampler2D uTexture;
uniform sampler2D uGuide;  // 1 / depth, circle of confusion [px]
uniform vec2 uPixelSize;
out vec4 result;

const float GOLDEN_ANGLE = 2.39996323;
const float MAX_BLUR_SIZE = 20.0;
const float RAD_SCALE = 0.5;

float getBlurSize(float coc)
{
    return abs(clamp(coc / MAX_BLUR_SIZE, -1.0, 1.0)) * MAX_BLUR_SIZE;
}

void main()
{
    vec2 texCoord = gl_FragCoord.xy * uPixelSize;
    vec2 center = texture(uGuide, texCoord).rg;
    float centerSize = getBlurSize(center.y);
    vec3 color = texture(uTexture, texCoord).rgb;
    float tot = 1.0;
    float radius = RAD_SCALE;
    for (float ang = 0.0; radius < MAX_BLUR_SIZE; ang += GOLDEN_ANGLE) {
        vec2 tc = texCoord + vec2(cos(ang), sin(ang)) * uPixelSize * radius;
        vec3 sampleColor = texture(uTexture, tc).rgb;
        vec2 guide = texture(uGuide, tc).rg;
        float sampleSize = getBlurSize(guide.y);
        if (guide.x < center.x)
            sampleSize = clamp(sampleSize, 0.0, centerSize * 2.0);
        float m = smoothstep(radius - 0.5, radius + 0.5, sampleSize);
        color += mix(color / tot, sampleColor, m);
        tot += 1.0;
        radius += RAD_SCALE / radius;
    }
    result = vec4(color / tot, tot - 1.0);
}
"""

# The same taps on a texture that holds every texel's own coordinates: how many come from another texel than the
# offset in exact arithmetic names, and how many there are.
FOREIGN_TAPS = """
#version 330
uniform sampler2D uTexel;
uniform sampler2D uOffset;  // one row: nearest whole texel of every tap, in double precision
uniform vec2 uPixelSize;
out vec2 result;

void main()
{
    vec2 texCoord = gl_FragCoord.xy * uPixelSize;
    vec2 last = 1.0 / uPixelSize - 1.0;
    float radius = 0.5, foreign = 0.0, ang = 0.0;
    int k = 0;
    for (; radius < 20.0; ang += 2.39996323) {
        vec2 tc = texCoord + vec2(cos(ang), sin(ang)) * uPixelSize * radius;
        vec2 wanted = clamp(floor(gl_FragCoord.xy) + texelFetch(uOffset, ivec2(k, 0), 0).rg, vec2(0.0), round(last));
        if (texture(uTexel, tc).rg != wanted)
            foreign += 1.0;
        radius += 0.5 / radius;
        k += 1;
    }
    result = vec2(foreign, float(k));
}
"""


def upload(
    context: moderngl.Context, color: np.ndarray, depth: np.ndarray, coc: np.ndarray, depth_filter: str
) -> tuple[shader.Pass, dict[str, Any], dict[str, Any]]:
    """What `shader.draw` needs for one image: the pass, its textures and its uniforms. Alpha counts the taps."""
    height, width = depth.shape
    guide = np.stack([1.0 / depth, coc], axis=-1)
    textures = {
        "uTexture": shader.texture_of(context, color, linear=True),
        "uGuide": shader.texture_of(context, guide, linear=depth_filter == "bilinear"),
    }
    work = shader.new_pass(context, SINGLE_PASS, (height, width))
    return work, textures, {"uPixelSize": (1.0 / width, 1.0 / height)}


def foreign_taps(context: moderngl.Context, shape: tuple[int, int], nearest: np.ndarray) -> np.ndarray:
    """Per pixel (H, W): taps whose nearest texel differs from the whole offsets `nearest` (N, 2)."""
    height, width = shape
    y, x = np.indices(shape)
    textures = {
        "uTexel": shader.texture_of(context, np.stack([x, y], axis=-1), linear=False),
        "uOffset": shader.texture_of(context, nearest[None], linear=False),
    }
    work = shader.new_pass(context, FOREIGN_TAPS, shape, components=2)
    shader.draw(work, textures, uPixelSize=(1.0 / width, 1.0 / height))
    result = shader.read(work)
    if (result[..., 1] != len(nearest)).any():
        raise ValueError(f"nearest: got {len(nearest)} taps; the shader has {result[0, 0, 1]:g}")
    return result[..., 0].astype(int)

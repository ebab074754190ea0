"""Scheuermann's twelve taps as a fragment shader, after the listing that several engines carry."""

from typing import Any

import numpy as np

from tests.gl import shader

__all__ = ["upload"]

POISSON = """
#version 330
uniform sampler2D uSharp;  // colour, blur code
uniform sampler2D uSmall;
uniform vec2 uSize;
uniform vec2 uTaps[12];
uniform float uMaxRadius;
out vec4 result;

void main()
{
    vec2 place = gl_FragCoord.xy / uSize;
    float center = textureLod(uSharp, place, 0.0).a;
    float radius = abs(center * 2.0 * uMaxRadius - uMaxRadius);
    float radiusSmall = radius * 0.4;
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 12; ++k) {
        vec4 high = textureLod(uSharp, place + uTaps[k] * radius / uSize, 0.0);
        vec4 low = textureLod(uSmall, place + uTaps[k] * radiusSmall * 4.0 / uSize, 0.0);
        vec4 tap = mix(high, low, abs(high.a * 2.0 - 1.0));
        float weight = tap.a >= center ? 1.0 : abs(tap.a * 2.0 - 1.0);
        sum += vec4(tap.rgb, 1.0) * weight;
    }
    result = sum.a > 0.0 ? vec4(sum.rgb / sum.a, 1.0) : textureLod(uSharp, place, 0.0);
}
"""


def upload(context: Any, coded: np.ndarray, small: np.ndarray, taps: np.ndarray, max_radius: float) -> tuple[Any, ...]:
    """What `shader.draw` needs: the pass, its textures and its uniforms. coded and small are (h, w, 4)."""
    height, width = coded.shape[:2]
    textures = {name: shader.texture_of(context, a, linear=True) for name, a in (("uSharp", coded), ("uSmall", small))}
    work = shader.new_pass(context, POISSON, (height, width))
    return work, textures, {"uSize": (width, height), "uTaps": taps.tolist(), "uMaxRadius": max_radius}

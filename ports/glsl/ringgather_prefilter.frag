#version 330
// Ring gather, second pass: a small ring's mean, and weights of near and far. Drawn at half the size, rounded up.
//
// Source: Wicked Engine (2025), WickedEngine/shaders/depthoffield_*.hlsl; Jimenez (2014).

uniform sampler2D uColor;      // linear RGB, float; filter linear, wrap clamp to edge
uniform sampler2D uPlanes;     // circle [px of half the size] and depth, float; filter nearest
uniform sampler2D uTiles;      // of 32 pixels and those around: least circle and depth, greatest circle and depth
uniform vec2 uHalf;            // size of the target [px]
uniform vec2 uPoints[8];       // the first ring, eight points at 1/4, from half a step on; y down
uniform float uForeground;     // how far behind the nearest depth is still near [unit of depth]

layout(location = 0) out vec4 filtered;  // colour, 1
layout(location = 1) out vec4 weights;   // circle, weight behind, weight before

const float PI = 3.14159265358979;

vec2 planesAt(vec2 place)
{
    return texelFetch(uPlanes, clamp(ivec2(floor(place)), ivec2(0), textureSize(uPlanes, 0) - 1), 0).rg;
}

void main()
{
    ivec2 here = ivec2(gl_FragCoord.xy);
    vec2 full = vec2(textureSize(uColor, 0));
    vec2 own = texelFetch(uPlanes, (2 * here + 1) * textureSize(uPlanes, 0) / (2 * ivec2(uHalf)), 0).rg;
    vec3 center = texture(uColor, gl_FragCoord.xy / uHalf).rgb;
    vec3 sum = center;
    for (int k = 0; k < 8; k++) {
        vec2 place = (gl_FragCoord.xy + 0.5 * own.r * uPoints[k]) * (full / uHalf);
        float apart = min(2.0 * abs(planesAt(place).g - own.g), 1.0);
        sum += mix(texture(uColor, place / full).rgb, center, apart);
    }
    filtered = vec4(sum / 9.0, 1.0);

    float nearest = texelFetch(uTiles, here / 16, 0).g;
    float behind = smoothstep(0.0, 1.0, (own.g - nearest) / uForeground);
    float light = 1.0 / max(PI * own.r * own.r, PI * 0.7071 * 0.7071);
    weights = vec4(own.r, light * behind, light * (1.0 - behind), 0.0);
}

#version 330
// Ring gather, the last pass: the blurred picture over the sharp one, by circle. Drawn over the whole picture.
//
// Source: Wicked Engine (2025), WickedEngine/shaders/depthoffield_*.hlsl; Jimenez (2014).

uniform sampler2D uColor;    // linear RGB, float; filter nearest
uniform sampler2D uPlanes;   // circle [px of half the size] and depth, float; filter nearest
uniform sampler2D uSoft;     // colour and alpha at half the size, float; filter linear, wrap clamp to edge
uniform sampler2D uTiles;    // of 32 pixels and those around: least circle and depth, greatest circle and depth

out vec4 fragColor;

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec2 own = texelFetch(uPlanes, pixel, 0).rg;
    vec4 tile = texelFetch(uTiles, pixel / 32, 0);
    vec4 soft = texture(uSoft, gl_FragCoord.xy / vec2(textureSize(uColor, 0)));
    float near = clamp(1.0 - (own.g - tile.y), 0.0, 1.0);
    float reach = mix(tile.z, own.r, near);
    float share = clamp(mix(own.r, reach, soft.a), 0.0, 1.0);
    fragColor = vec4(mix(texelFetch(uColor, pixel, 0).rgb, soft.rgb, share), 1.0);
}

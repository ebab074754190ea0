#version 330
// Halfres, the last pass: far, then near over the picture; wholly, where they are blurred by half or more.
//
// Source: three.js r187 (2025), DepthOfFieldNode.js.

uniform sampler2D uColor;  // the picture, linear RGB, float; filter nearest
uniform sampler2D uFar;    // colour and blur at half the size, float; filter linear, wrap clamp to edge
uniform sampler2D uNear;   // as uFar

out vec4 fragColor;

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec2 place = gl_FragCoord.xy / vec2(textureSize(uColor, 0));
    vec4 far = texture(uFar, place);
    vec4 near = texture(uNear, place);
    vec3 color = mix(texelFetch(uColor, pixel, 0).rgb, far.rgb, 2.0 * min(far.a, 0.5));
    fragColor = vec4(mix(color, near.rgb, 2.0 * min(near.a, 0.5)), 1.0);
}

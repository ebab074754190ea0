#version 330
// Ring gather, circles without sign, in pixels of half the size. Drawn over the whole picture.
//
// Source: Wicked Engine (2025), WickedEngine/shaders/depthoffield_*.hlsl; Jimenez (2014).

uniform sampler2D uCircle;        // circle of confusion, radius [px], float; filter nearest
uniform sampler2D uDepth;         // planar depth, finite, float; filter nearest
uniform float uLargest = 32.0;    // circles are cut at this radius [px]

out vec4 planes;  // circle, depth

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float circle = min(abs(texelFetch(uCircle, pixel, 0).r), uLargest);
    planes = vec4(0.5 * circle, texelFetch(uDepth, pixel, 0).r, 0.0, 0.0);
}

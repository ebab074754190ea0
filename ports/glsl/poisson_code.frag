#version 330
// Poisson disc, pass 1: the picture with the blur of every pixel and its side in the fourth channel.
//
// 0 is full blur in front of the focal plane, 1/2 is sharp, 1 is full blur behind. Blur grows linearly with depth. An
// 8-bit target would round the code; refdof does not.
//
// Source: Scheuermann (2004), Advanced Depth of Field, Game Developers Conference (ATI Research).

uniform sampler2D uColor;  // linear RGB, float
uniform sampler2D uDepth;  // planar depth [scene units], float; infinite is background
uniform float uNear;       // depth of full blur in front [scene units], < uFocus
uniform float uFocus;      // depth in focus [scene units]
uniform float uFar;        // depth of full blur behind [scene units], > uFocus

layout(location = 0) out vec4 coded;

void main()
{
    ivec2 here = ivec2(gl_FragCoord.xy);
    float depth = texelFetch(uDepth, here, 0).r;
    float blur = depth < uFocus ? (depth - uFocus) / (uFocus - uNear) : (depth - uFocus) / (uFar - uFocus);
    coded = vec4(texelFetch(uColor, here, 0).rgb, 0.5 + 0.5 * clamp(blur, -1.0, 1.0));
}

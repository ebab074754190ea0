#version 330
// Circular, first pass, one component: complex taps along the row, as far apart as the pixel's own circle says.
//
// Drawn over the whole picture once for every component, into two float targets.
//
// Source: Garcia (2017), Circular Separable Convolution Depth of Field; Niemitalo (2010).

uniform sampler2D uColor;    // linear RGB, float; filter linear, wrap clamp to edge
uniform sampler2D uCircle;   // circle of confusion, radius [px], float; filter nearest
uniform vec2 uTaps[9];       // normalised taps for places 0 .. 8: real and imaginary part
uniform float uStep;         // distance of taps over the circle: (1 + transition) / (fitted radius * 8)
uniform float uLargest;      // circles are cut at this radius [px]

layout(location = 0) out vec4 realPart;
layout(location = 1) out vec4 imaginaryPart;

void main()
{
    vec2 size = vec2(textureSize(uColor, 0));
    float apart = min(abs(texelFetch(uCircle, ivec2(gl_FragCoord.xy), 0).r), uLargest) * uStep;
    realPart = vec4(0.0);
    imaginaryPart = vec4(0.0);
    for (int j = -8; j <= 8; j++) {
        vec2 tap = uTaps[abs(j)];
        vec4 read = texture(uColor, (gl_FragCoord.xy + vec2(float(j) * apart, 0.0)) / size);
        realPart += tap.x * read;
        imaginaryPart += tap.y * read;
    }
}

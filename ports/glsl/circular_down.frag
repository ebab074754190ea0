#version 330
// Circular, second pass, one component: complex taps along the column. The sum over components is the picture.
//
// Drawn over the whole picture once for every component, with additive blending into one float target.
//
// Source: Garcia (2017), Circular Separable Convolution Depth of Field; Niemitalo (2010).

uniform sampler2D uReal;       // what the first pass has made, float; filter linear, wrap clamp to edge
uniform sampler2D uImaginary;  // as uReal
uniform sampler2D uCircle;     // circle of confusion, radius [px], float; filter nearest
uniform vec2 uTaps[9];         // normalised taps for places 0 .. 8: real and imaginary part
uniform vec2 uWeights;         // A and B: of the product's real and imaginary part
uniform float uStep;           // as in the first pass
uniform float uLargest;        // as in the first pass

out vec4 fragColor;

void main()
{
    vec2 size = vec2(textureSize(uReal, 0));
    float apart = min(abs(texelFetch(uCircle, ivec2(gl_FragCoord.xy), 0).r), uLargest) * uStep;
    vec4 realPart = vec4(0.0);
    vec4 imaginaryPart = vec4(0.0);
    for (int j = -8; j <= 8; j++) {
        vec2 tap = uTaps[abs(j)];
        vec2 place = (gl_FragCoord.xy + vec2(0.0, float(j) * apart)) / size;
        vec4 re = texture(uReal, place);
        vec4 im = texture(uImaginary, place);
        realPart += tap.x * re - tap.y * im;
        imaginaryPart += tap.x * im + tap.y * re;
    }
    fragColor = uWeights.x * realPart + uWeights.y * imaginaryPart;
}

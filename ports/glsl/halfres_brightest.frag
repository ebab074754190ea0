#version 330
// Halfres, greatest values of the means over 16 points of the disc. Drawn at half the size, near and far.
//
// Source: three.js r187 (2025), DepthOfFieldNode.js.

uniform sampler2D uMean;   // colour and blur, float; filter linear, wrap clamp to edge
uniform vec2 uFull;        // size of the picture [px]
uniform float uLargest;    // radius of the greatest blur [px of the picture]

out vec4 brightest;  // colour, blur

const float GOLDEN_ANGLE = 2.39996323;

void main()
{
    vec4 own = texelFetch(uMean, ivec2(gl_FragCoord.xy), 0);
    vec2 place = gl_FragCoord.xy / vec2(textureSize(uMean, 0));
    vec3 most = own.rgb;
    for (int i = 0; i < 80; i += 5) {
        float angle = float(i) * GOLDEN_ANGLE;
        vec2 point = sqrt(float(i) / 80.0) * vec2(cos(angle), sin(angle));
        most = max(most, texture(uMean, place + point * uLargest * own.a / uFull).rgb);
    }
    brightest = vec4(most, own.a);
}

#version 330
// Halfres, mean of the picture over 64 points of a disc as large as the blur. Drawn at half the size, near and far.
//
// Row 0 of the textures is the top row; where it is the bottom row, the points are mirrored.
//
// Source: three.js r187 (2025), DepthOfFieldNode.js.

uniform sampler2D uColor;   // the picture, linear RGB, float; filter linear, wrap clamp to edge
uniform sampler2D uBlur;    // blur 0 .. 1, in any size, float; filter linear, wrap clamp to edge
uniform vec2 uHalf;         // size of the target [px]
uniform float uLargest;     // radius of the greatest blur [px of the picture]

out vec4 mean;  // colour, blur

const float GOLDEN_ANGLE = 2.39996323;

void main()
{
    vec2 place = gl_FragCoord.xy / uHalf;
    float blur = texture(uBlur, place).r;
    vec2 reach = uLargest * blur / vec2(textureSize(uColor, 0));
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 80; i++) {
        if (i % 5 == 0)
            continue;
        float angle = float(i) * GOLDEN_ANGLE;
        sum += texture(uColor, place + sqrt(float(i) / 80.0) * vec2(cos(angle), sin(angle)) * reach).rgb;
    }
    mean = vec4(sum / 64.0, blur);
}

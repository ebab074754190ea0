#version 330
// Mipmap interpolation, one coarser level of colour and circles from the finer one: nine bilinear reads one finer texel
// apart, of Gaussian weights. A blurred background takes no colour from what is sharper than itself by uDelta.
//
// Drawn once for every level 1 .. M into two targets of max(1, width >> k) x max(1, height >> k) texels. Level 0 of
// circles is made by the host: (c, |c|, 0, 0) of the signed circle of confusion c [px], negative in front of focus.
//
// Source: Lee, Kim, Choi (2009), Real-Time Depth-of-Field Rendering Using Anisotropically Filtered Mipmap
// Interpolation, equations (1), (9) and (10).

uniform sampler2D uColor;     // finer level, linear RGB, float; filter linear, wrap clamp to edge
uniform sampler2D uCircle;    // finer level: signed circle, degree of blur, blur of nearer neighbours [px]; same filter
uniform vec2 uCoarse;         // width, height of the coarser level
uniform float uDelta = 0.5;   // how much sharper than its centre a tap may be [px]

layout(location = 0) out vec4 color;
layout(location = 1) out vec4 circle;

void main()
{
    vec2 place = gl_FragCoord.xy / uCoarse;
    vec2 texel = 1.0 / vec2(textureSize(uColor, 0));
    vec4 p = textureLod(uCircle, place, 0.0);
    vec4 colorSum = vec4(0.0), circleSum = vec4(0.0);
    float anisotropic = 0.0, isotropic = 0.0, nearer = 0.0;
    for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) {
            vec2 q = place + vec2(i, j) * texel;
            vec4 tap = textureLod(uCircle, q, 0.0);
            float weight = exp(-0.5 * float(i * i + j * j));
            circleSum += weight * tap;
            isotropic += weight;
            if (tap.x < 0.0 && tap.x < p.x)
                nearer = max(nearer, tap.y);  // Eq. (10)
            if (p.y > tap.y + uDelta && p.x > 0.0)
                continue;  // Eq. (9)
            colorSum += weight * textureLod(uColor, q, 0.0);
            anisotropic += weight;
        }
    color = colorSum / anisotropic;
    circle = vec4(circleSum.xy / isotropic, nearer, 0.0);
}

#version 330
// Halfres, near blur spread over its neighbours along one axis. Draw it twice over the whole picture: (1, 0), (0, 1).
//
// Source: three.js r187 (2025), DepthOfFieldNode.js.

uniform sampler2D uNear;  // blur in front, 0 .. 1, float; filter nearest, wrap clamp to edge
uniform ivec2 uAxis;

out vec4 spread;

void main()
{
    ivec2 last = textureSize(uNear, 0) - 1;
    float sum = 0.0;
    float total = 0.0;
    for (int i = -6; i <= 6; i++) {
        float weight = exp(-float(i * i) / (2.0 * (7.0 / 3.0) * (7.0 / 3.0)));
        sum += weight * texelFetch(uNear, clamp(ivec2(gl_FragCoord.xy) + i * uAxis, ivec2(0), last), 0).r;
        total += weight;
    }
    spread = vec4(sum / total, 0.0, 0.0, 0.0);
}

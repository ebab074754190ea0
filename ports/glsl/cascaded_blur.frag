#version 330
// Cascaded layers, one half of a Gaussian blur: along one axis, up to three standard deviations, of weights that sum up
// to 1. Drawn twice, with uAxis (1, 0) and then (0, 1). Outside the picture is its nearest pixel.
//
// Source: Schedl & Wimmer (2012), A Layered Depth-of-Field Method for Solving Partial Occlusion, equation (13).

uniform sampler2D uBuffer;    // premultiplied
uniform ivec2 uAxis;
uniform float uDeviation;     // standard deviation [px], > 0

layout(location = 0) out vec4 result;

void main()
{
    ivec2 here = ivec2(gl_FragCoord.xy), last = textureSize(uBuffer, 0) - 1;
    int reach = int(ceil(3.0 * uDeviation));
    vec4 sum = vec4(0.0);
    float total = 0.0;
    for (int k = -reach; k <= reach; ++k) {
        float x = float(k) / uDeviation, weight = exp(-0.5 * x * x);
        sum += weight * texelFetch(uBuffer, clamp(here + k * uAxis, ivec2(0), last), 0);
        total += weight;
    }
    result = sum / total;
}

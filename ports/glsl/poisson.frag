#version 330
// Poisson disc, pass 5: twelve taps inside the blur, each between the picture and its small blurred copy.
//
// The blur of a tap chooses between the two. A tap counts in full if it is not nearer than the pixel, and else by its
// own blur, so that sharp foregrounds do not leak.
//
// Source: Scheuermann (2004), Advanced Depth of Field, Game Developers Conference (ATI Research), as programs carry it.

uniform sampler2D uSharp;         // colour and code; filter linear, wrap clamp to edge
uniform sampler2D uSmall;         // the same, small and blurred; filter linear, wrap clamp to edge
uniform vec2 uSize;               // width, height of the picture
uniform float uMaxRadius = 5.0;   // radius of full blur [px]

layout(location = 0) out vec4 result;

const float SMALL = 4.0;         // width of the small picture's texels [px]
const float SMALL_RADIUS = 0.4;  // radius in the small picture [its texels], of the radius [px]
const vec2 TAPS[12] = vec2[](
    vec2(-0.326212, -0.40581), vec2(-0.840144, -0.07358), vec2(-0.695914, 0.457137), vec2(-0.203345, 0.620716),
    vec2(0.96234, -0.194983), vec2(0.473434, -0.480026), vec2(0.519456, 0.767022), vec2(0.185461, -0.893124),
    vec2(0.507431, 0.064425), vec2(0.89642, 0.412458), vec2(-0.32194, -0.932615), vec2(-0.791559, -0.59771));

// Share of the largest blur.
float blurOf(float code)
{
    return abs(code * 2.0 - 1.0);
}

void main()
{
    vec2 place = gl_FragCoord.xy / uSize;
    vec4 center = textureLod(uSharp, place, 0.0);
    float radius = blurOf(center.a) * uMaxRadius;
    float radiusSmall = radius * SMALL_RADIUS * SMALL;
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 12; ++k) {
        vec4 high = textureLod(uSharp, place + TAPS[k] * radius / uSize, 0.0);
        vec4 low = textureLod(uSmall, place + TAPS[k] * radiusSmall / uSize, 0.0);
        vec4 tap = mix(high, low, blurOf(high.a));
        float weight = tap.a >= center.a ? 1.0 : blurOf(tap.a);
        sum += vec4(tap.rgb, 1.0) * weight;
    }
    result = sum.a > 0.0 ? vec4(sum.rgb / sum.a, 1.0) : center;
}

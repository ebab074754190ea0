#version 330
// Poisson disc, pass 4: the small picture, colour and code, through a 3 x 3 Gaussian of weights 1, 2, 1.
//
// Source: Scheuermann (2004), Advanced Depth of Field, Game Developers Conference (ATI Research).

uniform sampler2D uQuarter;  // colour and code at a quarter of the sides, float

layout(location = 0) out vec4 small;

void main()
{
    ivec2 here = ivec2(gl_FragCoord.xy), last = textureSize(uQuarter, 0) - 1;
    vec4 sum = vec4(0.0);
    for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) {
            float weight = float((2 - abs(i)) * (2 - abs(j))) / 16.0;
            sum += weight * texelFetch(uQuarter, clamp(here + ivec2(i, j), ivec2(0), last), 0);
        }
    small = sum;
}

#version 330
// Poisson disc, passes 2 and 3: picture and code at half the size, rounded down: means of 2 x 2 texels.
//
// The small picture has a quarter of the sides: draw this twice. The last row or column of an odd size has no part.
//
// Source: Scheuermann (2004), Advanced Depth of Field, Game Developers Conference (ATI Research).

uniform sampler2D uFine;  // colour and code, float

layout(location = 0) out vec4 coarse;

void main()
{
    ivec2 first = 2 * ivec2(gl_FragCoord.xy);
    ivec2 second = min(first + 1, textureSize(uFine, 0) - 1);  // a side of one texel counts twice
    vec4 upper = texelFetch(uFine, first, 0) + texelFetch(uFine, ivec2(second.x, first.y), 0);
    vec4 lower = texelFetch(uFine, ivec2(first.x, second.y), 0) + texelFetch(uFine, second, 0);
    coarse = 0.25 * (upper + lower);
}

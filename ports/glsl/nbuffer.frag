#version 330
// N-buffer, a level from the one before: at every texel the least and the greatest value of the square whose first
// corner it is, twice as wide as the squares of the level before, and cut off at the border.
//
// Drawn over the whole buffer once for every level, from `nbuffer_bottom.frag` on, with uSide 1, 2, 4 and so on, into
// a target of two floats. All levels have the same size. Only comparisons are made: levels are exact.
//
// Source: Decoret (2005), N-Buffers for Efficient Depth Map Query.

uniform sampler2D uBefore;  // the level before: least, greatest
uniform int uSide;          // side of its squares [texels]

layout(location = 0) out vec4 extremes;  // least, greatest

void main()
{
    ivec2 here = ivec2(gl_FragCoord.xy);
    // A square that reaches the border has no neighbour that could add to it: clamped, it meets itself or a part.
    ivec2 there = min(here + uSide, textureSize(uBefore, 0) - 1);
    vec2 a = texelFetch(uBefore, here, 0).xy;
    vec2 b = texelFetch(uBefore, ivec2(there.x, here.y), 0).xy;
    vec2 c = texelFetch(uBefore, ivec2(here.x, there.y), 0).xy;
    vec2 d = texelFetch(uBefore, there, 0).xy;
    float least = min(min(a.x, b.x), min(c.x, d.x));
    float greatest = max(max(a.y, b.y), max(c.y, d.y));
    extremes = vec4(least, greatest, 0.0, 1.0);
}

#version 330
// N-buffer, level 0: the least and the greatest value of every block of texels, over four layers packed in one texel.
//
// Drawn over ceil(width / uBlock) x ceil(height / uBlock) fragments, into a target of two floats. Infinite values are
// empty. A block that holds nothing has a least value of inf and a greatest of -inf. Only comparisons are made.
//
// Source: Decoret (2005), N-Buffers for Efficient Depth Map Query; Lee, Eisemann & Seidel (2010), Real-Time Lens Blur
// Effects and Focus Control, Section 3.

uniform sampler2D uDepth;  // any values, float; the same in four channels if there is one layer
uniform int uBlock = 1;    // side of a block [texels]

layout(location = 0) out vec4 extremes;  // least, greatest

void main()
{
    float infinity = uintBitsToFloat(0x7f800000u);
    ivec2 first = ivec2(gl_FragCoord.xy) * uBlock;
    ivec2 end = min(first + uBlock, textureSize(uDepth, 0));  // blocks at the border may be partial
    float least = infinity, greatest = -infinity;
    for (int y = first.y; y < end.y; ++y)
        for (int x = first.x; x < end.x; ++x) {
            vec4 depth = texelFetch(uDepth, ivec2(x, y), 0);
            for (int k = 0; k < 4; ++k)
                if (abs(depth[k]) < infinity) {
                    least = min(least, depth[k]);
                    greatest = max(greatest, depth[k]);
                }
        }
    extremes = vec4(least, greatest, 0.0, 1.0);
}

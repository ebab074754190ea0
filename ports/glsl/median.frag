#version 330
// Median of the nine texels around each, channel by channel. Drawn over the whole picture.
//
// Used by the passes of ringgather and filament. With uSide, tiles without blur keep their texels.

uniform sampler2D uPicture;  // float; filter nearest, wrap clamp to edge
uniform sampler2D uTiles;    // least circle in x, greatest in z [px], float; filter nearest
uniform int uSide = 0;       // of a tile [texels]; 0: there are no tiles

out vec4 middle;

void order(inout vec4 a, inout vec4 b)
{
    vec4 low = min(a, b);
    b = max(a, b);
    a = low;
}

void order(inout vec4 a, inout vec4 b, inout vec4 c)
{
    order(a, b);
    order(b, c);
    order(a, b);
}

void main()
{
    ivec2 here = ivec2(gl_FragCoord.xy);
    ivec2 last = textureSize(uPicture, 0) - 1;
    vec4 texels[9];
    for (int k = 0; k < 9; k++)
        texels[k] = texelFetch(uPicture, clamp(here + ivec2(k % 3, k / 3) - 1, ivec2(0), last), 0);
    middle = texels[4];
    if (uSide > 0) {
        vec4 tile = texelFetch(uTiles, here / uSide, 0);
        if (max(abs(tile.x), abs(tile.z)) < 1.0)
            return;
    }
    // Rows in order: the median is that of the greatest least, the middle one of the middles, and the least greatest.
    order(texels[0], texels[1], texels[2]);
    order(texels[3], texels[4], texels[5]);
    order(texels[6], texels[7], texels[8]);
    vec4 low = max(texels[0], max(texels[3], texels[6]));
    vec4 high = min(texels[2], min(texels[5], texels[8]));
    order(texels[1], texels[4], texels[7]);
    order(low, texels[4], high);
    middle = texels[4];
}

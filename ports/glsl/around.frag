#version 330
// Tiles, least and greatest values of each and the eight around it. Drawn over all tiles, twice for two rings of them.
//
// Used by the passes of ringgather and filament.

uniform sampler2D uTiles;  // least values in two channels, greatest in two, float; filter nearest

out vec4 tile;  // as uTiles

void main()
{
    ivec2 last = textureSize(uTiles, 0) - 1;
    tile = texelFetch(uTiles, ivec2(gl_FragCoord.xy), 0);
    for (int y = -1; y <= 1; y++) {
        for (int x = -1; x <= 1; x++) {
            vec4 other = texelFetch(uTiles, clamp(ivec2(gl_FragCoord.xy) + ivec2(x, y), ivec2(0), last), 0);
            tile = vec4(min(tile.xy, other.xy), max(tile.zw, other.zw));
        }
    }
}

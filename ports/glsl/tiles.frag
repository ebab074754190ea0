#version 330
// Tiles: least and greatest values of squares of texels, of two channels. Drawn over ceil(side / uSide) texels.
//
// Used by the passes of ringgather and filament.

uniform sampler2D uValues;               // float; filter nearest
uniform ivec2 uChannels = ivec2(0, 1);   // of it
uniform int uSide;                       // of a tile [texels]

out vec4 tile;  // least value of both channels, greatest value of both

void main()
{
    ivec2 first = uSide * ivec2(gl_FragCoord.xy);
    ivec2 end = min(first + uSide, textureSize(uValues, 0));
    vec2 least = vec2(3.4e38);
    vec2 greatest = vec2(-3.4e38);
    for (int y = first.y; y < end.y; y++) {
        for (int x = first.x; x < end.x; x++) {
            vec4 texel = texelFetch(uValues, ivec2(x, y), 0);
            vec2 both = vec2(texel[uChannels.x], texel[uChannels.y]);
            least = min(least, both);
            greatest = max(greatest, both);
        }
    }
    tile = vec4(least, greatest);
}

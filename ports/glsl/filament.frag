#version 330
// Filament, the last pass: the blurred picture over the sharp one, by alpha. Drawn over the whole picture.
//
// Source: Filament (2025), filament/src/materials/dof; Abadie (2018), A Life of a Bokeh.

uniform sampler2D uColor;   // linear RGB, float; filter nearest
uniform sampler2D uSoft;    // colour times alpha and alpha, at half the size, filled up; filter linear, clamp to edge
uniform sampler2D uTiles;   // of 16 pixels, two rings around: least circle in x, greatest in z; filter nearest

out vec4 fragColor;

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec2 tile = texelFetch(uTiles, pixel / 16, 0).xz;
    vec3 sharp = texelFetch(uColor, pixel, 0).rgb;
    if (max(abs(tile.x), abs(tile.y)) < 1.0) {
        fragColor = vec4(sharp, 1.0);
        return;
    }
    vec4 soft = texture(uSoft, gl_FragCoord.xy / (2.0 * vec2(textureSize(uSoft, 0))));
    bool alone = tile.y - tile.x <= 0.05 * abs(tile.y) && abs(tile.x) >= 2.0;
    fragColor = vec4(alone ? soft.rgb : soft.rgb + (1.0 - soft.a) * sharp, 1.0);
}

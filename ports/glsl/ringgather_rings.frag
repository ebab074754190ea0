#version 330
// Ring gather, third pass: sums over three rings, near over far. Drawn at half the size, rounded up.
//
// Source: Wicked Engine (2025), WickedEngine/shaders/depthoffield_*.hlsl; Jimenez (2014).

uniform sampler2D uFiltered;   // colour, 1, float; filter linear, wrap clamp to edge
uniform sampler2D uWeights;    // circle, weight behind, weight before, float; filter nearest
uniform sampler2D uTiles;      // of 32 pixels and those around: least circle and depth, greatest circle and depth
uniform vec2 uPoints[48];      // ring j = 1 .. 3, 8 j points at j / 4, odd rings from half a step on; y down
uniform float uGain = 1.0;     // opacity of the near taps

out vec4 fragColor;  // colour, alpha

const float PI = 3.14159265358979;

void main()
{
    ivec2 here = ivec2(gl_FragCoord.xy);
    ivec2 last = textureSize(uWeights, 0) - 1;
    vec2 size = vec2(textureSize(uFiltered, 0));
    vec4 tile = texelFetch(uTiles, here / 16, 0);
    float most = tile.z;
    fragColor = texelFetch(uFiltered, here, 0);
    if (most < 1.0)
        return;

    int used = clamp(int(ceil(3.0 * sqrt(most))), 1, 3);
    float count = float((2 * used + 1) * (2 * used + 1));
    float reach = float(used) / 3.0 * most;
    if (most - tile.x < 1.0) {
        vec3 sum = fragColor.rgb;
        for (int k = 0; k < 4 * used * (used + 1); k++)
            sum += texture(uFiltered, (gl_FragCoord.xy + reach * uPoints[k]) / size).rgb;
        fragColor = vec4(sum / count, 0.0);
        return;
    }

    vec3 own = texelFetch(uWeights, here, 0).xyz;
    vec4 far = own.y * vec4(fragColor.rgb, 1.0);
    vec4 near = own.z * vec4(fragColor.rgb, 1.0);
    int k = 0;
    for (int ring = 1; ring <= used; ring++) {
        for (int i = 0; i < 8 * ring; i++, k++) {
            vec2 place = gl_FragCoord.xy + reach * uPoints[k];
            vec3 tap = texelFetch(uWeights, clamp(ivec2(floor(place)), ivec2(0), last), 0).xyz;
            float covers = clamp(tap.x * (float(used) / most) - float(ring) + 1.0, 0.0, 1.0);
            if (ring == 1)
                covers *= covers;
            vec4 color = vec4(texture(uFiltered, place / size).rgb, 1.0);
            far += tap.y * covers * color;
            near += tap.z * covers * color;
        }
    }
    float area = max(PI * most * most, PI * 0.7071 * 0.7071);
    float alpha = clamp(uGain / count * near.a * area, 0.0, 1.0);
    vec3 color = mix(far.rgb / max(1e-5, far.a), near.rgb / max(1e-5, near.a), alpha);
    fragColor = vec4(color, alpha);
}

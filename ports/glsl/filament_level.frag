#version 330
// Filament, a mip level from the one before: mean colour, nearest circle. Drawn over half its size, three times.
//
// Source: Filament (2025), filament/src/materials/dof; Abadie (2018), A Life of a Bokeh.

uniform sampler2D uFiner;  // colour, circle, float; filter nearest

out vec4 level;

void main()
{
    ivec2 first = 2 * ivec2(gl_FragCoord.xy);
    vec4 a = texelFetch(uFiner, first, 0);
    vec4 b = texelFetch(uFiner, first + ivec2(1, 0), 0);
    vec4 c = texelFetch(uFiner, first + ivec2(0, 1), 0);
    vec4 d = texelFetch(uFiner, first + ivec2(1, 1), 0);
    level = vec4(0.25 * (a.rgb + b.rgb + c.rgb + d.rgb), min(min(a.a, b.a), min(c.a, d.a)));
}

#version 330
// Filament, colour and nearest circle at half the size. Drawn over half of the sides, these filled up to 16 pixels.
//
// Source: Filament (2025), filament/src/materials/dof; Abadie (2018), A Life of a Bokeh.

uniform sampler2D uColor;        // linear RGB, float; filter nearest
uniform sampler2D uCircle;       // circle of confusion, radius [px], negative in front, float; filter nearest
uniform float uLargest = 32.0;   // circles are cut at this radius [px]

out vec4 halved;  // colour, circle

void main()
{
    ivec2 last = textureSize(uColor, 0) - 1;
    vec3 sum = vec3(0.0);
    float total = 0.0;
    float nearest = uLargest;
    for (int k = 0; k < 4; k++) {
        ivec2 pixel = min(2 * ivec2(gl_FragCoord.xy) + ivec2(k % 2, k / 2), last);
        vec3 color = texelFetch(uColor, pixel, 0).rgb;
        float weight = 1.0 / (1.0 + max(color.r, max(color.g, color.b)));
        sum += weight * color;
        total += weight;
        nearest = min(nearest, texelFetch(uCircle, pixel, 0).r);
    }
    nearest = max(nearest, -uLargest);
    halved = vec4(sum / total, abs(nearest) < 1.0 ? 0.0 : nearest);
}

#version 330
// Hexagon, both passes: means along three directions, of which the second pass reads what the first has made.
//
// Drawn twice over the whole picture, into two float targets. First with uFirst = true and the picture in both
// samplers; then with the two targets. Row 0 of the textures is the top row.
//
// Source: Bevy (2024), crates/bevy_post_process/src/dof; Barre-Brisebois (2017), Hexagonal Bokeh Blur Revisited.

uniform sampler2D uDown;     // the picture, or the mean downwards; float, filter linear, wrap clamp to edge
uniform sampler2D uBoth;     // the picture, or the mean of both directions; float, filter linear, wrap clamp to edge
uniform sampler2D uCircle;   // circle of confusion, radius [px], float; filter nearest
uniform bool uFirst;         // the first pass
uniform float uLargest = 32.0;  // circles are cut at this radius [px]
uniform bool uEqual = false;    // three equal rhombi

layout(location = 0) out vec4 first;
layout(location = 1) out vec4 second;

const float COS = 0.8660254037844386;

vec4 mean(sampler2D image, vec2 direction, int steps)
{
    vec2 size = vec2(textureSize(image, 0));
    int reads = uEqual ? max(steps, 1) : steps + 1;
    float start = uEqual && steps > 0 ? 0.5 : 0.0;
    vec4 sum = vec4(0.0);
    for (int k = 0; k < reads; k++)
        sum += texture(image, (gl_FragCoord.xy + (float(k) + start) * direction) / size);
    return sum / float(reads);
}

void main()
{
    float circle = abs(texelFetch(uCircle, ivec2(gl_FragCoord.xy), 0).r);
    int steps = int(roundEven(min(circle, uLargest)));
    vec4 one = mean(uDown, uFirst ? vec2(0.0, 1.0) : vec2(COS, -0.5), steps);
    vec4 two = mean(uBoth, uFirst ? vec2(COS, -0.5) : vec2(-COS, -0.5), steps);
    if (uFirst) {
        first = one;
        second = uEqual ? one + two : 0.5 * (one + two);
    } else {
        first = uEqual ? (one + two) / 3.0 : 0.5 * (one + two);
        second = vec4(0.0);
    }
}

#version 330
// Mipmap interpolation, the picture: the degree of blur read as coarse as the blur of nearer neighbours, and nine reads
// of a circle of colour, each between two levels.
//
// Drawn over the whole picture, from the levels of `mipmap_level.frag` as two textures with mipmaps.
//
// Source: Lee, Kim, Choi (2009), Real-Time Depth-of-Field Rendering Using Anisotropically Filtered Mipmap
// Interpolation, equations (6), (8) and (11).

uniform sampler2D uColors;    // levels 0 .. uLast of colour, float; filter linear and linear between levels, clamp
uniform sampler2D uCircles;   // levels of circles; same filter
uniform vec2 uSize;           // width, height of the picture
uniform float uLast;          // M, the last level: that of the largest degree of blur
uniform int uPoints = 5;      // points that smooth the blur of nearer neighbours: 0, 5 or 9

layout(location = 0) out vec4 result;  // linear RGB, smoothed degree of blur [px]

const float K_SIGMA = 2.0 / 3.0;
// Centre, axes, diagonals; diagonals moved onto the circle.
const vec2 CIRCLE[9] = vec2[](vec2(0), vec2(1, 0), vec2(-1, 0), vec2(0, 1), vec2(0, -1),
    vec2(1, 1) * sqrt(0.5), vec2(-1, 1) * sqrt(0.5), vec2(1, -1) * sqrt(0.5), vec2(-1, -1) * sqrt(0.5));

// Eq. (6): the level of a degree of blur [px].
float levelOf(float sigma)
{
    return K_SIGMA * sigma <= 0.5 ? 0.0 : 1.0 + log2(K_SIGMA * sigma);
}

// A Gaussian of the taps' places in their square: diagonals keep their weight.
float weightOf(int k)
{
    return k == 0 ? 1.0 : (k < 5 ? exp(-0.5) : exp(-1.0));
}

void main()
{
    vec2 place = gl_FragCoord.xy / uSize;

    // Eq. (11)
    float rho = 0.0, total = 0.0;
    for (int k = 0; k < uPoints; ++k) {
        rho += weightOf(k) * textureLod(uCircles, place + CIRCLE[k] * exp2(uLast) / uSize, uLast).z;
        total += weightOf(k);
    }
    float coarse = uPoints > 0 ? levelOf(rho / total) : 0.0;
    float sigma = textureLod(uCircles, place, min(coarse, uLast)).y;

    // Eq. (8): below m = 1 there is no lower level, and the circle shrinks instead.
    float m = levelOf(sigma);
    float lod = min(max(m - 1.0, 0.0), uLast);
    float radius = exp2(lod) * min(m, 1.0);  // px
    vec4 sum = vec4(0.0);
    total = 0.0;
    for (int k = 0; k < 9; ++k) {
        sum += weightOf(k) * textureLod(uColors, place + CIRCLE[k] * radius / uSize, lod);
        total += weightOf(k);
    }
    result = vec4(sum.rgb / total, sigma);
}

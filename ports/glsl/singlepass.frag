#version 330
// Single pass: every pixel gathers taps on a golden-angle spiral; a tap that does not reach it repeats the mean.
//
// Drawn over the whole picture, one fragment a pixel, into a float target. Names are those of the published listing;
// a host that does not set the last three uniforms gets the listing's constants.
//
// Source: Gustafsson (2018), Bokeh Depth of Field in a Single Pass, Tuxedo Labs.

uniform sampler2D uTexture;  // linear RGB, float; filter linear, wrap clamp to edge
uniform sampler2D uDepth;    // planar depth / uFar, float; filter nearest, wrap clamp to edge
uniform vec2 uPixelSize;     // 1 / width, 1 / height
uniform float uFar;          // depth of the far plane [scene units]
uniform float focusPoint;    // depth in focus [scene units]
uniform float focusScale;    // circle of confusion at depth d: focusScale uMaxBlurSize |1 / focusPoint - 1 / d| [px]

uniform float uMaxBlurSize = 20.0;   // circles are cut at this radius, and the spiral ends there [px]
uniform float uRadScale = 0.5;       // the radius grows by this over itself [px^2]
uniform float uBehindFactor = 2.0;   // a tap from behind counts up to this many times the pixel's own size

out vec4 fragColor;

const float GOLDEN_ANGLE = 2.39996323;  // radians

// Radius of the circle of confusion [px].
float getBlurSize(float depth)
{
    float coc = clamp((1.0 / focusPoint - 1.0 / depth) * focusScale, -1.0, 1.0);
    return abs(coc) * uMaxBlurSize;
}

// The order of the taps matters: each blends into the mean of those before.
vec3 depthOfField(vec2 texCoord)
{
    float centerDepth = texture(uDepth, texCoord).r * uFar;
    float centerSize = getBlurSize(centerDepth);
    vec3 color = texture(uTexture, texCoord).rgb;
    float total = 1.0;
    float radius = uRadScale;
    for (float angle = 0.0; radius < uMaxBlurSize; angle += GOLDEN_ANGLE) {
        vec2 place = texCoord + vec2(cos(angle), sin(angle)) * uPixelSize * radius;
        vec3 tapColor = texture(uTexture, place).rgb;
        float tapDepth = texture(uDepth, place).r * uFar;
        float tapSize = getBlurSize(tapDepth);
        if (tapDepth > centerDepth)
            tapSize = min(tapSize, centerSize * uBehindFactor);
        float m = smoothstep(radius - 0.5, radius + 0.5, tapSize);
        color += mix(color / total, tapColor, m);
        total += 1.0;
        radius += uRadScale / radius;
    }
    return color / total;
}

void main()
{
    fragColor = vec4(depthOfField(gl_FragCoord.xy * uPixelSize), 1.0);
}

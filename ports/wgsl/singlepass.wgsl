// Single pass: every pixel gathers taps on a golden-angle spiral; a tap that does not reach it repeats the mean.
//
// Drawn over the whole picture, one fragment a pixel, into a float target. Names are those of the published listing.
// Row 0 of the textures is the row of position.y = 0.5, so that rows are in the same order in and out.
//
// Source: Gustafsson (2018), Bokeh Depth of Field in a Single Pass, Tuxedo Labs.

struct Settings {
    uPixelSize: vec2f,     // 1 / width, 1 / height
    uFar: f32,             // depth of the far plane [scene units]
    focusPoint: f32,       // depth in focus [scene units]
    focusScale: f32,       // circle of confusion at depth d: focusScale uMaxBlurSize |1 / focusPoint - 1 / d| [px]
    uMaxBlurSize: f32,     // 20 in the listing: circles are cut at this radius, and the spiral ends there [px]
    uRadScale: f32,        // 0.5 in the listing: the radius grows by this over itself [px^2]
    uBehindFactor: f32,    // 2 in the listing: a tap from behind counts up to this many times the pixel's own size
}

@group(0) @binding(0) var<uniform> settings: Settings;
@group(0) @binding(1) var uTexture: texture_2d<f32>;   // linear RGB, rgba32float or rgba16float
@group(0) @binding(2) var uDepth: texture_2d<f32>;     // planar depth / uFar, r32float
@group(0) @binding(3) var colorSampler: sampler;       // linear, clamp to edge
@group(0) @binding(4) var depthSampler: sampler;       // nearest, clamp to edge

const GOLDEN_ANGLE: f32 = 2.39996323;  // radians

// Radius of the circle of confusion [px].
fn getBlurSize(depth: f32) -> f32 {
    let coc = clamp((1.0 / settings.focusPoint - 1.0 / depth) * settings.focusScale, -1.0, 1.0);
    return abs(coc) * settings.uMaxBlurSize;
}

fn depthAt(place: vec2f) -> f32 {
    return textureSampleLevel(uDepth, depthSampler, place, 0.0).r * settings.uFar;
}

fn colorAt(place: vec2f) -> vec3f {
    return textureSampleLevel(uTexture, colorSampler, place, 0.0).rgb;
}

// The order of the taps matters: each blends into the mean of those before.
fn depthOfField(texCoord: vec2f) -> vec3f {
    let centerDepth = depthAt(texCoord);
    let centerSize = getBlurSize(centerDepth);
    var color = colorAt(texCoord);
    var total = 1.0;
    var radius = settings.uRadScale;
    for (var angle = 0.0; radius < settings.uMaxBlurSize; angle += GOLDEN_ANGLE) {
        let place = texCoord + vec2f(cos(angle), sin(angle)) * settings.uPixelSize * radius;
        let tapDepth = depthAt(place);
        var tapSize = getBlurSize(tapDepth);
        if (tapDepth > centerDepth) {
            tapSize = min(tapSize, centerSize * settings.uBehindFactor);
        }
        let m = smoothstep(radius - 0.5, radius + 0.5, tapSize);
        color += mix(color / total, colorAt(place), m);
        total += 1.0;
        radius += settings.uRadScale / radius;
    }
    return color / total;
}

@fragment
fn main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return vec4f(depthOfField(position.xy * settings.uPixelSize), 1.0);
}

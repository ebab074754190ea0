#version 330
// Lens blur, one lens ray of every pixel: N-buffers cut the depths at which it can hit, and a walk from texel to texel
// finds the first surface in each pack of four layers.
//
// Inverse depth is counted in pixels of parallax, u = P E / depth: P pixels per unit at depth 1, E the lens radius. A
// ray is over a + u w [px] at u, and goes from large u, near the lens, down to u = 0. Drawn over the whole picture once
// for every lens point; the host adds the colours up and divides by the sum of their fourth channels.
//
// Source: Lee, Eisemann & Seidel (2010), Real-Time Lens Blur Effects and Focus Control, Section 3; Amanatides & Woo
// (1987), A Fast Voxel Traversal Algorithm for Ray Tracing.

uniform sampler2DArray uPacks;     // u of layers four by four, front to back, float; -infinity is empty
uniform sampler2DArray uColors;    // linear RGB of layers, float
uniform sampler2DArray uExtremes;  // N-buffers of packs: least, greatest; uLevels of one pack, then of the next
uniform int uLevels;
uniform int uBlock;                // side of the N-buffers' blocks [texels]
uniform int uIterations = 3;       // how often the depths are cut
uniform float uFocus;              // u of the focal plane
uniform vec2 uLens;                // lens point on the unit disc, x right, y down
uniform float uExtension;          // how far below a sample the surface before it may be to be the same one [u]
uniform int uLast;                 // layer behind which there may be more, -1: all are here
uniform vec3 uBackground;          // linear RGB

layout(location = 0) out vec4 hit;    // layer, column, row, u; layer -1: the background, -2: not known
layout(location = 1) out vec4 color;  // linear RGB, 1; all 0 if not known
layout(location = 2) out vec4 range;  // near and far end of the depths left of the first pack, and of the last

const float INFINITY = uintBitsToFloat(0x7f800000u);
const float MARGIN = 0.01;       // of a footprint [px]: a ray's place may be rounded across a border
const float STILL = 1e-20;       // a ray slower than this stays in its texel [px per u]
const float SAME_SURFACE = 0.5;  // between neighbouring texels of one surface [u]

// Least and greatest u of a pack between two blocks: four squares that may overlap.
vec2 extremesIn(int pack, ivec2 first, ivec2 last)
{
    int side = max(last.x - first.x, last.y - first.y) + 1, level = 0;
    while ((2 << level) < side)
        ++level;
    ivec2 second = max(last + 1 - (1 << level), first);
    int k = pack * uLevels + level;
    vec2 a = texelFetch(uExtremes, ivec3(first, k), 0).xy;
    vec2 b = texelFetch(uExtremes, ivec3(second.x, first.y, k), 0).xy;
    vec2 c = texelFetch(uExtremes, ivec3(first.x, second.y, k), 0).xy;
    vec2 d = texelFetch(uExtremes, ivec3(second, k), 0).xy;
    return vec2(min(min(a.x, b.x), min(c.x, d.x)), max(max(a.y, b.y), max(c.y, d.y)));
}

// Near and far end of the depths at which rays of the pixel can hit a pack; near < far if they cannot.
vec2 depthsOf(int pack, vec2 center)
{
    vec2 end = vec2(textureSize(uPacks, 0).xy - 1);
    float near = max(texelFetch(uExtremes, ivec3(0, 0, (pack + 1) * uLevels - 1), 0).y, -1.0), far = 0.0;
    for (int n = 0; n < uIterations; ++n) {
        // All rays are within the larger of the circles of confusion at both ends.
        float radius = max(abs(near - uFocus), abs(far - uFocus));
        ivec2 first = ivec2(clamp(center - radius - MARGIN, vec2(0.0), end));
        ivec2 last = ivec2(clamp(center + radius + MARGIN, vec2(0.0), end));
        vec2 found = extremesIn(pack, first / uBlock, last / uBlock);
        if (found.x > found.y)
            return vec2(-1.0, 0.0);
        vec2 cut = vec2(min(near, found.y), max(far, found.x - uExtension));
        if (cut == vec2(near, far))
            break;
        near = cut.x;
        far = cut.y;
    }
    return vec2(near, far);
}

// u at which a ray comes into the picture, -infinity if it never does.
float entryOf(vec2 a, vec2 w)
{
    vec2 size = vec2(textureSize(uPacks, 0).xy);
    float near = INFINITY, far = 0.0;
    for (int k = 0; k < 2; ++k) {
        if (w[k] == 0.0) {
            if (a[k] < 0.0 || a[k] >= size[k])
                return -INFINITY;
            continue;
        }
        float low = -a[k] / w[k], high = (size[k] - a[k]) / w[k];
        near = min(near, max(low, high));
        far = max(far, min(low, high));
    }
    return near >= far ? near : -INFINITY;
}

// The nearest sample of a texel between low and high: its layer; -1 if there is none.
int sampleBetween(ivec2 texel, float low, float high)
{
    for (int k = 0; k < 4 * textureSize(uPacks, 0).z; ++k) {
        float u = texelFetch(uPacks, ivec3(texel, k / 4), 0)[k % 4];
        if (u <= high)
            return u < low ? -1 : k;
    }
    return -1;
}

// The texel along one axis at u = begin; on a border the one that the ray leaves, as the walk's crossings have it.
int startOf(float a, float w, float begin, int size)
{
    int at = int(clamp(a + begin * w, 0.0, float(size - 1)));
    if (abs(w) < STILL)
        return at;
    int pace = w > 0.0 ? -1 : 1;
    float inverse = 1.0 / w, entry = w > 0.0 ? 1.0 : 0.0;
    while (at - pace >= 0 && at - pace < size && (float(at) + entry - a) * inverse <= begin)
        at -= pace;
    while (at + pace >= 0 && at + pace < size && (float(at) + (1.0 - entry) - a) * inverse > begin)
        at += pace;
    return at;
}

// The first sample of a pack that a ray meets from u = begin down to end: slot, -1 for none, its texel, and u.
int walk(int pack, vec2 a, vec2 w, float begin, float end, out ivec2 texel, out float met)
{
    ivec2 size = textureSize(uPacks, 0).xy;
    bvec2 moves = greaterThanEqual(abs(w), vec2(STILL));
    ivec2 pace = ivec2(mix(vec2(0.0), -sign(w), moves));
    vec2 inverse = mix(vec2(0.0), 1.0 / w, moves), ahead = 0.5 * vec2(1 + pace);
    texel = ivec2(startOf(a.x, w.x, begin, size.x), startOf(a.y, w.y, begin, size.y));
    ivec2 before = texel;
    for (bool first = true; ; first = false) {
        vec2 crossings = mix(vec2(-INFINITY), (vec2(texel) + ahead - a) * inverse, moves);
        float crossing = max(crossings.x, crossings.y), leave = max(crossing, end);
        vec4 samples = texelFetch(uPacks, ivec3(texel, pack), 0);
        for (int k = 0; k < 4 && samples[k] >= leave; ++k) {
            met = min(samples[k], begin);
            if (samples[k] <= begin)
                return k;
            // From the side, below the sample: it is met if the surface goes on in the texel before.
            if (!first && sampleBetween(before, samples[k] - uExtension, begin) >= 0)
                return k;
        }
        if (crossing < end)
            return -1;
        before = texel;
        begin = leave;
        texel += crossings.x > crossings.y ? ivec2(pace.x, 0) : ivec2(0, pace.y);
        if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, size)))
            return -1;
    }
}

// Colour of a layer beside the hit sample, or the hit's own where its surface does not go on.
vec3 colorBeside(int layer, ivec2 texel, ivec2 side)
{
    float u = texelFetch(uPacks, ivec3(texel, layer / 4), 0)[layer % 4];
    int other = sampleBetween(side, u - SAME_SURFACE, u + SAME_SURFACE);
    return texelFetch(uColors, other < 0 ? ivec3(texel, layer) : ivec3(side, other), 0).rgb;
}

// Bilinear colour inside the hit's surface; `from` is the place of the hit from the texel's centre [px].
vec3 colorOf(int layer, ivec2 texel, vec2 from)
{
    ivec2 toward = ivec2(from.x > 0.0 ? 1 : -1, from.y > 0.0 ? 1 : -1);
    ivec2 side = clamp(texel + toward, ivec2(0), textureSize(uPacks, 0).xy - 1);
    vec2 share = min(abs(from), 0.5);
    vec3 own = texelFetch(uColors, ivec3(texel, layer), 0).rgb;
    vec3 upper = mix(own, colorBeside(layer, texel, ivec2(side.x, texel.y)), share.x);
    vec3 lower = mix(colorBeside(layer, texel, ivec2(texel.x, side.y)), colorBeside(layer, texel, side), share.x);
    return mix(upper, lower, share.y);
}

void main()
{
    vec2 a = gl_FragCoord.xy - uFocus * uLens, w = uLens, size = vec2(textureSize(uPacks, 0).xy);
    // What a ray met outside the picture is not known: it may have come in behind the surfaces at the border.
    float border = entryOf(a, w);
    if (border < INFINITY && texelFetch(uPacks, ivec3(clamp(a + border * w, vec2(0.0), size - 1.0), 0), 0).r > border)
        border = -INFINITY;

    int layer = -1, packs = textureSize(uPacks, 0).z;
    ivec2 texel = ivec2(0);
    float nearest = -1.0;
    for (int pack = 0; pack < packs; ++pack) {
        vec2 depths = depthsOf(pack, gl_FragCoord.xy);
        range = pack == 0 ? depths.xyxy : vec4(range.xy, depths);
        float begin = min(depths.x, border), end = max(depths.y, nearest), met;
        ivec2 at;
        int slot = begin >= end ? walk(pack, a, w, begin, end, at, met) : -1;
        if (slot >= 0 && met > nearest) {
            layer = 4 * pack + slot;
            nearest = met;
            texel = at;
        }
    }

    // A miss ends outside the picture, or came in behind its border, or ends behind a full stack of layers.
    bool ends = all(greaterThanEqual(a, vec2(0.0))) && all(lessThan(a, size));
    bool full = ends && uLast >= 0 && texelFetch(uPacks, ivec3(a, uLast / 4), 0)[uLast % 4] > 0.0;
    if (layer < 0 && (border < 0.0 || !ends || full)) {
        hit = vec4(-2.0, 0.0, 0.0, 0.0);
        color = vec4(0.0);
        return;
    }
    hit = vec4(layer, texel, nearest);
    color = vec4(layer < 0 ? uBackground : colorOf(layer, texel, a + nearest * w - vec2(texel) - 0.5), 1.0);
}

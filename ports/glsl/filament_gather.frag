#version 330
// Filament, rings of taps: tiles of like circles, background, and foreground. Drawn at half the size.
//
// Circles and distances are in pixels, places in texels of half the size. A circle of n rings, the centre counted, has
// rings that are circle / (n - 1/2) apart.
//
// Source: Filament (2025), filament/src/materials/dof; Abadie (2018), A Life of a Bokeh; Jimenez (2014).

uniform sampler2D uHalf;     // colour and circle with levels 0 .. 3, float; filter linear, wrap clamp to edge
uniform sampler2D uTiles;    // of 8 texels, two rings around: least circle in x, greatest in z; filter nearest
uniform sampler2D uMoved;    // where the centre is moved [distances of rings]: noise, at most 1/2; filter nearest
uniform vec2 uPoints[80];    // unit ring i = 1 .. 4, 8 i points, odd rings from half a step on; y down
uniform int uRings = 5;      // at most, the centre counted

out vec4 fragColor;  // colour times alpha, alpha

int ringsOf(float circle)
{
    return min(uRings, int(ceil(0.5 * circle + 0.5)));
}

int levelOf(float apart)
{
    return apart > 0.0 ? clamp(int(floor(log2(0.5 * apart) + 0.5)), 0, 3) : 0;
}

float lightOf(float circle, int level)
{
    return 32.0 * 32.0 / max(circle * circle, float(2 << level));
}

float reaches(float rho, float circle, int level)
{
    return clamp((circle - rho) / float(1 << level) + 0.5, 0.0, 1.0);
}

vec4 nearestTo(vec2 place, int level)
{
    ivec2 last = (textureSize(uHalf, 0) >> level) - 1;  // some drivers want one level for all pixels of a size
    return texelFetch(uHalf, clamp(ivec2(floor(place / float(1 << level))), ivec2(0), last), level);
}

vec4 alike(vec2 tile, vec2 moved)
{
    float circle = 0.5 * (abs(tile.x) + abs(tile.y));
    int rings = ringsOf(circle);
    float apart = circle / (float(rings) - 0.5);
    float level = float(levelOf(apart));
    vec2 size = vec2(textureSize(uHalf, 0));
    vec2 place = gl_FragCoord.xy + 0.5 * apart * moved;
    vec3 sum = textureLod(uHalf, place / size, level).rgb;
    int k = 0;
    for (int ring = 1; ring < rings; ring++)
        for (int i = 0; i < 8 * ring; i++, k++)
            sum += textureLod(uHalf, (place + 0.5 * apart * float(ring) * uPoints[k]) / size, level).rgb;
    float alpha = clamp(circle - 1.0, 0.0, 1.0);
    return vec4(sum / float(k + 1) * alpha, alpha);
}

vec4 background(float greatest, float circle, vec2 moved)
{
    if (circle <= 1.0)
        return vec4(0.0);
    int rings = ringsOf(greatest);
    float apart = circle / (float(rings) - 0.5);
    int level = levelOf(apart);
    vec2 place = gl_FragCoord.xy + 0.5 * apart * moved;
    vec4 outer = vec4(0.0);      // colour, weight
    float outerCircle = 0.0;     // weighted sum of circles
    for (int ring = rings - 1; ring >= 0; ring--) {
        int count = max(8 * ring, 1);
        float border = apart * (float(ring) + 0.5);
        vec2 reach = ring > 0 ? apart * float(ring) * uPoints[4 * ring * (ring - 1)] : vec2(0.0);
        float rho = length(reach + apart * moved);
        vec4 inner = vec4(0.0);
        float innerCircle = 0.0;
        float missed = 0.0;
        for (int i = 0; i < count; i++) {
            vec2 offset = ring > 0 ? 0.5 * apart * float(ring) * uPoints[4 * ring * (ring - 1) + i] : vec2(0.0);
            vec4 tap = nearestTo(place + offset, level);
            if (tap.a <= 0.0)
                continue;
            float weight = reaches(rho, tap.a, level) * lightOf(tap.a, level);
            float before = ring == rings - 1 ? 1.0 : clamp(tap.a - border + 0.5, 0.0, 1.0);
            missed += before;
            outer += weight * before * vec4(tap.rgb, 1.0);
            inner += weight * (1.0 - before) * vec4(tap.rgb, 1.0);
            outerCircle += weight * before * tap.a;
            innerCircle += weight * (1.0 - before) * tap.a;
        }
        if (inner.a > 0.0) {
            if (outer.a > 0.0) {
                float hidden = 1.0 - missed / float(count);
                float kept = 1.0 - hidden * clamp(outerCircle / outer.a - innerCircle / inner.a, 0.0, 1.0);
                outer *= kept;
                outerCircle *= kept;
            }
            outer += inner;
            outerCircle += innerCircle;
        }
    }
    if (outer.a <= 0.0)
        return vec4(0.0);
    float full = lightOf(circle * (float(rings) + 0.5) / float(rings), level);
    float alpha = clamp(outer.a / full, 0.0, 1.0) * smoothstep(1.0, 2.0, circle);
    return vec4(alpha * outer.rgb / outer.a, alpha);
}

vec4 foreground(float least, float circleHere, vec2 moved, vec4 behind)
{
    int rings = ringsOf(-least);
    float apart = -least / (float(rings) - 0.5);
    int level = levelOf(apart);
    vec2 place = gl_FragCoord.xy + 0.5 * apart * moved;
    vec4 back = vec4(0.0);
    vec4 front = vec4(0.0);
    for (int ring = 0; ring < rings; ring++) {
        int first = 4 * ring * (ring - 1);
        vec2 reach = ring > 0 ? apart * float(ring) * uPoints[first] : vec2(0.0);
        float rho = length(reach + apart * moved);
        int pairs = max(4 * ring, 1);
        for (int i = 0; i < pairs; i++) {
            vec2 offset = ring > 0 ? 0.5 * apart * float(ring) * uPoints[first + i] : vec2(0.0);
            vec4 one = nearestTo(place + offset, level);
            vec4 two = nearestTo(place - offset, level);
            float circle = min(one.a, two.a);
            if (circle >= 0.0)
                continue;
            float weight = min(-circle, 1.0) * reaches(rho, -circle, level) * lightOf(-circle, level);
            if (ring == 0)
                weight *= 0.5;
            float far = clamp(0.5 * (circle - least - 2.0), 0.0, 1.0);
            vec4 both = vec4(one.rgb + two.rgb, 2.0);
            back += weight * far * both;
            front += weight * (1.0 - far) * both;
        }
    }
    float full = lightOf(-least * (float(rings) + 0.5) / float(rings), level);
    full *= float((2 * rings - 1) * (2 * rings - 1));
    float backAlpha = clamp(back.a / full, 0.0, 1.0);
    float frontAlpha = clamp(front.a / full, 0.0, 1.0);
    float alpha = 1.0 - (1.0 - frontAlpha) * (1.0 - backAlpha);
    vec3 color = front.rgb / max(front.a, 1e-30) * frontAlpha;
    color += back.rgb / max(back.a, 1e-30) * backAlpha * (1.0 - frontAlpha);
    if (alpha > 0.0 && alpha < 1.0 && behind.a == 0.0) {
        float filled = max(alpha, clamp(abs(circleHere) - 1.0, 0.0, 1.0));
        color *= filled / alpha;
        alpha = filled;
    }
    return vec4(color, alpha) + (1.0 - alpha) * behind;
}

void main()
{
    ivec2 here = ivec2(gl_FragCoord.xy);
    vec2 tile = texelFetch(uTiles, here / 8, 0).xz;
    vec2 moved = texelFetch(uMoved, here, 0).xy;
    float circle = texelFetch(uHalf, here, 0).a;
    fragColor = vec4(0.0);
    if (max(abs(tile.x), abs(tile.y)) < 1.0)
        return;
    if (tile.y - tile.x <= 0.05 * abs(tile.y)) {
        fragColor = alike(tile, moved);
        return;
    }
    if (tile.y > 0.0)
        fragColor = background(tile.y, abs(circle), moved);
    if (tile.x < 0.0)
        fragColor = foreground(tile.x, circle, moved, fragColor);
}

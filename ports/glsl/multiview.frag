#version 330
// Multiview synthesis, one view: the first surface that the lens ray of every pixel meets in layers of height fields.
//
// Heights are circles of confusion c [px], signed, negative in front of focus. Through lens point v the ray of a pixel
// is over (x - c v.x, y + c v.y) at c, y down. Each texel is a column as high as its surface. In each layer, front to
// back, a ray meets a top, where the texel's height lies on its part inside the texel; or a wall, where it comes into a
// texel below that height, from a texel with a surface that goes on there. Else it passes behind an edge, where the
// surface of the texel that it came from goes on until the ray comes out again. Drawn over the whole picture once for
// every lens point; the host averages the pictures.
//
// Source: Lee, Eisemann & Seidel (2009), Depth-of-Field Rendering with Multiview Synthesis, Section 4.3; here every
// texel under the ray is looked at, in place of a search by false position.

const int MOST = 32;
uniform sampler2DArray uHeights;  // c of every layer [px], front to back, float; infinity is empty
uniform sampler2DArray uColors;   // linear RGB of layers, float
uniform vec2 uEnds[MOST];         // least and greatest c that each layer can hold [px]
uniform vec2 uLens;               // lens point on the unit disc, x right, y up
uniform float uWall = 1.0;        // how far a surface may rise to the next texel [px]; infinite: any wall is surface
uniform vec3 uBackground;         // linear RGB

layout(location = 0) out vec4 hit;    // layer, column, row, c; layer -1: the background
layout(location = 1) out vec4 color;  // linear RGB, 1

const float INFINITY = uintBitsToFloat(0x7f800000u);

float heightAt(int layer, ivec2 texel)
{
    return texelFetch(uHeights, ivec3(texel, layer), 0).r;
}

// Where the ray leaves a texel, at most `last`, and the texel after it. The border's texels are endless: columns left
// of the picture are -1 and right of it `size.x`, rows likewise.
float leave(ivec2 texel, float last, ivec2 size, out ivec2 next)
{
    vec2 v = vec2(uLens.x, -uLens.y);  // down
    vec2 edge = vec2(v.x > 0.0 ? texel.x : texel.x + 1, v.y > 0.0 ? texel.y : texel.y + 1);
    vec2 at = vec2(INFINITY);
    for (int k = 0; k < 2; ++k)
        if (v[k] != 0.0 && !(v[k] > 0.0 && texel[k] < 0) && !(v[k] < 0.0 && texel[k] >= size[k]))
            at[k] = (gl_FragCoord[k] - edge[k]) / v[k];
    ivec2 pace = ivec2(v.x > 0.0 ? -1 : 1, v.y > 0.0 ? -1 : 1);
    next = texel + (at.x <= at.y ? ivec2(pace.x, 0) : ivec2(0, pace.y));
    return min(min(at.x, at.y), last);
}

// Whether a layer or a farther one has a surface between low and high at a texel.
bool goesOn(int layer, ivec2 texel, float low, float high)
{
    for (int k = layer; k < textureSize(uHeights, 0).z && uEnds[k].x <= high; ++k) {
        float height = heightAt(k, texel);
        if (low <= height && height <= high)
            return true;
    }
    return false;
}

// The first hit in one layer: column, row and c; column -1: none.
vec3 walk(int layer)
{
    ivec2 size = textureSize(uHeights, 0).xy;
    float enter = uEnds[layer].x, last = uEnds[layer].y + (uWall < INFINITY ? uWall : 0.0);
    vec2 place = gl_FragCoord.xy - enter * vec2(uLens.x, -uLens.y);
    ivec2 texel = ivec2(floor(clamp(place, vec2(-1.0), vec2(size))));
    ivec2 before = ivec2(-1), seen = ivec2(-1);
    float seenHeight = INFINITY;  // of the texel that the ray was in front of last
    while (true) {
        ivec2 next, here = clamp(texel, ivec2(0), size - 1);
        float leaves = leave(texel, last, size, next), height = heightAt(layer, here);
        if (height >= enter) {
            if (height <= leaves)
                return vec3(here, height);
            seen = here;
            seenHeight = height;
        } else if (before.x < 0 || (here != before && goesOn(layer, before, enter, height + uWall)))
            return vec3(here, enter);
        else if (seenHeight <= leaves)
            return vec3(seen, seenHeight);
        if (leaves >= last)
            return vec3(-1.0, 0.0, last);
        enter = leaves;
        texel = next;
        before = here;
    }
}

void main()
{
    hit = vec4(-1.0, 0.0, 0.0, 0.0);
    color = vec4(uBackground, 1.0);
    for (int layer = 0; layer < textureSize(uHeights, 0).z; ++layer) {
        vec3 found = walk(layer);
        if (found.x >= 0.0) {
            hit = vec4(layer, found);
            color = vec4(texelFetch(uColors, ivec3(found.xy, layer), 0).rgb, 1.0);
            return;
        }
    }
}

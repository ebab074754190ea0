// N-buffer: the least and the greatest depth of squares of pixels, for look-ups of any rectangle.
//
// Level i holds, at every pixel, the extremes of the 2^i x 2^i square whose first pixel that is, cut off at the border
// of the picture; all levels have its size. `bottom` makes level 0 from depth, `double` each next one from the one
// before, until a square covers the picture: 1 + ceil(log2(max(width, height))) levels.
//
// An infinite depth is empty: it is +inf in a minimum and -inf in a maximum, so that where there is nothing the minimum
// is above the maximum. Depths must not be NaN. Only comparisons are made: values are exact.
//
// Source: Decoret (2005), N-Buffers for Efficient Depth Map Query. Squares hang from a corner, not around a centre.

@group(0) @binding(0) var previous: texture_2d<f32>;                            // depth in r, or a level
@group(0) @binding(1) var level: texture_storage_2d<rg32float, write>;          // minimum, maximum
@group(0) @binding(2) var<uniform> side: u32;                                   // of the squares in `previous` [px]

const INFINITY_BITS = 0x7f800000u;

// Infinities are made of bits at run time: WGSL has no literal for them, and takes a constant one for an error.
fn extremes(depth: f32) -> vec2f {
    var bits = INFINITY_BITS;
    if ((bitcast<u32>(depth) & 0x7fffffffu) == bits) {
        return vec2f(bitcast<f32>(bits), bitcast<f32>(bits | 0x80000000u));
    }
    return vec2f(depth);
}

@compute @workgroup_size(8, 8)
fn bottom(@builtin(global_invocation_id) pixel: vec3u) {
    if (any(pixel.xy >= textureDimensions(level))) {
        return;
    }
    textureStore(level, pixel.xy, vec4f(extremes(textureLoad(previous, pixel.xy, 0).r), 0.0, 0.0));
}

// Four squares make one of twice the side. One that reaches the border has no right or lower neighbour that could add
// to it, and the last column or row stands for that.
@compute @workgroup_size(8, 8)
fn double(@builtin(global_invocation_id) pixel: vec3u) {
    let size = textureDimensions(level);
    if (any(pixel.xy >= size)) {
        return;
    }
    let next = min(pixel.xy + side, size - 1u);
    let a = textureLoad(previous, pixel.xy, 0).rg;
    let b = textureLoad(previous, vec2u(next.x, pixel.y), 0).rg;
    let c = textureLoad(previous, vec2u(pixel.x, next.y), 0).rg;
    let d = textureLoad(previous, next, 0).rg;
    let least = min(min(a.x, b.x), min(c.x, d.x));
    let greatest = max(max(a.y, b.y), max(c.y, d.y));
    textureStore(level, pixel.xy, vec4f(least, greatest, 0.0, 0.0));
}

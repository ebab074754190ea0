#version 330
// Cascaded layers, one layer: the parts of peeled surfaces that belong to it, blended over or under a buffer.
//
// A surface's weight is a trapezoid over its depth: 0 up to uAnchors.x, 1 from uAnchors.y to uAnchors.z, and 0 from
// uAnchors.w on; equal anchors are a step. Layer k has z_(k-2) .. z_(k+1), but no layer reaches into the first or the
// last one: 0, 0, z_0, z_1 for the first layer, z_0, z_0, z_1, z_2 for the second, and the same behind, with infinity.
// Buffers are premultiplied. Drawn from one buffer into another.
//
// Source: Schedl & Wimmer (2012), A Layered Depth-of-Field Method for Solving Partial Occlusion, equations (2) to (4),
// (12) and (13); the falling ramp of (4), which is printed upside down, as figure 4(a) has it.

uniform sampler2DArray uSurfaces;  // peeled surfaces, front to back: linear RGB, planar depth [scene units]; < 0: none
uniform sampler2D uBuffer;         // what is blended so far
uniform vec4 uAnchors;             // [scene units]
uniform bool uOver;                // the layer is blended over the buffer, else under it

layout(location = 0) out vec4 result;

// Weight of a surface; what lies behind the first one ends hard, so that no background lies over nearer layers.
float weightOf(float z, bool first)
{
    if (z <= uAnchors.x)
        return 0.0;
    if (z <= uAnchors.y)
        return (z - uAnchors.x) / (uAnchors.y - uAnchors.x);
    if (z <= uAnchors.z)
        return 1.0;
    return first && z < uAnchors.w ? (uAnchors.w - z) / (uAnchors.w - uAnchors.z) : 0.0;
}

// a over b
vec4 over(vec4 a, vec4 b)
{
    return a + (1.0 - a.a) * b;
}

void main()
{
    ivec2 here = ivec2(gl_FragCoord.xy);
    vec4 layer = vec4(0.0);
    for (int m = 0; m < textureSize(uSurfaces, 0).z; ++m) {
        vec4 surface = texelFetch(uSurfaces, ivec3(here, m), 0);
        layer = over(layer, weightOf(surface.a, m == 0) * vec4(surface.rgb, 1.0));  // Eq. (2)
    }
    vec4 buffer = texelFetch(uBuffer, here, 0);
    result = uOver ? over(layer, buffer) : over(buffer, layer);
}

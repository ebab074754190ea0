"""The same stages on Mesa's llvmpipe: shaders and draws for `benchmarks/raster.py`, upload and read-back left out."""

import moderngl
import numpy as np

from tests.gl import shader

__all__ = ["build", "gaussian", "generate", "peel", "query", "reads"]

_HEAD = "#version 330\n"

_BOTTOM = (
    _HEAD
    + """
uniform sampler2D a;
out vec2 c;
void main() { c = texelFetch(a, ivec2(gl_FragCoord.xy), 0).rr; }
"""
)

_DOUBLE = (
    _HEAD
    + """
uniform sampler2D a;
uniform int side;
out vec2 c;
void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy), q = min(p + side, textureSize(a, 0) - 1);
    vec2 s = texelFetch(a, p, 0).rg, t = texelFetch(a, ivec2(q.x, p.y), 0).rg;
    vec2 u = texelFetch(a, ivec2(p.x, q.y), 0).rg, v = texelFetch(a, q, 0).rg;
    c = vec2(min(min(s.r, t.r), min(u.r, v.r)), max(max(s.g, t.g), max(u.g, v.g)));
}
"""
)

_QUERY = (
    _HEAD
    + """
uniform sampler2DArray levels;
uniform sampler2D places;
out vec2 c;
void main()
{
    ivec4 r = ivec4(texelFetch(places, ivec2(gl_FragCoord.xy), 0));
    int longest = max(r.z - r.x, max(r.w - r.y, 1)), level = 0;
    while (longest >> (level + 1) > 0)
        level += 1;
    ivec2 q = max(r.zw + 1 - (1 << level), r.xy);
    vec2 s = texelFetch(levels, ivec3(r.xy, level), 0).rg, t = texelFetch(levels, ivec3(q.x, r.y, level), 0).rg;
    vec2 u = texelFetch(levels, ivec3(r.x, q.y, level), 0).rg, v = texelFetch(levels, ivec3(q, level), 0).rg;
    c = vec2(min(min(s.r, t.r), min(u.r, v.r)), max(max(s.g, t.g), max(u.g, v.g)));
}
"""
)

_READ = (
    _HEAD
    + """
uniform sampler2D image;
uniform sampler2D places;  // u, v, level
out vec4 c;
void main()
{
    vec3 p = texelFetch(places, ivec2(gl_FragCoord.xy), 0).xyz;
    c = textureLod(image, p.xy, p.z);
}
"""
)

_NINE = (
    _HEAD
    + """
uniform sampler2D image;
out vec4 c;
void main()
{
    vec2 texel = 1.0 / vec2(textureSize(image, 0)), centre = gl_FragCoord.xy * 2.0 * texel;
    float side = exp(-0.5);
    c = vec4(0.0);
    for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) {
            float w = (i == 0 ? 1.0 : side) * (j == 0 ? 1.0 : side);
            c += w * textureLod(image, centre + vec2(i, j) * texel, 0.0);
        }
    c /= (1.0 + 2.0 * side) * (1.0 + 2.0 * side);
}
"""
)

_VERTEX = (
    _HEAD
    + """
uniform vec4 scale;  // of x, y; depth: (a z + b) / -z
in vec3 position;
out vec3 place;
void main()
{
    place = position;
    gl_Position = vec4(position.xy * scale.xy, scale.z * position.z + scale.w, -position.z);
}
"""
)

_SURFACE = (
    _HEAD
    + """
uniform sampler2D last;
uniform bool peeling;
in vec3 place;
out vec4 c;
void main()
{
    if (peeling && -place.z <= texelFetch(last, ivec2(gl_FragCoord.xy), 0).z)
        discard;
    c = vec4(place.xy, -place.z, gl_PrimitiveID);
}
"""
)


def build(context, depth, count):
    """Draws that make both sides of an N-buffer."""
    bottom = shader.new_pass(context, _BOTTOM, depth.shape, components=2)
    source = shader.texture_of(context, depth, linear=False)
    passes = [shader.new_pass(context, _DOUBLE, depth.shape, components=2) for _ in range(count - 1)]

    def run():
        shader.draw(bottom, {"a": source})
        before = bottom
        for level, work in enumerate(passes):
            shader.draw(work, {"a": before.target.color_attachments[0]}, side=1 << level)
            before = work

    return run


def query(context, nbuffer, rectangles):
    """One draw that answers a rectangle per pixel: rectangles (H, W, 4)."""
    pairs = np.ascontiguousarray(np.stack([nbuffer.lowest, nbuffer.highest], axis=-1), dtype="f4")
    levels = context.texture_array((nbuffer.width, nbuffer.height, len(pairs)), 2, pairs.tobytes(), dtype="f4")
    levels.filter = (moderngl.NEAREST, moderngl.NEAREST)
    work = shader.new_pass(context, _QUERY, rectangles.shape[:2], components=2)
    places = shader.texture_of(context, rectangles, linear=False)
    return lambda: shader.draw(work, {"levels": levels, "places": places})


def generate(context, image):
    """glGenerateMipmap."""
    height, width = image.shape[:2]
    texture = context.texture((width, height), 4, image.tobytes(), dtype="f4")

    def run():
        texture.build_mipmaps(0, max(height, width).bit_length() - 1)
        context.finish()

    return run


def reads(context, levels, places):
    """One draw of textureLod at places (H, W, 4): u, v, level."""
    work = shader.new_pass(context, _READ, places.shape[:2])
    at, chain = shader.texture_of(context, places, linear=False), shader.chain_of(context, levels)
    return lambda: shader.draw(work, {"image": chain, "places": at})


def gaussian(context, image, count):
    """Draws of the first `count` coarser levels."""
    sources, passes = [shader.texture_of(context, image, linear=True)], []
    for level in range(1, count + 1):
        work = shader.new_pass(context, _NINE, (len(image) >> level, len(image) >> level))
        texture = work.target.color_attachments[0]
        texture.repeat_x = texture.repeat_y = False
        passes.append(work)
        sources.append(texture)

    def run():
        for work, texture in zip(passes, sources, strict=False):
            shader.draw(work, {"image": texture})

    return run


def peel(context, vertices, faces, camera, count):
    """Draws of the nearest `count` layers: camera-space place and triangle of every pixel."""
    program = context.program(vertex_shader=_VERTEX, fragment_shader=_SURFACE)
    near, far = 1e-2, float(np.abs(vertices).max()) * 2.0
    along = 2.0 * camera.pixels_per_tangent
    program["scale"] = (
        along / camera.width, along / camera.height, -(far + near) / (far - near), -2.0 * far * near / (far - near)
    )  # fmt: skip
    corners = context.buffer(np.ascontiguousarray(vertices, dtype="f4").tobytes())
    triangles = context.vertex_array(
        program, [(corners, "3f", "position")], context.buffer(np.ascontiguousarray(faces, dtype="i4").tobytes())
    )
    size = camera.width, camera.height
    targets = [
        context.framebuffer([context.texture(size, 4, dtype="f4")], context.depth_renderbuffer(size))
        for _ in range(count)
    ]

    def run():
        context.enable(moderngl.DEPTH_TEST)
        for layer, target in enumerate(targets):
            if layer:
                targets[layer - 1].color_attachments[0].use(0)
            program["last"], program["peeling"] = 0, layer > 0
            target.use()
            target.clear()
            triangles.render(moderngl.TRIANGLES)
            context.finish()
        context.disable(moderngl.DEPTH_TEST)

    return run

"""Texture filters and mip chains against Mesa's llvmpipe."""

import moderngl
import numpy as np
import pytest

from refdof.methods.multiview.coverage import coverage_mipmaps
from refdof.raster.filters.mip_chain import generate_mipmaps
from refdof.raster.gpu.gpu_model import LLVMPIPE
from refdof.raster.gpu.texture import bilinear, fetch, level_of_detail, trilinear
from tests.gl import shader

pytestmark = pytest.mark.gl

READ = """
#version 330
uniform sampler2D image;
uniform sampler2D places;  // u, v, level
out vec4 c;
void main()
{
    vec3 p = texelFetch(places, ivec2(gl_FragCoord.xy), 0).xyz;
    c = textureLod(image, p.xy, p.z);
}
"""

FETCH = """
#version 330
uniform sampler2D image;
uniform sampler2D places;  // x, y, level
out vec4 c;
void main()
{
    ivec3 p = ivec3(texelFetch(places, ivec2(gl_FragCoord.xy), 0).xyz);
    c = texelFetch(image, p.xy, p.z);
}
"""

# A read whose place and level come from another read, blended with a third.
CHAIN = """
#version 330
uniform sampler2D image;
uniform sampler2D places;
out vec4 c;
void main()
{
    vec2 p = texelFetch(places, ivec2(gl_FragCoord.xy), 0).xy;
    vec4 a = textureLod(image, p, 0.0);
    c = textureLod(image, p + a.xy * 0.25, a.z * 4.0) + textureLod(image, p - a.yz * 0.5, a.x) * a.w;
}
"""


def texels(shape, dtype, seed=31):
    random = np.random.default_rng(seed)
    if dtype == np.uint8:
        return random.integers(0, 256, (*shape, 4), dtype=np.uint8)
    values = random.normal(size=(*shape, 4)) * 10.0 ** random.uniform(-3, 3, (*shape, 4))
    return values.astype(np.float32)


def places(count=65536):
    """u, v and level, with many on texel centres, on borders of texels, on whole levels, and outside."""
    random = np.random.default_rng(32)
    uv = random.uniform(-0.3, 1.3, (count, 2))
    uv[: count // 4] = random.integers(-4, 70, (count // 4, 2)) / 64
    level = random.uniform(-1, 8, count)
    level[::5] = np.rint(level[::5] * 2) / 2
    return np.column_stack([uv, level, np.zeros(count)]).astype(np.float32).reshape(256, -1, 4)


def run(context, fragment, levels, at):
    work = shader.new_pass(context, fragment, at.shape[:2])
    shader.draw(
        work, {"image": shader.chain_of(context, levels), "places": shader.texture_of(context, at, linear=False)}
    )
    return shader.read(work)


def assert_same(seen, ours):
    same = seen.view(np.uint32) == ours.view(np.uint32)
    print(f"{same.size} values, {(~same).sum()} differ")
    assert same.all(), [(tuple(w), seen[tuple(w)], ours[tuple(w)]) for w in np.argwhere(~same)[:6]]


every_type = pytest.mark.parametrize("dtype", [np.float32, np.uint8])


@every_type
@pytest.mark.parametrize("shape", [(64, 64), (37, 53), (5, 128), (1, 7)])
def test_texture_lod(context, dtype, shape):
    levels = generate_mipmaps(texels(shape, dtype), LLVMPIPE)
    at = places()
    seen = run(context, READ, levels, at)
    assert_same(seen, trilinear(levels, at[..., 0], at[..., 1], at[..., 2], LLVMPIPE))
    flat = np.where(np.arange(4) == 2, np.float32(0), at)
    assert_same(run(context, READ, levels, flat), bilinear(levels[0], at[..., 0], at[..., 1], LLVMPIPE))


@every_type
def test_texel_fetch(context, dtype):
    levels = generate_mipmaps(texels((20, 30), dtype), LLVMPIPE)
    random = np.random.default_rng(33)
    at = random.integers(-3, 34, (64, 64, 4)).astype(np.float32)
    for level, image in enumerate(levels):
        at[..., 2] = level
        x, y = at[..., 0].astype(int), at[..., 1].astype(int)
        assert_same(run(context, FETCH, levels, at), fetch(image, x, y, LLVMPIPE))


@every_type
def test_a_chain_of_reads(context, dtype):
    image = texels((24, 40), dtype)
    if dtype == np.float32:
        image = np.random.default_rng(35).random(image.shape, dtype=np.float32)
    levels = generate_mipmaps(image, LLVMPIPE)
    at = places()
    u, v = at[..., 0], at[..., 1]
    a = bilinear(levels[0], u, v, LLVMPIPE)
    quarter, half = np.float32(0.25), np.float32(0.5)
    there = trilinear(levels, u + a[..., 0] * quarter, v + a[..., 1] * quarter, a[..., 2] * np.float32(4), LLVMPIPE)
    back = trilinear(levels, u - a[..., 1] * half, v - a[..., 2] * half, a[..., 0], LLVMPIPE)
    assert_same(run(context, CHAIN, levels, at), there + back * a[..., 3:])


@pytest.mark.parametrize("level", [0.0, 2.0, 0.25, 1.75])
def test_infinite_texels_and_nan(context, level):
    levels = [texels((16 >> k, 16 >> k), np.float32, seed=k) for k in range(4)]
    for image in levels[:3]:
        image[1, 1:3], image[3, 2], image[2, 2], image[0, 0] = np.inf, -np.inf, np.nan, -np.inf
    at = places()
    at[..., 2] = level
    ours = trilinear(levels, at[..., 0], at[..., 1], at[..., 2], LLVMPIPE)
    assert np.isnan(ours).any()
    assert np.array_equal(run(context, READ, levels, at), ours, equal_nan=True)


@every_type
def test_a_border(context, dtype):
    levels = generate_mipmaps(texels((37, 53), dtype), LLVMPIPE)
    at, color = places(), (0.2, -1.5, 30.0, 0.25)
    sampler = context.sampler(filter=(moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR))
    sampler.border_color = color
    sampler.use(0)
    try:
        seen = run(context, READ, levels, at)
    finally:
        sampler.clear(0)
    assert_same(seen, trilinear(levels, at[..., 0], at[..., 1], at[..., 2], LLVMPIPE, border=color))


def test_level_of_detail(context):
    levels = [np.full((256 >> k, 256 >> k, 4), k, dtype=np.float32) for k in range(9)]  # a read gives its own level
    read = (
        "#version 330\nuniform sampler2D image; uniform vec4 d; out vec4 c;"
        "void main() { c = texture(image, vec2(dot(gl_FragCoord.xy, d.xy), dot(gl_FragCoord.xy, d.zw))); }"
    )
    work = shader.new_pass(context, read, (4, 4))
    texture = shader.chain_of(context, levels)
    for ux, uy, vx, vy in [
        (3, 0, 0, 1),
        (1.5, 0, 0, 1.5),
        (7.3, 0, 1, 2),
        (1, 1, -1, 1),
        (2, 40, 0, 33),
        (200, 0, 0, 1),
    ]:
        shader.draw(work, {"image": texture}, d=(ux / 256, uy / 256, vx / 256, vy / 256))
        ours = level_of_detail(max(ux * ux + vx * vx, uy * uy + vy * vy), LLVMPIPE)
        # Derivatives are differences of coordinates of at most seven footprints, with two roundings each: relative
        # 14 x 2^-23, of which log2 makes at most 1.5 times that; levels up to 8 are rounded to 2^-21.
        assert np.abs(shader.read(work) - ours).max() <= 4e-6


@every_type
@pytest.mark.parametrize(
    "shape", [(64, 64), (16, 128), (2, 32), (96, 64), (600, 800), (37, 53), (7, 64), (101, 3), (1, 5), (3, 4099)]
)
def test_generated_mipmaps(context, dtype, shape):
    ours = generate_mipmaps(texels(shape, dtype), LLVMPIPE)
    seen = shader.generated(context, ours[0])
    assert len(seen) == len(ours)
    for a, b in zip(seen, ours, strict=True):
        assert a.shape == b.shape
        assert np.array_equal(a, b)


@pytest.mark.parametrize("bias", [-1.5, 0.25, 3.0])
def test_bias_is_added_to_the_level(context, bias):
    levels = [np.full((256 >> k, 256 >> k, 4), k, dtype=np.float32) for k in range(9)]  # a read gives its own level
    read = (
        "#version 330\nuniform sampler2D image; uniform float bias; out vec4 c;"
        "void main() { c = texture(image, gl_FragCoord.xy * (7.3 / 256.0), bias); }"
    )
    work = shader.new_pass(context, read, (4, 4))
    shader.draw(work, {"image": shader.chain_of(context, levels)}, bias=bias)
    ours = np.clip(level_of_detail(7.3**2, LLVMPIPE, bias=bias), 0, 8)
    assert np.abs(shader.read(work) - ours).max() <= 4e-6  # as in test_level_of_detail


def test_a_chain_of_coverage(context):
    random = np.random.default_rng(36)
    color, covered = random.random((32, 64, 3), dtype=np.float32), random.random((32, 64)) < 0.4
    levels = coverage_mipmaps(color, covered, LLVMPIPE)
    for seen, ours in zip(shader.generated(context, levels[0]), levels, strict=True):
        assert_same(seen, ours)

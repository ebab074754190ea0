"""Single pass against the article's listing as a fragment shader, on Mesa's llvmpipe."""

import numpy as np
import pytest

from refdof import View, load_scene
from refdof.methods.singlepass import Params, blur, bounds, spiral
from tests.gl import shader
from tests.gl import singlepass as listing

pytestmark = pytest.mark.gl

# Values in [0, 1]. Texture coordinates near 1 are rounded to 2^-24, 1e-5 px of 160; smoothstep has a slope of 1.5 and
# the first tap a share of 1/2. Outer taps are up to 0.0004 px off (angles added up in single precision), with shares
# of 1/100 and less and errors of either sign. 398 sums in single precision add about 1e-6.
TOLERANCE = 2e-5


@pytest.fixture(scope="module")
def fence():
    """Linear colour clipped to [0, 1], depth and circles of confusion of a built-in scene, 160 x 120."""
    scene = load_scene("fence")
    view = View(scene, scene.camera.with_size((160, 120)), scene.lens)
    pinhole = view.pinhole()
    return (
        np.clip(pinhole.color, 0.0, 1.0),
        pinhole.depth.astype(np.float32),
        (4.0 * view.coc_px()).astype(np.float32),  # both sides of the focal plane, up to 20 px
    )


def noise(height, width):
    """Nothing is like its neighbour: background and both signs up to 25 px anywhere."""
    random = np.random.default_rng(11)
    depth = np.where(random.random((height, width)) < 0.1, np.inf, random.uniform(1.0, 4.0, (height, width)))
    coc = random.uniform(-25.0, 25.0, (height, width))
    return tuple(a.astype(np.float32) for a in (random.random((height, width, 3)), depth, coc))


def hills(height, width):
    """Noise painted on a smooth surface through the focal plane; sizes change by at most 1.5 px from one texel
    to the next, so that a tap's error of position stays one of size.
    """
    color, _, _ = noise(height, width)
    y, x = np.indices((height, width))
    coc = 12.0 * np.sin(x / 13.0) * np.cos(y / 17.0) + 4.0 * np.sin((x + y) / 9.0)
    depth = 1.0 / (0.5 - 0.02 * coc)
    return color, depth.astype(np.float32), coc.astype(np.float32)


def difference(context, image, depth_filter):
    """Largest difference of a channel, per pixel."""
    work, textures, uniforms = listing.upload(context, *image, depth_filter)
    shader.draw(work, textures, **uniforms)
    result = shader.read(work)
    assert (result[..., 3] == 398).all()  # taps
    return np.abs(result[..., :3] - blur(*image, Params(depth_filter))).max(axis=-1)


def foreign(context, shape):
    return listing.foreign_taps(context, shape, np.floor(spiral()[:, :2] + 0.5))


def test_a_shader_reads_what_was_uploaded(context):
    image = np.random.default_rng(12).random((5, 7, 4), dtype=np.float32)
    copy = (
        "#version 330\nuniform sampler2D a; out vec4 c; void main() { c = texelFetch(a, ivec2(gl_FragCoord.xy), 0); }"
    )
    work = shader.new_pass(context, copy, (5, 7))
    shader.draw(work, {"a": shader.texture_of(context, image, linear=False)})
    assert np.array_equal(shader.read(work), image)


def test_the_listing_on_a_scene(context, fence):
    assert np.abs(fence[2]).max() > 15.0
    strange = foreign(context, (120, 160)) > 0
    # The first tap lies half a pixel to the right, on the border of two texels: where 1 / 160 and its multiples round
    # down, the shader reads depth at the pixel itself. One column of 160; all other taps are the same.
    print(f"{strange.sum()} of {strange.size} pixels have a tap on another texel")
    assert strange.mean() <= 0.02
    assert difference(context, fence, "nearest")[~strange].max() <= TOLERANCE


def test_the_listing_on_noise(context):
    # In steps of 1 / 128 every coordinate along x is exact: all taps of all pixels are compared.
    assert not foreign(context, (96, 128)).any()
    assert difference(context, noise(96, 128), "nearest").max() <= TOLERANCE


@pytest.mark.parametrize("size", [(320, 240), (317, 239)])
def test_the_listing_is_within_its_bounds_at_sizes_with_ties(context, size):
    width, height = size
    image = noise(height, width)
    work, textures, uniforms = listing.upload(context, *image, "nearest")
    shader.draw(work, textures, **uniforms)
    result = shader.read(work)[..., :3]
    found = bounds(*image)
    assert (result >= found.low - TOLERANCE).all()
    assert (result <= found.high + TOLERANCE).all()
    off = np.abs(result - blur(*image)).max(axis=-1)
    print(f"{(off > TOLERANCE).mean():.4f} of the pixels differ from one picture alone, by up to {off.max():.3f}")
    assert off.max() > 100 * TOLERANCE
    assert off[~found.ambiguity].max() <= TOLERANCE


def test_filtered_depth_on_a_scene(context, fence):
    assert difference(context, fence, "bilinear").max() <= TOLERANCE


def test_filtered_depth_on_hills(context):
    assert difference(context, hills(120, 160), "bilinear").max() <= TOLERANCE

"""Mipmap interpolation against its fragment shaders on Mesa's llvmpipe."""

import numpy as np
import pytest

from refdof import View, load_scene
from refdof.methods.mipmap import Params, blur
from refdof.methods.mipmap.method import _last_level
from tests.gl import mipmap as shaders
from tests.gl import shader

pytestmark = pytest.mark.gl

# Values in [0, 1]. Texture coordinates are rounded to 2^-24 of the picture, 1e-5 px of 160, in the levels, the circle
# and nine reads; llvmpipe's log2 is off by up to 6e-7 levels, which counts for less.
TOLERANCE = 3e-5


def differences(context, color, depth, coc, short):
    """Largest difference of a channel per pixel, and the number of levels."""
    height, width = coc.shape
    last = _last_level(float(np.abs(coc).max()), width, height)
    work = shaders.upload(context, color, coc, last, short=short)
    shaders.draw_levels(work)
    shaders.draw_picture(work, shaders.chains(work))
    picture = shader.read(work.picture)[..., :3]
    return np.abs(picture - blur(color, depth, coc, Params(depth_format="f16" if short else "f32"))).max(axis=-1), last


def scene_images(name, width, height):
    scene = load_scene(name)
    view = View(scene, scene.camera.with_size((width, height)), scene.lens)
    pinhole = view.pinhole()
    return np.clip(pinhole.color, 0.0, 1.0), pinhole.depth, (3.0 * view.coc_px()).astype(np.float32)


@pytest.mark.parametrize("size", [(160, 120), (127, 97)])
@pytest.mark.parametrize("name", ["cans", "atrium"])
def test_the_shaders_on_scenes(context, name, size):
    difference, last = differences(context, *scene_images(name, *size), short=False)
    assert last >= 3
    # A tap whose blur differs from its centre's by delta to the last bit may fall on either side in (9).
    print(f"{name}: largest difference {difference.max():.1e}, {(difference > TOLERANCE).sum()} pixels above the bound")
    assert (difference > TOLERANCE).mean() <= 0.002


def test_the_shaders_on_noise(context):
    random = np.random.default_rng(13)
    color, coc = random.random((96, 128, 3), dtype=np.float32), random.uniform(-25.0, 25.0, (96, 128))
    difference, _ = differences(context, color, np.ones((96, 128)), coc.astype(np.float32), short=False)
    assert difference.max() <= TOLERANCE


@pytest.mark.parametrize("name", ["cans", "atrium"])
def test_render_targets_of_16_bits(context, name):
    difference, _ = differences(context, *scene_images(name, 160, 120), short=True)
    # The last bit of a float32 decides, now and then, between two neighbours 2^-11 apart.
    assert np.quantile(difference, 0.95) <= TOLERANCE
    assert difference.max() <= 0.02

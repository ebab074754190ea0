"""Poisson disc filter against its fragment shader on Mesa's llvmpipe."""

import numpy as np
import pytest

from refdof.methods import poisson
from tests.gl import poisson as listing
from tests.gl import shader

pytestmark = pytest.mark.gl


def test_the_shader_on_noise(context):
    random = np.random.default_rng(14)
    color = random.random((96, 128, 3), dtype=np.float32)
    coc = random.uniform(-6.0, 6.0, (96, 128)).astype(np.float32)
    params = poisson.Params(code="thin_lens")
    coded = np.concatenate([color, poisson.code_of(np.ones_like(coc), coc, params)[..., None]], axis=-1).astype(
        np.float32
    )
    work, textures, uniforms = listing.upload(context, coded, poisson.shrink(coded), poisson.TAPS, 5.0)
    shader.draw(work, textures, **uniforms)
    difference = np.abs(shader.read(work)[..., :3] - poisson.blur(color, np.ones_like(coc), coc, params)).max(axis=-1)
    # Values in [0, 1] differ from texel to texel by up to 1, and places are rounded to 1e-5 px: as much in 12 reads.
    # A tap whose code is its centre's to the last bit may count or not; noise has hardly any.
    assert (difference > 5e-5).sum() <= 2

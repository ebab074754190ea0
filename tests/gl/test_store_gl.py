"""Stores to render targets against Mesa's llvmpipe, bit for bit."""

import numpy as np
import pytest

from refdof.raster.gpu.gpu_model import LLVMPIPE, store
from tests.gl import shader

pytestmark = pytest.mark.gl

COPY = """
#version 330
uniform sampler2D a;
out vec4 c;
void main() { c = texelFetch(a, ivec2(gl_FragCoord.xy), 0); }
"""

# OpenGL's name and the number of channels of each format
TARGETS = {
    "f16": (0x881A, 4),  # RGBA16F
    "unorm8": (0x8058, 4),  # RGBA8
    "unorm16": (0x805B, 4),  # RGBA16
    "r11g11b10f": (0x8C3A, 3),
}


def interesting():
    """Specials, every float16 and the halves between, every 16-bit step and the halves between, any bit pattern."""
    half = np.arange(0x7C00, dtype=np.uint16).view(np.float16).astype(np.float32)
    between = (half[:-1] + half[1:]) / 2  # exact: float16 has 13 bits fewer
    eleven = half.reshape(-1, 16)[:, 0]
    middle = (eleven[:-1] + eleven[1:]) / 2
    steps = (np.arange(0, 2 * 65535 + 3) / (2 * 65535)).astype(np.float32)
    eight = (np.arange(0, 513) / 510).astype(np.float32)
    positive = np.concatenate([half, between, eleven, middle, steps, eight])
    around = [positive, np.nextafter(positive, np.float32(0)), np.nextafter(positive, np.float32(np.inf))]
    tiny = np.arange(1, 2000, dtype=np.uint32).view(np.float32)  # float32 denormals
    big = np.float32([64512, 65024, 65503, 65504, 65519, 65520, 65535, 65536, 1e30, 3.4028235e38, np.inf])
    with np.errstate(invalid="ignore"):
        random = np.random.default_rng(21).integers(0, 1 << 32, 200_000, dtype=np.uint32).view(np.float32)
    signed = np.concatenate([*around, tiny, big])
    return np.concatenate([signed, -signed, [np.float32(np.nan)], random])


@pytest.mark.parametrize("name", TARGETS)
def test_store_is_that_of_llvmpipe(context, name):
    number, channels = TARGETS[name]
    values = interesting()
    width = 1024
    rows = -(-len(values) // width)
    image = np.resize(values, (rows, width))
    image = np.stack([np.roll(image, k, axis=1) for k in range(4)], axis=-1)
    seen = shader.stored(context, COPY, image, number)[..., :channels]
    ours = store(np.ascontiguousarray(image[..., :channels]), name, LLVMPIPE)
    same = (seen.view(np.uint32) == ours.view(np.uint32)) | (np.isnan(seen) & np.isnan(ours))
    wrong = np.argwhere(~same)
    print(f"{name}: {same.size} values, {len(wrong)} differ")
    assert not len(wrong), [(image[tuple(w)], seen[tuple(w)], ours[tuple(w)]) for w in wrong[:8]]

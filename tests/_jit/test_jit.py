"""Compiled helpers do what they say; tasks and their progress."""

import re
import time
from pathlib import Path

import numpy as np
import pytest

from refdof import _jit
from refdof._jit import row_registers, tap_registers, texel_registers, texel_sums

pytestmark = pytest.mark.fast

PACKAGE = Path(_jit.__file__).parents[1]
ROOT = Path(__file__).parents[2]


def test_tasks_report_progress_and_pass_errors_on():
    seen = []
    out = np.zeros(10)
    _jit.run_tasks(lambda k: out.__setitem__(k, k * k), range(10), lambda done, count: seen.append((done, count)))
    assert out.tolist() == [k * k for k in range(10)]
    assert seen[-1] == (10, 10)

    def fail(k):
        raise ValueError(k)

    with pytest.raises(ValueError, match="3"):
        _jit.run_tasks(fail, [3])


def test_an_interrupt_ends_after_the_running_jobs():
    ran = []

    def stop(done, count):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        _jit.run_tasks(lambda k: (time.sleep(0.01), ran.append(k)), range(1000), stop)
    assert len(ran) < 900  # all of them would take seconds


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_a_weighed_blend_is_added_to_its_row_alone(dtype):
    # All numbers are binary fractions: no rounding, in float64.
    texels = (np.random.default_rng(4).integers(0, 256, (7, 4)) / 256.0).astype(dtype)
    sums = np.arange(12.0).reshape(3, 4)
    a, b, c, d = texels[[2, 3, 5, 6]].astype(float)
    expected = sums.copy()
    expected[1] += 3.0 * (0.5 * (0.75 * a + 0.25 * b) + 0.5 * (0.75 * c + 0.25 * d))
    add(sums, 1, 3.0, texels, 2, 3, 5, 6, dtype(0.25), dtype(0.5))
    np.testing.assert_array_equal(sums, expected)
    added = expected[1] - np.arange(4.0, 8.0)
    add_twice(sums, 1, (1.5, -3.0), texels, 2, 3, 5, 6, dtype(0.25), dtype(0.5))
    expected[1] += added / 2
    expected[2] -= added
    np.testing.assert_array_equal(sums, expected)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_weighed_pairs_are_added_to_their_row_alone(dtype):
    # Binary fractions, as above.
    random = np.random.default_rng(5)
    wide, narrow, weights = ((random.integers(0, 64, (n, c)) / 64.0).astype(dtype) for n, c in ((7, 8), (7, 4), (2, 8)))
    sums = np.arange(24.0).reshape(3, 8).astype(dtype)
    expected = sums.astype(float)
    for k, texels in ((1, wide.astype(float)), (2, np.tile(narrow.astype(float), 2))):
        pairs = 0.75 * texels[2] + 0.25 * texels[3] + 0.5 * texels[5] + 0.5 * texels[6]
        expected[k] += weights[1].astype(float) * pairs
    add_two_pairs(sums, weights, wide, narrow, dtype(0.25), dtype(0.5))
    np.testing.assert_array_equal(sums, expected)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_weighed_texels_are_the_sum_of_each_channel(dtype):
    texels, weights = np.random.default_rng(2).random((7, 4)).astype(dtype), tuple(dtype(k) for k in (0.5, 2, 3))
    found = weigh(texels, (6, 0, 3), weights)
    expected = np.array([0.5, 2.0, 3.0]) @ texels[[6, 0, 3]].astype(float)
    np.testing.assert_allclose(found, expected, rtol=8 * np.finfo(dtype).eps)  # five roundings


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("size", [(1, 1), (1, 5), (4, 1), (6, 7)])
def test_a_circle_is_nine_bilinear_reads_cut_at_the_border(size, dtype):
    height, width = size
    texels = np.random.default_rng(3).random((2 + height * width + 1, 4)).astype(dtype)
    level = texels[2:-1].astype(float).reshape(height, width, 4)
    near, side, far = 0.25, 0.125, 0.0625
    for u, v, a, b in [(3.25, 2.5, 1.5, 0.75), (0.5, 0.5, 0.0, 0.0), (7.0, 6.0, 2.0, 9.0), (0.0, 1.25, 1.0, 0.5)]:
        found = circle(texels, 2, width, height, *map(dtype, (u, v, a, b)), tuple(map(dtype, (near, side, far))))
        expected = near * bilinear(level, u, v)
        for x, y in [(1, 0), (-1, 0), (0, 1), (0, -1)]:
            expected += side * bilinear(level, u + x * a, v + y * b)
        for x, y in [(1, 1), (-1, 1), (1, -1), (-1, -1)]:
            expected += far * bilinear(level, u + x * a * np.sqrt(0.5), v + y * b * np.sqrt(0.5))
        # Places of a few texels in a type of 24 or 53 bits, neighbours that differ by up to 1.
        np.testing.assert_allclose(found, expected[:3], rtol=0, atol=20 * np.finfo(dtype).eps)


def bilinear(level, u, v):
    """Clamped to the edge, with tents of one texel."""
    y, x = (np.clip(place - 0.5, 0, side - 1) for place, side in zip((v, u), level.shape, strict=False))
    rows, columns = (np.maximum(0, 1 - abs(np.arange(n) - at)) for at, n in ((y, level.shape[0]), (x, level.shape[1])))
    return np.einsum("y,x,yxc->c", rows, columns, level)


@_jit.tile_kernel
def add(sums, k, weight, texels, a, b, c, d, across, down):
    texel_sums.add_blend(sums, k, weight, texels, a, b, c, d, across, down)


@_jit.tile_kernel
def add_twice(sums, k, weights, texels, a, b, c, d, across, down):
    texel_sums.add_blend_twice(sums, k, weights, texels, a, b, c, d, across, down)


@_jit.tile_kernel
def add_two_pairs(sums, weights, wide, narrow, s, t):
    texel_sums.add_pairs(sums, 1, weights, 1, wide, 2, 3, 5, 6, s, t)
    texel_sums.add_pairs_of_four(sums, 2, weights, 1, narrow, 2, 3, 5, 6, s, t)


@_jit.tile_kernel
def weigh(texels, places, weights):
    return texel_registers.weigh_texels(texels, places, weights)


@_jit.tile_kernel
def circle(texels, start, width, height, u, v, a, b, shares):
    return texel_registers.read_circle(texels, start, width, height, u, v, a, b, shares)


@_jit.tile_kernel
def add_two_taps(sharp, soft, strides, firsts, weights, own, sums, k):
    tap_registers.add_two_taps(sharp, soft, strides, firsts, weights, own, sums, k)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("center", [0.0, 0.45, 1.0])
def test_two_taps_are_blended_by_their_blur_and_weighed(center, dtype):
    random = np.random.default_rng(5)
    sharp, soft = random.random((12, 4)).astype(dtype), random.random((9, 4)).astype(dtype)
    sharp[7:9, 3] = center
    firsts = np.array([[0, 0, 6, 0], [0, 4, 0, 0]])  # pictures of 4 and 3 columns
    weights = random.random((4, 4)).astype(dtype)
    sums = np.ones((4, 4), dtype)
    add_two_taps(sharp, soft, (4, 3), 4 * firsts, weights, 7, sums, 1)
    for k in (1, 2):
        high, low = (
            (1 - w[1]) * ((1 - w[0]) * texels[a] + w[0] * texels[a + 1])
            + w[1] * ((1 - w[0]) * texels[a + stride] + w[0] * texels[a + stride + 1])
            for texels, stride, a, w in (
                (sharp, 4, firsts[0, k], weights[:2, k]),
                (soft, 3, firsts[1, k], weights[2:, k]),
            )
        )
        blur = abs(2 * high[3] - 1)
        mixed = (1 - blur) * high + blur * low
        weight = 1 if mixed[3] >= center else abs(2 * mixed[3] - 1)
        np.testing.assert_allclose(sums[k], 1 + weight * np.array([*mixed[:3], 1]), rtol=20 * np.finfo(dtype).eps)
    np.testing.assert_array_equal(sums[[0, 3]], 1)


@_jit.tile_kernel
def blend_rows(texels, across, down, share, out):
    texel_registers.blend_to(texels, 0, 1, 2, 3, across, down, out, 0)
    texel_registers.blend_over(texels, 0, 1, 2, 3, across, down, share, out, 1)
    row_registers.blend_pair(texels, 2, 1, across, out, 2)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_blends_are_written_and_laid_over(dtype):
    texels, out = np.random.default_rng(6).random((4, 4)).astype(dtype), np.full((3, 4), 2.0, dtype)
    blend_rows(texels, dtype(0.25), dtype(0.5), dtype(0.75), out)
    expected = np.array([0.375, 0.125, 0.375, 0.125]) @ texels.astype(float)
    pair = np.array([0.0, 0.25, 0.75, 0.0]) @ texels.astype(float)
    np.testing.assert_allclose(out, [expected, 0.5 + 0.75 * expected, pair], rtol=16 * np.finfo(dtype).eps)


def test_passes_for_kernels_take_the_tests_of_every_room_that_has_some():
    listed = (ROOT / ".ci/kernel_rooms").read_text().split()
    assert all((ROOT / name).exists() for name in listed)
    made = re.compile(r"^@(?:_jit\.)?(?:kernel|tile_kernel|inline)\b", re.MULTILINE)
    rooms = {path.relative_to(PACKAGE).parent for path in PACKAGE.rglob("*.py") if made.search(path.read_text())}
    assert len(rooms) > 10
    for room in rooms:
        mirrored = [f"tests/{place}" for place in (room, *room.parents)]
        assert set(mirrored) & set(listed), f"tests of refdof/{room} are in no pass for kernels"

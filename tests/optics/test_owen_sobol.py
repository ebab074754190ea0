"""Scrambled nets keep their strata, scrambles are uniform and unrelated, and the aperture's map keeps areas."""

from itertools import islice

import numpy as np
import pytest
from scipy import stats

from refdof import Aperture
from refdof._jit import JIT_DISABLED, kernel, prange
from refdof.optics.aperture_sampling import aperture_sampler_of, lens_point
from refdof.optics.owen_sobol import axis_seed, block_of, reverse_bits, scramble, scramble_state

pytestmark = pytest.mark.fast


def scrambled(first, log2_count, seed, axes=(0, 1)):
    """Points (N, 2) of one block of the sequence under one scramble."""
    block = block_of(first, log2_count)
    with np.errstate(over="ignore"):
        state = scramble_state(seed, 7, 0)
        columns = [
            [reverse_bits(scramble(x, axis_seed(state, axis))) for x in block.reversed_points[axis]] for axis in axes
        ]
    return (np.array(columns, dtype=np.float64).T + 0.5) / 2.0**32


def is_net(points, log2_count):
    """One point in every box of 2^-k x 2^(k - m), for every k."""
    for k in range(log2_count + 1):
        cell = np.floor(points * [2**k, 2 ** (log2_count - k)]).astype(int)
        if len({tuple(c) for c in cell}) != len(points):
            return False
    return True


@pytest.mark.parametrize("log2_count", [0, 1, 2, 3, 5, 6])
@pytest.mark.parametrize("seed", [1, 2, 2**32 - 1])
def test_every_scramble_of_every_block_is_a_net(log2_count, seed):
    for first in (0, 1 << log2_count, 6 << log2_count):
        assert is_net(scrambled(first, log2_count, seed), log2_count)
    halves = [scrambled(first, log2_count, seed) for first in (0, 1 << log2_count)]
    assert is_net(np.concatenate(halves), log2_count + 1)  # doubling goes on with the same net


@pytest.mark.filterwarnings("ignore:The balance properties:UserWarning")
@pytest.mark.parametrize(("first", "log2_count"), [(0, 0), (0, 12), (96, 5), (7 << 10, 10), ((1 << 29) - 16, 4)])
def test_points_are_those_of_scipy(first, log2_count):
    engine = stats.qmc.Sobol(4, scramble=False, bits=32)
    if first:
        engine.fast_forward(first)
    expected = (engine.random(1 << log2_count) * 2.0**32).astype(np.uint32)
    words = [f"{x:032b}"[::-1] for x in expected.T.ravel()]
    backwards = np.array([int(word, 2) for word in words], dtype=np.uint32).reshape(4, -1)
    assert np.array_equal(block_of(first, log2_count).reversed_points, backwards)


def test_the_test_can_tell_a_net():
    assert not is_net(np.random.default_rng(0).random((16, 2)), 4)


SEEDS = 500 if JIT_DISABLED else 200_000
GRIDS = (2, 8, 16, 64)


@kernel
def draws(points, seeds, replicate, pixel, out):
    """Fill out (4, N): one bit-reversed point (4,) under the scrambles of N seeds, on the unit interval."""
    for s in prange(len(seeds)):
        state = scramble_state(seeds[s], replicate, pixel)
        for axis in range(4):
            out[axis, s] = reverse_bits(scramble(points[axis], axis_seed(state, axis))) * 2.0**-32


def drawn(point, replicate=0, pixel=0, seeds=None):
    """Where point number `point` of the net lies, (4, N) in [0, 1), for N seeds."""
    seeds = np.arange(SEEDS, dtype=np.int64) if seeds is None else seeds
    out = np.empty((4, len(seeds)))
    with np.errstate(over="ignore"):
        draws(np.ascontiguousarray(block_of(0, 8).reversed_points[:, point]), seeds, replicate, pixel, out)
    return out


def p_value(x, y, grid):
    """Chi-square of the joint histogram of x and y against independent uniforms."""
    cell = (x * grid).astype(np.int64) * grid + (y * grid).astype(np.int64)
    return stats.chisquare(np.bincount(cell, minlength=grid * grid)).pvalue


def assert_uniform(p):
    """Assert that none of many p-values is too small: by chance one choice of seeds in a thousand fails.

    P-values of one scramble's points, and of grids inside grids, are related: their own distribution says nothing.
    """
    assert min(p) > 1e-3 / len(p)


def grids():
    """Grids with at least five draws expected in a cell, as chi-square asks."""
    return [grid for grid in GRIDS if SEEDS / grid**2 >= 5]


def test_a_point_is_uniform_over_scrambles():
    p = []
    for point in (0, 1, 7, 255):
        for axis in drawn(point):
            p.append(stats.chisquare(np.bincount((axis * 256).astype(int), minlength=256)).pvalue)
    assert_uniform(p)


@pytest.mark.parametrize("points", [1, 2, 4, 16, 64, 256])
def test_axes_are_independent(points):
    p = []
    for point in {0, points // 2, points - 1}:  # of a net of so many points
        for replicate, pixel in ((0, 0), (15, 0), (3, 307_199)):
            place = drawn(point, replicate, pixel)
            p += [p_value(place[a], place[b], g) for a in range(4) for b in range(a + 1, 4) for g in grids()]
    assert_uniform(p)


@pytest.mark.parametrize("other", [{"replicate": 1}, {"replicate": 8}, {"pixel": 1}, {"pixel": 640}, {"pixel": 2**32}])
def test_replicates_and_pixels_are_independent(other):
    p = []
    for point in (0, 1, 100):
        here, there = drawn(point), drawn(point, **other)
        p += [p_value(here[a], there[b], g) for a in range(4) for b in range(4) for g in grids()]
    assert_uniform(p)


@pytest.mark.parametrize("step", [1, 2, 2**16, 2**31])
def test_neighbouring_seeds_are_independent(step):
    seeds = np.arange(0, 2 * SEEDS, 2, dtype=np.int64) if step == 1 else np.arange(SEEDS, dtype=np.int64) * 4
    here, there = drawn(1, seeds=seeds), drawn(1, seeds=(seeds + step) % 2**32)
    assert_uniform([p_value(here[a], there[b], g) for a in range(4) for b in range(4) for g in grids()])


def test_the_test_can_tell_related_axes():
    random = np.random.default_rng(0)
    x, y = random.random((2, 20_000))
    assert p_value(x, (y + 0.2 * (x > 0.5) * (y < 0.1)) % 1.0, 8) < 1e-6


def test_cells_are_all_visited_along_squares():
    block = block_of(0, 6)
    assert len({tuple(c) for c in block.cells}) == 64
    quarter = block.cells[:16].astype(int)  # the first quarter of the walk is a quarter of the square
    backwards = [[int(f"{v:03b}"[::-1], 2) for v in pair] for pair in quarter]
    assert np.max(backwards) == 3


@pytest.mark.parametrize(
    "aperture",
    [Aperture.disc(), Aperture.disc(ratio=0.5), Aperture.polygon(5, rotation=10.0), Aperture.polygon(6, curvature=0.4)],
)
def test_the_kernel_and_the_array_door_map_alike(aperture):
    square = np.random.default_rng(2).random((200, 2))
    aperture_sampler = aperture_sampler_of(aperture)
    kernel = np.array([lens_point(aperture_sampler, u, v) for u, v in square])
    np.testing.assert_allclose(kernel, aperture.from_square(square), atol=1e-15)  # the same steps, in float64


def test_an_image_is_sampled_by_its_transmission():
    weights = np.zeros((8, 8))
    weights[1, 3], weights[5, 2], weights[4, 6] = 1.0, 2.0, 5.0
    aperture_sampler = aperture_sampler_of(Aperture.image(weights))
    square = (np.indices((64, 64)).reshape(2, -1).T + 0.5) / 64
    points = np.array([lens_point(aperture_sampler, u, v) for u, v in square])
    column = np.floor((points[:, 0] + 1) * 4).astype(int)
    row = np.floor((1 - points[:, 1]) * 4).astype(int)
    counts = np.zeros((8, 8))
    np.add.at(counts, (row, column), 1)
    # A regular grid of 64 x 64 points hits every share to within one row of it.
    np.testing.assert_allclose(counts / len(points), weights / 8.0, atol=1 / 64)


def split_mix(state):
    """SplitMix64 as its authors print it, in Python's whole numbers: outputs one after another."""
    while True:
        state = (state + 0x9E3779B97F4A7C15) % 2**64
        z = (state ^ (state >> 30)) * 0xBF58476D1CE4E5B9 % 2**64
        z = (z ^ (z >> 27)) * 0x94D049BB133111EB % 2**64
        yield z ^ (z >> 31)


def output(state, number):
    return next(islice(split_mix(state), number, None))


def test_seeds_are_a_generators_outputs():
    # The first outputs for state 0 are published with the generator.
    assert [output(0, k) for k in range(3)] == [0xE220A8397B1DCDAF, 0x6E789E6AA1B965F4, 0x06C45D188009454F]
    with np.errstate(over="ignore"):
        assert [axis_seed(np.uint64(0), axis) for axis in range(3)] == [0xE220A839, 0x6E789E6A, 0x06C45D18]
        # Of replicates, then of pixels, then of axes.
        for seed, replicate, pixel, axis in ((0, 0, 0, 0), (1, 0, 3, 2), (7, 2, 0, 1), (2**32 - 1, 5, 40, 3)):
            state = np.uint64(scramble_state(np.uint32(seed), replicate, pixel))
            assert int(state) == output(output(seed, replicate), pixel)
            assert axis_seed(state, axis) == output(int(state), axis) >> 32

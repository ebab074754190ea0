"""Scrambled nets keep their strata, scrambles are uniform and unrelated, and the opening's map keeps areas."""

import numpy as np
import pytest
from scipy import stats

from refdof import Aperture
from refdof.opening import lens_point, opening_of
from refdof.owen import block_of, mix, reverse_bits, scramble


def scrambled(first, log2_count, seed, axes=(0, 1)):
    """Points (N, 2) of one block of the sequence under one scramble."""
    block = block_of(first, log2_count)
    with np.errstate(over="ignore"):
        state = mix(np.uint32(seed), np.uint32(7))
        columns = [
            [reverse_bits(scramble(x, mix(state, np.uint32(axis)))) for x in block.reversed_points[axis]]
            for axis in axes
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


def test_the_test_can_tell_a_net():
    assert not is_net(np.random.default_rng(0).random((16, 2)), 4)


def test_a_point_is_uniform_over_scrambles():
    points = np.concatenate([scrambled(0, 2, seed)[1:2] for seed in range(2000)])
    counts = np.histogram2d(*points.T, bins=8, range=[[0, 1], [0, 1]])[0]
    assert stats.chisquare(counts.ravel()).pvalue > 1e-4  # fixed seeds: one failure in 10 000 choices of them


def test_scrambles_of_neighbouring_seeds_are_unrelated():
    first, second = (np.array([scrambled(0, 0, seed)[0] for seed in range(k, 3000, 2)]) for k in (0, 1))
    for axis in range(2):
        # Independent uniforms: the correlation of 1500 pairs is normal with deviation 0.026; 4 of them.
        assert abs(np.corrcoef(first[:, axis], second[:, axis])[0, 1]) < 0.104
    assert abs(np.corrcoef(first[:, 0], first[:, 1])[0, 1]) < 0.104


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
    opening = opening_of(aperture)
    kernel = np.array([lens_point(opening, u, v) for u, v in square])
    np.testing.assert_allclose(kernel, aperture.from_square(square), atol=1e-15)  # the same steps, in float64


def test_an_image_is_sampled_by_its_transmission():
    weights = np.zeros((8, 8))
    weights[1, 3], weights[5, 2], weights[4, 6] = 1.0, 2.0, 5.0
    opening = opening_of(Aperture.image(weights))
    square = (np.indices((64, 64)).reshape(2, -1).T + 0.5) / 64
    points = np.array([lens_point(opening, u, v) for u, v in square])
    column = np.floor((points[:, 0] + 1) * 4).astype(int)
    row = np.floor((1 - points[:, 1]) * 4).astype(int)
    counts = np.zeros((8, 8))
    np.add.at(counts, (row, column), 1)
    # A regular grid of 64 x 64 points hits every share to within one row of it.
    np.testing.assert_allclose(counts / len(points), weights / 8.0, atol=1 / 64)

"""Lens rays: neighbouring pixels' rays pass the same small part of the lens, one after another."""

import numpy as np
import pytest

from refdof import Aperture, ThinLens, View
from refdof._jit import tile_kernel
from refdof.optics.aperture_sampling import aperture_sampler_of, lens_point
from refdof.optics.owen_sobol import axis_seed, block_of, scramble_state
from refdof.truth.lens_rays import Aim, _on_lens, _square_points, _start_strands
from tests import flat_scene

pytestmark = pytest.mark.fast


@tile_kernel
def square_points(aim, block, pixels, x, y):
    """Points of the unit square, x and y (cells, pixels), in the order in which they are visited."""
    count = len(pixels)
    tangents, seeds = np.zeros((2, count)), np.zeros((4, count), dtype=np.uint32)
    columns = np.zeros((1 << block.column_bits, count), dtype=np.uint32)
    rows = np.zeros((1 << block.row_bits, count), dtype=np.uint32)
    _start_strands(aim, pixels, 1, 0, tangents, seeds, columns, rows)
    for k in range(len(block.cells)):
        column, row = block.cells[k, 0], block.cells[k, 1]
        _square_points(block, 0, columns[column], rows[row], seeds[0], seeds[1], x[k], y[k])


@pytest.mark.parametrize(("log2_count", "columns", "rows"), [(4, 4, 4), (5, 8, 4)])
def test_all_pixels_visit_a_cell_of_the_lens_together(log2_count, columns, rows):
    shot, lens = flat_scene.camera(3, 2, 8.0), ThinLens(1.0, 2.0)
    view = View(flat_scene.scene_of([], shot, lens), shot, lens)
    aim = Aim(view.projection(), aperture_sampler_of(Aperture.disc()), np.uint32(5), False, False)
    pixels = np.array([[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]])
    x, y = np.empty((2, 1 << log2_count, len(pixels)))
    with np.errstate(over="ignore"):  # 64-bit numbers that wrap, where nothing is compiled
        square_points(aim, block_of(0, log2_count), pixels, x, y)
    cell = np.floor(x * columns) + columns * np.floor(y * rows)
    assert (cell == cell[:, :1]).all()
    assert sorted(cell[:, 0]) == list(range(columns * rows))
    # Within it each has a point of its own, scrambled apart.
    assert all(len(set(row)) == len(pixels) for row in (x + 1000.0 * y).tolist())


def test_a_plain_disc_has_the_points_of_any_aperture():
    sampler = aperture_sampler_of(Aperture.disc())
    x, y = np.random.default_rng(4).random((2, 20))
    wanted = [lens_point(sampler, *place) for place in zip(x, y, strict=True)]
    _on_lens(sampler, x, y)
    np.testing.assert_array_equal(np.stack([x, y], axis=1), wanted)


def test_pixels_are_numbered_row_by_row():
    """Every pixel scrambles with its own number, whichever pixels are sampled together."""
    shot, lens = flat_scene.camera(3, 2, 8.0), ThinLens(1.0, 2.0)
    view = View(flat_scene.scene_of([], shot, lens), shot, lens)
    aim, block = (
        Aim(view.projection(), aperture_sampler_of(Aperture.disc()), np.uint32(5), False, False),
        block_of(0, 4),
    )
    pixels = np.array([[2, 1], [0, 0], [1, 1]])
    tangents, seeds = np.zeros((2, 3)), np.zeros((4, 3), dtype=np.uint32)
    columns = np.zeros((1 << block.column_bits, 3), dtype=np.uint32)
    rows = np.zeros((1 << block.row_bits, 3), dtype=np.uint32)
    with np.errstate(over="ignore"):  # as in compiled code
        _start_strands(aim, pixels, 1, 7, tangents, seeds, columns, rows)
        states = [np.uint64(scramble_state(np.uint32(5), 7, number)) for number in (5, 0, 4)]
        wanted = [[axis_seed(state, k) for state in states] for k in range(4)]
    np.testing.assert_array_equal(seeds, wanted)

"""Tile tasks: the tiles of a reference, from the threads of this process or from the workers of a cluster.

On a cluster a task is a batch of tiles that takes about a second: the first ones are single tiles, whose time says how
many a second holds. The last ones are smaller, so that no worker waits long for another one. A tile's bits depend on
nothing but what all tiles share and its place.
"""

import math
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof._jit import compilations, run_tasks
from refdof.cluster import Cluster, completed
from refdof.truth.error_bar import excess, grid_of
from refdof.truth.tile_sampler import Spend, TileSampler
from refdof.view import View

__all__ = ["Tile", "TileWork", "for_each_tile"]

_TASK_S = 1.0  # against about 10 ms that a task costs besides
_LAST = 4  # a batch is at most this share of what is left for each worker


class Tile(NamedTuple):
    """What a picture keeps of a tile.

    pictures (4, h, w, 3) float32 are mean, standard error and the interval's ends; samples (h, w) int64; above (h, w)
    says where the tolerance was not met; noise: `refdof.image.noise_floor.noise_moments`.
    """

    corner: tuple[int, int]
    pictures: Float
    samples: Index
    above: np.ndarray
    noise: Float


class TileWork:
    """What all tiles share. It travels as scene, camera, lens and numbers; the rest is made where it is used."""

    def __init__(self, view: View, replicates: int, seed: int, spend: Spend, box: bool, shared_pattern: bool) -> None:
        self._view, self._how = view, (replicates, seed, spend, box, shared_pattern)
        self._sampler: TileSampler | None = None

    def __getstate__(self) -> Any:
        return (self._view.scene, self._view.camera, self._view.lens), self._how

    def __setstate__(self, state: Any) -> None:
        shot, self._how = state
        self._view, self._sampler = View(*shot), None

    def sampler(self) -> TileSampler:
        """Makes the tiles; it takes as long as building Embree's tree."""
        if self._sampler is None:
            self._sampler = TileSampler(self._view, *self._how)
        return self._sampler

    def tile(self, corner: tuple[int, int]) -> Tile:
        """The tile at an upper left pixel (x, y)."""
        replicates, _, spend, _, _ = self._how
        tile = self.sampler().tile(corner)
        grid = grid_of(np.stack([tile.columns, tile.rows], axis=1))
        pictures = np.stack([part[grid] for part in tile.found]).astype(np.float32)
        above = np.zeros(grid.shape, dtype=np.bool_)
        if spend.tolerance is not None:
            above = excess(tile.found, spend.tolerance)[grid] > 1.0
        return Tile(corner, pictures, tile.spent[grid] * replicates, above, tile.noise)


def for_each_tile(
    work: TileWork,
    corners: Sequence[tuple[int, int]],
    keep: Callable[[Tile], None],
    cluster: Cluster | None,
    progress: Callable[[int, int], None] | None,
) -> None:
    """Make all tiles, hand each to `keep` as it ends, and call progress(done, all) between."""
    if cluster is None:
        work.sampler()
        run_tasks(lambda corner: keep(work.tile(corner)), corners, progress)
        return
    done, batches = 0, _Batches(corners, cluster.workers())
    for _, (tiles, seconds) in completed(_sample, work, batches, cluster):
        batches.learn(len(tiles), seconds)
        for tile in tiles:
            keep(tile)
        done += len(tiles)
        if progress is not None:
            progress(done, len(corners))


def _sample(work: TileWork, batch: Sequence[tuple[int, int]]) -> tuple[list[Tile], float]:
    """The tiles of a batch, and how long they took; NaN if something was compiled in that time."""
    work.sampler()
    before, began = compilations(), time.perf_counter()
    tiles = run_tasks(work.tile, batch)
    seconds = time.perf_counter() - began
    return tiles, seconds if compilations() == before else math.nan


class _Batches:
    """Tiles in batches whose size follows what was learned."""

    def __init__(self, corners: Sequence[tuple[int, int]], workers: int) -> None:
        self._corners, self._workers = corners, max(workers, 1)
        self._next, self._tiles, self._seconds = 0, 0, 0.0

    def learn(self, tiles: int, seconds: float) -> None:
        if not math.isnan(seconds):
            self._tiles += tiles
            self._seconds += seconds

    def __iter__(self) -> Iterator[Sequence[tuple[int, int]]]:
        while self._next < len(self._corners):
            left = len(self._corners) - self._next
            fits = int(_TASK_S * self._tiles / max(self._seconds, 1e-6))
            size = max(1, min(fits, math.ceil(left / (_LAST * self._workers))))
            batch = self._corners[self._next : self._next + size]
            self._next += size
            yield batch

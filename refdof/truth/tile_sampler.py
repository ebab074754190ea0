"""Tile sampler: the estimates of one tile of pixels, from the first look to the last doubling.

A tile's rays are made, traced and shaded at once, so that its working set stays in the nearest caches.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from refdof._check import Float, Index
from refdof.image.noise_floor import LEAST_GROUPS, noise_moments
from refdof.optics.aperture_sampling import aperture_sampler_of
from refdof.optics.owen_sobol import block_of
from refdof.optics.systems.spectrum import add_wave, channel_weights
from refdof.raster.rays.embree import new_packets, new_query
from refdof.truth.emitters import first_samples
from refdof.truth.error_bar import Estimate, grid_of, summarise, unfinished
from refdof.truth.lens_rays import Aim, Traversal, trace_block
from refdof.view import View

__all__ = ["FIRST_POINTS", "Spend", "TileEstimate", "TileSampler", "corners_of", "power_of_two"]

_TILE = 16  # px
_PACKETS = 16  # traced between generating and shading
FIRST_POINTS = 8  # per replicate, before the first look at the error


@dataclass(frozen=True)
class Spend:
    """How many samples: `samples` per pixel; or, with a `tolerance`, as many as it needs, at most `most` per pixel."""

    samples: int
    tolerance: float | None
    most: int


@dataclass(frozen=True)
class TileEstimate:
    """A tile's pixels, by row and column (N,), the points spent on each per replicate (N,), and what they say.

    noise: `refdof.image.noise_floor.noise_moments`.
    """

    rows: Index
    columns: Index
    spent: Index
    found: Estimate
    noise: Float


class TileSampler:
    """Samples the tiles of one view."""

    def __init__(self, view: View, replicates: int, seed: int, spend: Spend, box: bool, shared_pattern: bool) -> None:
        self.width, self.height = view.camera.size
        self.replicates, self.tolerance = replicates, spend.tolerance
        self.most_points = int(power_of_two(spend.most / replicates))
        self._surfaces, self._tracer = view.surfaces(), view.tracer()
        plain = view.projection(), aperture_sampler_of(view.lens.aperture), np.uint32(seed), shared_pattern, box
        ray_map = view.ray_map()
        waves = 1 if ray_map is None else ray_map.waves
        self._aims = [Aim(*plain, ray_map, wave) for wave in range(waves)]
        self._weights = channel_weights(waves)
        if spend.tolerance is None:
            self._first = np.full((self.height, self.width), power_of_two(spend.samples / replicates))
        else:
            wanted = power_of_two(first_samples(view, spend.tolerance) / replicates)
            self._first = np.clip(wanted, min(FIRST_POINTS, self.most_points), self.most_points)

    def tile(self, corner: tuple[int, int], refine: bool = True) -> TileEstimate:
        """Sample a tile: the first look, and with a tolerance and `refine` the doublings that it asks for."""
        x, y = corner
        pixels = _tile_order(x, y, min(x + _TILE, self.width), min(y + _TILE, self.height))
        rows, columns = pixels[:, 1], pixels[:, 0]
        sums, spent = np.zeros((self.replicates, len(pixels), 3)), self._first[rows, columns]
        for count in np.unique(spent):
            todo: Index = np.flatnonzero(spent == count)
            sums[:, todo] = self._trace(pixels[todo], 0, int(count))
        grid = grid_of(pixels)
        found = summarise(sums, spent, grid)
        while self.tolerance is not None and refine:
            todo = np.flatnonzero(unfinished(found.mean, found.error, spent, grid, self.tolerance, self.most_points))
            if not len(todo):
                break
            have = int(spent[todo[0]])
            sums[:, todo] += self._trace(pixels[todo], have, have)
            spent[todo] += have
            found = summarise(sums, spent, grid)
        noise = noise_moments(sums, spent) if self.replicates >= LEAST_GROUPS else np.zeros(0)
        return TileEstimate(rows, columns, spent, found, noise)

    def _trace(self, pixels: Index, start: int, count: int) -> Any:
        """Sums (R, N, 3) over points start .. start + count - 1 of every replicate."""
        sums = np.zeros((self.replicates, len(pixels), 3))
        tracer = self._tracer
        query, packets = new_query(tracer, coherent=True), new_packets(_PACKETS)
        block = block_of(start, count.bit_length() - 1)
        traversal = Traversal(tracer.scene, tracer.packet, query, packets)
        if len(self._aims) == 1:
            trace_block(self._surfaces, traversal, self._aims[0], block, pixels, sums)
            return sums
        for weights, aim in zip(self._weights, self._aims, strict=True):
            of_wave = np.zeros_like(sums)
            trace_block(self._surfaces, traversal, aim, block, pixels, of_wave)
            add_wave(sums, weights, of_wave)
        return sums


def corners_of(size: tuple[int, int]) -> list[tuple[int, int]]:
    """The tiles of a picture (width, height), by their upper left pixel (x, y)."""
    return [(x, y) for y in range(0, size[1], _TILE) for x in range(0, size[0], _TILE)]


def power_of_two(count: Any) -> Any:
    """The smallest power of two that is not below `count`, at least 1."""
    return np.exp2(np.ceil(np.log2(np.maximum(count, 1)))).astype(np.int64)


def _tile_order(x0: int, y0: int, x1: int, y1: int) -> Index:
    """Pixels (N, 2) of a tile in blocks of 4 x 4, so that a packet of 16 is a small square."""
    y, x = np.mgrid[y0:y1, x0:x1]
    order = np.lexsort((x.ravel(), y.ravel(), x.ravel() // 4, y.ravel() // 4))
    return np.stack([x.ravel()[order], y.ravel()[order]], axis=1).astype(np.int64)

"""Measures of N-buffers, and of Gaussians one after the other."""

import math
import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from refdof.claims.bench import Bench
from refdof.methods.cascaded.gaussian import gaussian_blur
from refdof.raster.filters.n_buffer import n_buffer, query

__all__ = ["FILTERS", "FILTER_TIMES"]


def n_buffer_exact(_: Bench, squares: bool, count: int = 4000) -> float:
    """Share of random squares, or rectangles, whose least depth four look-ups in an N-buffer find exactly."""
    random = np.random.default_rng(1)
    depth = random.random((96, 128))
    buffer = n_buffer(depth, extremes="min")
    x, y = np.sort(random.integers(0, 128, (2, count)), axis=0), np.sort(random.integers(0, 96, (2, count)), axis=0)
    if squares:
        side = random.integers(0, 64, count)
        first = random.integers(0, 128 - side), random.integers(0, 96 - side)
        x, y = np.stack([first[0], first[0] + side]), np.stack([first[1], first[1] + side])
    found = query(buffer, x[0], y[0], x[1], y[1]).lowest
    exact = [depth[y[0, k] : y[1, k] + 1, x[0, k] : x[1, k] + 1].min() for k in range(count)]
    return float(np.mean(found == exact))


def n_buffer_memory(_: Bench, width: int, height: int) -> float:
    """Texels of an N-buffer of all pixels over those of one of blocks of 2 x 2 px."""
    depth = np.ones((height, width), dtype=np.float32)
    full, small = n_buffer(depth), n_buffer(depth, block=2)
    return full.lowest.size / small.lowest.size


def blur_in_steps(_: Bench, steps: Sequence[float]) -> float:
    """Largest difference between Gaussians one after the other and one of their Euclidean sum, over the peak."""
    light = np.zeros((1, 129, 129))
    light[0, 64, 64] = 1.0
    many, once, scratch = light.copy(), light.copy(), np.empty_like(light)
    for step in steps:
        gaussian_blur(many, step, scratch)
    gaussian_blur(once, math.sqrt(math.fsum(step * step for step in steps)), scratch)
    return float(np.abs(many - once).max() / once.max())


def n_buffer_time(_: Bench, width: int, height: int) -> float:
    """Time to build an N-buffer of all pixels over that of one of blocks of 2 x 2 px, in turn; the median of nine."""
    depth = np.random.default_rng(4).random((height, width), dtype=np.float32)

    def seconds(block: int) -> float:
        start = time.perf_counter()
        n_buffer(depth, block=block)
        return time.perf_counter() - start

    ratios = [seconds(1) / seconds(2) for _round in range(10)]
    return float(np.median(ratios[1:]))  # the first compiles


FILTERS: dict[str, Any] = {function.__name__: function for function in (n_buffer_exact, n_buffer_memory, blur_in_steps)}
FILTER_TIMES: dict[str, Any] = {n_buffer_time.__name__: n_buffer_time}

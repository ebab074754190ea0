"""Value noise: smooth random numbers in two and three dimensions, tileable, from an explicit generator."""

import numpy as np

from refdof._check import Float

__all__ = ["Noise3", "fractal", "smooth", "value_noise"]


def smooth(low: float, high: float, x: Float) -> Float:
    """Smooth step: 0 below `low`, 1 above `high`."""
    t = np.clip((x - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def value_noise(size: tuple[int, int], cells: tuple[int, int], rng: np.random.Generator) -> Float:
    """Noise (h, w) in 0 .. 1 with (rows, columns) random cells; it tiles."""
    table = rng.random(cells)
    for axis in (0, 1):
        x = (np.arange(size[axis]) + 0.5) * cells[axis] / size[axis]
        first = np.floor(x).astype(np.int64)
        t = x - first
        t = (t * t * (3.0 - 2.0 * t)).reshape((-1, 1) if axis == 0 else (1, -1))
        low, high = (np.take(table, (first + k) % cells[axis], axis=axis) for k in (0, 1))
        table = low + t * (high - low)
    return table


def fractal(
    size: tuple[int, int],
    cells: tuple[int, int],
    rng: np.random.Generator,
    octaves: int = 4,
    gain: float = 0.5,
) -> Float:
    """Sum of `octaves` noises (h, w), each twice as fine and `gain` as strong; mean about 0.5, tileable."""
    total, weight = np.zeros(size), 1.0
    for k in range(octaves):
        total += weight * (value_noise(size, (cells[0] << k, cells[1] << k), rng) - 0.5)
        weight *= gain
    return 0.5 + total


class Noise3:
    """Noise in space, period 16 along each axis, -1 .. 1."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._table = rng.random((16, 16, 16)) * 2.0 - 1.0

    def __call__(self, points: Float) -> Float:
        """Noise (...) at points (..., 3)."""
        base = np.floor(points)
        t = points - base
        t = t * t * (3.0 - 2.0 * t)
        i, j, k = np.moveaxis(base.astype(np.int64) % 16, -1, 0)
        ends = [[(a, (a + 1) % 16)[s] for s in (0, 1)] for a in (i, j, k)]
        x, y, z = t[..., 0], t[..., 1], t[..., 2]

        def edge(s: int, r: int) -> Float:
            low, high = (self._table[ends[0][q], ends[1][s], ends[2][r]] for q in (0, 1))
            return low + x * (high - low)

        near, far = (edge(0, r) + y * (edge(1, r) - edge(0, r)) for r in (0, 1))
        return near + z * (far - near)

    def fractal(self, points: Float, octaves: int = 3, gain: float = 0.5) -> Float:
        """Sum of noises, each twice as fine and `gain` as strong."""
        return sum((gain**k * self(points * 2.0**k + 5.3 * k) for k in range(octaves)), np.zeros(points.shape[:-1]))

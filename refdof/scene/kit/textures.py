"""Textures of the built-in scenes: masonry, wood, plaster, ground, stone and cloth.

Colours are written as in a paint box, "#rrggbb" in sRGB, and converted by `paint`. All textures tile; they
are (h, w, 3) float32, linear RGB.
"""

from collections.abc import Sequence

import numpy as np

from refdof._check import Float
from refdof.scene.kit.noise import fractal, smooth, value_noise

__all__ = [
    "blend",
    "bricks",
    "cloth",
    "cobbles",
    "mottled",
    "paint",
    "planks",
    "ramp",
    "stone",
    "tiles",
    "wood",
]


def paint(code: str) -> Float:
    """Linear RGB (3,) of an sRGB colour "#rrggbb"."""
    value = np.array([int(code[k : k + 2], 16) for k in (1, 3, 5)]) / 255.0
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


def blend(low: Float, high: Float, amount: Float) -> Float:
    """From `low` to `high` (colours or images) by `amount` (h, w)."""
    out = np.empty((*amount.shape, 3))
    for c in range(3):  # NumPy is slow on rows of three
        out[..., c] = low[..., c] + amount * (high[..., c] - low[..., c])
    return out


def shaded(color: Float, factor: Float) -> Float:
    """`color`, one (3,) or an image, times `factor` (h, w)."""
    out = np.empty((*factor.shape, 3))
    for c in range(3):
        out[..., c] = color[..., c] * factor
    return out


def ramp(amount: Float, codes: Sequence[str]) -> Float:
    """Colours (..., 3) along a row of paints, `amount` 0 .. 1."""
    colors = np.stack([paint(c) for c in codes])
    x = np.clip(amount, 0.0, 1.0) * (len(codes) - 1)
    k = np.minimum(x.astype(np.int64), len(codes) - 2)
    rest = x - k
    out = np.empty((*x.shape, 3))
    for c in range(3):
        out[..., c] = np.take(colors[:, c], k) + rest * np.take(colors[1:, c] - colors[:-1, c], k)
    return out


def mottled(size: int, codes: Sequence[str], rng: np.random.Generator, cells: int = 4, octaves: int = 6) -> Float:
    """Plaster, soil, grass from afar: fractal noise over a row of paints."""
    amount = fractal((size, size), (cells, cells), rng, octaves, 0.6)
    return ramp(0.5 + 0.9 * (amount - 0.5), codes).astype(np.float32)


def bricks(
    size: int,
    rows: int,
    columns: int,
    codes: Sequence[str],
    mortar: str,
    rng: np.random.Generator,
    joint: float = 0.08,
) -> Float:
    """Running bond of bricks twice as long as high; an even number of `rows` tiles.

    `joint` is the mortar's part of a brick's height.
    """
    u, v = _grid(size)
    y = v * rows
    row = np.floor(y).astype(np.int64)
    x = u * columns + 0.5 * (row % 2)
    column = np.floor(x).astype(np.int64) % columns
    edge = np.minimum(np.minimum(y % 1, 1 - y % 1), 2.0 * np.minimum(x % 1, 1 - x % 1))
    rough = fractal((size, size), (8, 8), rng, 5, 0.7) - 0.5
    face = smooth(joint * 0.3, joint, edge + 0.5 * joint * rough)
    tone = rng.random((rows, columns))[row, column]
    shade = (0.84 + 0.16 * smooth(0.0, 0.35, edge)) * (1.0 + 0.35 * rough)
    color = shaded(ramp(np.clip(tone + 0.4 * rough, 0, 1), codes), shade)
    ground = shaded(paint(mortar), 1.0 + 0.6 * rough)
    return np.maximum(blend(ground, color, face), 0.0).astype(np.float32)


def tiles(
    size: int,
    count: int,
    codes: Sequence[str],
    grout: str,
    rng: np.random.Generator,
    joint: float = 0.03,
    checker: bool = False,
) -> Float:
    """Square tiles, each of its own tone; `checker` alternates the two ends of the row of paints."""
    u, v = _grid(size)
    i, j = (np.floor(a * count).astype(np.int64) for a in (u, v))
    edge = np.minimum(*(np.minimum(a * count % 1, 1 - a * count % 1) for a in (u, v)))
    vein = fractal((size, size), (6, 6), rng, 5, 0.65) - 0.5
    tone = rng.random((count, count))[j, i]
    if checker:
        tone = 0.88 * ((i + j) % 2) + 0.12 * tone
    color = ramp(np.clip(tone + 0.35 * vein, 0, 1), codes) * (1.0 + 0.35 * vein)[..., None]
    color *= (0.88 + 0.12 * smooth(0.0, 0.12, edge))[..., None]
    return blend(paint(grout) * (1.0 + vein)[..., None], color, smooth(joint * 0.6, joint, edge)).astype(np.float32)


def cobbles(size: int, count: int, codes: Sequence[str], gap: str, rng: np.random.Generator) -> Float:
    """Rounded stones: cells around jittered points, darker towards the gaps."""
    u, v = _grid(size)
    x, y = u * count, v * count
    i, j = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    shift, tone = rng.uniform(0.15, 0.85, (count, count, 2)), rng.random((count, count))
    first, second, mine = np.full(x.shape, 9.0), np.full(x.shape, 9.0), np.zeros(x.shape)
    for di in (-1, 0, 1):
        for dj in (-1, 0, 1):
            p, q = (i + di) % count, (j + dj) % count
            distance = np.hypot(x - i - di - shift[q, p, 0], y - j - dj - shift[q, p, 1])
            nearer = distance < first
            second = np.where(nearer, first, np.minimum(second, distance))
            mine = np.where(nearer, tone[q, p], mine)
            first = np.minimum(first, distance)
    edge = second - first
    rough = fractal((size, size), (8, 8), rng, 5, 0.65) - 0.5
    color = shaded(ramp(mine + 0.3 * rough, codes), 0.6 + 0.4 * smooth(0.0, 0.5, edge) + 0.3 * rough)
    ground = shaded(paint(gap), 1.0 + rough)
    return np.maximum(blend(ground, color, smooth(0.04, 0.14, edge)), 0.0).astype(np.float32)


def wood(size: int, codes: Sequence[str], rng: np.random.Generator, rings: float = 9.0) -> Float:
    """Grain along u: stretched rings and fine fibres."""
    _, v = _grid(size)
    warp = fractal((size, size), (4, 1), rng, 4)
    ring = 0.5 + 0.5 * np.sin(2 * np.pi * (rings * v + 3.0 * (warp - 0.5)))
    fibre = value_noise((size, size), (size // 3, 6), rng) + value_noise((size, size), (size // 6, 3), rng) - 1.0
    broad = fractal((size, size), (3, 2), rng, 4) - 0.5
    return ramp(0.35 + 0.28 * ring**1.5 + 0.3 * fibre + 0.5 * broad, codes).astype(np.float32)


def planks(size: int, count: int, codes: Sequence[str], rng: np.random.Generator, gap: float = 0.03) -> Float:
    """`count` boards along u, each cut from its own place of the wood, with dark gaps and butt joints."""
    u, v = _grid(size)
    board = np.floor(v * count).astype(np.int64)
    grain = wood(size, codes, rng, 2.5 * count)
    shift = rng.integers(0, size, count)
    columns = (np.arange(size)[None, :] + shift[board[:, 0]][:, None]) % size
    color = np.take_along_axis(grain, columns[..., None], axis=1) * rng.uniform(0.72, 1.12, count)[board][..., None]
    end = (u + rng.random(count)[board]) % 1.0
    edge = np.minimum(np.minimum(v * count % 1, 1 - v * count % 1), np.minimum(end, 1 - end) * count)
    return (color * (0.25 + 0.75 * smooth(0.3 * gap, 1.6 * gap, edge))[..., None]).astype(np.float32)


def stone(size: int, codes: Sequence[str], rng: np.random.Generator, veins: float = 0.5) -> Float:
    """Marble and sandstone: clouds, and thin veins where a warped noise crosses its middle."""
    cloud = fractal((size, size), (3, 3), rng, 6, 0.6)
    warped = fractal((size, size), (2, 3), rng, 6, 0.62)
    vein = np.exp(-(((warped - 0.5) / 0.018) ** 2)) * smooth(0.3, 0.7, cloud)
    color = ramp(0.5 + 1.1 * (cloud - 0.5), codes)
    return (color * (1.0 - veins * 0.7 * vein)[..., None]).astype(np.float32)


def cloth(size: int, code: str, rng: np.random.Generator, threads: int = 96) -> Float:
    """Plain weave."""
    u, v = _grid(size)
    weave = np.sin(2 * np.pi * threads * u) * np.sin(2 * np.pi * threads * v)
    worn = fractal((size, size), (4, 4), rng, 5) - 0.5
    return np.maximum(paint(code) * (1.0 + 0.14 * weave + 0.5 * worn)[..., None], 0.0).astype(np.float32)


def _grid(size: int) -> tuple[Float, Float]:
    """Texture coordinates (u, v) of the texel centres; row 0 is the top row."""
    x = (np.arange(size) + 0.5) / size
    return np.broadcast_to(x[None, :], (size, size)), np.broadcast_to(x[::-1, None], (size, size))

"""Labels: printed paper for cans, drawn from distances (bands, a medallion of fruit, stroke letters)."""

from itertools import pairwise

import numpy as np

from refdof._check import Float
from refdof.scene.kit.noise import fractal, smooth
from refdof.scene.kit.textures import blend, paint

__all__ = ["label", "lettering"]

# Strokes of a letter on a field 4 wide and 6 high, lower left is (0, 0).
_STROKES: dict[str, list[list[tuple[float, float]]]] = {
    "A": [[(0, 0), (2, 6), (4, 0)], [(0.8, 2.2), (3.2, 2.2)]],
    "B": [
        [(0, 0), (0, 6), (2.4, 6), (3.5, 5.3), (3.5, 3.9), (2.4, 3.2), (0, 3.2)],
        [(2.4, 3.2), (4, 2.3), (4, 0.9), (2.6, 0), (0, 0)],
    ],
    "C": [[(4, 5), (2.9, 6), (1.1, 6), (0, 4.8), (0, 1.2), (1.1, 0), (2.9, 0), (4, 1)]],
    "E": [[(4, 6), (0, 6), (0, 0), (4, 0)], [(0, 3.1), (3.2, 3.1)]],
    "F": [[(4, 6), (0, 6), (0, 0)], [(0, 3.1), (3.2, 3.1)]],
    "H": [[(0, 0), (0, 6)], [(4, 0), (4, 6)], [(0, 3), (4, 3)]],
    "I": [[(2, 0), (2, 6)]],
    "L": [[(0, 6), (0, 0), (4, 0)]],
    "M": [[(0, 0), (0, 6), (2, 2.6), (4, 6), (4, 0)]],
    "N": [[(0, 0), (0, 6), (4, 0), (4, 6)]],
    "O": [[(1.1, 0), (0, 1.2), (0, 4.8), (1.1, 6), (2.9, 6), (4, 4.8), (4, 1.2), (2.9, 0), (1.1, 0)]],
    "P": [[(0, 0), (0, 6), (2.8, 6), (4, 5.2), (4, 3.6), (2.8, 2.8), (0, 2.8)]],
    "R": [[(0, 0), (0, 6), (2.8, 6), (4, 5.2), (4, 3.6), (2.8, 2.8), (0, 2.8)], [(2, 2.8), (4, 0)]],
    "S": [
        [
            (4, 5.1),
            (2.9, 6),
            (1.1, 6),
            (0, 5.1),
            (0, 4),
            (1, 3.2),
            (3, 2.8),
            (4, 2),
            (4, 0.9),
            (2.9, 0),
            (1.1, 0),
            (0, 0.9),
        ]
    ],
    "T": [[(0, 6), (4, 6)], [(2, 6), (2, 0)]],
    "U": [[(0, 6), (0, 1.2), (1.1, 0), (2.9, 0), (4, 1.2), (4, 6)]],
}


def lettering(x: Float, y: Float, word: str, height: float) -> Float:
    """Distance (h, w) to the strokes of `word`, centred on (0, 0), in the units of x and y."""
    unit = height / 6.0
    distance = np.full(np.broadcast(x, y).shape, np.inf)
    for k, letter in enumerate(word):
        shift = (5.6 * (k - (len(word) - 1) / 2.0) - 2.0) * unit
        for stroke in _STROKES.get(letter, []):
            for (ax, ay), (bx, by) in pairwise(stroke):
                px, py = x - shift - ax * unit, y + height / 2 - ay * unit
                ex, ey = (bx - ax) * unit, (by - ay) * unit
                t = np.clip((px * ex + py * ey) / (ex * ex + ey * ey), 0.0, 1.0)
                distance = np.minimum(distance, np.hypot(px - t * ex, py - t * ey))
    return distance


def label(design: tuple[str, str, str, str, int, str], rng: np.random.Generator, height: int = 320) -> Float:
    """Label (height, 2 height, 3): the same panel twice around, for a surface twice as long as it is high.

    `design` is paper, band, ink and fruit ("#rrggbb" each), the number of fruit, and a word.
    """
    paper, band, ink, fruit = (paint(code) for code in design[:4])
    count, word = design[4:]
    s = (np.arange(height) + 0.5) / height
    x, y = np.meshgrid(s - 0.5, s[::-1] - 0.5)
    texel = 1.2 / height
    color: Float = (
        np.broadcast_to(paper, (height, height, 3))
        * (1.0 - 0.25 * (np.abs(y) > 0.2) * smooth(0.1, 0.5, np.abs(y)))[..., None]
    )

    def put(color: Float, what: Float, distance: Float) -> Float:
        return blend(color, what, smooth(texel, -texel, distance))

    # A sunburst behind a cream medallion with a rim.
    ray = np.sin(24.0 * np.arctan2(y - 0.06, x))
    color = blend(color, 0.55 * paper + 0.45 * band, smooth(-0.2, 0.2, ray) * smooth(0.47, 0.3, np.abs(y)))
    oval = np.hypot(x / 1.12, y - 0.07) - 0.29
    color = put(color, band, oval - 0.022)
    color = put(color, paint("#f6ecd2"), oval)
    color = put(color, ink, np.abs(oval + 0.016) - 0.003)
    # Leaves, then shaded fruit.
    for k in range(3):
        a = 0.6 + 1.0 * k
        p, q = x * np.cos(a) + (y - 0.1) * np.sin(a), -x * np.sin(a) + (y - 0.1) * np.cos(a)
        color = put(
            color,
            paint("#3f7f3a") * (0.8 + 0.4 * smooth(-0.02, 0.02, q))[..., None],
            np.hypot((p - 0.13) / 2.6, q) - 0.05,
        )
    spread = 0.0 if count == 1 else 0.085
    for k in range(count):
        a = 2 * np.pi * k / count + 0.5
        size = 0.15 if count == 1 else 0.30 / (count + 1) + 0.02
        dx, dy = x - 1.15 * spread * np.cos(a), y - 0.07 - spread * np.sin(a)
        shine = np.exp(-((dx + 0.35 * size) ** 2 + (dy - 0.4 * size) ** 2) / (0.35 * size) ** 2)
        round_ = smooth(1.15 * size, 0.2 * size, np.hypot(dx, dy))
        color = put(
            color,
            fruit * (0.35 + 0.75 * round_)[..., None] + 0.45 * shine[..., None],
            np.hypot(dx, dy) - size,
        )
    # Bands above and below, the word on a banner.
    for level, thick in ((0.455, 0.05), (-0.455, 0.05)):
        color = put(color, band, np.abs(y - level) - thick)
        color = put(color, paint("#e8cf86"), np.abs(y - level + np.sign(level) * (thick + 0.014)) - 0.006)
    banner = np.maximum(np.abs(y + 0.235 - 0.05 * (0.5 - 2.0 * x * x)) - 0.1, np.abs(x) - 0.44)
    color = put(color, ink, banner)
    color = put(color, paint("#f7efdc"), lettering(x, y + 0.235 - 0.05 * (0.5 - 2.0 * x * x), word, 0.12) - 0.014)
    # Small print beside the panel, and the paper's own mottling.
    lines = np.maximum(np.abs(np.abs(x) - 0.485) - 0.011, np.abs(y) - 0.34)
    color = blend(color, 0.6 * color, smooth(texel, -texel, lines) * (np.sin(120.0 * y) > 0.1))
    worn = fractal((height, height), (4, 4), rng, 5) - 0.5
    color = np.clip(color * (1.0 + 0.12 * worn)[..., None], 0.0, 1.0)
    return np.tile(color, (1, 2, 1)).astype(np.float32)

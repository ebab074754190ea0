"""Plants: branches, blossoms, grass, flowers, bushes and trees."""

from collections.abc import Sequence

import numpy as np

from refdof._check import Float
from refdof.scene.kit.mesh import Mesh, join, rotation, scatter
from refdof.scene.kit.noise import Noise3
from refdof.scene.kit.shapes import leaf, sphere, tube
from refdof.scene.kit.textures import paint

__all__ = ["blossom", "branch", "bush", "daisy", "facing", "grass", "shades", "tree"]


def shades(count: int, codes: tuple[str, ...], rng: np.random.Generator, spread: float = 0.25) -> Float:
    """Random colours (count, 3) between two neighbours of a row of paints, some darker, some lighter."""
    colors = np.stack([paint(c) for c in codes])
    t = rng.random(count) * (len(codes) - 1)
    k = np.minimum(t.astype(np.int64), len(codes) - 2)
    mixed = colors[k] + (t - k)[:, None] * (colors[k + 1] - colors[k])
    return mixed * rng.uniform(1 - spread, 1 + spread, count)[:, None]


def facing(turn: Float, tilt: Float, roll: Float | None = None) -> Float:
    """Rotations (N, 3, 3): first `roll` about z, then up by `tilt` about x, then `turn` about y [degrees]."""
    matrix = np.einsum("nij,njk->nik", rotation("y", turn), rotation("x", -np.asarray(tilt)))
    return matrix if roll is None else np.einsum("nij,njk->nik", matrix, rotation("z", roll))


def branch(
    points: Sequence[Sequence[float]] | Float,
    thick: float,
    thin: float,
    rng: np.random.Generator,
    steps: int = 60,
    sides: int = 14,
    knots: float = 0.25,
) -> Mesh:
    """Gnarled branch through a few points (k, 3), from radius `thick` to `thin`."""
    through = np.asarray(points, dtype=np.float64)
    t = np.linspace(0, len(through) - 1, steps)
    path = np.stack([_catmull(through[:, i], t) for i in range(3)], axis=1)
    noise = Noise3(rng)
    path = path + 0.5 * thick * np.stack([noise(path / (9 * thick) + 7.0 * k) for k in range(3)], axis=1)
    radius = thick + (thin - thick) * np.linspace(0, 1, steps)
    body = tube(path, radius, sides)
    rough = noise.fractal(body.vertices * (0.6 / thick), 3) * knots
    scale = np.repeat(radius, sides + 1)
    vertices = body.vertices + (rough * scale)[:, None] * body.normal
    return Mesh(vertices, body.faces, body.uv, body.color * (1.0 + 0.9 * rough)[:, None], body.normal)


def blossom(rng: np.random.Generator, petal: str = "#f3c3cf", heart: str = "#b8384f") -> Mesh:
    """Flower of five round petals, one unit across, its face up; stamens in the middle."""
    one = leaf(0.5, 0.52, -0.25, 0.12, 5)
    t = one.vertices[:, 2:3] / 0.5
    one = one.tinted(paint(heart) + (paint(petal) - paint(heart)) * np.clip(0.25 + 1.2 * t, 0, 1))
    petals = [one.turned("x", rng.uniform(-12, 4)).turned("y", 72.0 * k + rng.uniform(-6, 6)) for k in range(5)]
    threads = []
    for k in range(7):
        end = np.array([0.16 * np.sin(0.7 * k), 0.16 + 0.04 * (k % 3), 0.16 * np.cos(0.7 * k)])
        threads.append(tube(np.stack([0 * end, 0.6 * end, end]), 0.009, 3).tinted(paint("#f0d9c0")))
        threads.append(sphere(0.022, 3, 6).moved(*end).tinted(paint("#e3b341")))
    return join([*petals, *threads])


def grass(
    place: Float,
    length: Float,
    width: float,
    rng: np.random.Generator,
    codes: tuple[str, ...],
    cells: int = 3,
) -> Mesh:
    """Blades on points (N, 3), dark at the foot and light at the tip."""
    blade = leaf(1.0, width, 0.35, 0.3, cells)
    dark = 0.35 + 0.75 * blade.vertices[:, 2:3]
    count = len(place)
    turn = facing(rng.uniform(0, 360, count), rng.uniform(52, 88, count))
    return scatter(blade.tinted(dark), place, turn, length, shades(count, codes, rng))


def daisy(rng: np.random.Generator, stem: float, petal: str, heart: str, petals: int = 12) -> Mesh:
    """Flower on a stem of height `stem`, in units of its own width."""
    lean = rng.uniform(-0.25, 0.25, 2) * stem
    path = np.array([[0, 0, 0], [0.2 * lean[0], 0.5 * stem, 0.2 * lean[1]], [lean[0], stem, lean[1]]])
    t = np.linspace(0, 2, 6)
    stalk = tube(np.stack([_catmull(path[:, i], t) for i in range(3)], axis=1), 0.035, 5).tinted(paint("#4c7a2e"))
    one = leaf(0.5, 0.2, 0.15, 0.15, 3)
    one = one.tinted(paint(petal) * (0.7 + 0.6 * one.vertices[:, 2:3]))
    head = [one.turned("x", -8.0).turned("y", 360.0 * k / petals) for k in range(petals)]
    head.append(sphere(0.14, 5, 9).scaled(1.0, 0.6, 1.0).moved(0, 0.02, 0).tinted(paint(heart)))
    tipped = join(head).turned("x", rng.uniform(10, 50)).turned("y", rng.uniform(0, 360)).moved(lean[0], stem, lean[1])
    return join([stalk, tipped])


def bush(
    radius: float,
    leaves: int,
    size: float,
    rng: np.random.Generator,
    codes: tuple[str, ...],
    flat: float = 0.8,
) -> Mesh:
    """Ball of leaves about the origin, dark inside and below."""
    direction = rng.normal(size=(leaves, 3))
    direction /= np.sqrt((direction * direction).sum(axis=1, keepdims=True))
    reach = rng.random(leaves) ** 0.35 * (1.0 + 0.25 * Noise3(rng)(direction * 2.0 + 3.0))
    place = radius * reach[:, None] * direction * [1.0, flat, 1.0]
    shade = (0.35 + 0.65 * reach**2) * (0.72 + 0.35 * direction[:, 1])
    turn = facing(
        np.degrees(np.arctan2(direction[:, 0], direction[:, 2])) + rng.uniform(-50, 50, leaves),
        rng.uniform(-50, 40, leaves),
    )
    return scatter(
        leaf(1.0, 0.5, 0.25, 0.2, 2),
        place,
        turn,
        size * rng.uniform(0.7, 1.3, leaves),
        shades(leaves, codes, rng) * shade[:, None],
    )


def tree(
    height: float, leaves: int, size: float, rng: np.random.Generator, codes: tuple[str, ...]
) -> tuple[Mesh, Mesh]:
    """Trunk with boughs, and its leaves."""
    h = height
    trunk = [
        branch(
            [(0, 0, 0), (0.02 * h, 0.3 * h, 0), (-0.01 * h, 0.75 * h, 0.01 * h)],
            0.035 * h,
            0.012 * h,
            rng,
            14,
            8,
        )
    ]
    crowns = []
    for k in range(6):
        angle, up = 2.4 * k + rng.uniform(-0.3, 0.3), rng.uniform(0.45, 0.85)
        far = 0.24 * h * (1.2 - 0.6 * up)
        end = np.array([far * np.sin(angle), up * h, far * np.cos(angle)])
        trunk.append(
            branch(
                np.stack([np.array([0, 0.3 * h, 0]), 0.5 * end + [0, 0.1 * h, 0], end]),
                0.014 * h,
                0.005 * h,
                rng,
                8,
                6,
            )
        )
        crowns.append(bush(0.21 * h, leaves // 7, size, rng, codes).moved(*end))
    crowns.append(bush(0.24 * h, leaves // 7, size, rng, codes).moved(0, 0.82 * h, 0))
    crown = join(crowns)
    lift = np.clip((crown.vertices[:, 1:2] / h - 0.35) / 0.6, 0, 1)
    return join(trunk), crown.tinted(0.62 + 0.5 * lift)


def _catmull(values: Float, t: Float) -> Float:
    """Catmull-Rom curve through `values` at integer t."""
    padded = np.concatenate([[2 * values[0] - values[1]], values, [2 * values[-1] - values[-2]]])
    k = np.minimum(t.astype(np.int64), len(values) - 2)
    s = t - k
    a, b, c, d = (padded[k + i] for i in range(4))
    return b + 0.5 * s * (c - a + s * (2 * a - 5 * b + 4 * c - d + s * (3 * (b - c) + d - a)))

"""Foliage: toadstools, in focus, amid grass, ferns and a thicket that a ray may cross a hundred times.

Figure 8 of Lee, Eisemann & Seidel (2010): single pixels with up to about 100 surfaces.
"""

from collections.abc import Iterator

import numpy as np

from refdof.scene.kit.backdrops import curtain
from refdof.scene.kit.darkening import beside
from refdof.scene.kit.mesh import Mesh, join, scatter
from refdof.scene.kit.noise import Noise3, fractal, smooth
from refdof.scene.kit.plants import branch, bush, daisy, facing, grass, shades
from refdof.scene.kit.shapes import lathe, leaf, plane, sphere
from refdof.scene.kit.shot import Shot
from refdof.scene.kit.textures import blend, mottled, paint, ramp
from refdof.scene.material import Material
from refdof.scene.scene import Part

__all__ = ["NUMBERS", "build"]

NUMBERS = ("blades", "ferns", "thicket")

_CAPS = (
    (-0.06, 0.0, 0.20, 0.085),
    (0.085, -0.05, 0.13, 0.062),
    (0.02, 0.09, 0.075, 0.04),
)  # x, z, height, cap radius


def build(shot: Shot, rng: np.random.Generator) -> Iterator[Part]:
    """Parts of the scene; the toadstools stand at the origin."""
    blades, ferns, thicket = (int(shot.numbers[key]) for key in NUMBERS)
    yield _ground(rng)
    yield from _toadstools(rng)
    yield _meadow(blades, rng).part(Material())
    yield _ferns(ferns, rng).part(Material())
    yield from _flowers(rng)
    yield from _woods(thicket, rng)


def _ground(rng: np.random.Generator) -> Part:
    moss = plane((-5, 0, 1.6), (10, 0, 0), (0, 0, -9), (60, 60))
    rise = 0.05 * Noise3(rng).fractal(moss.vertices * 1.3)
    dip = smooth(0.15, 0.9, np.hypot(moss.vertices[:, 0], moss.vertices[:, 2]))
    points = moss.vertices + np.column_stack([0 * rise, rise * dip, 0 * rise])
    shade = np.ones((len(points), 1))
    for x, z, _, r in _CAPS:
        shade = shade * beside(points, (x, 0, z), 0.5 * r, 0.06, 0.5)
    soil = mottled(512, ("#22301a", "#3d4f22", "#5d6b2f", "#4a3a22"), rng, 12, 5)
    return Mesh(points, moss.faces, moss.uv * [8, 7], moss.color * shade, moss.normal).part(Material(texture=soil))


def _toadstools(rng: np.random.Generator) -> Iterator[Part]:
    """Red caps with white warts, gills below, ringed stems."""
    caps, pale = [], []
    for x, z, h, r in _CAPS:
        lean = rng.uniform(-7, 7)
        t = np.linspace(0, 1, 14)
        dome = np.column_stack([r * np.sin(np.pi / 2 * t), h + 0.62 * r * np.cos(np.pi / 2 * t) ** 0.9])
        cap = lathe([[(float(a), float(b)) for a, b in dome]], 48)
        tone = ramp(cap.vertices[:, 1] / r - h / r + 0.25, ("#8f1610", "#c8261a", "#de4526"))
        caps.append(cap.tinted(tone).turned("z", lean).moved(x, 0, z))
        gills = lathe([[(r, h), (0.9 * r, h - 0.05 * r), (0.2 * r, h + 0.05 * r)]], 96)
        stripe = 0.55 + 0.45 * (np.arange(97) % 2)
        stem = lathe(
            [
                [(0.2 * r, 0.0), (0.26 * r, 0.1 * h), (0.17 * r, 0.5 * h), (0.15 * r, 1.05 * h)],
                [(0.3 * r, 0.66 * h), (0.17 * r, 0.76 * h)],
            ],
            24,
        )
        stem = stem.tinted(0.45 + 0.55 * np.clip(stem.vertices[:, 1:2] / (0.5 * h), 0, 1))
        body = [gills.tinted(np.tile(stripe, 3)[:, None] * 0.8), stem]
        for k in range(int(260 * r)):
            a, b = 2.4 * k, np.sqrt((k + 0.6) / (260 * r)) * 0.93
            at = (
                r * np.sin(np.pi / 2 * b) * np.sin(a),
                h + 0.62 * r * np.cos(np.pi / 2 * b) ** 0.9,
                r * np.sin(np.pi / 2 * b) * np.cos(a),
            )
            body.append(sphere(r * rng.uniform(0.05, 0.1), 5, 9).scaled(1, 0.55, 1).moved(*at))
        pale.append(join(body).tinted(paint("#f0e8d2")).turned("z", lean).moved(x, 0, z))
    yield join(caps).part(Material("phong", specular=(0.06, 0.06, 0.06), shininess=40))
    yield join(pale).part(Material())


def _meadow(count: int, rng: np.random.Generator) -> Mesh:
    """Grass, thick at a distance and cleared before the toadstools."""
    z = 0.82 - 4.8 * rng.random(count)
    x = rng.uniform(-1, 1, count) * (0.35 + 0.42 * (1.5 - z))
    near = np.hypot(x, (z - 0.25) * 0.55)
    keep = (near > 0.19) & ~((z > 0.55) & (np.abs(x) < 0.16))
    place = np.column_stack([x, 0 * x, z])[keep]
    tall = rng.uniform(0.09, 0.30, keep.sum()) * smooth(0.05, 0.55, near[keep]) + 0.035
    tall *= 1.0 + 1.1 * smooth(0.4, 2.4, -place[:, 2])  # rank grass behind
    return grass(place, tall, 0.055, rng, ("#2c4f1c", "#557f2a", "#8ea548", "#b3ac5c"), 2)


def _frond(pairs: int) -> Mesh:
    """Fern frond of unit length along +z that droops."""
    t = np.linspace(0.08, 0.99, pairs)
    height = 0.5 * np.sin(1.9 * t) - 0.25 * t**2
    size = 0.34 * np.sin(np.pi * (0.10 + 0.9 * t)) ** 0.8 + 0.02
    place = np.column_stack([0 * t, height, t])
    sides = [facing(np.full(pairs, s * 68.0), np.full(pairs, -12.0), np.full(pairs, s * -14.0)) for s in (-1, 1)]
    blade = leaf(1.0, 0.17, 0.25, 0.2, 2)
    leaves = [scatter(blade, place, turn, size) for turn in sides]
    u = np.linspace(0, 1, 10)
    stalk = branch(
        np.column_stack([0 * u, 0.5 * np.sin(1.9 * u) - 0.25 * u**2, u]),
        0.011,
        0.003,
        np.random.default_rng(0),
        10,
        4,
        0.0,
    )
    return join([*leaves, stalk.tinted((0.7, 0.6, 0.4))])


def _ferns(count: int, rng: np.random.Generator) -> Mesh:
    """Crowns of fronds around the clearing and behind it."""
    frond = _frond(20)
    place, turn, size = [], [], []
    for k in range(count):
        z = -0.45 - 3.4 * rng.random() if k > 4 else (0.55, 0.6, -0.25, -0.35, 0.3)[k]
        x = rng.uniform(-1.0, 1.0) * (0.5 - 0.42 * z) if k > 4 else (-0.40, 0.43, -0.42, 0.5, -0.62)[k]
        for j in range(8):
            place.append((x, 0.02, z))
            turn.append((45.0 * j + rng.uniform(-18, 18), rng.uniform(15, 42)))
            size.append(rng.uniform(0.24, 0.44))
    angles = np.array(turn)
    return scatter(
        frond,
        np.array(place),
        facing(angles[:, 0], angles[:, 1]),
        np.array(size),
        shades(len(size), ("#2f5f22", "#548a30", "#8ab04a"), rng),
    )


def _flowers(rng: np.random.Generator) -> Iterator[Part]:
    """Wood anemones and bluebells beside the toadstools and in the meadow."""
    heads = []
    for petal, heart, count in (
        ("#f5f2ea", "#e3bb3c", 26),
        ("#8d7fd0", "#e9dc9a", 22),
        ("#f0cf4c", "#a8681c", 12),
    ):
        x, z = rng.uniform(-1.0, 1.0, count), 0.35 - 2.6 * rng.random(count)
        keep = np.hypot(x, z * 0.6) > 0.2
        place = np.column_stack([x * (0.5 - 0.3 * z), 0 * x, z])[keep]
        one = daisy(rng, 4.2, petal, heart, 8)
        heads.append(
            scatter(
                one,
                place,
                facing(rng.uniform(-60, 60, len(place)), 0 * place[:, 0]),
                rng.uniform(0.035, 0.06, len(place)),
            )
        )
    yield join(heads).part(Material())


def _woods(thicket: int, rng: np.random.Generator) -> Iterator[Part]:
    """Hazel leaves in clumps, trunks, a bough across the top, and sunlit distance."""
    clumps = [
        bush(r, thicket // 9, 0.10, rng, ("#38682a", "#6a9a38", "#a8b850"), 0.9).moved(x, y, z)
        for x, y, z, r in (
            (-1.5, 0.55, -2.2, 0.55),
            (-0.6, 0.4, -2.7, 0.5),
            (0.35, 0.42, -2.5, 0.5),
            (1.3, 0.55, -2.1, 0.55),
            (2.0, 0.6, -3.2, 0.7),
            (-2.2, 0.7, -3.3, 0.8),
            (0.0, 0.5, -3.5, 0.7),
            (-1.2, 0.5, -3.6, 0.7),
            (1.2, 0.5, -3.7, 0.7),
        )
    ]
    yield join(clumps).part(Material())
    bough = np.array([(-0.62, 0.60, 0.62), (-0.3, 0.66, 0.6), (0.0, 0.63, 0.62), (0.3, 0.68, 0.58)])
    twigs = [branch(bough, 0.008, 0.003, rng, 40, 8).tinted(paint("#5a4630"))]
    t = rng.random(46) * 2.95
    k = t.astype(int)
    place = bough[k] + (t - k)[:, None] * (bough[k + 1] - bough[k]) + rng.normal(0, 0.02, (46, 3))
    hanging = scatter(
        leaf(1.0, 0.62, 0.3, 0.18, 5),
        place,
        facing(rng.uniform(0, 360, 46), rng.uniform(-75, 10, 46)),
        rng.uniform(0.06, 0.12, 46),
        shades(46, ("#4d8030", "#86ad42", "#b9c058"), rng),
    )
    trunks = [
        branch([(x, -0.1, z), (x + 0.08, 0.9, z), (x - 0.05, 2.2, z + 0.1)], r, 0.7 * r, rng, 40, 16, 0.18)
        for x, z, r in (
            (-1.05, -2.9, 0.13),
            (1.15, -3.3, 0.17),
            (0.3, -4.6, 0.12),
            (-0.4, -5.0, 0.10),
            (2.3, -4.4, 0.2),
            (-2.4, -4.6, 0.2),
        )
    ]
    yield join([*twigs, hanging]).part(Material())
    bark = mottled(256, ("#3a3226", "#5f523e", "#857a5e", "#66713f"), rng, 8)
    yield join(trunks).part(Material(texture=bark))
    u = np.linspace(0, 1, 1024)[None, :] * np.ones((512, 1))
    v = np.linspace(1, 0, 512)[:, None] * np.ones((1, 1024))
    haze = fractal((512, 1024), (5, 10), rng, 6, 0.6)
    stripe = fractal((1, 1024), (1, 40), rng, 3)[0][None, :] + 0.08 * (haze - 0.5)
    glow = np.exp(-(((u - 0.58) / 0.2) ** 2 + ((v - 0.55) / 0.5) ** 2))
    color = ramp(0.15 + 0.5 * haze + 0.35 * glow + 0.12 * v, ("#2f4a26", "#5f8a3c", "#a9bf62", "#eff0b4"))
    color = blend(color, color * paint("#6f7a58")[None, None] * 1.6, smooth(0.56, 0.66, stripe) * (1 - 0.6 * glow))
    yield (curtain(22.0, 7.0, 6.6, 0.9).moved(0, -0.6, 0).part(Material("unlit", texture=color.astype(np.float32))))

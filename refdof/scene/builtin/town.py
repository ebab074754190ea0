"""Town: gabled houses along a market street, a church, trees and hills; half way down the street is in focus.

Table 1 of Lee, Eisemann & Seidel (2010): about 100 000 triangles over a wide range of depths.
"""

from collections.abc import Iterator

import numpy as np

from refdof._check import Float
from refdof.scene.kit.backdrops import sky
from refdof.scene.kit.darkening import beside, capsule_shadow
from refdof.scene.kit.houses import church, gather, house, timbered
from refdof.scene.kit.mesh import Mesh, join
from refdof.scene.kit.noise import Noise3, smooth
from refdof.scene.kit.plants import tree
from refdof.scene.kit.shapes import box, lathe, surface
from refdof.scene.kit.shot import Shot
from refdof.scene.kit.textures import bricks, cobbles, mottled, paint
from refdof.scene.kit.vehicles import car
from refdof.scene.material import Material
from refdof.scene.scene import Part

__all__ = ["NUMBERS", "build"]

NUMBERS = ("rows", "pitch", "trees")

_WALLS = ("cream", "rose", "ochre", "timber", "timber", "sage", "timber dark")
_ROOFS = ("red", "red", "brown", "slate")


def build(shot: Shot, rng: np.random.Generator) -> Iterator[Part]:
    """Parts of the scene; the street runs along -z and bends a little."""
    rows, pitch, trees = int(shot.numbers["rows"]), shot.numbers["pitch"], int(shot.numbers["trees"])
    lots = _lots(rows, pitch, rng)
    groups = []
    for x, z, turn, width, depth, storeys in lots:
        wall, roof = _WALLS[rng.integers(len(_WALLS))], _ROOFS[rng.integers(len(_ROOFS))]
        one = house(width, depth, int(storeys), wall, roof, rng)
        groups.append({n: m.turned("y", turn).moved(x, float(_ground_level(x, z)), z) for n, m in one.items()})
    end = -pitch * rows - 6.0
    groups.append({n: m.moved(float(_bend(end)) + 1.0, 0, end - 10.0) for n, m in church(rng).items()})
    skins = _materials(rng)
    for name, mesh in sorted(gather(groups).items()):
        yield mesh.part(skins[name])
    yield from _terrain(lots, shot, rng)
    yield from _greenery(trees, rows * pitch, lots, rng)
    yield from _street(rows * pitch, rng)
    yield sky(260.0, ("#e9e2d0", "#a9c9e6", "#5c92cf"), rng, cover=0.3, ridge=("#5f7a86", 0.05))


def _bend(z: float | Float) -> Float:
    """Middle of the street at z."""
    return 2.2 * np.sin(np.asarray(z) / 26.0)


def _ground_level(x: float | Float, z: float | Float) -> float | Float:
    """Height of the ground: level in the street, rising beside it."""
    off = np.maximum(np.abs(np.asarray(x) - _bend(z)) - 11.0, 0.0)
    return 0.16 * off + 0.0012 * off**2


def _lots(rows: int, pitch: float, rng: np.random.Generator) -> list[tuple[float, float, float, float, float, int]]:
    """(x, z, turn, width, depth, storeys) of every house: two rows along the street, others on the slopes."""
    lots: list[tuple[float, float, float, float, float, int]] = []
    for k in range(rows):
        for side in (-1, 1):
            z = -pitch * k + (2.0 if side > 0 else 0.0)
            width, depth = rng.uniform(5.6, 7.3), rng.uniform(6.2, 8.0)
            lots.append(
                (
                    float(_bend(z)) + side * (5.4 + depth / 2),
                    z,
                    -90.0 * side + rng.uniform(-3, 3),
                    width,
                    depth,
                    int(rng.integers(2, 4)),
                )
            )
        for side in (-1, 1):
            if k % 2:
                z = -pitch * k + rng.uniform(-2, 2)
                x = float(_bend(z)) + side * rng.uniform(21, 30)
                lots.append((x, z, -90.0 * side + rng.uniform(-25, 25), rng.uniform(6, 8), rng.uniform(6, 8), 2))
    return lots


def _materials(rng: np.random.Generator) -> dict[str, Material]:
    def tiles_of(codes: tuple[str, ...], gap: str) -> Material:
        return Material(texture=bricks(256, 12, 10, codes, gap, rng, 0.16))

    def plaster(*codes: str) -> Material:
        return Material(texture=mottled(256, codes, rng, 5))

    return {
        "wall cream": plaster("#cbb98f", "#e3d4ac", "#efe5c8"),
        "wall rose": plaster("#b98270", "#d3a18c", "#e2b9a4"),
        "wall ochre": plaster("#b98a45", "#d6a95f", "#e5c283"),
        "wall sage": plaster("#8d9a7a", "#aab694", "#c3ccb0"),
        "wall timber": Material(texture=timbered(512, "#eadfc4", "#4a2f1e", rng)),
        "wall timber dark": Material(texture=timbered(512, "#d9b98a", "#3a2418", rng)),
        "wall stone": Material(texture=bricks(256, 8, 5, ("#8e8574", "#a89e8a", "#bfb59f"), "#6f6758", rng)),
        "plain": plaster("#cfc3a6", "#e0d6bd", "#ece4d0"),
        "roof red": tiles_of(("#7c3320", "#a44a2c", "#bd6540"), "#45201a"),
        "roof brown": tiles_of(("#5b3a2a", "#7d543c", "#946a4e"), "#33211a"),
        "roof slate": tiles_of(("#454c56", "#5b646f", "#727c86"), "#2c3138"),
        "brick": Material(texture=bricks(128, 8, 3, ("#7d3f2c", "#96523a"), "#8d8070", rng)),
        "clay": Material(base_color=tuple(paint("#b5653f").tolist())),
        "trim": plaster("#a69c88", "#c2b8a3", "#d6cdb9"),
        "frame": Material(base_color=(0.78, 0.76, 0.70)),
        "frame dark": Material(base_color=(0.03, 0.03, 0.03)),
        "glass": Material("phong", (0.07, 0.10, 0.14), specular=(0.35, 0.35, 0.35), shininess=60),
        "door": plaster("#4a2f22", "#6b4630", "#2f5a5e"),
        "shutter": plaster("#2f5f52", "#4c7d66", "#6a9078"),
    }


def _terrain(lots: list, shot: Shot, rng: np.random.Generator) -> Iterator[Part]:
    """Cobbled street and grassy slopes, darkened around the houses."""
    t = np.linspace(0, 1, 100)[:, None]
    z = 22.0 - 190.0 * t**1.25
    x = _bend(z) + 5.6 * np.linspace(-1, 1, 25)[None, :]
    street = surface(
        np.stack([x, 0 * x + 0.02, z + 0 * x], axis=-1),
        np.stack([(x - _bend(z)) / 2.8, z / 2.8 + 0 * x], axis=-1),
    )
    shade = np.ones((len(street.vertices), 1))
    for x0, z0, _, width, _, storeys in lots:
        shade = shade * capsule_shadow(
            street.vertices, (x0, 0, z0), 2.7 * storeys, 0.55 * width, shot.light.sun_direction, 1.2, 0.55
        )
    edge = np.abs(street.vertices[:, 0] - _bend(street.vertices[:, 2]))
    shade = shade * (1.0 - 0.35 * smooth(4.6, 5.6, edge))[:, None]
    yield street.tinted(shade).part(
        Material(texture=cobbles(512, 14, ("#7e766a", "#a0968a", "#bcb2a2"), "#5a5248", rng))
    )
    s, t = np.meshgrid(np.linspace(-1, 1, 61), np.linspace(0, 1, 71))
    z = 24.0 - 250.0 * t**1.3
    x = _bend(z) + 120.0 * np.sign(s) * np.abs(s) ** 1.6
    slope = surface(np.stack([x, _ground_level(x, z), z], axis=-1), np.stack([x, z], axis=-1) / 18.0)
    patches = (0.9 + 0.3 * Noise3(rng).fractal(slope.vertices * 0.06))[:, None]
    for x0, z0, _, width, _, _ in lots:
        slope = slope.tinted(beside(slope.vertices, (x0, 0, z0), 0.5 * width, 1.5, 0.4))
    yield slope.tinted(patches).part(
        Material(texture=mottled(512, ("#4c6a2c", "#6f8f3e", "#96a85a", "#b3a968"), rng, 8))
    )


def _greenery(count: int, length: float, lots: list, rng: np.random.Generator) -> Iterator[Part]:
    """Trees on the slopes and a few in the street."""
    kinds = [
        tree(1.0, 230, 0.095, rng, codes)
        for codes in (
            ("#3c6a2c", "#5f8f38", "#8aa84c"),
            ("#2f5a30", "#4d7d3c", "#71984a"),
            ("#8a7a2c", "#b3983c", "#7f9440"),
        )
    ]
    trunks: list[Mesh] = []
    crowns: list[Mesh] = []
    for k in range(count):
        side = 1 if k % 2 else -1
        z = 6.0 - (length + 50.0) * rng.random()
        x = float(_bend(z)) + side * (4.6 if k % 5 == 0 else rng.uniform(17, 60))
        if any(np.hypot(x - a, z - b) < 6.0 for a, b, *_ in lots) and k % 5:
            continue
        high = rng.uniform(4.0, 5.0) if k % 5 == 0 else rng.uniform(6.0, 10.5)
        trunk, crown = kinds[k % 3]
        for mesh, found in ((trunk, trunks), (crown, crowns)):
            found.append(mesh.scaled(high).turned("y", rng.uniform(0, 360)).moved(x, float(_ground_level(x, z)), z))
    yield join(trunks).part(Material(base_color=tuple(paint("#5f4a36").tolist())))
    yield join(crowns).part(Material())


def _street(length: float, rng: np.random.Generator) -> Iterator[Part]:
    """Market stalls, lamp posts, cars and barrels."""
    stalls, cloths, posts = [], [], []
    for k in range(9):
        z = -8.0 - 6.4 * k
        x = float(_bend(z)) + (2.9 if k % 2 else -2.9)
        stalls += [box(0.09, 2.2, 0.09).moved(x + a, 0, z + b) for a in (-1.0, 1.0) for b in (-0.8, 0.8)]
        stalls.append(box(2.0, 0.9, 1.3).moved(x, 0, z))
        s, t = np.meshgrid(np.linspace(-1, 1, 13), np.linspace(-1, 1, 5))
        roof = surface(np.stack([1.25 * s, 2.75 - 0.55 * t**2 - 0.04 * np.cos(12 * s) * np.abs(t), 1.15 * t], axis=-1))
        stripe = np.where(np.arange(13) % 2, 1.0, 0.0)[None, :].repeat(5, axis=0).reshape(-1, 1)
        code = ("#b8342c", "#2f6a8f", "#3f7f4a", "#d08a2c")[k % 4]
        cloths.append(roof.tinted(paint(code) + (paint("#f2ead8") - paint(code)) * stripe).moved(x, 0, z))
        for j in range(24):
            ball = lathe([[(0.0, 0.0), (0.11, 0.05), (0.1, 0.14), (0.0, 0.18)]], 6)
            fruit = paint(("#d0452c", "#e3a62f", "#6a9a3a", "#8f3f5a", "#e07a2c")[(j // 5 + k) % 5])
            cloths.append(ball.tinted(fruit).moved(x - 0.8 + 0.23 * (j % 8), 0.9, z - 0.4 + 0.4 * (j // 8)))
    post = lathe([[(0.16, 0.0), (0.15, 0.4), (0.07, 0.5), (0.05, 3.2), (0.2, 3.4), (0.16, 3.9), (0.0, 4.2)]], 8)
    for k in range(10):
        z = 2.0 - length * k / 10
        posts.append(post.moved(float(_bend(z)) + (4.4 if k % 2 else -4.4), 0, z))
    yield (join(stalls).tiled(0.5, 0.5).part(Material(texture=mottled(128, ("#6a4a30", "#8c6642", "#a88258"), rng))))
    yield join(cloths).part(Material())
    yield join(posts).part(Material("phong", (0.06, 0.07, 0.07), specular=(0.1, 0.1, 0.1)))
    shape = car()
    for x, z, turn, code in (
        (1.2, 1.5, 176.0, "#b23a2c"),
        (-1.4, -13.0, 4.0, "#d9d2bd"),
        (1.0, -27.0, 182.0, "#3f6a86"),
        (-1.0, -47.0, 2.0, "#c79a3c"),
    ):
        tints = {
            "paint": paint(code),
            "glass": paint("#26303a"),
            "black": paint("#222224"),
            "rear": paint("#8c1a16"),
            "front": paint("#efe9d6"),
        }
        whole = join(m.tinted(tints[n]) for n, m in shape.items()).turned("y", turn).moved(x + float(_bend(z)), 0.03, z)
        yield whole.part(Material("phong", specular=(0.14, 0.14, 0.14), shininess=60))

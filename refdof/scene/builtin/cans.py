"""Cans: a row of tins that recedes along a kitchen table, the nearest in focus.

Figure 11 of Lee, Kim & Choi (2009): what is sharp must not leak into the blurred background behind it.
"""

from collections.abc import Iterator

import numpy as np

from refdof._check import Float
from refdof.scene.kit.darkening import beside, capsule_shadow, corner_shade
from refdof.scene.kit.labels import label
from refdof.scene.kit.mesh import Mesh, join
from refdof.scene.kit.noise import Noise3
from refdof.scene.kit.shapes import box, lathe, leaf, plane, sphere
from refdof.scene.kit.shot import Shot
from refdof.scene.kit.textures import paint, planks, tiles, wood
from refdof.scene.material import Material
from refdof.scene.scene import Part

__all__ = ["NUMBERS", "build"]

NUMBERS = ("cans", "spacing")

_RADIUS, _HEIGHT, _WALL = 0.0375, 0.108, -1.35
_DESIGNS = (
    ("#b3242b", "#7d1418", "#2a3a2a", "#cf2f22", 1, "TOMATO"),
    ("#e9dfc4", "#2f6b4a", "#1e4a34", "#6fa03c", 5, "PEAS"),
    ("#f0b43c", "#a34a1c", "#7a2f14", "#f2c230", 5, "CORN"),
    ("#2e5f8a", "#16324f", "#c2412d", "#e08a4a", 1, "PEACH"),
    ("#efe6d8", "#8c2f45", "#5a1a30", "#7b2a58", 4, "PLUM"),
    ("#4d7f73", "#1f4a44", "#23302f", "#98a64a", 3, "OLIVE"),
    ("#e8e2cf", "#c9542b", "#8c2f18", "#d2691e", 3, "SOUP"),
)


def build(shot: Shot, rng: np.random.Generator) -> Iterator[Part]:
    """Parts of the scene."""
    count = int(shot.numbers["cans"])
    k = np.arange(count)
    # The row bends a little, as a hand would set it.
    place = np.stack([-0.085 + 0.088 * k + 0.004 * k**2, 0 * k, 0.05 - shot.numbers["spacing"] * k], axis=1)
    place[1:, [0, 2]] += rng.uniform(-0.006, 0.006, (count - 1, 2))
    turns = rng.uniform(-28, 28, count) - 85.0  # a panel's middle is a quarter turn from the seam
    turns[0] = -92.0
    paper = lathe([[(_RADIUS, y) for y in np.linspace(0.004, _HEIGHT - 0.004, 8)]], 56)
    for i in range(count):
        skin = Material(
            "phong",
            texture=label(_DESIGNS[i % len(_DESIGNS)], rng),
            specular=(0.035, 0.035, 0.035),
            shininess=40,
        )
        shade = 1.0 - 0.45 * np.exp(-paper.vertices[:, 1:2] / 0.012)
        yield paper.tinted(shade).turned("y", turns[i]).moved(*place[i]).part(skin)
    metal = Material("phong", (0.34, 0.34, 0.35), specular=(0.55, 0.55, 0.55), shininess=60)
    yield join(_tin().moved(*p) for p in place).part(metal)
    fruit = np.array(
        [
            (0.012, 0.031, 0.085),
            (0.055, 0.027, 0.045),
            (-0.2, 0.03, -0.36),
            (-0.27, 0.033, -0.3),
            (-0.21, 0.03, -0.24),
        ]
    )
    yield from _tomatoes(fruit, rng)
    yield _table(place, fruit, shot, rng)
    yield from _wall(rng)


def _tin() -> Mesh:
    """Rims, a ribbed lid that lies a little deep, and the seam below."""
    r, h = _RADIUS, _HEIGHT
    rim = [
        (r * 1.0, h - 0.005),
        (r * 1.035, h - 0.003),
        (r * 1.035, h),
        (r * 0.99, h + 0.0012),
        (r * 0.95, h),
    ]
    lid = [
        (r * 0.95, h),
        (r * 0.94, h - 0.004),
        (r * 0.85, h - 0.0045),
        (r * 0.8, h - 0.003),
        (r * 0.75, h - 0.0045),
    ]
    lid += [(r * 0.5, h - 0.0045), (r * 0.46, h - 0.0032), (r * 0.42, h - 0.0045), (0.0, h - 0.0045)]
    foot = [(r * 1.0, 0.005), (r * 1.03, 0.003), (r * 1.03, 0.0005), (r * 0.97, 0.0)]
    return lathe([foot[::-1], rim, lid], 56)


def _tomatoes(place: Float, rng: np.random.Generator) -> Iterator[Part]:
    """Ripe tomatoes with their green stars."""
    skins, stars = [], []
    for x, y, z in place:
        ribs = rng.uniform(0, 6.28)

        def bulge(unit: Float, ribs: float = ribs) -> Float:
            angle = np.arctan2(unit[..., 0], unit[..., 2])
            top = np.maximum(unit[..., 1], 0.0)
            return 1.0 + 0.035 * np.cos(5 * angle + ribs) * top - 0.2 * top**14 - 0.06 * np.abs(unit[..., 1])

        ball = sphere(y / 0.92, 20, 36, bulge)
        low = ball.vertices[:, 1:2] / y
        hue = paint("#c8281c") + (paint("#e2662a") - paint("#c8281c")) * np.clip(low - 0.3, 0, 1)
        lean = rng.uniform(-14, 14)
        skins.append(ball.tinted(hue * (1.0 - 0.55 * np.clip(-low, 0, 1))).turned("z", lean).moved(x, y, z))
        one = leaf(0.021, 0.007, 0.35, 0.1).tinted(paint("#4a7d34"))
        star = join(one.turned("y", 72.0 * k + rng.uniform(-12, 12)) for k in range(5))
        stars.append(star.moved(0, y * 0.93, 0).turned("z", lean).moved(x, y, z))
    yield join(skins).part(Material("phong", specular=(0.09, 0.09, 0.09), shininess=70))
    yield join(stars).part(Material("lambert"))


def _table(place: Float, fruit: Float, shot: Shot, rng: np.random.Generator) -> Part:
    """Boards across the picture, with the shade of what stands on them."""
    top = plane((-1.6, 0.0, 0.6), (3.2, 0, 0), (0, 0, _WALL - 0.6), (150, 120))
    shade = corner_shade(top.vertices[:, 2] - _WALL, 0.10, 0.6)
    for p in place:
        shade = shade * beside(top.vertices, p, _RADIUS, 0.012, 0.6)
        shade = shade * capsule_shadow(top.vertices, p, _HEIGHT, _RADIUS, shot.light.sun_direction, 0.012, 0.75)
    for x, y, z in fruit:
        shade = shade * beside(top.vertices, (x, 0, z), 0.3 * y, 0.014, 0.75)
        shade = shade * capsule_shadow(top.vertices, (x, 0, z), y, 0.85 * y, shot.light.sun_direction, 0.01, 0.7)
    boards = planks(1024, 7, ("#7a5233", "#a9794c", "#cda273", "#e2c194"), rng)
    return (
        top.tiled(3.1, 2.6)
        .tinted(shade)
        .part(Material("phong", texture=boards, specular=(0.03, 0.03, 0.03), shininess=30))
    )


def _wall(rng: np.random.Generator) -> Iterator[Part]:
    """Glazed tiles, a shelf with jars, and a hanging cloth."""
    wall = plane((-1.6, 0.0, _WALL), (3.2, 0, 0), (0, 1.3, 0), (64, 52))
    x, y = wall.vertices[:, 0], wall.vertices[:, 1]
    light = 0.62 + 0.45 * np.exp(-((x + 0.35) ** 2 + (y - 0.45) ** 2) / 0.35)
    under = np.where((y < 0.185) & (np.abs(x - 0.2) < 1.1), 1.0 - 0.5 * np.exp(-(0.185 - y) / 0.05), 1.0)
    glaze = tiles(512, 8, ("#8fa99b", "#b9cbb8", "#d9dfcf"), "#6d6a60", rng, 0.04)
    tint = (light * under)[:, None] * corner_shade(y, 0.08, 0.5)
    yield (
        wall.tiled(2.9, 1.2)
        .tinted(tint)
        .part(Material("phong", texture=glaze, specular=(0.06, 0.06, 0.06), shininess=30))
    )
    shelf = box(2.2, 0.03, 0.16).moved(0.2, 0.185, _WALL + 0.08).tiled(1.2, 6.0)
    yield shelf.part(Material(texture=wood(256, ("#4a2f1c", "#7a5232", "#9c7148"), rng)))
    jar = [
        [(0.0, 0.0), (0.045, 0.0)],
        [(0.045, 0.0), (0.05, 0.01), (0.05, 0.11), (0.036, 0.13), (0.036, 0.145)],
    ]
    lid = [[(0.04, 0.143), (0.04, 0.165), (0.0, 0.167)]]
    codes = (
        "#c4512d",
        "#e3b04b",
        "#4f7a4a",
        "#8e3b46",
        "#d8c9a8",
        "#35597a",
        "#d98a3d",
        "#6c8f5f",
        "#b8443a",
        "#e6d3a0",
    )
    spots = np.linspace(-0.78, 1.2, len(codes)) + rng.uniform(-0.03, 0.03, len(codes))
    grow, noise = rng.uniform(0.85, 1.25, len(codes)), Noise3(rng)
    jars = [
        lathe(jar, 24).scaled(g).tinted(paint(c)).moved(p, 0.215, _WALL + 0.08)
        for p, g, c in zip(spots, grow, codes, strict=True)
    ]
    lids = [lathe(lid, 24).scaled(g).moved(p, 0.215, _WALL + 0.08) for p, g in zip(spots, grow, strict=True)]
    filled = join(jars)
    grain = 0.8 + 0.35 * noise(filled.vertices * 60.0)
    yield filled.tinted(grain[:, None]).part(Material("phong", specular=(0.12, 0.12, 0.12), shininess=50))
    yield join(lids).part(Material("phong", (0.5, 0.42, 0.25), specular=(0.3, 0.26, 0.16), shininess=40))

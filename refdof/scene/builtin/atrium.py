"""Atrium: two storeys of arcades around a paved court, seen past the near columns to the sunlit far wall.

Figure 12 of Lee, Kim & Choi (2009): near columns are strongly blurred, the far wall is in focus.
"""

from collections.abc import Iterator

import numpy as np

from refdof._check import Float
from refdof.scene.kit.backdrops import sky
from refdof.scene.kit.darkening import beside, corner_shade
from refdof.scene.kit.masonry import baluster, column
from refdof.scene.kit.mesh import Mesh, join
from refdof.scene.kit.noise import smooth
from refdof.scene.kit.shapes import arch, box, disc, lathe, leaf, plane, surface
from refdof.scene.kit.shot import Shot
from refdof.scene.kit.textures import bricks, cloth, mottled, paint, stone, tiles
from refdof.scene.material import Material
from refdof.scene.scene import Part

__all__ = ["NUMBERS", "build"]

NUMBERS = ("bays", "bay", "aisle")

_SPRING, _STOREY, _TOP, _DEPTH = 2.9, 4.6, 8.2, 0.5


def build(shot: Shot, rng: np.random.Generator) -> Iterator[Part]:
    """Parts of the scene; the court runs along -z, its middle at x = 0."""
    bays, bay, aisle = int(shot.numbers["bays"]), shot.numbers["bay"], shot.numbers["aisle"]
    far = -bays * bay
    sand = Material(texture=stone(512, ("#b59a72", "#cdb48a", "#e0cba4", "#e9d9b8"), rng, 0.25))
    blocks = bricks(1024, 12, 6, ("#c9ab7c", "#d3b88c", "#dcc69c", "#cfae84"), "#a58c64", rng, 0.035)
    wall = Material(texture=blocks)
    pillars, arches, rails, uppers = [], [], [], []
    for side in (-1, 1):
        for k in range(bays + 1):
            pillars.append(column(_SPRING, 0.24, 48, 12).moved(side * aisle, 0, -k * bay))
            uppers.append(column(_TOP - _STOREY - 1.55, 0.15, 24).moved(side * aisle, _STOREY + 0.2, -k * bay))
        for k in range(bays):
            middle = -(k + 0.5) * bay
            low = arch(bay, _SPRING, _STOREY, _DEPTH, 0.3, 20)
            high = arch(bay, _TOP - 1.35, _TOP, 0.35, 0.2, 16)
            for shape in (low, high):
                arches.append(shape.turned("y", 90).moved(side * aisle, 0, middle))
            rails += _rail(bay, side * (aisle - 0.02), middle)
    yield join(pillars + uppers).tiled(2.0, 2.0).part(sand)
    lit = join(arches)
    shade = corner_shade(lit.vertices[:, 1] - _STOREY, 0.25, 0.3)
    yield lit.tiled(0.4, 0.4).tinted(shade).part(wall)
    yield join(rails).tiled(0.7, 0.7).part(sand)
    yield from _galleries(bays, bay, aisle, wall, rng)
    yield _floor(bays, bay, aisle, rng)
    yield from _far_wall(far, aisle, wall, sand, rng)
    yield from _banners(bays, bay, aisle, rng)
    yield from _planters(bay, aisle, far, rng)
    yield sky(80.0, ("#e9e6dc", "#9fc0e2", "#4f86c6"), rng, cover=0.6)


def _rail(bay: float, x: float, middle: float) -> list[Mesh]:
    """Cornice, balusters and hand rail above one arch."""
    posts = [baluster(0.6, 10).moved(x, _STOREY + 0.2, middle + bay * (k / 7 - 3 / 7)) for k in range(7)]
    cornice = box(_DEPTH + 0.2, 0.2, bay).moved(x, _STOREY, middle)
    return [*posts, cornice, box(0.22, 0.1, bay).moved(x, _STOREY + 0.8, middle)]


def _galleries(bays: int, bay: float, aisle: float, wall: Material, rng: np.random.Generator) -> Iterator[Part]:
    """Outer walls and ceilings of the aisles, dark inside, and the roofs."""
    far, back = -bays * bay, 2.6
    inside, ceilings = [], []
    for side in (-1, 1):
        x = side * (aisle + back)
        face = plane((x, 0, 3.0), (0, 0, far - 3.0), (0, _TOP, 0), (60, 24))
        y = face.vertices[:, 1]
        tone = 0.30 + 0.38 * np.exp(-(((y % _STOREY) - 1.0) ** 2) / 2.2)
        inside.append(face.tiled((3.0 - far) * 0.4, _TOP * 0.4).tinted(tone[:, None]))
        for level in (_STOREY, _TOP):
            flat = plane((side * (aisle - 0.2), level, 3.0), (0, 0, far - 3.0), (side * (back + 0.2), 0, 0), (40, 6))
            ceilings.append(flat.tiled(8, 1).tinted((0.42, 0.40, 0.38)))
    yield join(inside).part(wall)
    yield join(ceilings).part(Material(texture=mottled(256, ("#8d7552", "#b59b72", "#c9b48c"), rng)))
    roof = [box(3.2, 0.3, 3.0 - far).moved(s * (aisle + 1.2), _TOP, (3.0 + far) / 2) for s in (-1, 1)]
    yield (
        join(roof)
        .tiled(0.8, 0.8)
        .part(Material(texture=bricks(256, 8, 6, ("#8e4a2c", "#b4623a", "#c97a4d"), "#5a3020", rng)))
    )


def _floor(bays: int, bay: float, aisle: float, rng: np.random.Generator) -> Part:
    """Paving, darker in the aisles and around the columns, with a runner of light along the court."""
    far = -bays * bay
    ground = plane((-6, 0, 3.5), (12, 0, 0), (0, 0, far - 3.5), (120, 240))
    p = ground.vertices
    shade = (0.42 + 0.58 * smooth(aisle + 0.5, aisle - 0.6, np.abs(p[:, 0])))[:, None]
    patch = smooth(-0.2, 0.2, np.sin((p[:, 2] + 0.5 * p[:, 0]) * 2 * np.pi / bay) - 0.1)
    shade = shade * (0.8 + 0.34 * patch * smooth(aisle, aisle - 0.8, np.abs(p[:, 0] + 0.6)))[:, None]
    for side in (-1, 1):
        for k in range(bays + 1):
            shade = shade * beside(p, (side * aisle, 0, -k * bay), 0.3, 0.16, 0.6)
    shade = shade * corner_shade(p[:, 2] - far, 0.5, 0.4)
    slabs = tiles(1024, 8, ("#7c6a55", "#a8937a", "#d2c2a6"), "#4c4034", rng, 0.02, checker=True)
    return (
        ground.tiled(2.5, 5.0)
        .tinted(shade)
        .part(Material("phong", texture=slabs, specular=(0.05, 0.05, 0.05), shininess=25))
    )


def _far_wall(far: float, aisle: float, wall: Material, sand: Material, rng: np.random.Generator) -> Iterator[Part]:
    """End of the court: a great door under an arch, a rose above it, niches beside it."""
    door = arch(2 * aisle + 0.6, 2.3, _TOP, 0.6, 1.45, 32).moved(0, 0, far)
    side = [
        plane((s, 0, far + 0.3), (w, 0, 0), (0, 2.3, 0), (8, 8)).tiled(abs(w), 2.3)
        for s, w in ((-aisle - 0.3, 1.45), (aisle - 1.15, 1.45))
    ]
    ends = [
        plane((s, 0, far + 0.3), (3.0, 0, 0), (0, _TOP, 0), (8, 16)).tiled(3.0, _TOP)
        for s in (-aisle - 3.2, aisle + 0.2)
    ]
    reveal = [
        plane((s, 0, far + 0.3), (0, 0, -0.6), (0, 2.3, 0)).tiled(0.6, 2.3) for s in (-aisle + 1.15, aisle - 1.15)
    ]
    front = join([door, *side, *ends, *reveal])
    y = front.vertices[:, 1]
    glow = 0.75 + 0.35 * np.exp(-((front.vertices[:, 0] ** 2 + (y - 4.5) ** 2) / 14.0))
    yield front.tiled(0.5, 0.5).tinted(glow[:, None] * corner_shade(y, 0.4, 0.45)).part(wall)
    # Trim: a moulded ring about the aperture, a string course, a rose with spokes.
    ring = [
        _hoop(aisle - 1.15 + 0.1, 2.3, far + 0.32, half=True),
        box(2 * aisle + 0.6, 0.18, 0.3).moved(0, _STOREY, far + 0.35),
    ]
    rose_y = 6.35
    ring += [_hoop(r, rose_y, far + 0.33) for r in (1.25, 0.42)]
    spokes = [
        box(0.07, 0.86, 0.12).moved(0, 0.4, 0).turned("z", 30.0 * k).moved(0, rose_y, far + 0.33) for k in range(12)
    ]
    ring += [*spokes, *(column(2.35, 0.13, 24).moved(s * (aisle - 1.0), 0, far + 0.5) for s in (-1, 1))]
    yield join(ring).tiled(1.5, 1.5).part(sand)
    glass = disc(1.25, 48).turned("x", 90).moved(0, rose_y, far + 0.305)
    yield glass.part(Material(texture=_stained(rng)))
    timber = plane((-aisle, 0, far - 0.2), (2 * aisle, 0, 0), (0, 4.0, 0), (20, 20))
    boards = bricks(512, 2, 10, ("#4b2a18", "#6a3d22", "#7d4c2c"), "#24140b", rng, 0.02)
    yield (
        timber.tiled(1.2, 1.0)
        .tinted(corner_shade(timber.vertices[:, 1] - 3.6, 0.6, 0.55))
        .part(Material(texture=boards))
    )
    studs = [
        lathe([[(0.045, 0.0), (0.035, 0.03), (0.0, 0.04)]], 10).turned("x", 90).moved(x, y, far - 0.2)
        for x in np.linspace(-1.0, 1.0, 8)
        for y in (0.5, 1.2, 1.9, 2.6)
    ]
    yield join(studs).part(Material("phong", (0.3, 0.24, 0.14), specular=(0.4, 0.32, 0.2)))


def _hoop(radius: float, y: float, z: float, half: bool = False) -> Mesh:
    """Flat moulding along a circle (or its upper half) on the wall."""
    angle = np.linspace(0, np.pi if half else 2 * np.pi, 49)
    profile = ((-0.1, 0.0), (-0.1, 0.1), (-0.04, 0.13), (0.04, 0.13), (0.1, 0.1), (0.1, 0.0))
    rows = [
        np.column_stack([(radius + a) * np.cos(angle), y + (radius + a) * np.sin(angle), np.full(49, z + b)])
        for a, b in profile
    ]
    return surface(np.stack(rows))


def _stained(rng: np.random.Generator) -> Float:
    """Coloured glass in a wheel of panes."""
    s = (np.arange(256) + 0.5) / 128 - 1
    x, y = np.meshgrid(s, -s)
    sector = np.floor((np.arctan2(y, x) / (2 * np.pi) + 0.5) * 24).astype(int) % 24
    ring = np.minimum((np.hypot(x, y) * 4).astype(int), 3)
    glass = np.stack([paint(c) for c in ("#2b5fa8", "#b32d3a", "#e0a93a", "#3f8a5a", "#6a3f8f", "#d9d2b0")])
    return (1.3 * glass[rng.integers(0, 6, (4, 24))[ring, sector]]).astype(np.float32)


def _banners(bays: int, bay: float, aisle: float, rng: np.random.Generator) -> Iterator[Part]:
    """Cloths that hang from the gallery, rippled."""
    for k, code in ((1, "#8f2430"), (3, "#26506e"), (5, "#5c6b2c")):
        texture = Material(texture=cloth(256, code, rng, 64))
        hung = []
        for side in (-1, 1):
            z0 = -(k + (0.5 if side < 0 else 1.5) - 0.45) * bay
            s, t = np.meshgrid(np.linspace(0, 1, 41), np.linspace(0, 1, 25))
            ripple = 0.07 * (0.25 + t) * np.sin(2 * np.pi * (3.2 * s + 0.25 * t) + k)
            points = np.stack(
                [
                    side * (aisle - 0.42) + ripple,
                    _STOREY + 0.75 - 2.0 * t - 0.12 * np.sin(np.pi * s) * t,
                    z0 - 1.2 * s,
                ],
                axis=-1,
            )
            sheet = surface(points)
            hung.append(sheet.tiled(2, 3).tinted((0.8 + 3.0 * ripple.reshape(-1, 1)) * (1.0 - 0.25 * t.reshape(-1, 1))))
        yield join(hung).part(texture)


def _planters(bay: float, aisle: float, far: float, rng: np.random.Generator) -> Iterator[Part]:
    """Clay pots with small palms between the columns."""
    pot = lathe(
        [
            [(0.0, 0.0), (0.2, 0.0)],
            [(0.2, 0.0), (0.27, 0.36), (0.3, 0.36), (0.31, 0.44), (0.26, 0.44), (0.24, 0.38)],
            [(0.24, 0.4), (0.0, 0.4)],
        ],
        24,
    )
    pots, plants = [], []
    for k in range(1, int(-far / bay)):
        for side in (-1, 1):
            x, z = side * (aisle - 0.05), -(k + 0.5) * bay
            pots.append(pot.moved(x, 0, z))
            for j in range(16):
                one = leaf(rng.uniform(0.7, 1.15), 0.13, rng.uniform(0.5, 0.9), 0.3, 6).tinted(
                    paint("#4f7a35") * rng.uniform(0.6, 1.3)
                )
                plants.append(
                    one.turned("x", -rng.uniform(48, 82)).turned("y", 22.5 * j + rng.uniform(-9, 9)).moved(x, 0.42, z)
                )
    yield join(pots).tiled(4, 2).part(Material(texture=mottled(256, ("#8f4a2c", "#b4623c", "#c9784e"), rng)))
    yield join(plants).part(Material())

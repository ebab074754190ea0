"""Fence: a cottage garden, in focus, seen through a weathered wooden lattice close to the lens.

Figure 8 (foreground blur) of Lee, Eisemann & Seidel (2009): bars narrower than their blur become translucent.
"""

from collections.abc import Iterator

import numpy as np

from refdof.scene.kit.backdrops import sky
from refdof.scene.kit.darkening import corner_shade
from refdof.scene.kit.masonry import window
from refdof.scene.kit.mesh import Mesh, join, scatter
from refdof.scene.kit.noise import Noise3, smooth
from refdof.scene.kit.plants import blossom, branch, bush, daisy, facing, grass, shades
from refdof.scene.kit.shapes import box, lathe, leaf, plane, sphere
from refdof.scene.kit.shot import Shot
from refdof.scene.kit.textures import bricks, cobbles, mottled, paint, planks, wood
from refdof.scene.material import Material
from refdof.scene.scene import Part

__all__ = ["NUMBERS", "build"]

NUMBERS = ("mesh_width", "slat", "distance")

_WALL = -8.6
_GREEN = ("#3d6a2b", "#5f8f35", "#86a94a")


def build(shot: Shot, rng: np.random.Generator) -> Iterator[Part]:
    """Parts of the scene."""
    yield from _lattice(shot, rng)
    yield from _house(rng)
    yield from _garden(rng)
    yield sky(60.0, ("#dfe7ea", "#a9c4de", "#5f8fc4"), rng)


def _lattice(shot: Shot, rng: np.random.Generator) -> Iterator[Part]:
    """Two crossing layers of slats, turned a little to the view, with a vine."""
    step, width, far = shot.numbers["mesh_width"], shot.numbers["slat"], shot.numbers["distance"]
    slats = []
    for layer, angle in enumerate((45.0, -45.0)):
        for k in range(-6, 7):
            one = box(width * rng.uniform(0.9, 1.1), 1.6, 0.007).moved(k * step * 0.7071, -0.8, 0.008 * layer)
            one = one.tinted(rng.uniform(0.75, 1.15)).tiled(6.0, 1.5).turned("z", angle + rng.uniform(-0.8, 0.8))
            slats.append(one)
    fence = join(slats).turned("y", 14.0).moved(0.0, 1.53, -far)
    old = wood(512, ("#6f665a", "#94897a", "#b9ae9c"), rng, 5.0)
    yield fence.part(Material(texture=np.ascontiguousarray(old.transpose(1, 0, 2))))
    stem = np.array(
        [
            (-0.42, 1.16, -0.02),
            (-0.26, 1.3, 0.02),
            (-0.29, 1.47, -0.01),
            (-0.15, 1.6, 0.02),
            (-0.16, 1.72, 0.0),
            (-0.02, 1.86, 0.01),
        ]
    )
    stem = stem + np.array([0, 0, -far + 0.07])
    yield branch(stem, 0.005, 0.002, rng, 60, 8).tinted(paint("#5a6b34")).part(Material())
    t = rng.random(34) * (len(stem) - 1.001)
    at = t.astype(np.int64)
    place = stem[at] + (t - at)[:, None] * (stem[at + 1] - stem[at]) + rng.normal(0, 0.008, (34, 3))
    turn = facing(rng.uniform(0, 360, 34), rng.uniform(-40, 40, 34), rng.uniform(-40, 40, 34))
    yield scatter(
        leaf(1.0, 0.6, 0.3, 0.2, 5), place, turn, rng.uniform(0.035, 0.065, 34), shades(34, _GREEN, rng)
    ).part(Material())


def _house(rng: np.random.Generator) -> Iterator[Part]:
    """Brick front with a door, two windows, flower boxes, ivy and a lantern."""
    front = plane((-9, 0, _WALL), (18, 0, 0), (0, 5.2, 0), (90, 40))
    x, y = front.vertices[:, 0], front.vertices[:, 1]
    stain = 0.9 + 0.12 * Noise3(rng).fractal(front.vertices * 0.8)
    shade = stain[:, None] * corner_shade(y, 0.5, 0.45) * corner_shade(y - 4.1, 0.5, 0.5)
    shade = (
        shade * (1.0 - 0.35 * np.exp(-np.maximum(np.hypot((x + 0.6) / 0.9, (y - 1.0) / 1.5) - 0.8, 0) / 0.15))[:, None]
    )
    red = bricks(1024, 18, 7, ("#8a4630", "#a85c3e", "#bb7350", "#9a4c3a"), "#b3a48c", rng, 0.13)
    yield front.tiled(18 / 1.7, 5.2 / 1.45).tinted(shade).part(Material(texture=red))
    yield (
        box(18, 0.35, 0.7)
        .moved(0, 4.1, _WALL + 0.3)
        .tiled(0.3, 1.0)
        .part(Material(texture=wood(256, ("#5a4634", "#7d654c", "#9a8062"), rng)))
    )
    frames, glass, trim = [], [], []
    for at, wide in ((-2.9, 1.25), (1.75, 1.7)):
        bars, panes = window(wide, 1.35, 2 if wide < 1.5 else 3, 3, 0.08)
        frames += [bars.moved(at, 1.35, _WALL + 0.06)]
        dark = 0.35 + 0.65 * smooth(1.2, 0.1, panes.vertices[:, 1] + 0.3 * panes.vertices[:, 0])
        glass.append(panes.tinted(dark[:, None]).moved(at, 1.35, _WALL + 0.05))
        trim += [
            box(wide + 0.3, 0.12, 0.25).moved(at, 1.23, _WALL + 0.1),
            box(wide + 0.3, 0.2, 0.12).moved(at, 2.7, _WALL + 0.05),
        ]
        shutter = join(
            [
                box(0.42, 1.35, 0.05),
                *(box(0.36, 0.03, 0.03).moved(0, 0.1 + 0.115 * k, 0.03) for k in range(11)),
            ]
        )
        trim += [
            shutter.tinted(paint("#4f7d7a") / 0.75).moved(at + s * (wide / 2 + 0.26), 1.35, _WALL + 0.05)
            for s in (-1, 1)
        ]
    trim += [
        box(1.5, 0.14, 0.5).moved(-0.6, 0.0, _WALL + 0.3),
        box(1.2, 0.12, 0.3).moved(-0.6, 0.14, _WALL + 0.2),
    ]
    yield join(frames).part(Material(base_color=(0.86, 0.84, 0.78)))
    yield join(glass).part(Material("phong", (0.10, 0.13, 0.17), specular=(0.45, 0.45, 0.45), shininess=60))
    yield join(trim).part(Material(texture=mottled(256, ("#a39b8c", "#c9c0ae", "#ddd6c6"), rng)))
    yield from _door(rng)
    yield from _flower_boxes(rng)
    ivy = rng.random((2600, 2)) * [1.6, 4.2]
    keep = (
        Noise3(rng).fractal(np.column_stack([ivy * 0.9, 0 * ivy[:, 0]]))
        + 1.5 * np.exp(-ivy[:, 0] / 0.9)
        - 0.05 * ivy[:, 1]
        > 0.42
    )
    ivy = ivy[keep & (ivy[:, 0] < 0.92)]  # clear of the window
    count = len(ivy)
    place = np.column_stack([3.95 - ivy[:, 0], ivy[:, 1], _WALL + 0.05 + 0.08 * rng.random(count)])
    turn = facing(rng.uniform(-70, 70, count), rng.uniform(-80, -30, count))
    yield scatter(
        leaf(1.0, 0.8, 0.3, 0.15, 3),
        place,
        turn,
        rng.uniform(0.1, 0.2, count),
        shades(count, ("#24471f", "#41702c", "#6d9440"), rng),
    ).part(Material())


def _door(rng: np.random.Generator) -> Iterator[Part]:
    """Blue panelled door with frame, brass and a lantern."""
    z = _WALL + 0.04
    leaf_ = [box(0.92, 2.0, 0.05).moved(-0.6, 0.26, z)]
    leaf_ += [
        box(0.34, h, 0.03).moved(-0.6 + s * 0.21, y, z + 0.03) for s in (-1, 1) for y, h in ((0.42, 0.62), (1.18, 0.9))
    ]
    blue = np.ascontiguousarray(wood(256, ("#1f4468", "#2a5a86", "#35689a"), rng, 6.0).transpose(1, 0, 2))
    yield join(leaf_).part(Material("phong", texture=blue, specular=(0.05, 0.05, 0.05), shininess=30))
    posts = [box(0.12, 2.1, 0.14).moved(-0.6 + s * 0.53, 0.26, z) for s in (-1, 1)] + [
        box(1.32, 0.16, 0.18).moved(-0.6, 2.3, z)
    ]
    yield join(posts).part(Material(base_color=(0.82, 0.80, 0.74)))
    brass = [
        sphere(0.035, 8, 12).moved(-0.26, 1.2, z + 0.07),
        box(0.2, 0.06, 0.02).moved(-0.6, 1.05, z + 0.05),
    ]
    lantern = [
        lathe([[(0.0, 0.28), (0.09, 0.2), (0.08, 0.19)], [(0.07, 0.0), (0.05, -0.03), (0.0, -0.04)]], 6).moved(
            0.3, 2.0, z + 0.2
        )
    ]
    lantern += [
        box(0.012, 0.2, 0.012).moved(0.3 + 0.065 * np.sin(a), 2.0, z + 0.2 + 0.065 * np.cos(a))
        for a in np.arange(6) * 1.047
    ]
    lantern += [box(0.03, 0.03, 0.22).moved(0.3, 2.26, z + 0.1)]
    yield join(brass).part(Material("phong", (0.45, 0.32, 0.12), specular=(0.5, 0.4, 0.2), shininess=40))
    yield join(lantern).part(Material("phong", (0.03, 0.03, 0.03), specular=(0.15, 0.15, 0.15)))
    yield (
        lathe([[(0.045, 0.0), (0.055, 0.18)]], 12).moved(0.3, 2.0, z + 0.2).part(Material("unlit", (1.0, 0.8, 0.45)))
    )


def _flower_boxes(rng: np.random.Generator) -> Iterator[Part]:
    """Boxes below the windows, filled."""
    boxes, flowers, green = [], [], []
    head = blossom(rng, "#e8556d", "#c22440")
    for at, wide in ((-2.9, 1.25), (1.75, 1.7)):
        boxes.append(box(wide, 0.2, 0.22).moved(at, 1.0, _WALL + 0.22))
        count = int(48 * wide)
        place = np.column_stack(
            [
                at + rng.uniform(-0.5, 0.5, count) * wide,
                rng.uniform(1.18, 1.45, count),
                _WALL + 0.22 + rng.uniform(-0.1, 0.14, count),
            ]
        )
        flowers.append(
            scatter(
                head,
                place,
                facing(rng.uniform(-60, 60, count), rng.uniform(-80, -20, count)),
                rng.uniform(0.07, 0.12, count),
                shades(count, ("#ffffff", "#ffc9b0", "#ffffff"), rng),
            )
        )
        green += [
            bush(0.2, 150, 0.09, rng, _GREEN, 0.7).moved(at + wide * s, 1.2, _WALL + 0.22)
            for s in np.linspace(-0.42, 0.42, 5)
        ]
    yield join(boxes).part(Material(texture=wood(256, ("#6b4a30", "#8a6342", "#a87d56"), rng)))
    yield join([*flowers, *green]).part(Material())


def _garden(rng: np.random.Generator) -> Iterator[Part]:
    """Lawn, a path to the door, beds along the wall, and a bench."""
    lawn = plane((-10, 0, -0.5), (20, 0, 0), (0, 0, _WALL + 0.5), (100, 50))
    tone = 0.85 + 0.3 * Noise3(rng).fractal(lawn.vertices * 0.7)
    shade = tone[:, None] * corner_shade(lawn.vertices[:, 2] - _WALL, 0.6, 0.5)
    yield (
        lawn.tiled(9, 4)
        .tinted(shade)
        .part(Material(texture=mottled(512, ("#39551f", "#577a2e", "#7c9a45"), rng, 16, 5)))
    )
    path = plane((-1.25, 0.012, -1.0), (1.3, 0, 0), (0, 0, _WALL + 1.5), (8, 90))
    wiggle = 0.12 * Noise3(rng)(path.vertices * [1.5, 1.0, 3.0])
    path = Mesh(
        path.vertices + np.column_stack([wiggle, 0 * wiggle, 0 * wiggle]),
        path.faces,
        path.uv,
        path.color,
        path.normal,
    )
    yield path.tiled(1, 5.5).part(Material(texture=cobbles(512, 6, ("#8f8778", "#b0a694", "#c8bfae"), "#5a5a38", rng)))
    spot = rng.uniform((-6, -8.3), (6, -4.0), (9000, 2))
    spot = spot[np.abs(spot[:, 0] + 0.6) > 0.62]
    place = np.column_stack([spot[:, 0], 0 * spot[:, 0], spot[:, 1]])
    yield grass(place, rng.uniform(0.05, 0.13, len(place)), 0.07, rng, _GREEN, 2).part(Material())
    bed = [
        bush(rng.uniform(0.25, 0.42), 260, 0.13, rng, ("#2f5526", "#4c7a33", "#7b9f4d")).moved(x, 0.22, _WALL + 0.5)
        for x in np.r_[np.arange(-5.5, -1.4, 0.55), np.arange(0.45, 6, 0.55)]
    ]
    heads: list[Mesh] = []
    for petal, heart in (
        ("#f4efe2", "#e0a92c"),
        ("#e9c43f", "#8a5a1a"),
        ("#c86fa8", "#e6c24a"),
        ("#7f74c9", "#e8cf5a"),
    ):
        one = daisy(rng, 3.2, petal, heart)
        x = rng.uniform(-5.5, 5.5, 34)
        x = x[np.abs(x + 0.6) > 0.9]
        place = np.column_stack([x, 0 * x, _WALL + rng.uniform(0.5, 1.25, len(x))])
        heads.append(scatter(one, place, facing(rng.uniform(-70, 70, len(x)), 0 * x), rng.uniform(0.16, 0.24, len(x))))
    yield join([*bed, *heads]).part(Material())
    seat = [box(1.5, 0.04, 0.11).moved(0, 0.45, 0.13 * k) for k in range(3)] + [
        box(1.5, 0.1, 0.03).moved(0, 0.6 + 0.16 * k, -0.05) for k in range(2)
    ]
    seat += [box(0.07, h, 0.07).moved(s * 0.68, 0, z) for s in (-1, 1) for h, z in ((0.45, 0.28), (0.9, -0.05))]
    yield (
        join(seat)
        .tiled(1.0, 6.0)
        .moved(2.9, 0, _WALL + 1.4)
        .part(Material(texture=planks(256, 2, ("#6d4b2e", "#8f6840", "#b08a5c"), rng)))
    )

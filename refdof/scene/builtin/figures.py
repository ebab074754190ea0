"""Figures: statues, a bust, a knot and an urn in a museum's hall; the orator is in focus.

Figure 6 of Schedl & Wimmer (2012): several finely triangulated bodies before and behind the focal plane.
"""

from collections.abc import Iterator

import numpy as np

from refdof._check import Float
from refdof.scene.kit.darkening import beside, capsule_shadow, corner_shade
from refdof.scene.kit.masonry import column
from refdof.scene.kit.mesh import Mesh, join
from refdof.scene.kit.noise import Noise3, fractal, smooth
from refdof.scene.kit.people import head, statue
from refdof.scene.kit.sculpt import Body, merged, sculpt, soft_union
from refdof.scene.kit.shapes import arch, box, lathe, plane, tube
from refdof.scene.kit.shot import Shot
from refdof.scene.kit.textures import mottled, paint, ramp, stone, tiles
from refdof.scene.material import Material
from refdof.scene.scene import Part

__all__ = ["NUMBERS", "build"]

NUMBERS = ("cell",)

_BACK, _SIDE, _TOP = -13.0, 4.6, 6.0
# pose, hem, mirrored, x, z, turn, plinth, material
_STATUES = (
    ("dancer", 0.60, False, -1.15, -2.35, 24.0, 0.42, "bronze"),
    ("orator", 0.015, False, 0.30, -4.1, -8.0, 0.40, "marble"),
    ("thinker", 0.015, True, -1.05, -6.6, 18.0, 0.45, "terracotta"),
    ("archer", 0.66, True, 1.75, -7.6, -30.0, 0.50, "verdigris"),
)


def build(shot: Shot, rng: np.random.Generator) -> Iterator[Part]:
    """Parts of the scene."""
    cell = shot.numbers["cell"]
    skins = _materials(rng)
    feet, plinths = [], []
    for pose, hem, mirrored, x, z, turn, high, skin in _STATUES:
        body = statue(pose, hem, cell, rng, mirrored)
        y = body.vertices[:, 1:2]
        body = body.tinted(0.8 + 0.2 * np.clip(y / 0.5, 0, 1)).turned("y", turn).moved(x, high, z)
        yield _weathered(body, skin, rng).part(skins[skin])
        plinths.append(_plinth(0.78, high).turned("y", turn).moved(x, 0, z))
        feet.append((x, z, 0.42, high))
    for x, z, high in ((1.18, -2.5, 1.02), (-2.5, -8.6, 1.25), (0.35, -9.6, 1.0)):
        plinths.append(_plinth(0.46, high).moved(x, 0, z))
        feet.append((x, z, 0.26, high))
    yield _urn(rng).moved(1.18, 1.02, -2.5).part(skins["glaze"])
    bust = sculpt(_bust(), (-0.36, -0.15, -0.3), (0.36, 0.86, 0.36), 0.45 * cell)
    yield _weathered(bust.turned("y", 24), "marble", rng).moved(-2.5, 1.25, -8.6).part(skins["marble"])
    yield _knot(rng).moved(0.35, 1.36, -9.6).part(skins["gold"])
    yield join(plinths).part(skins["plinth"])
    yield _floor(feet, shot, rng)
    yield from _hall(rng)


def _materials(rng: np.random.Generator) -> dict[str, Material]:
    def shiny(texture: Float, gloss: float, shininess: float) -> Material:
        return Material("phong", texture=texture, specular=(gloss, gloss, gloss), shininess=shininess)

    return {
        "marble": shiny(stone(512, ("#b9b3a6", "#dcd6c8", "#f1ece0", "#f8f5ee"), rng, 0.35), 0.04, 30),
        "bronze": Material(
            "phong",
            texture=mottled(256, ("#4a2e16", "#6f4a24", "#946a36"), rng, 6),
            specular=(0.26, 0.19, 0.10),
            shininess=40,
        ),
        "terracotta": shiny(mottled(256, ("#9a5234", "#b96a45", "#cd8259"), rng, 8), 0.02, 10),
        "verdigris": shiny(mottled(256, ("#2f4f46", "#4f7f70", "#7da593", "#5a4a2c"), rng, 7), 0.1, 30),
        "plinth": shiny(stone(512, ("#3b3a3c", "#56545a", "#78757a"), rng, -0.6), 0.06, 40),
        "glaze": Material("phong", specular=(0.16, 0.16, 0.16), shininess=80),
        "gold": Material("phong", (0.62, 0.42, 0.13), specular=(0.5, 0.38, 0.16), shininess=50),
    }


def _weathered(body: Mesh, skin: str, rng: np.random.Generator) -> Mesh:
    """Grime in the hollows, and streaks."""
    noise = Noise3(rng)
    streak = noise.fractal(body.vertices * [9.0, 1.6, 9.0], 3)
    grime = paint({"marble": "#8a7a5c", "bronze": "#274a40", "terracotta": "#5a3324", "verdigris": "#2c2a1c"}[skin])
    hollow = np.clip(1.0 - body.color[:, :1], 0, 1)
    tint = 1.0 + (grime / grime.max() - 1.0) * np.clip(0.9 * hollow + 0.25 * streak[:, None], 0, 0.8)
    return body.tinted(tint)


def _plinth(wide: float, high: float) -> Mesh:
    """Block with a base and a cornice, darkest at the floor."""
    block = join(
        [
            box(wide + 0.12, 0.1, wide + 0.12),
            box(wide, high - 0.18, wide).moved(0, 0.1, 0),
            box(wide + 0.08, 0.08, wide + 0.08).moved(0, high - 0.08, 0),
        ]
    )
    return block.tinted(corner_shade(block.vertices[:, 1], 0.12, 0.35))


def _bust() -> Body:
    """Head twice as large as life on draped shoulders and a foot."""
    cones = [(-0.17, 0.21, -0.03, 0.17, 0.21, -0.03, 0.12, 0.12, 0.85)]
    cones += [(0, 0.12, 0.0, 0, 0.22, 0.01, 0.13, 0.18, 0.8), (0, 0.0, 0, 0, 0.12, 0, 0.10, 0.06, 1.0)]
    cones += [
        (-0.24 + 0.05 * k, 0.30 - 0.028 * k, 0.03, 0.02 + 0.035 * k, 0.10 - 0.008 * k, 0.13, 0.018, 0.02, 1.0)
        for k in range(5)
    ]
    chest, face = soft_union(np.array(cones), 0.04), soft_union(head((0, 0.55, 0.02), 1.75, -12.0, 3.0), 0.02)
    return lambda points: merged(chest(points), face(points), 0.04)


def _urn(rng: np.random.Generator) -> Mesh:
    """Black urn with red bands, a meander and a frieze, fluted below, with two handles."""
    profile = [
        (0.0, 0.0),
        (0.11, 0.0),
        (0.115, 0.02),
        (0.06, 0.05),
        (0.05, 0.08),
        (0.12, 0.16),
        (0.2, 0.3),
        (0.215, 0.42),
        (0.17, 0.52),
        (0.1, 0.57),
        (0.09, 0.64),
        (0.15, 0.70),
        (0.155, 0.72),
        (0.14, 0.725),
    ]
    line = np.asarray(profile)
    for _ in range(4):
        cut = np.stack([0.75 * line[:-1] + 0.25 * line[1:], 0.25 * line[:-1] + 0.75 * line[1:]], axis=1).reshape(-1, 2)
        line = np.concatenate([line[:1], cut[1:-1], line[-1:]])
    body = lathe([[(float(a), float(b)) for a, b in line]], 128)
    x, y, z = body.vertices.T
    angle = np.arctan2(x, z)
    flute = smooth(0.30, 0.2, y) * smooth(0.09, 0.13, y)
    ribs = 1.0 + 0.035 * flute * np.cos(32 * angle)
    shape = Mesh(
        body.vertices * np.column_stack([ribs, np.ones_like(ribs), ribs]),
        body.faces,
        body.uv,
        body.color,
        body.normal,
    )
    frieze = smooth(-0.15, 0.15, np.sin(9 * angle) * np.cos(60 * (y - 0.42)) + 0.5 * np.sin(27 * angle + 40 * y)) * (
        np.abs(y - 0.42) < 0.07
    )
    key = (np.abs(y - 0.545) < 0.016) * (np.sin(40 * angle) > -0.1)
    rings = (
        (np.abs(y - 0.335) < 0.006)
        | (np.abs(y - 0.505) < 0.006)
        | (np.abs(y - 0.66) < 0.01)
        | (np.abs(y - 0.03) < 0.012)
    )
    red = np.clip(frieze + key + rings + 0.4 * flute * (0.5 + 0.5 * np.cos(32 * angle)), 0, 1)
    color = paint("#1c1714") + red[:, None] * (paint("#c0623a") - paint("#1c1714"))
    t = np.linspace(0, 1, 50)
    loop = np.column_stack([0.10 + 0.17 * np.sin(np.pi * t) ** 0.8, 0.66 - 0.24 * t, 0 * t])
    loop[-1, 0] = 0.2
    handles = join([tube(loop, 0.014, 20), tube(loop, 0.014, 20).turned("y", 180)]).tinted(paint("#1c1714"))
    grain = 1.0 + 0.25 * Noise3(rng)(shape.vertices * 25.0)
    return join([shape.tinted(color * grain[:, None]), handles]).turned("y", 20)


def _knot(rng: np.random.Generator) -> Mesh:
    """Trefoil knot, carved with a spiral."""
    t = np.linspace(0, 2 * np.pi, 421)
    t[-1] = 0.0
    ring = 0.22 * (1.0 + 0.42 * np.cos(3 * t))
    body = tube(
        np.column_stack([ring * np.cos(2 * t), 0.13 * np.sin(3 * t), ring * np.sin(2 * t)]),
        0.062,
        36,
        closed=True,
    )
    u, v = body.uv.T
    turns = round(float(v.max())) * 8 / v.max()
    carve = np.cos(2 * np.pi * (2 * u + turns * v))
    deep = 0.006 * carve + 0.002 * Noise3(rng)(body.vertices * 60.0)
    shape = Mesh(body.vertices + deep[:, None] * body.normal, body.faces, body.uv, body.color, body.normal)
    return shape.tinted((0.68 + 0.32 * carve)[:, None]).turned("x", 78).turned("y", 12)


def _floor(feet: list[tuple[float, float, float, float]], shot: Shot, rng: np.random.Generator) -> Part:
    ground = plane((-_SIDE, 0, 1.5), (2 * _SIDE, 0, 0), (0, 0, _BACK - 1.5), (110, 150))
    shade = corner_shade(ground.vertices[:, 2] - _BACK, 0.7, 0.5) * corner_shade(
        _SIDE - np.abs(ground.vertices[:, 0]), 0.7, 0.5
    )
    for x, z, r, h in feet:
        shade = shade * beside(ground.vertices, (x, 0, z), r, 0.16, 0.5)
        shade = shade * capsule_shadow(ground.vertices, (x, 0, z), h + 0.8, r, shot.light.sun_direction, 0.25, 0.45)
    slabs = tiles(1024, 6, ("#57504a", "#9a8f80", "#cfc5b2"), "#2a2623", rng, 0.012, checker=True)
    return (
        ground.tiled(2.0, 3.2)
        .tinted(shade)
        .part(Material("phong", texture=slabs, specular=(0.08, 0.08, 0.08), shininess=40))
    )


def _hall(rng: np.random.Generator) -> Iterator[Part]:
    """Red walls with paintings, an arcade across the back with lit niches, a coffered ceiling's edge."""
    walls = [plane((s * _SIDE, 0, 1.5), (0, 0, _BACK - 1.5), (0, _TOP, 0), (60, 24)) for s in (-1, 1)]
    sides = join(walls)
    y, z = sides.vertices[:, 1], sides.vertices[:, 2]
    pools = 0.6 + 0.5 * np.exp(-((y - 2.6) ** 2) / 1.6) * (0.6 + 0.4 * np.cos(2 * np.pi * z / 3.0))
    wallpaper = mottled(512, ("#5a1f22", "#6f2b2c", "#7d3734"), rng, 8)
    yield (sides.tiled(6, 3).tinted(pools[:, None] * corner_shade(y, 0.5, 0.4)).part(Material(texture=wallpaper)))
    low = [box(0.08, 0.95, 14.5).moved(s * (_SIDE - 0.04), 0, -5.75) for s in (-1, 1)] + [
        box(0.14, 0.08, 14.5).moved(s * (_SIDE - 0.07), 0.95, -5.75) for s in (-1, 1)
    ]
    pale = Material(texture=stone(512, ("#a89d8a", "#c4baa6", "#d8cfbc"), rng, 0.3))
    bays, niches, glow, piers = [], [], [], []
    for k in range(3):
        x = (k - 1) * 3.0
        bays.append(arch(3.0, 2.9, _TOP, 0.5, 0.55, 28).moved(x, 0, _BACK + 0.4))
        piers += [box(0.55, 2.9, 0.5).moved(x + s * 1.225, 0, _BACK + 0.4) for s in (-1, 1)]
        apse = lathe(
            [
                [(0.95, y) for y in np.linspace(0, 2.9, 8)],
                [(0.95 * np.cos(a), 2.9 + 0.95 * np.sin(a)) for a in np.linspace(0, np.pi / 2, 9)[:-1]] + [(0.0, 3.85)],
            ],
            40,
        )
        niches.append(apse.moved(x, 0, _BACK + 0.2))
        glow.append(0.5 + 0.75 * np.exp(-((niches[-1].vertices[:, 1] - 2.9) ** 2) / 0.9))
    columns = [column(2.9, 0.2, 48, 12).moved(x, 0, _BACK + 0.75) for x in (-4.5, -1.5, 1.5, 4.5)]
    trim = [box(2 * _SIDE, 0.22, 0.3).moved(0, 4.6, _BACK + 0.7)]
    front = join([*bays, *piers, *columns, *trim, *low])
    yield front.tiled(1 / 3, 1 / 3).tinted(corner_shade(front.vertices[:, 1], 0.4, 0.4)).part(pale)
    inside = join(niches)
    yield inside.tinted(np.concatenate(glow)[:, None]).part(
        Material(texture=mottled(256, ("#7f8c8f", "#9aa6a5", "#b5bdb6"), rng, 6))
    )
    ends = [plane((s, 0, _BACK + 0.65), (w, 0, 0), (0, _TOP, 0)) for s, w in ((-_SIDE - 0.6, 0.7), (_SIDE - 0.1, 0.7))]
    yield join([*ends, plane((-_SIDE, _TOP, 1.5), (2 * _SIDE, 0, 0), (0, 0, _BACK - 1.5), (12, 16)).tiled(6, 9)]).part(
        pale
    )
    behind_joints = plane((-6, -0.5, _BACK - 1.0), (12, 0, 0), (0, 8, 0)).tinted(0.05)
    yield behind_joints.part(pale)
    frames = []
    for k, far in enumerate((-3.6, -6.6, -9.6)):
        for side in (-1, 1):
            wide, high = rng.uniform(1.5, 2.1), rng.uniform(1.2, 1.7)
            face = -90.0 * side
            rim = [box(wide + 0.3, 0.16, 0.12).moved(0, h, 0) for h in (-0.16, high)] + [
                box(0.16, high, 0.12).moved(s * (wide / 2 + 0.07), 0, 0) for s in (-1, 1)
            ]
            frames += [m.turned("y", face).moved(side * (_SIDE - 0.06), 1.75, far) for m in rim]
            canvas = (
                plane((-wide / 2, 0, 0.02), (wide, 0, 0), (0, high, 0))
                .turned("y", face)
                .moved(side * (_SIDE - 0.03), 1.75, far)
            )
            yield canvas.part(Material(texture=_landscape(k, rng)))
    yield join(frames).part(Material("phong", (0.42, 0.28, 0.09), specular=(0.35, 0.26, 0.12), shininess=30))


def _landscape(kind: int, rng: np.random.Generator) -> Float:
    """Painted view: sky, three ridges, water."""
    v = np.linspace(1, 0, 128)[:, None] * np.ones((1, 192))
    brush = fractal((128, 192), (10, 12), rng, 4, 0.6)
    skies = (
        ("#d8b878", "#a8b4b8", "#5f7f9f"),
        ("#d99a6a", "#b98a8f", "#5a5f86"),
        ("#c9d0c4", "#9fb4bc", "#6f8fae"),
    )
    color = ramp(0.25 * (brush - 0.5) + (v - 0.35) / 0.65, skies[kind])
    for k in range(3):
        line = 0.62 - 0.14 * k + 0.3 * (fractal((1, 192), (1, 4 + 3 * k), rng, 4)[0] - 0.5)
        tone = ramp(
            np.clip(brush + 0.1 * k - 0.2, 0, 1),
            (("#5f7a70", "#7d9484"), ("#4a5f3c", "#7a8548"), ("#2f3a26", "#5a5a30"))[k],
        )
        color = np.where((v < line)[..., None], tone, color)
    return color.astype(np.float32)

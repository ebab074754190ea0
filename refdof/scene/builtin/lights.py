"""Lights: a cafe table in a rainy street at night, in focus, among small bright lamps before and behind it.

Figure 8 (bokeh) of Lee, Eisemann & Seidel (2009): every lamp out of focus draws the lens aperture's shape.
"""

from collections.abc import Iterator

import numpy as np

from refdof.scene.kit.backdrops import sky
from refdof.scene.kit.cafe import cafe_table
from refdof.scene.kit.darkening import beside
from refdof.scene.kit.lamplight import Lamps, bulbs, lamp_light, streaks
from refdof.scene.kit.masonry import window
from refdof.scene.kit.mesh import Mesh, join
from refdof.scene.kit.shapes import box, lathe, plane, surface, tube
from refdof.scene.kit.shot import Shot
from refdof.scene.kit.textures import cobbles, mottled, paint, ramp
from refdof.scene.kit.vehicles import car
from refdof.scene.material import Material
from refdof.scene.scene import Part

__all__ = ["NUMBERS", "build"]

NUMBERS = ("houses", "garland")

_FLOOR = (0.035, 0.042, 0.075)
_TABLE = np.array([0.05, 0.0, -1.92])
_TOP = 0.98


def build(shot: Shot, rng: np.random.Generator) -> Iterator[Part]:
    """Parts of the scene; the street runs along -z between x = -4.5 and 4.5."""
    houses = int(shot.numbers["houses"])
    street = _street_lamps(houses)
    cars = _cars()
    near = _garland(int(shot.numbers["garland"]), rng)
    candle = Lamps(_TABLE[None] + [[-0.10, _TOP + 0.10, -0.03]], np.array([0.012]), np.array([[60.0, 30.0, 9.0]]))
    across = _across(rng)
    shining = Lamps(*(np.concatenate(a) for a in zip(street, cars[1], near, across, candle, strict=True)))
    yield bulbs(shining).part(Material("unlit"))
    warm = Lamps(*(np.concatenate(a) for a in zip(street, candle, strict=True)))
    yield from _ground(shot, Lamps(*(np.concatenate(a) for a in zip(street, cars[1], strict=True))), rng)
    yield from _houses(houses, street, rng)
    yield from cars[0]
    yield from _posts(street, warm)
    yield from _wires(near)
    yield from cafe_table(shot, _TABLE, _TOP, rng)
    yield sky(90.0, ("#2e2a38", "#171b2e", "#0b0f1e"), rng, "#3a3444", 0.6)


def _street_lamps(houses: int) -> Lamps:
    z = -6.0 - 6.5 * np.arange(houses)
    place = np.concatenate(
        [np.column_stack([np.full(houses, s * 3.3), np.full(houses, 3.5), z - (s > 0) * 3.0]) for s in (-1, 1)]
    )
    return Lamps(place, np.full(2 * houses, 0.085), np.tile([[48.0, 31.0, 13.0]], (2 * houses, 1)))


def _garland(count: int, rng: np.random.Generator) -> Lamps:
    """Fairy lights on two sagging wires between the lens and the table."""
    t = np.linspace(-1, 1, count // 2)
    wires = [
        np.column_stack([0.56 * t, 1.66 - 0.08 * (1 - t**2) + 0.05 * s + 0.10 * s * t, -1.12 + 0.08 * s + 0.05 * t])
        for s in (-1, 1)
    ]
    place = np.concatenate(wires) + rng.normal(0, 0.006, (2 * len(t), 3))
    color = np.array([[27.0, 17.0, 7.5], [29.0, 8.0, 5.0], [9.0, 20.0, 9.0], [8.0, 14.0, 29.0], [28.0, 20.0, 6.0]])
    return Lamps(place, np.full(len(place), 0.0047), color[np.arange(len(place)) % 5])


def _across(rng: np.random.Generator) -> Lamps:
    """Strings of bulbs across the street, traffic lights and distant signs."""
    place, color = [], []
    for k in range(2):
        t = np.linspace(-1, 1, 13)
        place.append(np.column_stack([4.3 * t, 4.6 - 0.9 * (1 - t**2) + 0.15 * k, np.full(13, -8.0 - 9.0 * k)]))
        color.append(np.tile([[27.0, 18.7, 8.6]], (13, 1)))
    spots = np.array(
        [
            (2.6, 2.5, -21.0),
            (-2.6, 2.5, -21.5),
            (0.9, 2.8, -34.0),
            (-3.9, 2.3, -13.0),
            (3.95, 2.7, -15.0),
            (-3.9, 3.0, -26.0),
            (3.9, 2.2, -27.0),
        ]
    )
    place.append(spots)
    color.append(
        np.array(
            [
                (3, 37, 16),
                (3, 37, 16),
                (56, 6, 4),
                (9, 23, 70),
                (70, 9, 42),
                (9, 56, 51),
                (65, 28, 5),
            ],
            dtype=float,
        )
    )
    joined = np.concatenate(place)
    return Lamps(
        joined + rng.normal(0, 0.01, joined.shape),
        np.where(joined[:, 1] > 3.2, 0.047, 0.062),
        np.concatenate(color),
    )


def _cars() -> tuple[list[Part], Lamps]:
    """Parked and coming cars, their lamps apart."""
    shape, parts = car(), []
    glow, radius, radiance = [], [], []
    glass, black = [], []
    for x, z, turn, code in (
        (-2.9, -11.5, 180, "#5c1f22"),
        (2.9, -9.6, 180, "#24405c"),
        (-2.7, -17.0, 180, "#c9c2b0"),
        (1.0, -19.0, 0, "#3a3f45"),
        (1.0, -30.0, 0, "#7c8b90"),
        (2.8, -25.0, 180, "#394a3a"),
    ):

        def put(mesh: Mesh, x: float = x, z: float = z, turn: float = turn) -> Mesh:
            return mesh.turned("y", turn).moved(x, 0, z)

        body = put(shape["paint"])
        rim = 0.35 + 0.65 * np.clip(body.normal[:, 1:2] * 0.7 + 0.4, 0, 1)
        parts.append(
            body.tinted(paint(code) * 0.35 * rim * [1.1, 0.85, 0.65]).part(
                Material("phong", specular=(0.25, 0.25, 0.25), base_color=(4.0, 4.0, 4.0))
            )
        )
        glass.append(put(shape["glass"]))
        black.append(put(shape["black"]))
        coming = turn == 0
        for s in (-1, 1):
            lamp = (s * 0.56, 0.64, 2.06) if coming else (s * 0.58, 0.74, 2.09)
            glow.append((x + lamp[0], lamp[1], z + lamp[2]))
            radius.append(0.085 if coming else 0.064)
            radiance.append((90.0, 85.0, 75.0) if coming else (40.0, 3.0, 2.0))
    parts.append(join(glass).part(Material("phong", (0.02, 0.025, 0.03), specular=(0.6, 0.6, 0.6))))
    parts.append(join(black).part(Material("lambert", (0.12, 0.12, 0.13))))
    return parts, Lamps(np.array(glow), np.array(radius), np.array(radiance))


def _ground(shot: Shot, lamps: Lamps, rng: np.random.Generator) -> Iterator[Part]:
    """Wet cobbles: lamplight times stone, plus the lamps' streaks, broken up by the stones."""
    t = np.linspace(0, 1, 170)[:, None]
    z = -0.7 * (70.0 / 0.7) ** t
    x = np.linspace(-1, 1, 200)[None, :] * (1.4 + 0.85 * np.abs(z))
    points = np.stack([x, 0 * x, z + 0 * x], axis=-1)
    ground = surface(points, points[..., [0, 2]] / 1.6)
    stones = cobbles(512, 8, ("#5a5a62", "#74747c", "#8e8c90"), "#2c2c34", rng)
    lit = lamp_light(ground, lamps, 0.9, (0.05, 0.055, 0.085))
    shine = streaks(ground.vertices, np.asarray(shot.camera.eye), lamps, 0.22)
    lit = lit.tinted(beside(ground.vertices, _TABLE, 0.25, 0.2, 0.5))
    wet = Mesh(lit.vertices, lit.faces, lit.uv, lit.color + shine, lit.normal)
    yield wet.part(Material("unlit", texture=stones))
    walk = [box(2.6, 0.14, 62.0).moved(s * 5.0, 0, -35.0) for s in (-1, 1)]
    yield lamp_light(join(_fine(w) for w in walk), lamps, 0.8, _FLOOR).part(Material("unlit", (0.25, 0.24, 0.24)))


def _fine(slab: Mesh) -> Mesh:
    """A kerb's top and inner face in many cells, so that lamplight can vary on it."""
    low, high = slab.vertices.min(axis=0), slab.vertices.max(axis=0)
    top = plane((low[0], high[1], high[2]), (high[0] - low[0], 0, 0), (0, 0, low[2] - high[2]), (10, 120))
    x = low[0] if low[0] > 0 else high[0]
    face = plane((x, 0, low[2]), (0, 0, high[2] - low[2]), (0, high[1], 0), (120, 1))
    return join([top, face])


def _houses(count: int, lamps: Lamps, rng: np.random.Generator) -> Iterator[Part]:
    """Fronts on both sides and across the end, with lit and dark windows and shops."""
    walls, frames, panes, shops = [], [], [], []
    codes = ("#8a5f48", "#a08a6a", "#7d7f86", "#94664c", "#86795f", "#6f7a72")
    for side in (-1, 0, 1):
        for k in range(count if side else 2):
            wide, high = 7.0, rng.uniform(8.5, 13.0) + (0 if side else 3)

            def put(mesh: Mesh, side: int = side, k: int = k) -> Mesh:
                if side == 0:
                    return mesh.moved(7.0 * k - 3.5, 0, -52.0)
                return mesh.turned("y", -90.0 * side).moved(side * 6.2, 0, -5.0 - 7.0 * k)

            front = plane((-wide / 2, 0, 0), (wide, 0, 0), (0, high, 0), (14, 18)).tiled(wide / 3, high / 3)
            trim = [box(wide, 0.25, 0.3).moved(0, y, 0.1) for y in (3.1, high - 0.3)]
            walls.append(put(join([front, *trim])).tinted(paint(codes[rng.integers(len(codes))])))
            for row in range(int((high - 4.0) / 2.9)):
                for column in range(3):
                    bars, pane = window(1.15, 1.7, 2, 2, 0.08)
                    at = (2.1 * (column - 1), 3.9 + 2.9 * row, 0.05)
                    frames.append(put(bars.moved(*at)))
                    glow = ramp(rng.random(()), ("#ffb45a", "#ffd9a0", "#ff9a4a", "#cfe0ff")) * rng.uniform(0.4, 1.8)
                    if rng.random() > 0.42:
                        glow = np.array([0.012, 0.016, 0.03])
                    fall = (
                        0.55 + 0.6 * pane.vertices[:, 1:2] / 1.7 + 0.25 * rng.standard_normal((len(pane.vertices), 1))
                    )
                    panes.append(put(pane.moved(*at).tinted(np.maximum(fall, 0.1) * glow)))
            glow = ramp(rng.random(()), ("#ffcf8a", "#ffe6bf", "#ff9f6a", "#bfe8e0")) * rng.uniform(0.8, 2.2)
            glass = plane((-2.6, 0.5, 0.06), (5.2, 0, 0), (0, 2.1, 0), (12, 5))
            shops.append(put(glass.tinted(glow * (0.35 + 0.65 * rng.random((len(glass.vertices), 1))))))
            frames += [put(box(0.12, 2.1, 0.1).moved(x, 0.5, 0.08)) for x in (-2.6, -0.9, 0.9, 2.6)]
            cover = plane((-2.8, 2.35, 1.1), (5.6, 0, 0), (0, 0.55, -1.05), (16, 1))
            stripe = np.where((np.arange(17) % 2 == 0)[None, :], 1.0, 0.25).repeat(2, axis=0).reshape(-1, 1)
            walls.append(put(cover).tinted(stripe * paint(codes[(k + 3) % 6]) * 1.6))
    skin = mottled(256, ("#a8a098", "#d0c8be", "#efe8de"), rng, 6)
    yield lamp_light(join(walls), lamps, 1.1, _FLOOR).part(Material("unlit", texture=skin))
    yield lamp_light(join(frames), lamps, 0.9, _FLOOR).part(Material("unlit", (0.4, 0.37, 0.33)))
    yield join([*panes, *shops]).part(Material("unlit"))


def _posts(street: Lamps, warm: Lamps) -> Iterator[Part]:
    """Cast-iron posts under the street lamps."""
    profile = [
        (0.14, 0.0),
        (0.14, 0.35),
        (0.08, 0.45),
        (0.06, 1.2),
        (0.045, 3.0),
        (0.09, 3.1),
        (0.05, 3.2),
        (0.1, 3.36),
    ]
    cap = [(0.16, 3.62), (0.05, 3.8), (0.0, 3.95)]
    posts = join(lathe([profile, cap], 12).moved(x, 0, z) for x, _, z in street.place)
    yield lamp_light(posts, warm, 0.5, _FLOOR).part(Material("unlit", (0.18, 0.19, 0.18)))


def _wires(near: Lamps) -> Iterator[Part]:
    half = len(near.place) // 2
    wires = [tube(near.place[s] + [0, 0.012, 0], 0.0016, 5) for s in (slice(0, half), slice(half, None))]
    caps = [lathe([[(0.0, 0.012), (0.003, 0.011), (0.0035, 0.002)]], 8).moved(*p) for p in near.place]
    yield join([*wires, *caps]).part(Material("unlit", (0.012, 0.016, 0.012)))

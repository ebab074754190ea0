"""Cafe table: a checked cloth with a candle lantern, a cup on its saucer, a rose in a bottle and a book.

Candle and lamplight are baked into the colours.
"""

from collections.abc import Callable, Iterator

import numpy as np

from refdof._check import Float
from refdof.scene.kit.darkening import beside
from refdof.scene.kit.lamplight import Lamps, lamp_light
from refdof.scene.kit.mesh import Mesh, join
from refdof.scene.kit.plants import blossom
from refdof.scene.kit.shapes import box, disc, lathe, leaf, sphere, surface, torus, tube
from refdof.scene.kit.shot import Shot
from refdof.scene.kit.textures import cloth, mottled, paint, planks, ramp
from refdof.scene.material import Material
from refdof.scene.scene import Part

__all__ = ["cafe_table"]

_FLOOR = (0.035, 0.042, 0.075)  # light everywhere


def cafe_table(shot: Shot, foot: Float, top: float, rng: np.random.Generator) -> Iterator[Part]:
    """The table's parts; `foot` (3,) is where it stands, `top` how high it is."""
    candle = Lamps(foot[None] + [[-0.10, top + 0.16, 0.0]], np.array([0.03]), np.array([[120.0, 74.0, 34.0]]))
    eye = np.asarray(shot.camera.eye)
    fill = Lamps(np.array([[0.5, 2.3, eye[2] - 0.9]]), np.array([0.2]), np.array([[42.0, 33.0, 24.0]]))
    lamps = Lamps(*(np.concatenate(a) for a in zip(candle, fill, strict=True)))

    def at(mesh: Mesh, x: float, z: float, y: float = top) -> Mesh:
        return lamp_light(mesh.moved(foot[0] + x, y, foot[2] + z), lamps, 0.55, _FLOOR)

    angle = np.linspace(0, 2 * np.pi, 121)
    angle[-1] = 0.0
    fall = np.concatenate([np.linspace(0, 0.36, 14), np.full(8, 0.37)])
    drop = np.concatenate([np.zeros(14), np.linspace(0.01, 0.34, 8)])
    reach = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(fall), np.diff(drop)))])  # along the cloth
    wave = 0.022 * np.sin(14 * angle)[None, :] * (drop / 0.34)[:, None] + fall[:, None]
    linen = surface(
        np.stack([wave * np.sin(angle), -drop[:, None] + 0 * wave, wave * np.cos(angle)], axis=-1),
        closed=(False, True),
    )
    linen = Mesh(
        linen.vertices,
        linen.faces,
        2.4 * (reach[:, None, None] * np.stack([np.sin(angle), np.cos(angle)], axis=-1)).reshape(-1, 2),
        linen.color,
        linen.normal,
    )
    contact = np.minimum(
        beside(linen.vertices, (0.11, 0, 0.12), 0.07, 0.02, 0.55),
        beside(linen.vertices, (-0.10, 0, 0.0), 0.06, 0.03, 0.4),
    )
    contact = contact * beside(linen.vertices, (0.06, 0, -0.12), 0.03, 0.02, 0.5)
    s = (np.arange(512) + 0.5) / 512
    check = 0.5 * ((s[None] * 6 % 1) < 0.5) + 0.5 * ((s[:, None] * 6 % 1) < 0.5)
    weave = ramp(check, ("#ece4d6", "#c4524a", "#8f1f24")) * (cloth(512, "#ffffff", rng, 64))
    yield at(linen.tinted(contact), 0, 0).part(Material("unlit", texture=weave.astype(np.float32)))
    leg = lathe([[(0.2, 0.0), (0.19, 0.03), (0.04, 0.06), (0.025, 0.3), (0.03, 0.9)]], 24)
    yield at(leg, 0, 0, 0.0).part(Material("unlit", (0.15, 0.15, 0.16)))
    iron = [
        lathe(
            [
                [(0.062, 0.0), (0.066, 0.012), (0.055, 0.02)],
                [(0.06, 0.17), (0.064, 0.18), (0.03, 0.215), (0.0, 0.225)],
            ],
            24,
        )
    ]
    iron += [
        tube(np.array([(0.056 * np.sin(a), y, 0.056 * np.cos(a)) for y in (0.015, 0.1, 0.175)]), 0.003, 6)
        for a in np.arange(8) * np.pi / 4
    ]
    iron.append(torus(0.026, 0.0035, 24, 8).turned("x", 90).moved(0, 0.248, 0))
    yield at(join(iron), -0.10, 0.0).tinted((1.6, 1.5, 1.4)).part(Material("unlit", (0.16, 0.14, 0.11)))
    wax = lathe([[(0.03, 0.005), (0.03, 0.085), (0.024, 0.083), (0.0, 0.08)]], 24)
    wax = wax.tinted(np.array([1.0, 0.62, 0.28]) * (0.25 + 1.7 * np.clip(wax.vertices[:, 1:2] / 0.085, 0, 1) ** 3))
    yield wax.moved(foot[0] - 0.10, top, foot[2]).part(Material("unlit"))
    flame = lathe([[(0.0, -0.014), (0.006, -0.006), (0.0065, 0.002), (0.004, 0.016), (0.0, 0.03)]], 12)
    yield flame.moved(foot[0] - 0.10, top + 0.1, foot[2]).part(Material("unlit", (0, 0, 0), emission=(30.0, 16.0, 5.0)))
    yield from _setting(at, rng)


def _setting(at: Callable[..., Mesh], rng: np.random.Generator) -> Iterator[Part]:
    """Cup, book and rose."""
    cup = [
        [(0.0, 0.006), (0.028, 0.004), (0.03, 0.008), (0.043, 0.035), (0.049, 0.075), (0.047, 0.0755)],
        [(0.047, 0.0755), (0.04, 0.035), (0.026, 0.012), (0.0, 0.012)],
    ]
    saucer = [
        [
            (0.0, 0.0),
            (0.035, 0.0),
            (0.078, 0.012),
            (0.08, 0.0145),
            (0.076, 0.0145),
            (0.035, 0.004),
            (0.0, 0.004),
        ]
    ]
    ear = tube(
        np.array([(0.045, 0.065, 0), (0.066, 0.062, 0), (0.072, 0.042, 0), (0.058, 0.024, 0), (0.038, 0.022, 0)]),
        0.0045,
        8,
    )
    bowl = lathe(cup, 40)
    band = np.where(np.abs(bowl.vertices[:, 1:2] - 0.06) < 0.012, [[0.20, 0.34, 0.55]], [[1.0, 0.97, 0.9]])
    china = join([lathe(saucer, 40), bowl.tinted(band).moved(0, 0.003, 0), ear.turned("y", 35).moved(0, 0.003, 0)])
    yield at(china, 0.11, 0.12).part(Material("unlit", (0.8, 0.8, 0.8)))
    yield at(disc(0.046, 32, 0.068), 0.11, 0.12).part(Material("unlit", (0.10, 0.05, 0.025)))
    cover = [box(0.13, 0.004, 0.19).moved(0, y, 0) for y in (0.0, 0.026)] + [box(0.005, 0.03, 0.19).moved(-0.064, 0, 0)]
    pages = box(0.122, 0.022, 0.184).moved(0, 0.004, 0)
    yield at(join(cover).turned("y", 24), -0.12, 0.19).part(
        Material("unlit", texture=mottled(128, ("#1f3d4d", "#2c5468", "#3d6c80"), rng))
    )
    yield at(pages.turned("y", 24), -0.12, 0.19).part(
        Material("unlit", texture=planks(128, 24, ("#cfc3a4", "#e0d6ba", "#efe7d0"), rng))
    )
    bottle = lathe(
        [
            [
                (0.0, 0.0),
                (0.034, 0.0),
                (0.036, 0.006),
                (0.036, 0.1),
                (0.014, 0.135),
                (0.012, 0.17),
                (0.015, 0.175),
            ]
        ],
        32,
    )
    yield at(bottle, 0.06, -0.12).part(Material("unlit", (0.10, 0.26, 0.20)))
    rose = blossom(rng, "#d8304a", "#6f0f22")
    head = join(
        [rose.scaled(s).turned("y", 36.0 * k).moved(0, 0.008 * k, 0) for k, s in enumerate((0.09, 0.075, 0.055))]
    )
    stem = tube(np.array([(0, 0.16, 0), (0.004, 0.22, 0.002), (0.012, 0.28, 0.006)]), 0.003, 6).tinted(paint("#3f6a30"))
    green = [
        leaf(0.06, 0.03, 0.3).turned("x", -35).turned("y", a).moved(0.005, 0.22, 0.0).tinted(paint("#47763a"))
        for a in (70.0, 250.0)
    ]
    yield at(
        join(
            [
                head.turned("x", 42).moved(0.012, 0.28, 0.006),
                stem,
                *green,
                sphere(0.012, 6, 8).moved(0.012, 0.283, 0.008).tinted(paint("#4a0c18")),
            ]
        ),
        0.06,
        -0.12,
    ).part(Material("unlit", (1.3, 1.3, 1.3)))

"""Mirrors: chrome, brass, copper and glaze on a studio table; the teapot is in focus.

Figure 9 of Lee, Eisemann & Seidel (2009): shading that depends on the view differs between lens samples.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from refdof.scene.kit.darkening import beside, capsule_shadow
from refdof.scene.kit.mesh import Mesh, join
from refdof.scene.kit.shapes import lathe, plane, sphere, surface, torus, tube
from refdof.scene.kit.shot import Shot
from refdof.scene.kit.studio import studio
from refdof.scene.kit.textures import mottled, paint, planks
from refdof.scene.material import Light, Material
from refdof.scene.scene import Part

__all__ = ["NUMBERS", "build", "lit"]

NUMBERS = ("map_size", "balls")

_METAL = {
    "chrome": (0.86, 0.87, 0.88),
    "brass": (0.86, 0.64, 0.30),
    "copper": (0.85, 0.48, 0.34),
    "steel": (0.55, 0.57, 0.60),
}


def lit(shot: Shot) -> Light:
    """The shot's light with the studio for mirrors to see."""
    return replace(shot.light, environment=studio(int(shot.numbers["map_size"]), "#6b4428"))


def build(shot: Shot, rng: np.random.Generator) -> Iterator[Part]:
    """Parts of the scene; feet holds (x, 0, z, foot radius, height) of what stands on the table."""
    feet: list[tuple[float, float, float, float, float]] = []
    yield _teapot().moved(0.0, 0, -0.07).part(_glaze("#7a1f1c", 0.22))
    feet.append((0.0, 0, -0.07, 0.062, 0.13))
    yield sphere(0.062, 40, 80).moved(-0.205, 0.062, 0.03).part(_metal("chrome"))
    feet.append((-0.205, 0, 0.03, 0.018, 0.1))
    yield (torus(0.062, 0.021, 96, 40).turned("x", 90).turned("y", 38).moved(0.225, 0.083, -0.05).part(_metal("brass")))
    feet.append((0.225, 0, -0.05, 0.02, 0.12))
    yield (_knot(0.05, 0.0135).turned("x", 68).turned("y", -20).moved(-0.17, 0.075, -0.34).part(_metal("copper")))
    feet.append((-0.17, 0, -0.34, 0.05, 0.1))
    yield _vase().moved(0.17, 0, -0.42).part(_glaze("#123f5a", 0.2))
    feet.append((0.17, 0, -0.42, 0.05, 0.22))
    yield _goblet().moved(-0.015, 0, -0.62).part(_metal("steel"))
    feet.append((-0.015, 0, -0.62, 0.05, 0.2))
    yield from _balls(int(shot.numbers["balls"]), feet, rng)
    yield sphere(0.05, 40, 80).moved(0.125, 0.05, 0.27).part(_metal("chrome"))
    feet.append((0.125, 0, 0.27, 0.015, 0.08))
    yield from _stage(shot, feet, rng)


def _metal(name: str) -> Material:
    return Material("phong", (0.01, 0.01, 0.01), specular=_METAL[name], shininess=400)


def _glaze(code: str, gloss: float) -> Material:
    r, g, b = paint(code).tolist()
    return Material("phong", (r, g, b), specular=(gloss, gloss, gloss), shininess=200)


def _curve(points: list[tuple[float, float]], steps: int) -> list[tuple[float, float]]:
    """Smooth profile through a few points (quadratic B-spline midpoints kept)."""
    line = np.asarray(points)
    for _ in range(steps):  # Chaikin's corner cutting, ends kept
        cut = np.stack([0.75 * line[:-1] + 0.25 * line[1:], 0.25 * line[:-1] + 0.75 * line[1:]], axis=1).reshape(-1, 2)
        line = np.concatenate([line[:1], cut[1:-1], line[-1:]])
    return [(float(x), float(y)) for x, y in line]


def _teapot() -> Mesh:
    """Round body with a lid and knob, a bent spout and a handle."""
    body = _curve(
        [
            (0.0, 0.0),
            (0.055, 0.0),
            (0.062, 0.004),
            (0.058, 0.012),
            (0.098, 0.04),
            (0.1, 0.085),
            (0.075, 0.118),
            (0.05, 0.124),
            (0.048, 0.122),
        ],
        3,
    )
    lid = _curve(
        [
            (0.051, 0.124),
            (0.05, 0.131),
            (0.03, 0.139),
            (0.012, 0.143),
            (0.008, 0.15),
            (0.017, 0.158),
            (0.013, 0.17),
            (0.0, 0.171),
        ],
        3,
    )
    t = np.linspace(0, 1, 40)
    spout = np.column_stack([0.085 + 0.085 * t, 0.05 + 0.012 * np.sin(np.pi * t) + 0.07 * t**1.5, 0 * t])
    grip = np.linspace(0.35, 2 * np.pi - 1.15, 60)
    handle = np.column_stack([-0.108 + 0.05 * np.cos(grip), 0.078 + 0.042 * np.sin(grip), 0 * grip])[::-1]
    thick = 0.017 - 0.008 * t
    return join([lathe([body, lid], 96), tube(spout, thick, 32), tube(handle, 0.0075, 24)]).turned("y", -28)


def _knot(radius: float, thickness: float) -> Mesh:
    """Trefoil knot."""
    t = np.linspace(0, 2 * np.pi, 161)
    t[-1] = 0.0
    ring = radius * (1.0 + 0.42 * np.cos(3 * t))
    return tube(
        np.column_stack([ring * np.cos(2 * t), 0.5 * radius * np.sin(3 * t), ring * np.sin(2 * t)]),
        thickness,
        20,
        closed=True,
    )


def _vase() -> Mesh:
    profile = _curve(
        [
            (0.0, 0.0),
            (0.04, 0.0),
            (0.045, 0.01),
            (0.085, 0.07),
            (0.07, 0.13),
            (0.028, 0.165),
            (0.026, 0.2),
            (0.045, 0.225),
            (0.04, 0.226),
        ],
        3,
    )
    return lathe([profile, _curve([(0.04, 0.226), (0.022, 0.2), (0.02, 0.15)], 2)], 80)


def _goblet() -> Mesh:
    profile = [
        (0.0, 0.0),
        (0.05, 0.0),
        (0.05, 0.006),
        (0.012, 0.016),
        (0.009, 0.05),
        (0.016, 0.06),
        (0.009, 0.07),
        (0.012, 0.1),
        (0.05, 0.13),
        (0.055, 0.19),
        (0.05, 0.2),
    ]
    return lathe([_curve(profile, 4), _curve([(0.05, 0.2), (0.045, 0.14), (0.0, 0.11)], 3)], 72)


def _balls(
    count: int, feet: list[tuple[float, float, float, float, float]], rng: np.random.Generator
) -> Iterator[Part]:
    """Small marbles in free places."""
    codes = ("#d8a32c", "#1f6a5a", "#b7352b", "#274f8f", "#7f2f68", "#d9d2c2")
    placed = 0
    while placed < count:
        x, z, r = rng.uniform(-0.27, 0.27), rng.uniform(-0.5, 0.2), rng.uniform(0.014, 0.024)
        if all(np.hypot(x - f[0], z - f[2]) > max(f[3] * 1.0, 0.06) + 2.0 * r + 0.03 for f in feet):
            material = _metal("chrome") if placed % 3 == 2 else _glaze(codes[placed % 6], 0.25)
            yield sphere(r, 18, 36).moved(x, r, z).part(material)
            feet.append((x, 0, z, 0.3 * r, 1.6 * r))
            placed += 1


def _stage(
    shot: Shot, feet: list[tuple[float, float, float, float, float]], rng: np.random.Generator
) -> Iterator[Part]:
    """Table of walnut boards and a painted cloth that rises behind it."""
    top = plane((-1.0, 0, 0.75), (2.0, 0, 0), (0, 0, -1.75), (120, 110))
    shade = np.ones((len(top.vertices), 1))
    for x, _, z, r, h in feet:
        shade = shade * beside(top.vertices, (x, 0, z), r, 0.5 * h, 0.6)
        shade = shade * capsule_shadow(
            top.vertices, (x, 0, z), h, max(r, 0.35 * h), shot.light.sun_direction, 0.03, 0.4
        )
    glow = 0.75 + 0.5 * np.exp(-(top.vertices[:, :1] ** 2 + (top.vertices[:, 2:3] + 0.1) ** 2) / 0.25)
    boards = planks(1024, 8, ("#3a2113", "#5e3a22", "#85573a", "#a87650"), rng)
    yield (
        top.tiled(2.2, 2.0)
        .tinted(shade * glow)
        .part(Material("phong", texture=boards, specular=(0.07, 0.07, 0.07), shininess=80))
    )
    s, t = np.meshgrid(np.linspace(-1, 1, 41), np.linspace(0, 1, 25))
    fold = 0.02 * np.sin(17 * s + 2 * t) * (0.4 + t)
    cloth = surface(np.stack([2.0 * s, 1.6 * t**1.4, -0.97 - 0.5 * np.sqrt(t) + fold], axis=-1))
    tone = (0.45 + 0.75 * np.exp(-((s - 0.1) ** 2 / 0.12 + (t - 0.25) ** 2 / 0.12)) + 4.0 * fold).reshape(-1, 1)
    backdrop = mottled(512, ("#66757c", "#929d9a", "#beb8a8"), rng, 5)
    yield cloth.tiled(2, 1).tinted(tone).part(Material(texture=backdrop))

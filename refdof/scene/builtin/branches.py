"""Branches: two plum branches cross before a gilded screen, the focal plane between them.

Figure 8 (distorted geometries) of Lee, Eisemann & Seidel (2009): where they cross, they appear separated.
"""

from collections.abc import Iterator

import numpy as np

from refdof._check import Float
from refdof.scene.kit.mesh import Mesh, join, scatter
from refdof.scene.kit.noise import fractal, smooth
from refdof.scene.kit.plants import blossom, branch, facing, shades
from refdof.scene.kit.shapes import leaf, plane, sphere, surface, tube
from refdof.scene.kit.shot import Shot
from refdof.scene.kit.textures import blend, mottled, paint, ramp
from refdof.scene.material import Material
from refdof.scene.scene import Part

__all__ = ["NUMBERS", "build"]

NUMBERS = ("front", "behind", "screen")


def build(shot: Shot, rng: np.random.Generator) -> Iterator[Part]:
    """Parts of the scene: each branch keeps its own depth."""
    front, behind, screen = (shot.numbers[key] for key in NUMBERS)
    bark = Material(texture=mottled(256, ("#3a2a20", "#5d4634", "#8a7058"), rng, 8))
    pale = Material(texture=mottled(256, ("#4d4a3c", "#76705a", "#a39c80"), rng, 8))
    # Points are written for a depth of 1 and pushed along their rays, so the crossing stays where it is.
    rising = front * np.array(
        [(-0.46, -0.24, -1), (-0.24, -0.12, -0.99), (-0.02, -0.03, -1.01), (0.2, 0.11, -1), (0.44, 0.2, -1)]
    )
    twig = front * np.array([(-0.24, -0.12, -0.99), (-0.2, 0.0, -1.01), (-0.23, 0.13, -1.0), (-0.19, 0.21, -1.01)])
    falling = behind * np.array(
        [(-0.46, 0.19, -1), (-0.2, 0.1, -1.005), (0.0, -0.03, -1), (0.17, -0.13, -0.995), (0.42, -0.22, -1)]
    )
    shoot = behind * np.array([(0.17, -0.13, -0.995), (0.22, -0.01, -1), (0.32, 0.05, -1.0), (0.36, 0.14, -0.995)])
    yield join([branch(rising, 0.010, 0.004, rng), branch(twig, 0.005, 0.0016, rng, 40, 10)]).part(bark)
    yield join([branch(falling, 0.013, 0.006, rng), branch(shoot, 0.006, 0.002, rng, 40, 10)]).part(pale)
    flowers = [_bloom(path, n, 0.052 * front, rng) for path, n in ((rising, 6), (twig, 6))]
    yield join(flowers).part(Material())
    white = [_bloom(path, n, 0.05 * behind, rng, "#f6efe6", "#c8a25a") for path, n in ((falling, 6), (shoot, 5))]
    yield join(white).part(Material())
    yield _leaves(rising, 0.035 * front, rng)
    yield _leaves(falling, 0.04 * behind, rng)
    focus = shot.lens.focus_distance
    yield (
        _butterfly()
        .scaled(0.075 * focus)
        .turned("x", -22)
        .turned("z", 34)
        .moved(-0.085 * focus, 0.172 * focus, -focus)
        .part(Material())
    )
    yield from _screen(screen, rng)


def _along(path: Float, t: Float) -> Float:
    k = np.minimum(t.astype(np.int64), len(path) - 2)
    return path[k] + (t - k)[:, None] * (path[k + 1] - path[k])


def _bloom(
    path: Float,
    count: int,
    size: float,
    rng: np.random.Generator,
    petal: str = "#f0b6c6",
    heart: str = "#b02a48",
) -> Mesh:
    """Flowers and buds beside a branch, away from its middle, where the branches cross."""
    t = np.linspace(0.25, len(path) - 1.05, count) + rng.uniform(-0.15, 0.15, count)
    if len(path) > 4:
        t = np.where(np.abs(t - 2.0) < 0.62, t + np.sign(t - 2.0) * 0.6, t)
    angle = rng.uniform(0, 6.28, count)
    side = np.column_stack([np.cos(angle), np.sin(angle), 0.3 + 0 * angle])
    place = _along(path, t) + 0.3 * size * side
    turn = facing(rng.uniform(-45, 45, count), rng.uniform(-100, -40, count))
    flowers = scatter(
        blossom(rng, petal, heart),
        place,
        turn,
        size * rng.uniform(0.8, 1.1, count),
        shades(count, ("#ffffff", "#fbe6e0"), rng, 0.05),
    )
    t = rng.uniform(0.2, len(path) - 1.05, 2 * count)
    angle = rng.uniform(0, 6.28, 2 * count)
    place = _along(path, t) + 0.16 * size * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    bud = sphere(0.13, 8, 10).scaled(1, 1.25, 1).tinted(0.5 * paint(petal) + 0.5 * paint(heart))
    buds = scatter(bud, place, facing(0 * t, rng.uniform(-60, 60, 2 * count)), size * rng.uniform(0.7, 1.2, 2 * count))
    return join([flowers, buds])


def _leaves(path: Float, size: float, rng: np.random.Generator) -> Part:
    """A few young leaves."""
    count = 16
    t = rng.uniform(0.1, len(path) - 1.02, count)
    t = np.where(np.abs(t - 2.0) < 0.45, t + np.sign(t - 2.0) * 0.5, t)
    turn = facing(rng.uniform(0, 360, count), rng.uniform(-20, 60, count), rng.uniform(-60, 60, count))
    tint = shades(count, ("#6f8f3a", "#9aa648", "#a8603c"), rng)
    return scatter(leaf(1.0, 0.42, 0.3, 0.2, 6), _along(path, t), turn, size * rng.uniform(0.6, 1.1, count), tint).part(
        Material()
    )


def _butterfly() -> Mesh:
    """Butterfly with spread wings, about one unit to a wing tip; it hovers in the focal plane."""
    wings = []
    for low, high, long, codes in (
        (4.0, 72.0, 1.0, ("#e8b23a", "#dd7a22", "#b8481c")),
        (-78.0, 2.0, 0.72, ("#e9c052", "#e08a2c", "#c25a22")),
    ):
        angle, s = np.meshgrid(np.radians(np.linspace(low, high, 41)), np.linspace(0, 1, 25))
        t = (angle - angle.min()) / (angle.max() - angle.min())
        reach = long * (0.72 + 0.28 * np.sin(np.pi * t**0.7) + 0.02 * np.sin(34 * t)) * s
        points = np.stack([reach * np.cos(angle), reach * np.sin(angle), 0.30 * reach * np.cos(angle)], axis=-1)
        dark = np.maximum(smooth(0.80, 0.86, s), smooth(0.82, 0.97, np.cos(26 * t)) * smooth(0.1, 0.4, s))
        spot = smooth(0.2, 0.6, np.cos(44 * t)) * smooth(0.05, 0.02, np.abs(s - 0.92))
        color = blend(blend(ramp(s, codes), paint("#2a1a12"), dark), paint("#f6ead0"), spot)
        wing = surface(points).tinted(color.reshape(-1, 3))
        wings += [wing, wing.scaled(-1.0, 1.0, 1.0)]
    y = np.linspace(-0.42, 0.34, 14)
    body = tube(
        np.column_stack([0 * y, y, 0.02 + 0 * y]),
        0.05 * np.sin(np.pi * np.linspace(0.06, 0.97, 14)) ** 0.6,
        12,
    )
    feelers = [
        tube(np.array([(0, 0.3, 0.03), (s * 0.12, 0.52, 0.1), (s * 0.3, 0.68, 0.12)]), 0.009, 5) for s in (-1, 1)
    ]
    return join([*wings, join([body, *feelers]).tinted(paint("#3a2618"))])


def _screen(distance: float, rng: np.random.Generator) -> Iterator[Part]:
    """Folding screen of gold leaf in squares, darker towards misty hills below, in lacquered frames."""
    gold = _gold(rng)
    frames = []
    width = 0.62
    for k in range(-2, 3):
        tilt = 14.0 if k % 2 else -14.0
        panel = plane((-width / 2, -1.0, 0), (width, 0, 0), (0, 2.0, 0), (20, 40))
        fold = 1.0 - 0.25 * np.exp(-(width / 2 - np.abs(panel.vertices[:, :1])) / 0.03)
        panel = panel.tinted(fold)
        panel = Mesh(panel.vertices, panel.faces, panel.uv * [1 / 5, 1] + [(k + 2) / 5, 0], panel.color, panel.normal)
        yield panel.turned("y", tilt).moved(k * width * 0.97, 0, -distance).part(gold)
        edge = plane((-0.006, -1.0, 0.002), (0.012, 0, 0), (0, 2.0, 0), (1, 1))
        frames += [
            edge.moved(s * (width / 2 - 0.006), 0, 0).turned("y", tilt).moved(k * width * 0.97, 0, -distance)
            for s in (-1, 1)
        ]
    yield join(frames).part(Material("phong", (0.05, 0.02, 0.015), specular=(0.1, 0.1, 0.1)))


def _gold(rng: np.random.Generator) -> Material:
    """Gold leaf with a sun and three ridges of hills in mist, over all five panels."""
    height, width = 640, 1024
    u = np.broadcast_to((np.arange(width) + 0.5)[None, :] / width, (height, width))
    v = np.broadcast_to((height - 0.5 - np.arange(height))[:, None] / height, (height, width))
    i, j = (u * 30).astype(int), (v * 20).astype(int)
    seam = np.minimum(np.minimum(u * 30 % 1, 1 - u * 30 % 1), np.minimum(v * 20 % 1, 1 - v * 20 % 1))
    worn = fractal((height, width), (6, 10), rng, 6, 0.6) - 0.5
    tone = 0.45 + 0.22 * rng.random((20, 30))[j, i] + 0.55 * worn + 0.16 * smooth(0.0, 0.07, seam) + 0.25 * (v - 0.5)
    color = ramp(tone, ("#6e5120", "#a37c33", "#cfa852", "#ecd28a"))
    disc = np.hypot((u - 0.56) * 1.55, v - 0.57)
    color = blend(color, paint("#b4472e") * (1 + 0.5 * worn)[..., None], 0.8 * smooth(0.0705, 0.0685, disc))
    for k, (level, code) in enumerate(((0.45, "#7d8a66"), (0.40, "#566f5c"), (0.35, "#344f4a"))):
        line = level + 0.12 * (fractal((1, width), (1, 9 + 5 * k), rng, 5)[0] - 0.5)
        inside = smooth(-0.002, 0.002, line - v)
        fade = np.clip(1.0 - (line - v) / 0.17, 0.0, 1.0) ** 1.5
        color = blend(color, paint(code) * (1 + 0.6 * worn)[..., None], inside * (0.12 + 0.68 * fade))
    return Material(texture=np.maximum(color, 0).astype(np.float32))

"""Backdrops: skies with clouds on a dome, and walls of mist and hills behind a scene."""

import numpy as np

from refdof.scene.kit.mesh import Mesh
from refdof.scene.kit.noise import fractal, smooth
from refdof.scene.kit.shapes import surface
from refdof.scene.kit.textures import blend, paint, ramp
from refdof.scene.material import Material
from refdof.scene.scene import Part

__all__ = ["curtain", "sky"]


def sky(
    radius: float,
    codes: tuple[str, ...],
    rng: np.random.Generator,
    cloud: str = "#ffffff",
    cover: float = 0.5,
    ridge: tuple[str, float] | None = None,
) -> Part:
    """Half a dome around the origin, open behind (+z): a ramp of paints, with clouds and a far ridge.

    `ridge` is the paint and height (part of the dome's height) of hills along the horizon.
    """
    theta, phi = np.meshgrid(np.linspace(-0.12, 1.25, 13), np.linspace(-2.0, 2.0, 33), indexing="ij")
    points = radius * np.stack([np.cos(theta) * np.sin(phi), np.sin(theta), -np.cos(theta) * np.cos(phi)], axis=-1)
    height, width = 512, 1024
    up = np.broadcast_to(np.linspace(1.25, -0.12, height)[:, None] / 1.25, (height, width))
    color = ramp(np.clip(up, 0, 1) ** 0.7, codes)
    billow = fractal((height, width), (5, 6), rng, 6, 0.55)
    amount = smooth(0.72 - 0.4 * cover, 1.05 - 0.4 * cover, billow) * smooth(0.0, 0.15, up)
    color = blend(color, paint(cloud) * (0.82 + 0.25 * billow)[..., None], 0.9 * amount)
    if ridge is not None:
        for layer in range(3):
            line = ridge[1] * (1.0 - 0.3 * layer) * (0.4 + fractal((1, width), (1, 7 + 4 * layer), rng, 5)[0])
            tone = paint(ridge[0]) + (paint(codes[0]) - paint(ridge[0])) * (0.65 - 0.3 * layer)
            rough = 1.0 + 0.25 * (fractal((height, width), (32, 64), rng, 3) - 0.5)
            color = blend(color, tone * rough[..., None], smooth(0.006, -0.006, up - line))
    return surface(points).part(Material("unlit", texture=color.astype(np.float32)))


def curtain(width: float, height: float, distance: float, bend: float = 0.6) -> Mesh:
    """Upright wall, curved towards the viewer at its sides, its foot's middle at (0, 0, -distance)."""
    s, t = np.meshgrid(np.linspace(-1, 1, 33), np.linspace(0, 1, 17))
    angle = bend * s
    radius = width / (2 * max(bend, 1e-6))
    return surface(np.stack([radius * np.sin(angle), height * t, -distance + radius * (1 - np.cos(angle))], axis=-1))

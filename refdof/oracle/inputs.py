"""Input pictures of packs: each shows one kind of mistake more clearly than any scene does.

A picture's circles are those of a thin lens, P E (1 / focus - 1 / depth), so that a port can also make its own.
"""

from collections.abc import Callable

import numpy as np

from refdof.oracle import extremes
from refdof.oracle.pictures import FAR, Picture, random, seen
from refdof.scene.load import load_scene
from refdof.view import View

__all__ = ["FAR", "INPUTS", "ORIGINS", "Picture"]

_SCENE = "fence"


def ramp(width: int, height: int) -> Picture:
    """Red and green are the place; one depth: a shift of all taps shows as such."""
    y, x = np.indices((height, width)) + 0.5
    color = np.stack([x / width, y / height, np.full(x.shape, 0.25)], axis=-1)
    return seen(color, np.full(x.shape, 4.0), 48.0, 2.0)


def impulses(width: int, height: int) -> Picture:
    """White pixels 48 px apart before circles beyond the maximum: the footprint, tap by tap."""
    y, x = np.indices((height, width))
    lit = (x % 48 == min(24, width // 2)) & (y % 48 == min(24, height // 2))
    return seen(16.0 * lit[..., None] * [1.0, 0.5, 0.25], np.ones(x.shape), 50.0, 2.0)


def constant(width: int, height: int) -> Picture:
    """One colour at any depth: stays as it is."""
    (place,) = random(1, (height, width))
    return seen(np.full((height, width, 3), [0.5, 0.25, 0.75]), 1.0 + 7.0 * place, 50.0, 2.0)


def cards(width: int, height: int) -> Picture:
    """A near, a sharp and a far card over the background, with checks on each: who may spread over whom."""
    y, x = np.indices((height, width))
    depth = np.where(y < height // 4, FAR, 5.0)
    depth = np.where((4 * x > width) & (4 * x < 3 * width) & (3 * y > height), 2.0, depth)
    depth = np.where((3 * x < width) & (8 * y > height), 1.2, depth)
    checks = ((x // 5 + y // 3) % 2)[..., None]
    tint = np.stack([1.0 / depth, 0.2 + 0.1 * (depth == 2.0), np.minimum(depth, 8.0) / 8.0], axis=-1)
    return seen(tint * (0.2 + 0.8 * checks), depth, 36.0, 2.0)


def bar(width: int, height: int) -> Picture:
    """Thin bars, near and far, thinner than their blur."""
    y, x = np.indices((height, width))
    color, depth = np.full((height, width, 3), 0.1), np.full(x.shape, 2.0)
    far, near = x // 2 == width // 8, np.abs(2 * x - width - y) < 3
    color[far], depth[far] = [0.1, 0.4, 1.0], 6.0
    color[near], depth[near] = [1.0, 0.8, 0.2], 1.1
    return seen(color, depth, 30.0, 2.0)


def hdr(width: int, height: int) -> Picture:
    """Lights of up to 64 over a slope through the focal plane, circles of both signs to beyond the maximum."""
    y, x = np.indices((height, width))
    light = ((x * 7 + y * 13) % 97 == 0)[..., None] * np.array([64.0, 24.0, 6.0])
    return seen(0.05 + light, 1.0 + 5.0 * (x + 0.5 * y) / (width + 0.5 * height), 60.0, 2.0)


def noise(width: int, height: int) -> Picture:
    """No texel is like its neighbour: a tap that reads another one shows. Made for sizes with ties."""
    one = (height, width)
    color, lit, nearness, empty = random(2, (*one, 3), (*one, 1), one, one)
    depth = np.where(empty < 0.1, FAR, 1.0 / (0.1 + 0.9 * nearness))
    return seen(color * (lit < 0.3), depth, 44.0, 2.0)


def scene(width: int, height: int) -> Picture:
    """A built-in scene as a pinhole sees it, with circles four times its own lens's."""
    shot = load_scene(_SCENE)
    camera, lens = shot.camera.with_size((width, height)), shot.lens
    pinhole = View(shot, camera, lens).pinhole()
    scale = 4.0 * camera.pixels_per_tangent * lens.radius
    return seen(pinhole.color, np.minimum(pinhole.depth, FAR), float(scale), float(lens.focus_distance))


INPUTS: dict[str, Callable[[int, int], Picture]] = {
    made.__name__: made for made in (ramp, impulses, constant, cards, bar, hdr, noise, scene, *extremes.INPUTS)
}

ORIGINS: dict[str, str] = {
    "ramp": "public ports: half a pixel added or missing in 4 of 32 families, a shifted or ignored coordinate in 1",
    "impulses": "public ports: a loop cut short in 4 of 32 families, a wrong pixel size in 5, another spiral in 6",
    "constant": "public ports: tone map, gamma, clamp or noise inside the pass in 5 of 32 families, 0 / 0 in 2",
    "cards": "public ports: order decided by size in 3 of 32 families, another size rule in 2, wrong depth in 4",
    "bar": "public ports: an early-out for sharp pixels, over which nothing near can then spread, in 2 of 32 families",
    "hdr": "public ports: a clamp inside the pass in 5 of 32 families; targets of 8 bits leave 55 to 58 dB",
    "noise": "right ports on sizes that are not powers of two: up to 0.9 % of pixels 0.02 to 0.1 off at ties",
    "scene": "a small scene alone let a loop of 76 taps instead of 398 pass",
}
"""Why an input is here: what was found in public ports of the single pass, in November 2026, or with such pictures."""

"""A scene with everything at once, laid out in pixels, and what a pinhole sees of it, painted by hand.

A tiled wall in the focal plane that crosses the upper and the lower border; a card near the lens that crosses the left
and the upper border; a farther card that crosses the lower border; a lamp brighter than white behind the focal plane; a
bar near the lens, from border to border, and on the wall behind it a stripe that no pinhole ray meets; a background.
Edges lie between pixels, and parts of the wall do not overlap. Channels are 0.1 to 0.9, except for the lamp's red.
"""

import math

import numpy as np

from refdof import Camera, Material, Part, Scene, ThinLens

WIDTH, HEIGHT = 160, 120
SCALE = 160.0  # P, pixels per unit tangent
FOCUS, NEAR, BEHIND, FAR = 4.0, 2.0, 8.0, 16.0
RADIUS = 0.1  # of the lens: circles of 16 (1 / 4 - 1 / depth) px: -4, 2, 3, and 4 for the background
CAMERA = Camera(
    (0.0, 0.0, 4.0), (0.0, 0.0, 0.0), fov_y=2.0 * math.degrees(math.atan(HEIGHT / 2 / SCALE)), size=(WIDTH, HEIGHT)
)
OUT = 60  # pixels beyond the border
BACKGROUND = (0.2, 0.3, 0.6)
LAMP, LAMP_OFF, LAMP_RED = (20, 80, 26, 86), (0.1, 0.5, 0.2), 8.0
BAR, BAR_COLOR = (127, -OUT, 130, HEIGHT + OUT), (0.8, 0.1, 0.3)
STRIPE, STRIPE_COLOR = (128, -OUT, 129, HEIGHT + OUT), (0.1, 0.9, 0.2)
TILE = 7
TILES = 0.1 + 0.8 * np.random.default_rng(3).random((HEIGHT // TILE + 1, 10, 3))


def rectangles(lamp_red=LAMP_RED, bar=True):
    """From far to near: (x0, y0, x1, y1) px on the pinhole picture, y down, depth, colour."""
    yield (-OUT, 96, 46, HEIGHT + OUT), FAR, (0.9, 0.7, 0.2)
    yield LAMP, BEHIND, (lamp_red, *LAMP_OFF[1:])
    for j, i in np.ndindex(TILES.shape[:2]):
        top, bottom = (-OUT if j == 0 else TILE * j), (HEIGHT + OUT if j == len(TILES) - 1 else TILE * (j + 1))
        yield (50 + TILE * i, top, 50 + TILE * (i + 1), bottom), FOCUS, tuple(TILES[j, i])
    plain = (0.1, 0.2, 0.5)  # around the stripe
    yield (50 + TILE * TILES.shape[1], -OUT, STRIPE[0], HEIGHT + OUT), FOCUS, plain
    yield STRIPE, FOCUS, STRIPE_COLOR
    yield (STRIPE[2], -OUT, WIDTH + OUT, HEIGHT + OUT), FOCUS, plain
    yield (-OUT, -OUT, 24, 40), NEAR, (0.5, 0.9, 0.1)
    if bar:
        yield BAR, NEAR, BAR_COLOR


def scene(color=None, mirrored=False, lens=ThinLens(RADIUS, FOCUS), **words):
    """The scene; with `color`, all of it in that colour."""
    parts = []
    for (x0, y0, x1, y1), depth, own in rectangles(**words):
        x = (np.array([x0, x1, x1, x0]) - WIDTH / 2) * depth / SCALE
        y = (HEIGHT / 2 - np.array([y1, y1, y0, y0])) * depth / SCALE
        corners = np.stack([-x if mirrored else x, y, np.full(4, 4.0 - depth)], axis=1)
        paint = Material("unlit", base_color=(0.0, 0.0, 0.0), emission=color or own)
        parts.append(Part(corners, np.array([[0, 1, 2], [0, 2, 3]]), paint))
    return Scene.from_parts("full", parts, CAMERA, lens, color or BACKGROUND)


def pinhole(**words):
    """Colour (H, W, 3) and depth (H, W) through the pinhole."""
    picture, depths = np.empty((HEIGHT, WIDTH, 3)), np.full((HEIGHT, WIDTH), np.inf)
    picture[:] = BACKGROUND
    for (x0, y0, x1, y1), depth, own in rectangles(**words):
        seen = np.s_[max(y0, 0) : max(y1, 0), max(x0, 0) : max(x1, 0)]
        picture[seen], depths[seen] = own, depth
    return picture, depths

"""A flat scene for the studio: two cards at known depths before a pinhole, and a state that asks for it."""

import numpy as np

from refdof import ThinLens
from tests.flat_scene import camera, rectangle, scene_of

WIDTH, HEIGHT, SCALE = 64, 48, 50.0
NEAR, FAR = 2.0, 8.0


def scene():
    """A near card on the left half, a far one behind all; each pixel's depth is known."""
    parts = [rectangle(-5.0, 0.0, -5.0, 5.0, NEAR, (0.8, 0.2, 0.1)), rectangle(-20, 20, -20, 20, FAR, (0.1, 0.3, 0.8))]
    return scene_of(parts, camera(WIDTH, HEIGHT, SCALE), ThinLens(0.1, NEAR))


def depth():
    """(H, W) of the pinhole: the edge is between columns 31 and 32."""
    return np.where(np.arange(WIDTH) < WIDTH // 2, NEAR, FAR) * np.ones((HEIGHT, 1))


def state(number=1, **changes):
    """A state as a page sends it; `changes` by key, those of the lens as `lens_KEY`."""
    shot = scene().camera
    lens = {
        "kind": "thin",
        "radius": 0.1,
        "focus": NEAR,
        "focal_length": 0.05,
        "file": "double_gauss",
        "f_number": None,
    }
    lens |= {key[5:]: value for key, value in changes.items() if key.startswith("lens_")}
    return {
        "id": number,
        "camera": {"eye": list(shot.eye), "target": list(shot.target), "up": list(shot.up), "fov_y": shot.fov_y},
        "size": [WIDTH, HEIGHT],
        "lens": lens,
        "points": [],
        "method": "scatter",
        "overlay": "none",
        "frame": 0,
        "moving": False,
    } | {key: value for key, value in changes.items() if not key.startswith("lens_")}

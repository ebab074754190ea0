"""A lopsided scene for the comparison with Mitsuba, and the door to `benchmarks/mitsuba_peer.py`.

No mirror image, turn, change of focus or change of lens size maps the picture to itself. All triangles run
anticlockwise as seen from the lens, because Mitsuba's area lights shine to their front only.
"""

import sys
from pathlib import Path

import numpy as np
import trimesh

import refdof

sys.path.append(str(Path(__file__).parents[2] / "benchmarks"))
import mitsuba_peer

__all__ = ["lopsided", "mitsuba_peer"]

UNLIT = refdof.Material("unlit")
SIZE = (44, 36)  # not square; a multiple of 4 for the block averages


def lopsided():
    """A ball before the focal plane, a box behind it and a slanted sheet through it; the camera is rolled."""
    camera = refdof.Camera.look_at((0.7, 1.1, 4.0), (0.2, 0.3, 0.0), up=(0.2, 1.0, 0.1), fov_y=37.0, size=SIZE)
    lens = refdof.ThinLens(radius=0.2, focus_distance=3.6)
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.38).apply_translation((-0.45, 0.55, 1.6))
    box = trimesh.creation.box((0.9, 1.5, 0.7)).apply_translation((1.2, 0.1, -2.0))
    sheet = trimesh.Trimesh(
        [(-2.0, -1.1, -1.5), (0.9, -1.4, 1.2), (1.4, 0.1, 0.3), (-1.6, 0.9, -1.9)], [(0, 1, 2), (0, 2, 3)]
    )
    parts = [
        _part(ball, (0.9, 0.35, 0.1), (0.9, 0.2, 0.4)),
        _part(box, (0.1, 0.5, 0.9), (0.2, 0.5, 0.3)),
        _part(sheet, (0.3, 0.8, 0.2), (0.25, 0.1, 0.3)),
    ]
    return refdof.Scene.from_parts("lopsided", parts, camera, lens, (0.02, 0.05, 0.12))


def _part(mesh, color, slope):
    """Vertex colours that rise along x, y and z by `slope` each."""
    rise = mesh.vertices @ np.array([0.31, 0.17, 0.23])
    colors = np.clip(np.asarray(color) + rise[:, None] * np.asarray(slope), 0.0, None)
    return refdof.Part(mesh.vertices, mesh.faces, UNLIT, color=colors)

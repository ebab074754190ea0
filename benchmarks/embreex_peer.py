"""embreex's own class, `EmbreeScene.run`: how fast lens rays made beforehand are traced, and nothing else.

It traces one ray at a time on one thread and neither makes the rays nor shades what they meet.
"""

import time

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

import refdof

__all__ = ["lens_rays", "trace_rate"]

_TILE = 16  # px


def lens_rays(camera: refdof.Camera, lens: refdof.ThinLens, side: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Origins and directions (H W side^2, 3) float32 in camera space, through pixel centres.

    Tile by tile, and in a tile one of side x side cells of the lens after the other: the order that suits caches.
    """
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[0 : camera.height, 0 : camera.width]
    order = np.lexsort((x.ravel(), y.ravel(), x.ravel() // _TILE, y.ravel() // _TILE))
    tiles = np.split(order, np.flatnonzero(np.diff((y // _TILE * camera.width + x // _TILE).ravel()[order])) + 1)
    origins, directions = [], []
    for tile in tiles:
        right = (x.ravel()[tile] + 0.5 - camera.width / 2) / camera.pixels_per_tangent
        up = (camera.height / 2 - y.ravel()[tile] - 0.5) / camera.pixels_per_tangent
        cell = np.arange(side * side)[:, None]
        radius = np.sqrt((cell // side + rng.random((side * side, len(tile)))) / side) * lens.radius
        angle = 2.0 * np.pi * (cell % side + rng.random((side * side, len(tile)))) / side
        ox, oy = radius * np.cos(angle), radius * np.sin(angle)
        dx, dy = right - ox / lens.focus_distance, up - oy / lens.focus_distance
        origins.append(np.stack([ox, oy, np.zeros_like(ox)], axis=-1).reshape(-1, 3))
        directions.append(np.stack([dx, dy, -np.ones_like(dx)], axis=-1).reshape(-1, 3))
    return np.concatenate(origins).astype(np.float32), np.concatenate(directions).astype(np.float32)


def trace_rate(scene: refdof.Scene, camera: refdof.Camera, lens: refdof.ThinLens, side: int = 5) -> dict[str, float]:
    """Rays, and the wall and CPU seconds that `EmbreeScene.run` spends on them."""
    embree = EmbreeScene()
    vertices = camera.camera_from_world(scene.vertices).astype(np.float32)
    mesh = TriangleMesh(embree, vertices, scene.faces.astype(np.int32))
    origins, directions = lens_rays(camera, lens, side, seed=0)
    embree.run(origins[:1], directions[:1])  # builds the acceleration structure
    wall, cpu = time.perf_counter(), time.process_time()
    met = embree.run(origins, directions)
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    del mesh  # belongs to `embree` until here
    return {"rays": len(origins), "seconds": wall, "cpu_seconds": cpu, "hit_share": float(np.mean(met >= 0))}

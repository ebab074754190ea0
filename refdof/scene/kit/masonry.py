"""Masonry shared by scenes: columns, balustrades and framed windows."""

import numpy as np

from refdof.scene.kit.darkening import corner_shade
from refdof.scene.kit.mesh import Mesh, join
from refdof.scene.kit.shapes import box, lathe, plane

__all__ = ["baluster", "column", "window"]


def column(height: float, radius: float, segments: int = 32, flutes: int = 0) -> Mesh:
    """Column on a square plinth, with a round base, a slightly swelling shaft and a capital.

    `flutes` grooves run along the shaft (segments should be a multiple, at least four for each).
    """
    r, h = radius, height
    base = [
        (1.42, 0.25),
        (1.45, 0.33),
        (1.42, 0.42),
        (1.25, 0.46),
        (1.22, 0.55),
        (1.3, 0.6),
        (1.28, 0.7),
        (1.1, 0.74),
    ]
    t = np.linspace(0, 1, 10)
    shaft = np.column_stack([r * (1.05 - 0.2 * t**1.6), 0.74 * r + t * (h - 2.1 * r)])
    top = shaft[-1, 1]
    bell = [
        (0.86, 0.0),
        (0.95, 0.06),
        (0.95, 0.14),
        (0.86, 0.2),
        (0.88, 0.5),
        (1.0, 0.8),
        (1.22, 1.02),
        (1.3, 1.06),
    ]
    body = lathe([shaft], segments)
    if flutes:
        body = _fluted(body, flutes, r)
    rings = lathe([[(a * r, b * r) for a, b in base], [(a * r, top + b * r) for a, b in bell]], segments)
    slabs = [
        box(3.0 * r, 0.26 * r, 3.0 * r),
        box(2.8 * r, h - top - 1.06 * r, 2.8 * r).moved(0, top + 1.06 * r, 0),
    ]
    whole = join([body, rings, *slabs])
    y = whole.vertices[:, 1]
    return whole.tinted(corner_shade(y, 0.5 * r, 0.35) * corner_shade(y - (top + 1.06 * r), 0.45 * r, 0.4))


def _fluted(body: Mesh, flutes: int, radius: float) -> Mesh:
    angle = np.arctan2(body.vertices[:, 0], body.vertices[:, 2])
    groove = np.abs(np.sin(0.5 * flutes * angle))
    factor = 1.0 - 0.045 * (1.0 - groove)
    vertices = body.vertices * np.column_stack([factor, np.ones_like(factor), factor])
    return Mesh(vertices, body.faces, body.uv, (0.62 + 0.38 * groove)[:, None] * body.color, body.normal)


def baluster(height: float, segments: int = 12) -> Mesh:
    """One turned post of a balustrade."""
    profile = [
        (0.5, 0.0),
        (0.5, 0.1),
        (0.28, 0.16),
        (0.3, 0.25),
        (0.52, 0.42),
        (0.46, 0.55),
        (0.24, 0.78),
        (0.3, 0.86),
        (0.5, 0.9),
        (0.5, 1.0),
    ]
    return lathe([[(0.24 * height * r, height * y) for r, y in profile]], segments)


def window(width: float, height: float, columns: int = 2, rows: int = 3, frame: float = 0.05) -> tuple[Mesh, Mesh]:
    """Frame with bars, and the panes behind them; lower middle at the origin, facing +z."""
    bars = [box(frame, height, 0.06).moved(s * (width - frame) / 2, 0, 0) for s in (-1, 1)]
    bars += [box(width - 2 * frame, frame, 0.06).moved(0, y, 0) for y in (0.0, height - frame)]
    bars += [
        box(0.5 * frame, height - 2 * frame, 0.04).moved(width * (k / columns - 0.5), frame, 0)
        for k in range(1, columns)
    ]
    bars += [box(width - 2 * frame, 0.5 * frame, 0.04).moved(0, height * k / rows, 0) for k in range(1, rows)]
    panes = plane((-width / 2, 0, -0.015), (width, 0, 0), (0, height, 0), (columns, rows))
    return join(bars), panes

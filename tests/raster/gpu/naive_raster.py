"""Naive twin of the rasteriser: pixels outside, faces inside, whole numbers and fractions only.

The fill rule is stated as another one: a centre counts if the point a tiny step right of it and a far tinier step
below it lies inside. No edge can run through that point. Depth and weights solve a + u (b - a) + v (c - a) = t d.
"""

from fractions import Fraction

import numpy as np

STEP = 2**40  # one over the step right; its square is one over the step down; corners are below 2^30


def on_grid(vertex, camera, bits=12, real=np.float64):
    """A camera-space vertex in front of the eye on the grid of 2^-bits px: two ints, y down. real: of its place."""
    x, y, z = (float(v) for v in vertex)
    column = real(camera.width / 2 + x * camera.pixels_per_tangent / -z)
    row = real(camera.height / 2 - y * camera.pixels_per_tangent / -z)
    return tuple(round(Fraction(float(v - real(0.5))) * 2**bits) for v in (column, row))


def side(a, b, p):
    """Twice the area of (a, b, p) in units of 1 / STEP^2, with p moved right and down."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    return (dx * (p[1] - a[1]) - dy * (p[0] - a[0])) * STEP**2 - dy * STEP + dx


def turn(corners):
    """1 if the corners run from x towards y, -1 if the other way, 0 without area."""
    (ax, ay), (bx, by), (cx, cy) = corners
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    return (area > 0) - (area < 0)


def covers(corners, x, y, bits=12):
    """Whether the snapped triangle covers the centre of pixel (x, y)."""
    p = (x << bits, y << bits)
    signs = {side(corners[k], corners[(k + 1) % 3], p) > 0 for k in range(3)}
    return turn(corners) != 0 and len(signs) == 1


def ray_meets(triangle, direction):
    """Exact (t, u, v) where the ray t d meets the triangle's plane, or None. triangle (3, 3), direction (3,)."""
    a, b, c = ([Fraction(float(v)) for v in corner] for corner in triangle)
    e, f = [q - p for p, q in zip(a, b, strict=True)], [q - p for p, q in zip(a, c, strict=True)]
    d = [Fraction(v) for v in direction]

    def det(p, q, r):
        return sum(p[i] * (q[i - 2] * r[i - 1] - q[i - 1] * r[i - 2]) for i in range(3))

    whole = det(d, e, f)
    if whole == 0:
        return None
    minus_d = [-v for v in d]
    return det(a, e, f) / whole, det(minus_d, a, f) / whole, det(minus_d, e, a) / whole


def ray_of(camera, x, y):
    """The direction (dx, dy, -1) through the centre of a pixel."""
    scale = 1.0 / camera.pixels_per_tangent
    return (x + 0.5 - 0.5 * camera.width) * scale, (0.5 * camera.height - y - 0.5) * scale, -1.0


def draw(vertices, faces, camera, bits=12, real=np.float64):
    """depth, triangle and weights as `rasterize`, for triangles in front of the near plane and not edge-on."""
    shape = (camera.height, camera.width)
    depth, triangle, weight = np.full(shape, np.inf), np.full(shape, -1), np.zeros((*shape, 2))
    snapped = [[on_grid(vertices[v], camera, bits, real) for v in face] for face in faces]
    for y, x in np.ndindex(shape):
        best = None
        for i in reversed(range(len(faces))):
            if covers(snapped[i], x, y, bits):
                corners = vertices[faces[i]]
                t, u, v = ray_meets(corners, ray_of(camera, x, y))
                nearest, farthest = (Fraction(float(-k)) for k in (corners[:, 2].max(), corners[:, 2].min()))
                t = min(max(t, nearest), farthest) if t > 0 else farthest
                if best is None or t <= best:
                    best, triangle[y, x], weight[y, x] = t, i, (float(u), float(v))
        if best is not None:
            depth[y, x] = float(best)
    return depth, triangle, weight


def near_an_edge(vertices, faces, camera, reach):
    """(H, W) bool: pixels whose centre is within `reach` px of a visible edge of any face, hidden by others or not."""
    edges = np.unique(np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    # Of an edge that passes the eye's plane, take the part in front.
    near = 1e-6 * np.abs(vertices).max()
    edges = edges[(vertices[edges, 2] < -near).any(axis=1)]
    start, end = vertices[edges[:, 0]], vertices[edges[:, 1]]
    swap = start[:, 2] > end[:, 2]
    start[swap], end[swap] = end[swap], start[swap]  # `start` is the farther one
    part = np.minimum(1.0, (-near - start[:, 2]) / np.maximum(end[:, 2] - start[:, 2], 1e-300))
    a, b = _place(start, camera), _place(start + part[:, None] * (end - start), camera)
    mask = np.zeros((camera.height, camera.width), dtype=bool)
    last = np.array([camera.width - 1, camera.height - 1])
    first_cell = np.maximum(np.ceil(np.minimum(a, b) - reach), 0).astype(int)
    last_cell = np.minimum(np.floor(np.maximum(a, b) + reach), last).astype(int)
    for k in np.flatnonzero((first_cell <= last_cell).all(axis=1)):
        rows, columns = np.mgrid[first_cell[k, 1] : last_cell[k, 1] + 1, first_cell[k, 0] : last_cell[k, 0] + 1]
        along = b[k] - a[k]
        px, py = columns - a[k, 0], rows - a[k, 1]
        t = np.clip((px * along[0] + py * along[1]) / max(along @ along, 1e-300), 0.0, 1.0)
        mask[rows, columns] |= np.hypot(px - t * along[0], py - t * along[1]) <= reach
    return mask


def _place(points, camera):
    """Camera-space points (N, 3) in front of the eye as (N, 2) px from the centre of pixel (0, 0), y down."""
    x, y, z = points.T
    scale = camera.pixels_per_tangent / -z
    return np.stack([camera.width / 2 + x * scale - 0.5, camera.height / 2 - y * scale - 0.5], axis=1)

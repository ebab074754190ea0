"""Shapes: surfaces over a grid, and what is made of them (boxes, planes, spheres, lathes, tubes, arches).

Texture coordinates run 0 .. 1 over a shape, except for boxes and arches, where they are in scene units.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from refdof._check import Float
from refdof.scene.kit.mesh import Mesh, join

__all__ = ["arch", "box", "disc", "lathe", "leaf", "plane", "sphere", "surface", "torus", "tube"]


# A cube of edge 1 that stands on the origin: front, back, right, left, top and bottom, four corners each.
_CUBE_AXES = np.repeat([[0, 1], [0, 1], [2, 1], [2, 1], [0, 2], [0, 2]], 4, axis=0)  # which edges u and v run along
_CUBE_UV = np.tile([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], (6, 1))
_CUBE_NORMAL = np.repeat([[0.0, 0, 1], [0, 0, -1], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]], 4, axis=0)
_CUBE_RIGHT = np.repeat([[1.0, 0, 0], [-1, 0, 0], [0, 0, -1], [0, 0, 1], [1, 0, 0], [1, 0, 0]], 4, axis=0)
_CUBE = 0.5 * _CUBE_NORMAL + (_CUBE_UV[:, :1] - 0.5) * _CUBE_RIGHT + [0.0, 0.5, 0.0]
_CUBE = _CUBE + (_CUBE_UV[:, 1:] - 0.5) * np.cross(_CUBE_NORMAL, _CUBE_RIGHT)
_CUBE_FACES = (np.array([[0, 1, 2], [0, 2, 3]]) + 4 * np.arange(6)[:, None, None]).reshape(-1, 3)


def surface(points: Float, uv: Float | None = None, closed: tuple[bool, bool] = (False, False)) -> Mesh:
    """Smooth surface through a grid of points.

    Parameters
    ----------
    points : (m, n, 3)
        Rows may shrink to one point (a pole): triangles without area are left out.
    uv : (m, n, 2), or None
        None: u = 0 .. 1 along a row, v = 0 .. 1 from the first row to the last.
    closed : (bool, bool)
        Whether the last row (column) lies on the first one, so that normals run on across the seam.
    """
    rows, columns = points.shape[:2]
    if uv is None:
        u, v = np.meshgrid(np.linspace(0, 1, columns), np.linspace(0, 1, rows))
        uv = np.stack([u, v], axis=-1)
    normal: Float = np.cross(_slope(points, 1, closed[1]), _slope(points, 0, closed[0]))
    length = np.sqrt((normal * normal).sum(axis=-1, keepdims=True))
    flat = length[..., 0] <= 1e-9 * length.max()
    normal = normal / np.where(length > 0, length, 1.0)
    for row in np.flatnonzero(flat.any(axis=1)):  # poles: the mean of the ring beside them
        ring = normal[1 if row == 0 else row - 1].mean(axis=0)
        normal[row, flat[row]] = ring / max(np.sqrt((ring * ring).sum()), 1e-12)
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    faces = np.concatenate([np.stack(t, axis=-1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])
    corner = points.reshape(-1, 3)[faces]
    solid = (np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]) != 0.0).any(axis=1)
    return Mesh(
        points.reshape(-1, 3).astype(np.float64),
        faces[solid],
        uv.reshape(-1, 2).astype(np.float64),
        np.ones((rows * columns, 3)),
        normal.reshape(-1, 3),
    )


def plane(
    corner: Sequence[float], right: Sequence[float], up: Sequence[float], cells: tuple[int, int] = (1, 1)
) -> Mesh:
    """Rectangle from `corner` along two edges, cut into (along right, along up) cells."""
    s = np.linspace(0, 1, cells[0] + 1)[None, :, None]
    t = np.linspace(0, 1, cells[1] + 1)[:, None, None]
    return surface(np.asarray(corner) + s * np.asarray(right) + t * np.asarray(up))


def box(width: float, height: float, depth: float) -> Mesh:
    """Box that stands on the origin, sharp edges, texture coordinates in scene units."""
    size = np.array([width, height, depth])
    return Mesh(_CUBE * size, _CUBE_FACES, _CUBE_UV * size[_CUBE_AXES], np.ones((24, 3)), _CUBE_NORMAL)


def disc(radius: float, segments: int = 32, height: float = 0.0) -> Mesh:
    """Horizontal disc about the y axis; texture coordinates show the square around it."""
    return replace(
        mesh := lathe([[(0.0, height), (radius, height)]], segments),
        uv=mesh.vertices[:, [0, 2]] / (2 * radius) + 0.5,
    )


def lathe(sections: Sequence[Sequence[tuple[float, float]] | Float], segments: int = 48) -> Mesh:
    """Sections of a profile (radius, height), turned about the y axis; smooth but for the edges between."""
    angle = np.linspace(0, 2 * np.pi, segments + 1)
    angle[-1] = 0.0
    meshes = []
    for section in sections:
        r, y = np.asarray(section, dtype=np.float64).T[:, :, None]
        points = np.stack([r * np.sin(angle), np.broadcast_to(y, (len(r), segments + 1)), r * np.cos(angle)], axis=-1)
        meshes.append(surface(points, closed=(False, True)))
    return join(meshes)


def sphere(radius: float, rows: int = 16, columns: int = 32, bulge: Callable[[Float], Float] | None = None) -> Mesh:
    """Sphere about the origin; `bulge` maps unit directions (m, n, 3) to factors (m, n) of the radius."""
    theta = np.linspace(-np.pi / 2, np.pi / 2, rows + 1)[:, None]
    phi = np.linspace(0, 2 * np.pi, columns + 1)[None, :]
    ring = np.cos(theta)
    ring[[0, -1]] = 0.0
    phi[0, -1] = 0.0
    unit = np.stack([ring * np.sin(phi), np.sin(theta) + 0 * phi, ring * np.cos(phi)], axis=-1)
    factor = np.ones(unit.shape[:2]) if bulge is None else bulge(unit)
    return surface(radius * factor[..., None] * unit, closed=(False, True))


def torus(radius: float, thickness: float, segments: int = 64, sides: int = 32) -> Mesh:
    """Ring about the y axis: `radius` to the middle of a tube of radius `thickness`."""
    angle = np.linspace(0, 2 * np.pi, segments + 1)
    angle[-1] = 0.0
    path = radius * np.stack([np.cos(angle), 0 * angle, np.sin(angle)], axis=-1)
    return tube(path, thickness, sides, closed=True)


def tube(path: Float, radius: float | Float, sides: int = 8, closed: bool = False) -> Mesh:
    """Round tube along a path (k, 3) with one radius, or one per point; v counts its length in girths."""
    path = np.asarray(path, dtype=np.float64)
    tangent = _slope(path[None], 1, closed)[0]
    tangent = tangent / np.sqrt((tangent * tangent).sum(axis=1, keepdims=True))
    # Carry a frame along the path without twist; a closed path spreads its remaining twist evenly.
    side = np.empty_like(path)
    side[0] = _across(tangent[0])
    for k in range(1, len(path)):
        s = side[k - 1] - tangent[k] * (side[k - 1] * tangent[k]).sum()
        side[k] = s / np.sqrt((s * s).sum())
    other = np.cross(tangent, side)
    twist = np.zeros(len(path))
    if closed:
        last = np.arctan2((side[-1] * other[0]).sum(), (side[-1] * side[0]).sum())
        twist = -last * np.linspace(0, 1, len(path))
    angle = np.linspace(0, 2 * np.pi, sides + 1)
    angle[-1] = 0.0
    angle = angle[None, :] + twist[:, None]
    thick = np.broadcast_to(radius, len(path))[:, None, None]
    around = np.cos(angle)[..., None] * side[:, None] + np.sin(angle)[..., None] * other[:, None]
    points = path[:, None] + thick * around
    if closed:
        points[-1] = points[0]
    step = np.sqrt((np.diff(path, axis=0) ** 2).sum(axis=1))
    along = np.concatenate([[0.0], np.cumsum(step)]) / (2 * np.pi * max(float(np.mean(radius)), 1e-9))
    u, v = np.meshgrid(np.linspace(0, 1, sides + 1), along)
    return surface(points, np.stack([u, v], axis=-1), (closed, True))


def leaf(length: float = 1.0, width: float = 0.4, bend: float = 0.3, fold: float = 0.2, cells: int = 4) -> Mesh:
    """Pointed leaf from the origin along +z, face up, bent down at the tip and folded along its middle."""
    t = np.linspace(0, 1, cells + 1)[:, None]
    half = width / 2 * np.sin(np.pi * t**0.8) ** 0.9
    half[[0, -1]] = [[0.012 * width], [0.0]]
    s = np.array([[-1.0, 0.0, 1.0]])
    points = np.stack([half * s, half * fold * np.abs(s) - bend * length * t**2 + 0 * s, length * t + 0 * s], axis=-1)
    return surface(points)


def arch(width: float, spring: float, height: float, depth: float, pier: float, segments: int = 16) -> Mesh:
    """Bay of an arcade: a wall with a round arch that springs at height `spring`, between two piers.

    The wall's middle is at x = z = 0; nothing is built below the springing.
    """
    reach = width / 2 - pier
    angle = np.linspace(np.pi, 0, segments + 1)
    x = np.concatenate([[-width / 2], reach * np.cos(angle), [width / 2]])
    y = np.concatenate([[spring], spring + reach * np.sin(angle), [spring]])
    x[1], x[-2], y[1], y[-2] = -reach, reach, spring, spring
    low, high = np.stack([x, y], axis=-1), np.stack([x, np.full_like(x, height)], axis=-1)
    grid = np.stack([low + t * (high - low) for t in np.linspace(0, 1, 4)])
    face = np.concatenate([grid, np.full((*grid.shape[:2], 1), depth / 2)], axis=-1)
    soffit = np.stack([np.column_stack([low, np.full(len(x), z)]) for z in (-depth / 2, depth / 2)])
    walls = [surface(face, grid), surface(face * [1, 1, -1], grid)]
    walls += [
        replace(m, uv=np.column_stack([m.vertices[:, 2], m.vertices[:, 0] + m.vertices[:, 1]]))
        for m in (surface(soffit[:, :2]), surface(soffit[:, 1:-1]), surface(soffit[:, -2:]))
    ]
    return join(walls)


def _slope(points: Float, axis: int, closed: bool) -> Float:
    """Central differences along an axis, one-sided at open ends."""
    if closed:
        core = np.take(points, range(points.shape[axis] - 1), axis=axis)
        step = np.roll(core, -1, axis=axis) - np.roll(core, 1, axis=axis)
        return np.concatenate([step, np.take(step, [0], axis=axis)], axis=axis)
    return np.gradient(points, axis=axis)


def _across(direction: Float) -> Float:
    """Some unit vector at right angles to `direction`."""
    other = np.zeros(3)
    other[np.argmin(np.abs(direction))] = 1.0
    side = np.cross(direction, other)
    return side / np.sqrt((side * side).sum())

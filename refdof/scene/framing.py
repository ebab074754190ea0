"""A suggested shot for a model that brings none: which way is up, where to stand, what to focus on.

1. up is y; it is z if the model stands on z like on a table            `up_axis`
2. three-quarter view from the front and slightly above, or on the side
   that shows a flat model, as near as a margin around the whole model
   allows                                                               `suggest_camera`
3. focus where the optical axis first meets the model; the lens is so
   large that the worse of the nearest and the farthest surface in the
   picture blurs by a set radius                                        `suggest_lens`
"""

import math

import numpy as np

from refdof._check import Float, Index
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens

__all__ = ["suggest_camera", "suggest_lens", "up_axis"]

_FOV_Y = 40.0  # [degrees]
_SIZE = (640, 480)  # [px]
_AZIMUTH = 30.0  # of the eye, to the right of the model's front [degrees]
_ELEVATION = 15.0  # of the eye, above the horizon [degrees]
_ELEVATION_OF_MAPS = 60.0  # of the eye, above what lies flat [degrees]
_FLAT = 0.05  # a model is flat along an axis if its extent is at most this share of the next larger one
_FILL = 0.86  # share of the picture's width or height that the model takes
_BLUR_PX = 12.0  # largest circle of confusion of a surface in the picture, for 480 rows
_LARGEST_LENS = 0.25  # radius over focus distance; a flat model would ask for more
_BASE_BAND = 0.02  # lowest share of the height that counts as the side a model stands on
_BASE_SHARE = 0.1  # least share of its outline that such a side covers


def up_axis(vertices: Float, faces: Index) -> int:
    """1 if y is up, 2 if z is.

    z is up if flat faces at the lowest end of z cover at least a tenth of the model's outline seen along z,
    and twice the share that those at the lowest end of y cover; otherwise y is, as most files have it. y is also up
    if the model is flat along z: it is a picture that stands, not one that lies.
    """
    if _flat_axis(vertices[np.unique(faces)]) == 2:
        return 1
    y, z = _base_share(vertices, faces, 1), _base_share(vertices, faces, 2)
    return 2 if z >= _BASE_SHARE and z > 2.0 * y else 1


def suggest_camera(vertices: Float, faces: Index, up: int = 1) -> Camera:
    """Three-quarter view of all triangles; the front is +z where y is up, and -y where z is.

    A model that is flat along x has its front at +x; one that is flat along the upward axis is seen from 60 degrees
    above instead of 15.

    The projected model fills 0.86 of the picture's width or height, and nothing of it is cut off. It fills less
    only if it is seen end-on: the eye stays a tenth of the largest extent away from it.

    Parameters
    ----------
    vertices : (V, 3) float64
    faces : (F, 3) int64
        At least one.
    up : int
        Axis that points upwards: 1 (y) or 2 (z).
    """
    points = vertices[np.unique(faces)]
    flat, upwards = _flat_axis(points), np.eye(3)[up]
    facing = np.eye(3)[0] if flat == 0 else np.array([0.0, 0.0, 1.0] if up == 1 else [0.0, -1.0, 0.0])
    side, height = math.radians(_AZIMUTH), math.radians(_ELEVATION_OF_MAPS if flat == up else _ELEVATION)
    aside, front = math.sin(side) * math.cos(height), math.cos(side) * math.cos(height)
    backward = aside * np.cross(upwards, facing) + front * facing + math.sin(height) * upwards
    right = np.cross(upwards, backward)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(backward, right), backward])

    middle = (points.min(axis=0) + points.max(axis=0)) / 2.0
    x, y, z = axes @ (points - middle).T
    tangent_y = math.tan(math.radians(_FOV_Y) / 2.0) * _FILL
    shift_x, distance_x = _fit(x, z, tangent_y * _SIZE[0] / _SIZE[1])
    shift_y, distance_y = _fit(y, z, tangent_y)
    distance = max(distance_x, distance_y, float(z.max()) + 0.1 * float(np.ptp(points, axis=0).max()))
    target = middle + shift_x * axes[0] + shift_y * axes[1]
    eye = target + distance * backward
    return Camera(tuple(eye), tuple(target), tuple(upwards), _FOV_Y, _SIZE)


def suggest_lens(vertices: Float, faces: Index, camera: Camera) -> ThinLens:
    """Lens focused where the optical axis meets the model, or at the first third of the depths in view.

    The circles of confusion of the nearest and of the farthest surface in the picture are at most 12 px in a picture of
    480 rows, in proportion in others. These are the true ends of all triangles inside the picture, cut at its edges:
    so no visible surface blurs more. The larger circle is 12 px, unless the lens radius would be above a quarter of the
    focus distance. The background has no bound.
    """
    points = camera.camera_from_world(vertices)
    seen = _depths_in_view(points, faces, camera)
    if seen is None:  # the camera looks away from everything
        distance = float(np.linalg.norm(np.subtract(camera.target, camera.eye)))
        return ThinLens(0.01 * distance, distance)
    near, far = seen
    focus = _depth_along(points, faces, 0.0, 0.0).min(initial=math.inf)
    focus = float(focus) if math.isfinite(focus) else near + (far - near) / 3.0
    span = max(abs(1.0 / focus - 1.0 / far), abs(1.0 / near - 1.0 / focus))
    per_radius = camera.pixels_per_tangent * 480.0 / camera.height * span  # coc_px of a lens with radius 1
    largest = _LARGEST_LENS * focus
    return ThinLens(min(_BLUR_PX / per_radius, largest) if per_radius > 0 else largest, focus)


def _fit(across: Float, toward: Float, tangent: float) -> tuple[float, float]:
    """Shift and distance of the nearest eye that sees all points within +-tangent.

    From |across - shift| <= tangent * (distance - toward) for every point, solved for the least distance.
    """
    above = float((across + tangent * toward).max())
    below = float((-across + tangent * toward).max())
    return (above - below) / 2.0, (above + below) / (2.0 * tangent)


def _depths_in_view(points: Float, faces: Index, camera: Camera) -> tuple[float, float] | None:
    """Least and greatest depth of triangles inside the picture; points (V, 3) in camera space.

    A triangle is nearest and farthest at corners of what the picture leaves of it: at its own corners, on its edges
    where they leave the picture, or at corners of the picture.
    """
    y_end = camera.height / (2.0 * camera.pixels_per_tangent)
    x_end = y_end * camera.width / camera.height
    # How far a point is inside each of the picture's four sides; the picture shows it where all are >= 0.
    sides = np.array([[1.0, 0.0, -x_end], [-1.0, 0.0, -x_end], [0.0, 1.0, -y_end], [0.0, -1.0, -y_end]])
    into = points @ sides.T
    inside = into >= 0
    corners = np.unique(faces)
    found = [-points[corners[inside[corners].all(axis=1)], 2]]
    cut = faces[inside[faces].any(axis=1).all(axis=1) & ~inside[faces].all(axis=(1, 2))]
    for k in range(4):
        others = [side for side in range(4) if side != k]
        for start, end in ((0, 1), (1, 2), (2, 0)):
            a, b = cut[:, start], cut[:, end]
            crossing = inside[a, k] != inside[b, k]
            a, b = a[crossing], b[crossing]
            share = (into[a, k] / (into[a, k] - into[b, k]))[:, None]
            place = points[a] + share * (points[b] - points[a])
            found.append(-place[((place @ sides[others].T) >= 0).all(axis=1)][:, 2])
    found += [_depth_along(points, cut, x, y) for x in (-x_end, x_end) for y in (-y_end, y_end)]
    depth = np.concatenate(found)
    depth = depth[depth > 0]
    return (float(depth.min()), float(depth.max())) if len(depth) else None


def _depth_along(points: Float, faces: Index, x: float, y: float) -> Float:
    """Depths at which the ray (x, y, -1) from the eye meets triangles; points (V, 3) in camera space."""
    points = points + points[:, 2:] * np.array([x, y, 0.0])  # sheared: the ray is the optical axis
    a, b, c = (points[faces[:, k]] for k in range(3))
    weights = np.stack([_area(b, c), _area(c, a), _area(a, b)])
    total = weights.sum(axis=0)
    hit = ((weights >= 0).all(axis=0) | (weights <= 0).all(axis=0)) & (total != 0)
    depth = -(weights[:, hit] * np.stack([a, b, c])[:, hit, 2]).sum(axis=0) / total[hit]
    return depth[depth > 0]


def _area(a: Float, b: Float) -> Float:
    """Twice the signed areas of the triangles (origin, a, b), seen along z."""
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def _flat_axis(points: Float) -> int | None:
    """The axis along which points have no extent, or next to none; None if there is none, or two."""
    extent = np.ptp(points, axis=0)
    least, next_larger, _ = np.argsort(extent, kind="stable")
    return int(least) if extent[least] <= _FLAT * extent[next_larger] and extent[next_larger] > 0 else None


def _base_share(vertices: Float, faces: Index, axis: int) -> float:
    """Area of the faces at the lowest end of `axis`, seen along it, over that of the model's box."""
    corner = vertices[faces]
    low, extent = corner.min(axis=(0, 1)), np.ptp(corner, axis=(0, 1))
    j, k = [other for other in range(3) if other != axis]
    if not (extent[j] > 0 and extent[k] > 0):
        return 0.0
    flat = corner[corner[:, :, axis].max(axis=1) <= low[axis] + _BASE_BAND * extent[axis]]
    p = (flat[:, :, [j, k]] - low[[j, k]]) / extent[[j, k]]
    p, q = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    return float(np.abs(p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]).sum() / 2.0)

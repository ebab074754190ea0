"""A suggested shot for a model that brings none: which way is up, where to stand, what to focus on.

1. up is y; it is z if the model stands on z like on a table            `up_axis`
2. three-quarter view from the front and slightly above, as near as a
   margin around the whole model allows                                 `suggest_camera`
3. focus where the optical axis first meets the model; the lens is so
   large that the model's far end blurs by a set radius                 `suggest_lens`
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
_FILL = 0.86  # share of the picture's width or height that the model takes
_FAR_BLUR_PX = 12.0  # radius at the model's far end, in a picture of 480 rows
_LARGEST_LENS = 0.25  # radius over focus distance; a flat model would ask for more
_BASE_BAND = 0.02  # lowest share of the height that counts as the side a model stands on
_BASE_SHARE = 0.1  # least share of its outline that such a side covers


def up_axis(vertices: Float, faces: Index) -> int:
    """1 if y is up, 2 if z is.

    z is up if flat faces at the lowest end of z cover at least a tenth of the model's outline seen along z,
    and twice the share that those at the lowest end of y cover; otherwise y is, as most files have it.
    """
    y, z = _base_share(vertices, faces, 1), _base_share(vertices, faces, 2)
    return 2 if z >= _BASE_SHARE and z > 2.0 * y else 1


def suggest_camera(vertices: Float, faces: Index, up: int = 1) -> Camera:
    """Three-quarter view of all triangles; the front is +z where y is up, and -y where z is.

    Parameters
    ----------
    vertices : (V, 3) float64
    faces : (F, 3) int64
        At least one.
    up : int
        Axis that points upwards: 1 (y) or 2 (z).
    """
    points = vertices[np.unique(faces)]
    side, height = math.radians(_AZIMUTH), math.radians(_ELEVATION)
    aside, front = math.sin(side) * math.cos(height), math.cos(side) * math.cos(height)
    above = math.sin(height)
    backward = np.array([aside, above, front] if up == 1 else [aside, -front, above])
    upwards = np.eye(3)[up]
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
    """Lens focused where the optical axis meets the model, or at the first third of the depths in view."""
    picture = camera.project(vertices[np.unique(faces)])
    x, y, depth = picture.T
    ahead = depth > 0
    inside = ahead & (x >= 0) & (x <= camera.width) & (y >= 0) & (y <= camera.height)
    seen = depth[inside if inside.any() else ahead]
    if not len(seen):  # the camera looks away from everything
        distance = float(np.linalg.norm(np.subtract(camera.target, camera.eye)))
        return ThinLens(0.01 * distance, distance)
    near, far = float(seen.min()), float(seen.max())
    focus = _depth_on_axis(camera.camera_from_world(vertices), faces) or near + (far - near) / 3.0
    span = max(abs(1.0 / focus - 1.0 / far), abs(1.0 / near - 1.0 / focus) if far <= focus else 0.0)
    per_radius = camera.pixels_per_tangent * 480.0 / camera.height * span  # coc_px of a lens with radius 1
    largest = _LARGEST_LENS * focus
    return ThinLens(min(_FAR_BLUR_PX / per_radius, largest) if per_radius > 0 else largest, focus)


def _fit(across: Float, toward: Float, tangent: float) -> tuple[float, float]:
    """Shift and distance of the nearest eye that sees all points within +-tangent.

    From |across - shift| <= tangent * (distance - toward) for every point, solved for the least distance.
    """
    above = float((across + tangent * toward).max())
    below = float((-across + tangent * toward).max())
    return (above - below) / 2.0, (above + below) / (2.0 * tangent)


def _depth_on_axis(points: Float, faces: Index) -> float | None:
    """Depth at which the optical axis first meets a triangle; points (V, 3) in camera space."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    weights = np.stack([_area(b, c), _area(c, a), _area(a, b)])
    total = weights.sum(axis=0)
    hit = ((weights >= 0).all(axis=0) | (weights <= 0).all(axis=0)) & (total != 0)
    depth = -(weights[:, hit] * np.stack([a, b, c])[:, hit, 2]).sum(axis=0) / total[hit]
    depth = depth[depth > 0]
    return float(depth.min()) if len(depth) else None


def _area(a: Float, b: Float) -> Float:
    """Twice the signed areas of the triangles (origin, a, b), seen along z."""
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


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

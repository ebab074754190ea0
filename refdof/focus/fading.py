"""Fading: the share of a focus point that counts, less outside the picture and where it is hidden.

1. it fades out beyond the picture's border                     `_inside`
2. it counts as much as its surroundings are visible            `_visible`
3. where the scene moves, both change smoothly in time          `shares`

Something that passes fast may hide a point, or take it out of the picture, from one frame to the next. So what is
visible is the mean over the frames about, with the weights of a raised cosine. For what is inside, first the least of
the frames about is taken: a point has faded out when it leaves the picture, and its place there never counts. From one
frame to the next, each of the two changes by a seventh at most, the largest weight. A share depends on the frame only,
not on those that were asked for before.
"""

import hashlib
from functools import partial

import numpy as np

from refdof._check import Float, Index
from refdof.view import View

__all__ = ["places", "shares"]

_MARGIN = 0.1  # of the picture's height: how far outside of it a point has faded out
_WINDOW = 0.02  # of the picture's height: radius of the disc whose visible share is the point's
_SLACK = 0.01  # of the depth: what hides a point is nearer by more than that
_REACH = 6  # frames to each side: a quarter of a second, in which a focus is pulled
_COSINE = (1.0 + np.cos(np.pi * np.arange(-_REACH, _REACH + 1) / (_REACH + 1))) / (2.0 * (_REACH + 1))  # its sum is 1


def places(triangles: Index, barycentrics: Float, view: View) -> Float:
    """(N, 3): x and y in the picture [px] and depth of points (N, 3) in triangles (N,)."""
    corners = view.scene.vertices[view.scene.faces[triangles]]
    return view.camera.project((barycentrics[:, :, None] * corners).sum(axis=1))


def shares(triangles: Index, barycentrics: Float, view: View, frame: float) -> Float:
    """(N,) in 0 .. 1 at a frame; 0 behind the camera."""
    frames = view.scene.frames
    if frames is None:
        found = places(triangles, barycentrics, view)
        return _inside(found, view) * _visible(found, view)
    digest = hashlib.sha256(np.ascontiguousarray(np.column_stack([triangles, barycentrics])).tobytes()).hexdigest()

    def about(reach: int, what: str) -> Float:
        """(2 reach + 1, N): `_inside` or `_visible` at the frames about; what a view found once, it keeps."""
        rows = []
        for step in range(-reach, reach + 1):
            now = min(max(frame + step, float(frames[0])), float(frames[1]))
            name = f"focus points {what} {digest} {now!r}"
            rows.append(view.product(name, partial(_at, triangles, barycentrics, view, now, what)))
        return np.stack(rows)

    inside = about(2 * _REACH, "inside")
    least = np.stack([inside[k : k + 2 * _REACH + 1].min(axis=0) for k in range(2 * _REACH + 1)])
    lasting = _mean(least)
    if not lasting.any():
        return lasting
    return lasting * _mean(about(_REACH, "visible"))


def _at(triangles: Index, barycentrics: Float, view: View, frame: float, what: str) -> Float:
    view = view.at_frame(frame)
    found = places(triangles, barycentrics, view)
    return _inside(found, view) if what == "inside" else _visible(found, view)


def _mean(rows: Float) -> Float:
    """(N,) of rows (2 _REACH + 1, N), weighed; rows of ones give 1 exactly."""
    total = np.zeros(rows.shape[1])
    for weight, row in zip(_COSINE, rows - rows[_REACH], strict=True):
        total += weight * row
    return np.clip(rows[_REACH] + total, 0.0, 1.0)


def _inside(found: Float, view: View) -> Float:
    """(N,): 1 inside the picture, 0 beyond the margin and behind the camera, smooth between."""
    width, height = view.camera.size
    x, y, depth = found.T
    beyond = np.hypot(np.maximum(np.maximum(-x, x - width), 0.0), np.maximum(np.maximum(-y, y - height), 0.0))
    rest = np.maximum(1.0 - beyond / (_MARGIN * height), 0.0)
    return np.where(depth > 0.0, rest * rest * (3.0 - 2.0 * rest), 0.0)


def _visible(found: Float, view: View) -> Float:
    """(N,): share of the pixels about a place that show nothing nearer; 1 where there are none."""
    return np.array([_visible_share(view, x, y, depth) if depth > 0.0 else 1.0 for x, y, depth in found.tolist()])


def _visible_share(view: View, x: float, y: float, depth: float) -> float:
    width, height = view.camera.size
    reach = max(_WINDOW * height, 1.0)
    if not (-reach <= x <= width + reach and -reach <= y <= height + reach):
        return 1.0
    rows = np.arange(max(int(y - reach), 0), min(int(y + reach) + 1, height))[:, None]
    columns = np.arange(max(int(x - reach), 0), min(int(x + reach) + 1, width))[None, :]
    near = np.hypot(columns + 0.5 - x, rows + 0.5 - y) <= reach
    if not near.any():
        return 1.0
    rows, columns = np.broadcast_arrays(rows, columns)
    seen = view.pinhole().depth[rows[near], columns[near]]
    return float((seen >= depth * (1.0 - _SLACK)).mean())

"""Animation: where a scene's vertices are at each frame. Frame f is at the time f / 24 s.

`Scene.with_frames` takes the vertices of every frame; of a glTF file, `refdof.scene.gltf.rig` makes them.
Faces and materials stay; normals are those of the moved triangles, unless a file states its own, which it turns.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof.optics.camera import Camera
from refdof.scene.smooth_normals import mean_normals, shared_normals

__all__ = ["FRAMES_PER_SECOND", "Animation", "Pose", "between_frames", "scaled_camera"]

FRAMES_PER_SECOND = 24.0


class Pose(NamedTuple):
    """A scene at a frame: vertices and normals (V, 3) in world space, and the file's own camera, if it has one."""

    vertices: Float
    normal: Float
    camera: Camera | None


@dataclass(frozen=True, eq=False)
class Animation:
    """Poses from frame `first` to frame `last`, held beyond.

    Attributes
    ----------
    pose : function of a frame, which may lie between whole ones
    frame : the one that a scene with this animation stands at; None: none yet
    camera : the one that the animation gave the scene, which moves on with it; None: the scene's camera stays
    """

    first: int
    last: int
    pose: Callable[[float], Pose]
    frame: float | None = None
    camera: Camera | None = None

    def scaled(self, factor: float, camera: Camera) -> "Animation":
        """The same in a unit of length `factor` times smaller; `camera` is the scene's, so scaled."""
        followed = None if self.camera is None else camera
        return replace(self, pose=partial(_scaled_pose, self.pose, factor), camera=followed)


def between_frames(vertices: Float, faces: Index, rest: Float, normal: Float) -> Animation:
    """Vertices (F, V, 3) of frames 0 .. F - 1, moved along straight lines between them.

    Corners that are smooth together in `normal` (V, 3) where vertices are at `rest` (V, 3) stay so.
    """
    return Animation(0, len(vertices) - 1, partial(_line, vertices, faces, shared_normals(rest, normal)))


def _line(vertices: Float, faces: Index, group: Index, frame: float) -> Pose:
    before = min(int(frame), len(vertices) - 1)
    t = frame - before
    moved = vertices[before].copy() if t == 0.0 else (1.0 - t) * vertices[before] + t * vertices[before + 1]
    return Pose(moved, mean_normals(moved, faces, group), None)


def _scaled_pose(pose: Callable[[float], Pose], factor: float, frame: float) -> Pose:
    found = pose(frame)
    camera = None if found.camera is None else scaled_camera(found.camera, factor)
    return Pose(np.asarray(found.vertices * factor), found.normal, camera)


def scaled_camera(camera: Camera, factor: float) -> Camera:
    """The same view in a unit of length `factor` times smaller."""
    eye, target = ((x * factor, y * factor, z * factor) for x, y, z in (camera.eye, camera.target))
    return replace(camera, eye=eye, target=target)

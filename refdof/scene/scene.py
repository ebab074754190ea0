"""Scene: triangles, materials and light, as plain arrays in world space."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from refdof._check import (
    LARGEST_LENGTH,
    Float,
    Index,
    InputError,
    as_choice,
    as_color,
    as_float,
    as_index,
    as_instance,
    as_instances,
    as_integer,
    as_number,
)
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens
from refdof.scene.animation import Animation, between_frames, scaled_camera
from refdof.scene.material import SHADINGS, Light, Material, as_colors, as_opacity

__all__ = ["Part", "Scene"]


@dataclass(frozen=True, eq=False)
class Part:
    """A triangle mesh of one material: what scene makers and file readers hand to `Scene.from_parts`.

    Parameters
    ----------
    vertices : (V, 3)
        World space; no coordinate is larger than 1e100.
    faces : (F, 3) int
    material : Material
    uv : (V, 2), or None
        Texture coordinates.
    color : (V, 3), or None
        Linear RGB that multiplies the material's.
    normal : (V, 3), or None
        Unit shading normals; None: every face is flat.
    opacity : (V,), or None
        0 .. 1; multiplies the material's.

    Raises
    ------
    InputError
        If a value is not finite or too large, an index is out of range, or a shape is wrong.
    """

    vertices: Float
    faces: Index
    material: Material = field(default_factory=Material)
    uv: Float | None = None
    color: Float | None = None
    normal: Float | None = None
    opacity: Float | None = None

    def __post_init__(self) -> None:
        vertices = _places("vertices", self.vertices)
        count = len(vertices)
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "faces", as_index("faces", self.faces, (None, 3), end=count))
        as_instance("material", self.material, Material)
        if self.uv is not None:
            object.__setattr__(self, "uv", as_float("uv", self.uv, (count, 2), dtype=np.float32))
        if self.color is not None:
            object.__setattr__(self, "color", as_colors("color", self.color, (count, 3)))
        if self.normal is not None:
            object.__setattr__(self, "normal", as_float("normal", self.normal, (count, 3), dtype=np.float32))
        if self.opacity is not None:
            object.__setattr__(self, "opacity", as_opacity("opacity", self.opacity, (count,)))


@dataclass(frozen=True, eq=False)
class Scene:
    """Triangles with attributes at their vertices. Make one with `Scene.from_parts` or `refdof.load_scene`.

    Attributes
    ----------
    vertices : (V, 3) float64, world space
    faces : (F, 3) int64
    uv : (V, 2) float32; color : (V, 3) float32, linear; normal : (V, 3) float32
    face_material : (F,) int64, index into materials
    background : (3,) floats, linear RGB of rays that meet nothing
    camera, lens : the suggested shot
    dropped_faces : how many degenerate triangles were left out
    animation : where the vertices go, or None; the scene stands at one frame of it
    opacity : (V,) float32 in 0 .. 1, or None: 1 everywhere

    Raises
    ------
    InputError
        If an array is not as stated, not finite or too large, or an index is out of range.
    """

    name: str
    vertices: Float
    faces: Index
    uv: Float
    color: Float
    normal: Float
    face_material: Index
    materials: tuple[Material, ...]
    background: tuple[float, float, float]
    light: Light
    camera: Camera
    lens: ThinLens
    dropped_faces: int = 0
    animation: Animation | None = None
    opacity: Float | None = None

    def __post_init__(self) -> None:
        as_instance("name", self.name, str)
        vertices = _places("vertices", self.vertices)
        count = len(vertices)
        faces = as_index("faces", self.faces, (None, 3), end=count)
        materials = as_instances("materials", self.materials, Material)
        for name, value in (
            ("vertices", vertices),
            ("faces", faces),
            ("uv", as_float("uv", self.uv, (count, 2), dtype=np.float32)),
            ("color", as_colors("color", self.color, (count, 3))),
            ("normal", as_float("normal", self.normal, (count, 3), dtype=np.float32)),
            ("face_material", as_index("face_material", self.face_material, (len(faces),), end=len(materials))),
            ("materials", materials),
            ("background", as_color("background", self.background)),
            ("dropped_faces", as_integer("dropped_faces", self.dropped_faces, minimum=0)),
        ):
            object.__setattr__(self, name, value)
        for name, kind in (("light", Light), ("camera", Camera), ("lens", ThinLens)):
            as_instance(name, getattr(self, name), kind)
        if self.animation is not None:
            as_instance("animation", self.animation, Animation)
        if self.opacity is not None:
            object.__setattr__(self, "opacity", as_opacity("opacity", self.opacity, (count,)))

    @property
    def frames(self) -> tuple[int, int] | None:
        """First and last frame of the animation, 24 a second; None: the scene stands still."""
        return None if self.animation is None else (self.animation.first, self.animation.last)

    @property
    def frame(self) -> float:
        """The frame of the animation that the scene stands at; 0 where nothing moves."""
        return 0.0 if self.animation is None or self.animation.frame is None else self.animation.frame

    def at_frame(self, frame: float) -> "Scene":
        """The scene at a frame, which may lie between whole ones: the same faces, with moved vertices and normals.

        Before the first and after the last frame, their pose holds. A file's own camera moves, too, unless another
        took its place. What stands still, or at this frame, is itself.
        """
        frame, animation = as_number("frame", frame), self.animation
        if animation is None:
            return self
        frame = min(max(frame, float(animation.first)), float(animation.last))
        if frame == animation.frame:
            return self
        pose = animation.pose(frame)
        camera = self.camera if pose.camera is None or self.camera is not animation.camera else pose.camera
        followed = camera if camera is pose.camera else None
        animation = replace(animation, frame=frame, camera=followed)
        return replace(self, vertices=pose.vertices, normal=pose.normal, camera=camera, animation=animation)

    def with_frames(self, vertices: Float) -> "Scene":
        """The same scene animated, at frame 0: `vertices` (F, V, 3) of frames 0 .. F - 1, world space.

        Between frames vertices move along straight lines. Normals are computed anew at every frame: corners at one
        place that have one normal stay smooth together.

        Raises
        ------
        InputError
            If the shape does not fit the scene's vertices, or a coordinate is not finite or larger than 1e100.
        """
        bound, shape = LARGEST_LENGTH, (None, len(self.vertices), 3)
        moved = as_float("vertices", vertices, shape, dtype=np.float64, minimum=-bound, maximum=bound)
        if not len(moved):
            raise InputError("vertices: got no frame; allowed is at least one")
        animation = between_frames(moved.copy(), self.faces, self.vertices, self.normal)
        return replace(self, animation=animation).at_frame(0)

    @classmethod
    def from_parts(
        cls,
        name: str,
        parts: Sequence[Part],
        camera: Camera,
        lens: ThinLens,
        background: tuple[float, float, float] = (0.0, 0.0, 0.0),
        light: Light | None = None,
    ) -> "Scene":
        """Join parts into one scene. Triangles without area are dropped and counted.

        Raises
        ------
        InputError
            If an argument is not of the kind that its name says.
        """
        parts = [replace(part) for part in as_instances("parts", parts, Part)]  # arrays may have been written to
        meshes, dropped, first = [], 0, 0
        for part in parts:
            vertices, faces = part.vertices, part.faces
            solid = _has_area(vertices, faces)
            dropped += int((~solid).sum())
            faces = faces[solid]
            uv, color, normal, opacity = part.uv, part.color, part.normal, part.opacity
            if normal is None:
                vertices, faces, normal, *looks = _flat(vertices, faces, uv, color, opacity)
                uv, color, opacity = looks
            count = len(vertices)
            uv = np.zeros((count, 2)) if uv is None else uv
            color = np.ones((count, 3)) if color is None else color
            opacity = np.ones(count) if opacity is None else opacity
            meshes.append((vertices, faces + first, uv, color, normal, opacity))
            first += count
        materials = list(dict.fromkeys(part.material for part in parts))
        face_material = [np.full(len(m[1]), materials.index(p.material)) for m, p in zip(meshes, parts, strict=True)]

        def join(k: int, columns: int, dtype: type) -> Any:
            empty = np.zeros((0, columns))
            return np.concatenate([empty, *(m[k] for m in meshes)]).astype(dtype)

        opaque = all(part.opacity is None for part in parts)

        return cls(
            name,
            join(0, 3, np.float64),
            join(1, 3, np.int64),
            join(2, 2, np.float32),
            join(3, 3, np.float32),
            join(4, 3, np.float32),
            np.concatenate([np.zeros(0, dtype=np.int64), *face_material]).astype(np.int64),
            tuple(materials),
            background,
            Light() if light is None else light,
            camera,
            lens,
            dropped,
            opacity=None if opaque else np.concatenate([m[5] for m in meshes]),
        )

    def with_shading(self, shading: str) -> "Scene":
        """The same scene with every material's shading replaced."""
        as_choice("shading", shading, SHADINGS)
        return replace(self, materials=tuple(replace(m, shading=shading) for m in self.materials))

    def with_background(self, background: tuple[float, float, float]) -> "Scene":
        """The same scene before another background, linear RGB."""
        return replace(self, background=background)

    def scaled(self, factor: float) -> "Scene":
        """The same scene, camera and lens in a unit of length `factor` times smaller, 1e-100 .. 1e100."""
        factor = as_number("factor", factor, minimum=1.0 / LARGEST_LENGTH, maximum=LARGEST_LENGTH)
        reach = np.abs(np.concatenate([self.vertices, [self.camera.eye, self.camera.target]])).max()
        if not reach * factor <= LARGEST_LENGTH:
            raise InputError(
                f"factor: got {factor:g} for coordinates of up to {reach:g}; "
                f"allowed is what keeps them <= {LARGEST_LENGTH:g}"
            )

        camera = scaled_camera(self.camera, factor)
        focus = self.lens.focus_distance * factor
        lens = replace(self.lens, radius=self.lens.radius * factor, focus_distance=focus)
        animation = None if self.animation is None else self.animation.scaled(factor, camera)
        return replace(self, vertices=self.vertices * factor, camera=camera, lens=lens, animation=animation)


def _places(name: str, value: Any) -> Float:
    """Coordinates (V, 3) float64 whose products stay in that type."""
    return as_float(name, value, (None, 3), dtype=np.float64, minimum=-LARGEST_LENGTH, maximum=LARGEST_LENGTH)


def _has_area(vertices: Float, faces: Index) -> np.ndarray:
    """(F,) bool: False where two corners coincide or all three lie on a line."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return (np.cross(b - a, c - a) != 0.0).any(axis=1)


def _flat(vertices: Float, faces: Index, *looks: Float | None) -> tuple:
    """Give every triangle its own corners, with what vertices have, and its geometric normal."""
    corner = faces.ravel()
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal = normal / np.abs(normal).max(axis=1, keepdims=True)  # before squaring: tiny triangles underflow
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return (
        vertices[corner],
        np.arange(len(corner)).reshape(-1, 3),
        np.repeat(normal, 3, axis=0),
        *(None if look is None else look[corner] for look in looks),
    )

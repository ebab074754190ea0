"""Scene: triangles, materials and light, as plain arrays in world space.

Shading of a surface point with normal n, seen from direction o, and albedo a = base_color * texture * vertex color:

========  =====================================================================================
unlit     a + emission
lambert   a * E(n) + emission
phong     a * E(n) + emission + specular * (sun * max(0, r.l)^shininess + environment(r))
========  =====================================================================================

E(n) = sun * max(0, n.l) + ground + (sky - ground) * (1 + n.y) / 2, r the mirror direction of o about n. Every surface
has two sides: n is turned towards the viewer. No shadows: what a scene wants dark is dark in its colours.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from refdof._check import (
    LARGEST_COLOR,
    LARGEST_LENGTH,
    Float,
    Index,
    InputError,
    as_choice,
    as_color,
    as_float,
    as_image,
    as_index,
    as_instance,
    as_instances,
    as_integer,
    as_number,
    as_vector,
)
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens

__all__ = ["SHADINGS", "Light", "Material", "Part", "Scene"]

SHADINGS = ("unlit", "lambert", "phong")


@dataclass(frozen=True, eq=False)
class Material:
    """How a surface answers light. Colours are linear Rec.709 RGB, at most 1e8.

    Parameters
    ----------
    shading : "unlit", "lambert" or "phong"
    base_color, emission, specular : (3,) floats >= 0
        Emission may exceed 1 (HDR emitters). `specular` is used by phong only.
    texture : (h, w, 3) float32, or None
        Linear RGB, bilinear, repeated; (u, v) = (0, 0) is its lower left corner, row 0 its top row.
    shininess : float
        Phong exponent >= 1.
    """

    shading: str = "lambert"
    base_color: tuple[float, float, float] = (1.0, 1.0, 1.0)
    texture: Float | None = None
    emission: tuple[float, float, float] = (0.0, 0.0, 0.0)
    specular: tuple[float, float, float] = (0.0, 0.0, 0.0)
    shininess: float = 50.0

    def __post_init__(self) -> None:
        as_choice("shading", self.shading, SHADINGS)
        for name in ("base_color", "emission", "specular"):
            object.__setattr__(self, name, as_color(name, getattr(self, name)))
        object.__setattr__(self, "shininess", as_number("shininess", self.shininess, minimum=1.0, maximum=1e6))
        if self.texture is not None:
            object.__setattr__(self, "texture", _colors("texture", self.texture, (None, None, 3)))


@dataclass(frozen=True, eq=False)
class Light:
    """A distant sun, a two-colour dome and what mirrors see.

    Parameters
    ----------
    sun_direction : (3,) floats
        From the surface towards the sun, world space, any length.
    sun, sky, ground : (3,) floats >= 0
        Irradiance / pi of the sun at normal incidence, and of the dome from above and below.
    environment : (n, n, 3) float32, or None
        What a mirror sees, as an octahedral map of world directions (y up); None: the dome's own colours.
    """

    sun_direction: tuple[float, float, float] = (0.4, 0.8, 0.45)
    sun: tuple[float, float, float] = (0.75, 0.72, 0.66)
    sky: tuple[float, float, float] = (0.42, 0.46, 0.54)
    ground: tuple[float, float, float] = (0.20, 0.18, 0.16)
    environment: Float | None = None

    def __post_init__(self) -> None:
        direction = np.asarray(as_vector("sun_direction", self.sun_direction))
        if not direction.any():
            raise InputError("sun_direction: got (0, 0, 0); allowed is any other direction")
        # Scale by a power of two before the norm, so that squares neither leave the type nor vanish.
        direction = np.ldexp(direction, -np.frexp(np.abs(direction).max())[1])
        x, y, z = (direction / np.linalg.norm(direction)).tolist()
        object.__setattr__(self, "sun_direction", (x, y, z))
        for name in ("sun", "sky", "ground"):
            object.__setattr__(self, name, as_color(name, getattr(self, name)))
        if self.environment is not None:
            environment = _colors("environment", self.environment, (None, None, 3))
            if environment.shape[0] != environment.shape[1]:
                raise InputError(f"environment: got shape {environment.shape}; allowed is (n, n, 3), an octahedral map")
            object.__setattr__(self, "environment", environment)


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

    def __post_init__(self) -> None:
        vertices = _places("vertices", self.vertices)
        count = len(vertices)
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "faces", as_index("faces", self.faces, (None, 3), end=count))
        as_instance("material", self.material, Material)
        if self.uv is not None:
            object.__setattr__(self, "uv", as_float("uv", self.uv, (count, 2), dtype=np.float32))
        if self.color is not None:
            object.__setattr__(self, "color", _colors("color", self.color, (count, 3)))
        if self.normal is not None:
            object.__setattr__(self, "normal", as_float("normal", self.normal, (count, 3), dtype=np.float32))


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
            ("color", _colors("color", self.color, (count, 3))),
            ("normal", as_float("normal", self.normal, (count, 3), dtype=np.float32)),
            ("face_material", as_index("face_material", self.face_material, (len(faces),), end=len(materials))),
            ("materials", materials),
            ("background", as_color("background", self.background)),
            ("dropped_faces", as_integer("dropped_faces", self.dropped_faces, minimum=0)),
        ):
            object.__setattr__(self, name, value)
        for name, kind in (("light", Light), ("camera", Camera), ("lens", ThinLens)):
            as_instance(name, getattr(self, name), kind)

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
            uv, color, normal = part.uv, part.color, part.normal
            if normal is None:
                vertices, faces, uv, color, normal = _flat(vertices, faces, uv, color)
            count = len(vertices)
            uv = np.zeros((count, 2)) if uv is None else uv
            color = np.ones((count, 3)) if color is None else color
            meshes.append((vertices, faces + first, uv, color, normal))
            first += count
        materials = list(dict.fromkeys(part.material for part in parts))
        face_material = [np.full(len(m[1]), materials.index(p.material)) for m, p in zip(meshes, parts, strict=True)]

        def join(k: int, columns: int, dtype: type) -> Any:
            empty = np.zeros((0, columns))
            return np.concatenate([empty, *(m[k] for m in meshes)]).astype(dtype)

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

        def times(v: tuple[float, float, float]) -> tuple[float, float, float]:
            return v[0] * factor, v[1] * factor, v[2] * factor

        camera = replace(self.camera, eye=times(self.camera.eye), target=times(self.camera.target))
        focus = self.lens.focus_distance * factor
        lens = replace(self.lens, radius=self.lens.radius * factor, focus_distance=focus)
        return replace(self, vertices=self.vertices * factor, camera=camera, lens=lens)


def _places(name: str, value: Any) -> Float:
    """Coordinates (V, 3) float64 whose products stay in that type."""
    return as_float(name, value, (None, 3), dtype=np.float64, minimum=-LARGEST_LENGTH, maximum=LARGEST_LENGTH)


def _colors(name: str, value: Any, shape: tuple[int | None, ...]) -> Float:
    """Linear RGB, float32, whose products stay in that type."""
    return as_image(name, value, shape, dtype=np.float32, minimum=0.0, maximum=LARGEST_COLOR)


def _has_area(vertices: Float, faces: Index) -> np.ndarray:
    """(F,) bool: False where two corners coincide or all three lie on a line."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return (np.cross(b - a, c - a) != 0.0).any(axis=1)


def _flat(vertices: Float, faces: Index, uv: Float | None, color: Float | None) -> tuple:
    """Give every triangle its own corners and its geometric normal."""
    corner = faces.ravel()
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal = normal / np.abs(normal).max(axis=1, keepdims=True)  # before squaring: tiny triangles underflow
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return (
        vertices[corner],
        np.arange(len(corner)).reshape(-1, 3),
        None if uv is None else uv[corner],
        None if color is None else color[corner],
        np.repeat(normal, 3, axis=0),
    )

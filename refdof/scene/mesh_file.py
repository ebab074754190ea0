"""Mesh files: any file that trimesh reads, as a scene with a shot. The only file that knows trimesh.

1. read the file; whatever goes wrong becomes one line     `_read`
2. every mesh, placed by its node                          `_part`
3. its colours and textures, made linear                   `_Looks`
4. the file's own normals, or smooth ones with creases     `refdof.scene.smooth_normals`
5. a glTF file's animation, skins and morph targets        `refdof.scene.gltf.rig`
6. a glTF file's own camera, or a suggested shot           `refdof.scene.gltf.camera`, `refdof.scene.framing`

What is left out: points, lines, transparency, and every texture but that of the base colour; of animations, all but a
glTF file's first. An animated scene stands at frame 0.
Texture coordinates outside 0 .. 1 repeat, whatever the file asks for.
"""

import io
import logging
import urllib.parse
import warnings
from codecs import BOM_UTF8
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from refdof._check import Float, Index, InputError, as_choice, as_color, as_float, as_index, as_path
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens
from refdof.scene.framing import suggest_camera, suggest_lens, up_axis
from refdof.scene.gltf.camera import camera_kinds, gltf_camera
from refdof.scene.gltf.extensions import left_out_extensions
from refdof.scene.gltf.file import GltfFile, Numbers, read_gltf
from refdof.scene.gltf.look import look_of
from refdof.scene.gltf.plain import marked, marks_of, material_of, without_cameras
from refdof.scene.gltf.rig import Limb, Rig, animation_of, is_rigged, read_rig, turned_normals
from refdof.scene.material import SHADINGS, Light, Material
from refdof.scene.scene import Part, Scene
from refdof.scene.smooth_normals import smooth_normals

__all__ = ["load_mesh"]

_GLTF = ("glb", "gltf")
_TEXT = ("obj", "off")
_MOST_BYTES = 1 << 30  # of a file beside the mesh
_MOST_PIXELS = 1 << 26  # of a texture: 8192 x 8192, 805 MB as linear colours
_LONGEST_WARNING = 500
_GREY = (0.5, 0.5, 0.5)  # albedo of what has no colour
_WHITE = (1.0, 1.0, 1.0)  # leaves the colours of a texture or of vertices as they are
_SPECULAR = (0.04, 0.04, 0.04)  # normal reflectance of glass and plastic, glTF 2.0 appendix B
_MAX_SHININESS = 2000.0  # a highlight narrower than a pixel would only flicker

# trimesh logs for those who listen; without a handler its warnings would be printed.
logging.getLogger("trimesh").addHandler(logging.NullHandler())


def load_mesh(
    path: str | Path, shading: str | None = None, background: tuple[float, float, float] = (0.46, 0.55, 0.64)
) -> Scene:
    """Read a mesh file.

    Parameters
    ----------
    path : str or Path
        OBJ, PLY, STL, OFF, GLB, glTF or any other file with triangles that trimesh reads.
    shading : "unlit", "lambert", "phong", or None: "lambert", and "unlit" for materials of glTF files that are
    background : (3,) floats >= 0
        Linear RGB of rays that meet nothing; the default is a light grey-blue.

    Returns
    -------
    Scene
        Named after the file, in the file's unit of length, with the file's own camera or a suggested one.

    Raises
    ------
    InputError
        If the file is missing, unreadable, broken, of an unknown kind or without triangles, or if a number
        in it is NaN, infinite or out of range.
    """
    path = as_path("scene", path)
    if shading is not None:
        as_choice("shading", shading, SHADINGS)
    background = as_color("background", background)
    try:
        _check_kind(path)
        file = read_gltf(path) if _suffix(path) in _GLTF else None
        beside, looks = _Beside(path), _Looks(shading, None if file is None else file.header)
        extensions = [] if file is None else left_out_extensions(file.header)
        rig = None if file is None or not is_rigged(file.header) else read_rig(file, beside.get)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            # NumPy's word for garbage between numbers; what follows would be lost in silence.
            warnings.filterwarnings("error", message="string or file could not be read")
            parts, limbs = _read(path, looks, beside, file, rig)
        # The shot follows from the scene, so a stand-in comes first.
        camera, lens = Camera((0, 0, 1), (0, 0, 0)), ThinLens(0.0, 1.0)
        scene = Scene.from_parts(path.stem, parts, camera, lens, background)
        if rig is not None:  # the camera moves with it, if the file has one
            scene = replace(scene, animation=replace(animation_of(rig, limbs), camera=camera)).at_frame(0)
    except InputError as error:
        raise _refusal(path, str(error)) from None
    except Exception as error:  # trimesh lets through whatever its parsers meet
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise _refusal(path, f"it cannot be read ({reason[:160]})") from error
    left_out = [f"{name} ({reason})" for name, reason in {**beside.missing, **looks.broken}.items()]
    left_out += [f"the extension {name}" for name in extensions]
    if file is not None and camera_kinds(file.header) == {"orthographic"}:
        left_out.append("its orthographic camera")
    if left_out:
        warnings.warn(f"{path.name}: left out: {', '.join(left_out)}"[:_LONGEST_WARNING], stacklevel=2)
    if not len(scene.faces):
        raise _refusal(path, f"it has no triangle with an area ({scene.dropped_faces} without)")
    up = 1 if file is not None else up_axis(scene.vertices, scene.faces)  # glTF defines y as up
    animation = scene.animation
    if animation is not None:
        file_camera = animation.camera
    else:
        file_camera = None if file is None else gltf_camera(file.header)
    shown = scene.vertices
    if animation is not None and not np.ptp(shown, axis=0).any():  # what is yet to grow is shown as it will be
        shown = scene.at_frame(animation.last).vertices
        if not np.ptp(shown, axis=0).any():
            raise _refusal(path, "its triangles have no extent at its first and last frame")
    camera = file_camera or suggest_camera(shown, scene.faces, up)
    lens = suggest_lens(shown, scene.faces, camera)
    x, y, z = scene.light.sun_direction
    light = Light() if up == 1 else Light(sun_direction=(x, -z, y))  # the sun stands above the model's front
    if animation is not None and animation.first == animation.last:
        animation = None
    return replace(scene, camera=camera, lens=lens, light=light, animation=animation)


def _refusal(path: Path, reason: str) -> InputError:
    return InputError(f"scene: got {str(path)!r}: {reason}; allowed is a mesh file with triangles")


def _suffix(path: Path) -> str:
    return path.suffix.lower().lstrip(".")


def _check_kind(path: Path) -> None:
    """Raise if the path is no file of a kind that trimesh reads."""
    if not path.is_file():
        raise InputError("it is not a file" if path.exists() else "there is no such file")
    formats = sorted(trimesh.available_formats())
    if not any(path.name.lower().endswith(f".{known}") for known in formats):
        raise InputError(f"its type is not one of {', '.join(formats)}")
    if path.stat().st_size == 0:
        raise InputError("it is empty")


class _Beside(trimesh.resolvers.FilePathResolver):
    """The files that a mesh file names: plain ones in its folder or below, in any letter case.

    `missing` has those that are left out, with the reason.
    """

    def __init__(self, path: Path) -> None:
        super().__init__(str(path))
        self._root = path.parent.resolve()
        self.missing: dict[str, str] = {}

    def get(self, name: str) -> bytes:
        """The bytes of a file by its name, which may be a URI, with slashes of any system.

        Of a path that leads nowhere, such as one of another machine, the last part is looked for beside the mesh.
        """
        written = name.strip().replace("\\", "/")
        reasons = []
        for text in dict.fromkeys((written, urllib.parse.unquote(written), written.rpartition("/")[2])):
            try:
                path = _in_any_case(self._root, text)
                if path.stat().st_size > _MOST_BYTES:
                    raise ValueError(f"it has {path.stat().st_size} bytes; allowed are at most {_MOST_BYTES}")
            except (OSError, ValueError) as error:
                reasons.append(str(error))
                continue
            self.missing.pop(name, None)
            return path.read_bytes()
        self.missing[name] = reasons[0]
        raise FileNotFoundError(f"{name}: {reasons[0]}")


def _in_any_case(root: Path, name: str) -> Path:
    """The plain file of a name below `root`; of names that differ in letter case only, the first."""
    if "://" in name:
        raise ValueError("it is on another machine; allowed are files beside the mesh")
    path = root
    for part in Path(name).parts:
        found = path / part
        if not found.exists() and path.is_dir():
            alike = sorted(other.name for other in path.iterdir() if other.name.lower() == part.lower())
            found = path / alike[0] if alike else found
        path = found
    path = path.resolve()
    if not path.is_relative_to(root):
        raise ValueError("it is outside of the mesh file's folder")
    if not path.is_file():
        raise ValueError("it is no plain file" if path.exists() else "there is no such file")
    return path


def _read(
    path: Path, looks: "_Looks", beside: _Beside, file: GltfFile | None, rig: Rig | None
) -> tuple[list[Part], list[Limb]]:
    """All meshes of the file, in world space; with a rig, in their nodes' space, and each part's limb."""
    if file is None:
        data = _tidied(path)
    else:
        numbers = Numbers(file, beside.get) if rig is None else rig.numbers
        data = without_cameras(file, numbers) if rig is None else marked(file, numbers)
    opened: Any = path if data is None else io.BytesIO(data)
    kind = None if data is None else _suffix(path)
    loaded = trimesh.load_scene(opened, kind, beside, process=False)  # neither merge nor drop vertices
    parts, limbs = [], []
    for node in loaded.graph.nodes_geometry:
        world, name = loaded.graph[node]
        mesh = loaded.geometry[name]
        if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces):
            placed = np.asarray(world, dtype=np.float64) if rig is None else np.eye(4)
            part, source, states_normals = _part(mesh, placed, looks)
            parts.append(part)
            if rig is not None:
                limbs.append(_limb(node, mesh, part, source, states_normals))
    return parts, limbs


def _limb(node: str, mesh: Any, part: Part, source: Index, states_normals: bool) -> Limb:
    normal = np.zeros((0, 3)) if part.normal is None else part.normal.astype(np.float64)
    return Limb(*marks_of(node, mesh.vertex_attributes), source, part.vertices, normal, part.faces, states_normals)


def _tidied(path: Path) -> bytes | None:
    """What trimesh is given in the file's place; None if it can take the file as it is."""
    if _suffix(path) not in _TEXT:
        return None
    data = path.read_bytes()
    marked = data.startswith(BOM_UTF8)  # the first line would be lost in silence, and with it a vertex
    data = data.removeprefix(BOM_UTF8)
    try:
        data.decode()
    except UnicodeDecodeError:  # names and comments of older programs
        return data.decode("latin-1").encode()
    return data if marked else None


def _part(mesh: Any, world: Float, looks: "_Looks") -> tuple[Part, Index, bool]:
    """One mesh in world space; `world` (4, 4) is its node's transform. Also the mesh's vertex that each of the part's
    copies, and whether the normals are the file's own.
    """
    vertices = as_float("vertices", mesh.vertices, (None, 3), dtype=np.float64)
    faces = as_index("faces", mesh.faces, (None, 3), end=len(vertices))
    vertices = vertices @ world[:3, :3].T + world[:3, 3]
    normal = _file_normals(mesh, world)
    uv, color, material = looks.of(mesh)
    source: Index = np.arange(len(vertices))
    if mesh.visual.kind == "face" and color is not None:  # every face gets corners of its own
        source, faces = faces.ravel(), np.arange(faces.size).reshape(-1, 3)
        vertices, color = vertices[source], np.repeat(color, 3, axis=0)
        normal = None if normal is None else normal[source]
    states_normals = normal is not None
    if normal is None:
        # glTF 2.0, 3.7.2.1: flat where a file states none.
        copied, faces, normal = smooth_normals(vertices, faces, *([0.0] if looks.of_gltf else []))
        source, vertices = source[copied], vertices[copied]
        uv = None if uv is None else uv[copied]
        color = None if color is None else color[copied]
    return Part(vertices, faces, material, uv, color, normal), source, states_normals


def _file_normals(mesh: Any, world: Float) -> Float | None:
    """Unit normals (V, 3) that the file states, in world space; None if it states none or a useless one."""
    if "vertex_normals" not in mesh._cache:  # asking the mesh itself would compute them
        return None
    normal = turned_normals(np.asarray(mesh.vertex_normals, dtype=np.float64), world[:3, :3])
    return normal if np.isfinite(normal).all() else None


class _Looks:
    """Materials as this package wants them; every material and every texture is made once and shared."""

    def __init__(self, shading: str | None, header: dict[str, Any] | None) -> None:
        self._shading, self._given = "lambert" if shading is None else shading, shading is not None
        self._header, self.of_gltf = header, header is not None
        self._materials: dict[Any, Material] = {}
        self._textures: dict[int, Float | None] = {}
        self.broken: dict[str, str] = {}  # textures that are left out, with the reason

    def of(self, mesh: Any) -> tuple[Float | None, Float | None, Material]:
        """Texture coordinates (V, 2), linear colours (V, 3), or (F, 3) if per face, and the material."""
        visual = mesh.visual
        if visual.kind in ("vertex", "face"):
            colors = visual.vertex_colors if visual.kind == "vertex" else visual.face_colors
            return None, self._linear(colors), self._plain(_WHITE)
        if visual.kind != "texture":
            return None, None, self._plain(_GREY)
        colors = visual.vertex_attributes.get("color", mesh.vertex_attributes.get("color"))
        fits = visual.uv is not None and np.shape(visual.uv) == (len(mesh.vertices), 2)
        uv = np.array(visual.uv) if fits else None
        color = None if colors is None else self._linear(colors)
        return uv, color, self._material(visual.material, uv is not None)

    def _linear(self, colors: Any) -> Float:
        """(N, 3) linear RGB of (N, 3 or 4) colours; glTF stores them linear, all others as sRGB."""
        colors = np.asarray(colors)
        rgb = colors[:, :3] / (np.iinfo(colors.dtype).max if colors.dtype.kind in "ui" else 1.0)
        return rgb if self.of_gltf else _decode_srgb(rgb)

    def _plain(self, base_color: tuple[float, float, float]) -> Material:
        if base_color not in self._materials:
            self._materials[base_color] = Material(self._shading, base_color, specular=_SPECULAR)
        return self._materials[base_color]

    def _material(self, source: Any, has_uv: bool) -> Material:
        """Material of one of trimesh's; the colours of materials are linear already."""
        key = (id(source), has_uv)
        if key not in self._materials:
            shading = self._shading
            if isinstance(source, trimesh.visual.material.PBRMaterial):
                image, shininess = source.baseColorTexture, _shininess(source.roughnessFactor)
                factor = source.baseColorFactor
                base = _WHITE if factor is None else tuple((factor[:3] / 255.0).tolist())
                glows = source.emissiveFactor is not None and source.emissiveTexture is None
                emission = tuple(source.emissiveFactor.tolist()) if glows else (0.0, 0.0, 0.0)
                index = None if self._header is None else material_of(source.name)
                if self._header is not None and index is not None:
                    look = look_of(self._header, index)
                    base, emission = base if look.base is None else look.base, look.emission
                    shading = "unlit" if look.unlit and not self._given else shading
            else:
                words = getattr(source, "kwargs", {})  # of the .mtl file, as written
                image, emission = getattr(source, "image", None), (0.0, 0.0, 0.0)
                if getattr(image, "format", None) is None:  # from no file: trimesh's stand-in for no material
                    image = None
                base = words.get("kd", _GREY if image is None else _WHITE)
                base = tuple(np.broadcast_to(np.maximum(base, 0.0), 3).tolist())
                shininess = float(np.clip(words.get("ns", 50.0), 1.0, _MAX_SHININESS))
            texture = self._texture(image) if image is not None and has_uv else None
            self._materials[key] = Material(shading, base, texture, emission, _SPECULAR, shininess)
        return self._materials[key]

    def _texture(self, image: Any) -> Float | None:
        """(h, w, 3) float32 linear RGB; None if the image is broken."""
        if id(image) not in self._textures:
            name = f"texture {len(self._textures) + 1}"
            try:
                if image.width * image.height > _MOST_PIXELS:
                    raise ValueError(f"{image.width} x {image.height} pixels; allowed are at most {_MOST_PIXELS}")
                encoded = np.asarray(image.convert("RGB"))
            except (OSError, ValueError, SyntaxError) as error:  # Pillow reads pixels only now
                self._textures[id(image)] = None
                self.broken[name] = " ".join(str(error).split())
            else:
                self._textures[id(image)] = _decode_srgb(np.arange(256) / 255.0).astype(np.float32)[encoded]
        return self._textures[id(image)]


def _shininess(roughness: float | None) -> float:
    """Phong exponent for a glTF roughness: a quarter of the half vector's 2 / roughness^4 - 2."""
    alpha = (1.0 if roughness is None else float(roughness)) ** 2
    return float(np.clip((2.0 / max(alpha * alpha, 1e-6) - 2.0) / 4.0, 1.0, _MAX_SHININESS))


def _decode_srgb(encoded: Float) -> Float:
    """Linear values of sRGB-encoded ones, IEC 61966-2-1."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)

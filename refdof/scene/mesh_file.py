"""Mesh files: any file that trimesh reads, as a scene with a shot. The only file that knows trimesh.

1. read the file; whatever goes wrong becomes one line     `_read`, `refdof.scene.beside`
2. every mesh, placed by its node                          `_part`
3. its colours and textures, made linear                   `refdof.scene.looks`
4. the file's own normals, or smooth ones with creases     `refdof.scene.smooth_normals`
5. a glTF file's animation, skins and morph targets        `refdof.scene.gltf.rig`
6. a glTF file's own camera, or a suggested shot           `refdof.scene.gltf.camera`, `refdof.scene.framing`

What is left out: points, lines, transparency, and every texture but that of the base colour; of animations, all but a
glTF file's first. An animated scene stands at frame 0.
Texture coordinates outside 0 .. 1 repeat, whatever the file asks for.
"""

import io
import logging
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
from refdof.scene.beside import FilesBeside
from refdof.scene.framing import suggest_camera, suggest_lens, up_axis
from refdof.scene.gltf.camera import camera_kinds, gltf_camera
from refdof.scene.gltf.extensions import left_out_extensions
from refdof.scene.gltf.file import GltfFile, Numbers, read_gltf
from refdof.scene.gltf.plain import marked, marks_of, without_cameras
from refdof.scene.gltf.rig import Limb, Rig, animation_of, is_rigged, read_rig, turned_normals
from refdof.scene.looks import Looks
from refdof.scene.material import SHADINGS, Light
from refdof.scene.scene import Part, Scene
from refdof.scene.smooth_normals import smooth_normals

__all__ = ["load_mesh"]

_GLTF = ("glb", "gltf")
_TEXT = ("obj", "off")
_LONGEST_WARNING = 500

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
        beside, looks = FilesBeside(path), Looks(shading, None if file is None else file.header)
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


class _Resolver(trimesh.resolvers.FilePathResolver):
    """`FilesBeside`, as trimesh asks for files."""

    def __init__(self, path: Path, beside: FilesBeside) -> None:
        super().__init__(str(path))
        self._beside = beside

    def get(self, name: str) -> bytes:
        return self._beside.get(name)


def _read(
    path: Path, looks: Looks, beside: FilesBeside, file: GltfFile | None, rig: Rig | None
) -> tuple[list[Part], list[Limb]]:
    """All meshes of the file, in world space; with a rig, in their nodes' space, and each part's limb."""
    if file is None:
        data = _tidied(path)
    else:
        numbers = Numbers(file, beside.get) if rig is None else rig.numbers
        data = without_cameras(file, numbers) if rig is None else marked(file, numbers)
    opened: Any = path if data is None else io.BytesIO(data)
    kind = None if data is None else _suffix(path)
    loaded = trimesh.load_scene(opened, kind, _Resolver(path, beside), process=False)  # neither merge nor drop vertices
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


def _part(mesh: Any, world: Float, looks: Looks) -> tuple[Part, Index, bool]:
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

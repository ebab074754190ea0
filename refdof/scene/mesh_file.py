"""Mesh files: OBJ, PLY, OFF, STL, glTF and GLB as a scene with a shot.

1. what a kind of file holds; whatever goes wrong becomes one line     `refdof.scene.formats`, `refdof.scene.gltf`
2. every surface, placed by its node                                   `_part`
3. the file's own normals, or smooth ones with creases                 `refdof.scene.smooth_normals`
4. a glTF file's animation, skins and morph targets                    `refdof.scene.gltf.rig`
5. a glTF file's own camera, or a suggested shot                       `_with_shot`

What is left out is told in one warning. An animated scene stands at frame 0.
"""

import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from refdof._check import (
    Float,
    Index,
    InputError,
    as_bool,
    as_choice,
    as_color,
    as_float,
    as_index,
    as_instance,
    as_path,
)
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens
from refdof.scene.formats.obj import read_obj
from refdof.scene.formats.off import read_off
from refdof.scene.formats.ply import read_ply
from refdof.scene.formats.reading import Reading, Surface
from refdof.scene.framing import suggest_camera, suggest_lens, up_axis
from refdof.scene.gltf.camera import beyond_clipping, gltf_camera, refuse_other_cameras
from refdof.scene.gltf.extensions import left_out_extensions
from refdof.scene.gltf.file import GltfFile, Numbers, read_gltf
from refdof.scene.gltf.nodes import matrix_of, tree_of
from refdof.scene.gltf.placed import Placed, copied, copied_faces, read_placed
from refdof.scene.gltf.rig import Limb, Rig, animation_of, is_rigged, read_rig, turned_normals
from refdof.scene.limits import Limits
from refdof.scene.material import SHADINGS, Light
from refdof.scene.scene import Part, Scene
from refdof.scene.smooth_normals import smooth_normals

__all__ = ["load_mesh"]

_GLTF = ("glb", "gltf")
_READERS = {"obj": read_obj, "ply": read_ply, "off": read_off}
_LONGEST_WARNING = 500


def load_mesh(
    path: str | Path,
    shading: str | None = None,
    background: tuple[float, float, float] = (0.46, 0.55, 0.64),
    limits: Limits = Limits(),
    file_camera: bool = True,
) -> Scene:
    """Read a mesh file.

    Parameters
    ----------
    path : str or Path
        OBJ, PLY, STL, OFF, GLB, glTF or any other file with triangles that trimesh reads.
    shading : "unlit", "lambert", "phong", or None: "lambert", and "unlit" for materials of glTF files that are
    background : (3,) floats >= 0
        Linear RGB of rays that meet nothing; the default is a light grey-blue.
    limits : Limits
        The most that reading may take.
    file_camera : bool
        False: suggest a shot even if the file has a camera.

    Returns
    -------
    Scene
        Named after the file, in the file's unit of length, with the file's own camera or a suggested one.

    Raises
    ------
    InputError
        If the file is missing, unreadable, broken, of an unknown kind or without triangles, if a number in it is NaN,
        infinite or out of range, if it needs what is not read, or more than the limits allow.
    """
    path = as_path("scene", path)
    if shading is not None:
        as_choice("shading", shading, SHADINGS)
    background = as_color("background", background)
    as_instance("limits", limits, Limits)
    own_camera = as_bool("file_camera", file_camera)
    try:
        _check_kind(path)
        reading = Reading(path, shading, limits)
        reading.meter.bytes(path.name, path.stat().st_size)
        data = path.read_bytes()
        file = read_gltf(data) if _suffix(path) in _GLTF else None
        parts, limbs, rig = _read(path, data, reading) if file is None else _read_gltf(file, reading)
        # The shot follows from the scene, so a stand-in comes first.
        camera, lens = Camera((0, 0, 1), (0, 0, 0)), ThinLens(0.0, 1.0)
        scene = Scene.from_parts(path.stem, parts, camera, lens, background)
        if rig is not None:  # the camera moves with it, if the file has one
            scene = replace(scene, animation=replace(animation_of(rig, limbs), camera=camera)).at_frame(0)
        if file is not None and own_camera:
            refuse_other_cameras(file.header)
    except InputError as error:
        raise _refusal(path, str(error)) from None
    except Exception as error:  # parsers let through whatever they meet
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise _refusal(path, f"it cannot be read ({reason[:160]})") from error
    if not len(scene.faces):
        raise _refusal(path, f"it has no triangle with an area ({scene.dropped_faces} without)")
    return _with_shot(path, scene, file, reading, own_camera)


def _with_shot(path: Path, scene: Scene, file: GltfFile | None, reading: Reading, own_camera: bool) -> Scene:
    """The scene with the file's camera, or a suggested one; what was left out is told."""
    up = 1 if file is not None else up_axis(scene.vertices, scene.faces)  # glTF defines y as up
    animation = scene.animation
    if file is None or not own_camera:
        file_camera = None
    else:
        file_camera = gltf_camera(file.header) if animation is None else animation.camera
    if file is not None and file_camera is not None:
        for what in beyond_clipping(file.header, file_camera, scene.vertices, scene.faces):
            reading.leave_out(what, "what lies beyond is drawn")
    left_out = reading.left_out()
    if left_out:
        warnings.warn(f"{path.name}: left out: {', '.join(left_out)}"[:_LONGEST_WARNING], stacklevel=3)
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
    """Raise if the path is no file of a kind that is read."""
    if not path.is_file():
        raise InputError("it is not a file" if path.exists() else "there is no such file")
    if _suffix(path) not in (*_GLTF, *_READERS):
        from refdof.scene.formats.by_trimesh import trimesh_kinds  # slow to import

        if _suffix(path) not in trimesh_kinds():
            raise InputError(f"its type is not one of {', '.join(trimesh_kinds())}")
    if path.stat().st_size == 0:
        raise InputError("it is empty")


def _read(path: Path, data: bytes, reading: Reading) -> tuple[list[Part], list[Limb], None]:
    """All surfaces of a file that is no glTF file."""
    kind = _suffix(path)
    if kind in _READERS:
        surfaces = _READERS[kind](data, reading)
    else:
        from refdof.scene.formats.by_trimesh import read_by_trimesh  # slow to import

        surfaces = read_by_trimesh(path, data, kind, reading)
    return [_part(surface, np.eye(4), smooth=True)[0] for surface in surfaces if len(surface.faces)], [], None


def _read_gltf(file: GltfFile, reading: Reading) -> tuple[list[Part], list[Limb], Rig | None]:
    """All primitives of a glTF file, in world space; with a rig, in their nodes' space, and each part's limb."""
    header = file.header
    for name in left_out_extensions(header):
        reading.leave_out(f"the extension {name}")
    if len(header.get("animations", ())) > 1:
        reading.leave_out("animations but the first")
    if sum("camera" in node for node in header.get("nodes", ())) > 1:
        reading.leave_out("cameras but the first perspective one")
    numbers = Numbers(file, reading.beside.get, reading.meter)
    reading.meter.instances(len(header.get("nodes", ())))
    tree = tree_of(header)
    rig = read_rig(header, numbers, tree) if is_rigged(header) else None
    placed = read_placed(header, numbers, tree, reading)
    local = [] if rig is not None else [matrix_of(node) for node in header.get("nodes", [])]
    with np.errstate(all="ignore"):  # transforms may hold any numbers; `Scene` judges what comes out
        world = tree.worlds(local) if local else []
    parts, limbs = [], []
    for item in placed:
        reading.meter.clock()
        surface, source = _instances(item, rig)
        part, again, states_normals = _part(surface, np.eye(4) if rig is not None else world[item.node], smooth=False)
        parts.append(part)
        if rig is not None:
            normal = np.zeros((0, 3)) if part.normal is None else part.normal.astype(np.float64)
            whose = (item.node, item.mesh, item.primitive)
            limbs.append(Limb(*whose, source[again], part.vertices, normal, part.faces, states_normals))
    return parts, limbs, rig


def _instances(item: Placed, rig: Rig | None) -> tuple[Surface, Index]:
    """A node's copies of a surface as one surface, and the vertex that each of its own is of."""
    surface, copies = item.surface, item.copies
    source = np.arange(len(surface.vertices))
    if copies is None:
        return surface, source
    if rig is not None and ("skin" in rig.header["nodes"][item.node] or _has_targets(rig.header, item)):
        raise InputError(
            f"nodes {item.node}: has instances with a skin or morph targets; allowed are instances without"
        )
    many: dict[str, Any] = {
        name: None if values is None else np.tile(values, (len(copies), *[1] * (values.ndim - 1)))
        for name, values in (("uv", surface.uv), ("color", surface.color), ("opacity", surface.opacity))
    }
    vertices = copied(surface.vertices, copies)
    faces = copied_faces(surface.faces, len(surface.vertices), len(copies))
    if surface.normal is not None:
        many["normal"] = np.concatenate([turned_normals(surface.normal, matrix[:3, :3]) for matrix in copies])
    return surface._replace(vertices=vertices, faces=faces, **many), np.tile(source, len(copies))


def _has_targets(header: dict[str, Any], item: Placed) -> bool:
    return bool(header["meshes"][item.mesh]["primitives"][item.primitive].get("targets"))


def _part(surface: Surface, world: Float, smooth: bool) -> tuple[Part, Index, bool]:
    """One surface in world space; `world` (4, 4) is its node's transform. Also the surface's vertex that each of the
    part's copies, and whether the normals are the file's own. Others are smooth, or flat.
    """
    vertices = as_float("vertices", surface.vertices, (None, 3), dtype=np.float64)
    faces = as_index("faces", surface.faces, (None, 3), end=len(vertices))
    with np.errstate(all="ignore"):  # `Part` judges what comes out
        vertices = vertices @ world[:3, :3].T + world[:3, 3]
    normal = None if surface.normal is None else turned_normals(surface.normal, world[:3, :3])
    if normal is not None and not np.isfinite(normal).all():  # one of no direction is useless
        normal = None
    uv, color, opacity = surface.uv, surface.color, surface.opacity
    source: Index = np.arange(len(vertices))
    states_normals = normal is not None
    if normal is None:
        # glTF 2.0, 3.7.2.1: flat where a file states none.
        source, faces, normal = smooth_normals(vertices, faces, *([] if smooth else [0.0]))
        vertices = vertices[source]
        uv, color, opacity = (None if values is None else values[source] for values in (uv, color, opacity))
    return Part(vertices, faces, surface.material, uv, color, normal, opacity), source, states_normals

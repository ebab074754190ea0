"""Files of kinds that only trimesh reads, such as STL. The only file that knows trimesh."""

import io
import logging
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from refdof._check import Float, as_float
from refdof.scene.formats.reading import GREY, SPECULAR, WHITE, Reading, Surface, decoded
from refdof.scene.material import Material

__all__ = ["read_by_trimesh", "trimesh_kinds"]

_ARCHIVES = ("zip", "tar.gz", "tar.bz2", "bz2")

# trimesh logs for those who listen; without a handler its warnings would be printed.
logging.getLogger("trimesh").addHandler(logging.NullHandler())


def trimesh_kinds() -> list[str]:
    """Suffixes of the files that trimesh reads; archives must be unpacked first."""
    return sorted(set(trimesh.available_formats()) - set(_ARCHIVES))


def read_by_trimesh(path: Path, data: bytes, kind: str, reading: Reading) -> list[Surface]:
    """The surfaces of a file, in world space; whatever its parser meets is raised."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        # NumPy's word for garbage between numbers; what follows would be lost in silence.
        warnings.filterwarnings("error", message="string or file could not be read")
        loaded = trimesh.load_scene(io.BytesIO(data), kind, _Resolver(path, reading), process=False)
    found = []
    for node in loaded.graph.nodes_geometry:
        world, name = loaded.graph[node]
        mesh = loaded.geometry[name]
        if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces):
            reading.meter.instances(1)
            reading.meter.triangles(len(mesh.faces))
            found.append(_surface(mesh, np.asarray(world, dtype=np.float64), reading))
    return found


class _Resolver(trimesh.resolvers.FilePathResolver):
    """The files beside, as trimesh asks for them."""

    def __init__(self, path: Path, reading: Reading) -> None:
        super().__init__(str(path))
        self._beside = reading.beside

    def get(self, name: str) -> bytes:
        return self._beside.get(name)


def _surface(mesh: Any, world: Float, reading: Reading) -> Surface:
    """A mesh placed by `world` (4, 4)."""
    vertices = as_float("vertices", mesh.vertices, (None, 3), dtype=np.float64) @ world[:3, :3].T + world[:3, 3]
    faces, visual = np.asarray(mesh.faces, dtype=np.int64), mesh.visual
    if visual.kind == "face":  # every face gets corners of its own
        vertices, faces = vertices[faces.ravel()], np.arange(faces.size).reshape(-1, 3)
        color, opacity = decoded(np.repeat(np.asarray(visual.face_colors, dtype=np.float64), 3, axis=0), "u")
        return Surface(vertices, faces, reading.plain(WHITE), color=color, opacity=opacity)
    if visual.kind == "vertex":
        color, opacity = decoded(np.asarray(visual.vertex_colors, dtype=np.float64), "u")
        return Surface(vertices, faces, reading.plain(WHITE), color=color, opacity=opacity)
    if visual.kind != "texture":
        return Surface(vertices, faces, reading.plain(GREY))
    fits = visual.uv is not None and np.shape(visual.uv) == (len(mesh.vertices), 2)
    return Surface(vertices, faces, _material(visual.material, fits, reading), np.array(visual.uv) if fits else None)


def _material(source: Any, has_uv: bool, reading: Reading) -> Material:
    """A material's base colour and picture."""
    if hasattr(source, "to_simple"):
        source = source.to_simple()
    image = getattr(source, "image", None)
    if image is None or getattr(image, "format", None) is None or not has_uv:  # trimesh's own stand-in has no format
        color = np.asarray(source.main_color)[:3] / 255.0
        return reading.plain((float(color[0]), float(color[1]), float(color[2])))
    picture = reading.pictures.of_image(id(image), "texture", image)
    return Material(reading.shading(), WHITE, None if picture is None else picture.color, specular=SPECULAR)

"""Load a scene by name or from a file."""

import difflib
import os
from pathlib import Path
from typing import Any

from refdof._check import InputError, as_choice, as_color, as_path
from refdof.scene.builtin import SCENES, built_in
from refdof.scene.limits import Limits
from refdof.scene.material import SHADINGS
from refdof.scene.scene import Scene

__all__ = ["load_scene"]


def load_scene(
    name: str | Path,
    shading: str | None = None,
    background: tuple[float, float, float] | None = None,
    limits: Limits = Limits(),
    file_camera: bool = True,
) -> Scene:
    """A built-in scene, or a mesh file: glTF, GLB, OBJ, PLY, OFF, STL and others.

    Parameters
    ----------
    name : str or Path
        One of `refdof.SCENES`, or a path.
    shading : "unlit", "lambert" or "phong", optional
        Replaces the scene's own; files are "lambert" by default.
    background : (3,) floats, optional
        Linear RGB of rays that meet nothing; replaces the scene's own.
    limits : Limits
        The most that reading a file may take.
    file_camera : bool
        False: suggest a shot even if a glTF file has a camera.

    Returns
    -------
    Scene
        With a suggested `.camera` and `.lens`.

    Raises
    ------
    InputError
        If there is neither such a scene nor such a file, or the file holds no usable triangles, needs
        what is not read, or asks for more than the limits allow.
    """
    path = as_path("scene", name)
    if shading is not None:
        as_choice("shading", shading, SHADINGS)
    if str(name) in SCENES:
        scene = built_in(str(name))
        if shading is not None:
            scene = scene.with_shading(shading)
        return scene if background is None else scene.with_background(as_color("background", background))
    if not path.suffix and not os.path.exists(path):
        near = difflib.get_close_matches(str(name), SCENES, n=1, cutoff=0.6)
        hint = f"did you mean {near[0]!r}? " if near else ""
        raise InputError(f"scene: got {str(name)!r}; {hint}allowed are {', '.join(SCENES)}, or a mesh file")
    from refdof.scene.mesh_file import load_mesh  # trimesh is slow to import

    words: dict[str, Any] = {} if background is None else {"background": background}
    return load_mesh(path, shading, limits=limits, file_camera=file_camera, **words)

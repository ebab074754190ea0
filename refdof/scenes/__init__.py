"""Built-in scenes: nine procedural worlds, each made to show one phenomenon of depth of field."""

from importlib import import_module

import numpy as np

from refdof._check import as_choice
from refdof.scene import Scene
from refdof.scenes.shot import Shot, read_shot

__all__ = ["SCENES", "built_in", "shot_of"]

SCENES: tuple[str, ...] = (
    "cans",
    "atrium",
    "fence",
    "branches",
    "lights",
    "mirrors",
    "foliage",
    "town",
    "figures",
)


def built_in(name: str) -> Scene:
    """Make a built-in scene; the same bits at every call.

    Raises
    ------
    InputError
        If there is no such scene, or its file in data/scenes is not as it should be.
    """
    shot = shot_of(name)
    module = import_module(f"refdof.scenes.{name}")
    parts = module.build(shot, np.random.default_rng(shot.seed))
    light = module.lit(shot) if hasattr(module, "lit") else shot.light
    return Scene.from_parts(name, list(parts), shot.camera, shot.lens, shot.background, light)


def shot_of(name: str) -> Shot:
    """What the scene's file says: title, phenomenon, figure, light, camera, lens and numbers.

    Raises
    ------
    InputError
        As `built_in`.
    """
    as_choice("scene", name, SCENES)
    return read_shot(name, import_module(f"refdof.scenes.{name}").NUMBERS)

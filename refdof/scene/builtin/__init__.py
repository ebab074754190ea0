"""Built-in scenes: procedural worlds, each made to show one phenomenon of depth of field.

A scene is a module (or a folder) here with `NUMBERS` and `build(shot, rng)`, and data/scenes/NAME.toml, its shot. It is
found by itself. Other modules are what scenes are made with. `make new-scene NAME=...` writes both files.
"""

from importlib import import_module
from pkgutil import iter_modules

import numpy as np

from refdof._check import as_choice
from refdof._jit import source_digest
from refdof._store import stored
from refdof.scene.kit.shot import Shot, read_shot, shot_places
from refdof.scene.scene import Scene

__all__ = ["SCENES", "built_in", "shot_of"]


def _found() -> tuple[str, ...]:
    """Modules of this folder that have a file of their name in data/scenes, in the order that the files state."""
    places = shot_places()
    modules = {found.name for found in iter_modules(__path__)}
    return tuple(sorted(modules & places.keys(), key=lambda name: (places[name], name)))


SCENES: tuple[str, ...] = _found()


def built_in(name: str) -> Scene:
    """A built-in scene, made or from the store; the same bits at every call.

    Raises
    ------
    InputError
        If there is no such scene, or its file in data/scenes is not as it should be.
    """
    shot = shot_of(name)
    return stored("scenes", (name, shot, source_digest("scene", "optics")), lambda: _made(name, shot))


def _made(name: str, shot: Shot) -> Scene:
    module = import_module(f"{__name__}.{name}")
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
    return read_shot(name, import_module(f"{__name__}.{name}").NUMBERS)

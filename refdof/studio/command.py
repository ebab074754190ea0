"""The command line that makes a page's picture once more."""

import math
import shlex

from refdof._check import InputError
from refdof.scene.scene import Scene
from refdof.studio.pictures import FINE_SAMPLES, settings_of_method
from refdof.studio.state import State

__all__ = ["command_of"]


def command_of(scene: Scene, name: str, state: State, focus_file: str, output: str = "picture.png") -> str:
    """`refdof render`, or `refdof focus` for another frame than the first, with all that the state says.

    Parameters
    ----------
    scene : Scene
        Camera options that it suggests itself are left out.
    name : str
        What the command calls the scene.
    focus_file : str
        Where the points are, if there are any.

    Raises
    ------
    InputError
        If something moves, the lens has no focus points and the frame is not 0: no command renders that.
    """
    lens, camera, own = state.lens, state.camera, scene.camera
    words = [name, "--method", state.method]
    for key, value in settings_of_method(state.method, FINE_SAMPLES).items():
        words += ["--set", f"{key}={value}"]
    words += ["--size", f"{camera.width}x{camera.height}", "--lens-radius", _shown(lens.radius)]
    for word in ("eye", "target", "up"):
        place = getattr(camera, word)
        if place != getattr(own, word):
            words.append(f"--{word}={','.join(_shown(value) for value in place)}")  # a minus sign is no option
    if camera.fov_y != own.fov_y and lens.kind != "file":
        words += ["--fov", _shown(camera.fov_y)]
    if lens.kind in ("thin", "file"):
        if state.frame != 0.0 and scene.frames is not None:
            raise InputError(
                f"frame: got {state.frame:g}; a command renders other frames than 0 with focus points only"
            )
        words += ["--focus", _shown(lens.focus)]
        if lens.kind == "file":
            words += ["--lens", lens.file]
            words += [] if lens.f_number is None else ["--f-number", _shown(lens.f_number)]
    elif state.frame == 0.0:
        words += ["--focus-points", focus_file]
    else:
        frame = round(state.frame)
        words += ["--points", focus_file, "--frames", f"{frame}:{frame + 1}", "--out", output.rpartition(".")[0]]
        suffix = output.rpartition(".")[2]
        return shlex.join(["refdof", "focus", *words, *([] if suffix == "png" else ["--format", suffix])])
    return shlex.join(["refdof", "render", *words, "-o", output])


def _shown(value: float) -> str:
    return "inf" if math.isinf(value) else repr(value)

"""Shot: what options of the command line choose of camera and lens, put over the shot that a scene suggests."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from refdof._check import InputError, as_pair
from refdof.focus.focus_file import load_focus
from refdof.focus.focus_lens import focus_lens
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens
from refdof.optics.systems.paraxial import entrance_pupil
from refdof.optics.systems.prescription import load_lens
from refdof.optics.systems.system_lens import SystemLens
from refdof.options import listed, refuse_ignored
from refdof.scene.limits import Limits
from refdof.scene.load import load_scene
from refdof.scene.scene import Scene
from refdof.view import View

__all__ = ["CameraChoice", "FileChoice", "LensChoice", "lens_of_points", "scene_camera_lens"]

_PLACES = ("eye", "target", "up")


@dataclass(frozen=True)
class CameraChoice:
    """What is said of the camera, in the words of the options; None is the scene's own."""

    size: str | None = None
    eye: str | None = None
    target: str | None = None
    up: str | None = None
    fov: float | None = None

    def parts(self) -> dict[str, Any]:
        """The fields of a `Camera` that are said."""
        found: dict[str, Any] = {} if self.size is None else {"size": _size(self.size)}
        said = {name: getattr(self, name) for name in _PLACES}
        found |= {name: _place(name, text) for name, text in said.items() if text is not None}
        return found if self.fov is None else found | {"fov_y": self.fov}


@dataclass(frozen=True)
class LensChoice:
    """What is said of the lens, as options have it; None is the scene's own, or the lens file's."""

    radius: float | None = None
    focus: float | None = None
    file: str | None = None
    f_number: float | None = None
    wavelengths: int | None = None
    no_vignetting: bool | None = None


@dataclass(frozen=True)
class FileChoice:
    """How a mesh file is read, as options have it."""

    limit: list[str] | None = None
    no_file_camera: bool | None = None

    def load(self, name: str) -> Scene:
        """The scene of a name or file."""
        return load_scene(name, limits=Limits().with_words(self.limit or []), file_camera=not self.no_file_camera)


def scene_camera_lens(
    name: str, camera: CameraChoice, lens: LensChoice = LensChoice(), file: FileChoice = FileChoice()
) -> tuple[Scene, Camera, ThinLens]:
    """Load a scene and put the options over its suggested shot.

    A lens system is scaled so that its entrance pupil, open as far as it goes, has the lens radius; it sets the field
    of view.

    Raises
    ------
    InputError
        If there is no such scene or lens, an option would be ignored, or its value is not allowed.
    """
    parts = camera.parts()
    if lens.file is None:
        given = {"f_number": lens.f_number, "wavelengths": lens.wavelengths, "no_vignetting": lens.no_vignetting}
        refuse_ignored("without --lens", "with it", **given)
    else:
        refuse_ignored("with --lens, which sets it", "without it", fov=camera.fov)
    system = None if lens.file is None else load_lens(lens.file)
    scene = file.load(name)
    try:
        seen = replace(scene.camera, **parts)
        thin = replace(
            scene.lens,
            radius=scene.lens.radius if lens.radius is None else lens.radius,
            focus_distance=scene.lens.focus_distance if lens.focus is None else lens.focus,
        )
        if system is None:
            return scene, seen, thin
        if thin.radius == 0.0:
            raise InputError("lens-radius: got 0 with --lens; allowed is a size to which the lens is scaled, above 0")
        scale = entrance_pupil(system).radius / thin.radius
        count = 3 if lens.wavelengths is None else lens.wavelengths
        real = SystemLens(system, thin.focus_distance, lens.f_number, scale, count, not lens.no_vignetting)
    except InputError as error:
        raise InputError(_by_option(str(error))) from None
    return scene, real.seen_by(seen), real


def lens_of_points(points: Path | None, scene: Scene, camera: Camera, lens: ThinLens, choice: LensChoice) -> ThinLens:
    """The lens that follows the focus points of a file; the lens itself without one. It calls kernels.

    Raises
    ------
    InputError
        If there is no such file, something in it is not allowed, or an option would be ignored.
    """
    if points is None:
        return lens
    refuse_ignored("with --focus-points, which set it", "without them", focus=choice.focus)
    refuse_ignored("with --focus-points, which need a thin lens", "without them", lens=choice.file)
    return focus_lens(load_focus(points), View(scene, camera, lens))


def _by_option(message: str) -> str:
    """An error of a camera or a lens, by the name of the option."""
    options = {"radius": "lens-radius", "focus_distance": "focus", "f_number": "f-number", "fov_y": "fov"}
    name, colon, rest = message.partition(":")
    return options.get(name, name) + colon + rest


def _size(text: str) -> tuple[int, int]:
    width, _, height = text.lower().partition("x")
    if not (width.isdigit() and height.isdigit()):
        raise InputError(f"size: got {text!r}; allowed is WIDTHxHEIGHT, such as 640x480")
    return as_pair("size", (width, height), minimum=1, maximum=32768)


def _place(name: str, text: str) -> tuple[float, ...]:
    try:
        place = tuple(float(word) for word in listed(text))
    except ValueError:
        place = ()
    if len(place) != 3:
        raise InputError(f"{name}: got {text!r}; allowed is X,Y,Z, three numbers")
    return place

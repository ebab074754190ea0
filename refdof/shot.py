"""Shot: what options of the command line choose of camera and lens, put over the shot that a scene suggests.

A field of view is said by --fov, or by --focal-length and --sensor. A lens radius is said by --lens-radius, or by
--f-number with --focal-length; with --sensor alone, the focal length follows from the field of view. Whatever says a
thing twice, or nothing, is refused.
"""

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from refdof._check import InputError, as_color, as_number
from refdof.focus.focus_file import load_focus
from refdof.focus.focus_lens import focus_lens
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens, photographic_share
from refdof.optics.systems.paraxial import entrance_pupil
from refdof.optics.systems.prescription import load_lens
from refdof.optics.systems.system_lens import SystemLens
from refdof.options import listed, metres_of, refuse_ignored
from refdof.scene.limits import Limits
from refdof.scene.load import load_scene
from refdof.scene.scene import Scene
from refdof.typed import as_typed
from refdof.view import View

__all__ = [
    "THIN",
    "CameraChoice",
    "LensChoice",
    "SceneChoice",
    "lens_of_points",
    "photographic_facts",
    "scene_camera_lens",
    "size_of",
]

THIN = ("f-number", "focal-length", "sensor")  # the options of a lens that a command without --lens has
_OPTIONS = {  # by arguments of a camera or a lens
    "radius": "lens-radius",
    "focus_distance": "focus",
    "f_number": "f-number",
    "fov_y": "fov",
    "focal_length": "focal-length",
}
_LARGEST_SIDE = 32768
_PLACES = ("eye", "target", "up")


@dataclass(frozen=True)
class SceneChoice:
    """What is said of surfaces, of what is behind them, and of how a mesh file is read; None is the scene's own."""

    shading: str | None = None
    background: str | None = None
    limit: list[str] | None = None
    no_file_camera: bool | None = None

    def load(self, name: str) -> Scene:
        """The scene of a name or file."""
        background = None if self.background is None else as_color("background", _three("background", self.background))
        limits = Limits().with_words(self.limit or [])
        return load_scene(name, self.shading, background, limits=limits, file_camera=not self.no_file_camera)


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
        found: dict[str, Any] = {} if self.size is None else {"size": size_of(self.size)}
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
    focal_length: float | None = None  # [mm]
    sensor: float | None = None  # height [mm]
    units: str | None = None
    known: tuple[str, ...] = ("lens", *THIN)  # options that the command has, which errors may name

    def metres(self) -> float:
        """How many metres a scene unit has."""
        return metres_of(self.units)

    def fov(self) -> float | None:
        """The field of view that focal length and sensor have, focused at infinity [degrees]."""
        if self.focal_length is None or self.sensor is None:
            return None
        fov = math.degrees(2.0 * math.atan(self.sensor / 2.0 / self.focal_length))
        if not 1e-6 <= fov <= 179.0:
            got = f"{self.focal_length:g} with --sensor {self.sensor:g}, a field of view of {fov:g} degrees"
            raise InputError(f"focal-length: got {got}; allowed are 1e-06 to 179")
        return fov

    def focal_mm(self, camera: Camera) -> float | None:
        """The focal length that is said, or that a sensor has with the camera's field of view [mm]."""
        if self.focal_length is not None or self.sensor is None:
            return self.focal_length
        return self.sensor / (2.0 * math.tan(math.radians(camera.fov_y) / 2.0))

    def thin(self, suggested: ThinLens, camera: Camera) -> ThinLens:
        """The thin lens that is said."""
        focus = suggested.focus_distance if self.focus is None else self.focus
        focal = self.focal_mm(camera)
        if self.f_number is None or self.file is not None or focal is None:
            radius = suggested.radius if self.radius is None else self.radius
            return replace(suggested, radius=radius, focus_distance=focus)
        return ThinLens.from_f_number(focal / 1000.0 / self.metres(), self.f_number, focus, suggested.aperture)

    def check(self, fov: float | None) -> None:
        """Raise if a number is not allowed, an option would be ignored, or two say one thing; fov: that of --fov."""
        self.metres()
        for name, value in {"focal-length": self.focal_length, "sensor": self.sensor}.items():
            if value is not None:
                as_number(name, value, above=0.0)
        if self.file is not None:
            refuse_ignored("with --lens, which sets it", "without it", fov=fov)
            own = "with --lens, which has its own"
            refuse_ignored(own, "without it", focal_length=self.focal_length, sensor=self.sensor)
            if self.units is not None:
                refuse_ignored("with --lens and --units, which set it", "without --units", lens_radius=self.radius)
            return
        refuse_ignored("without --lens", "with it", wavelengths=self.wavelengths, no_vignetting=self.no_vignetting)
        if self.focal_length is None and self.sensor is None:
            self._refuse_without("lens", "focal-length", "sensor", f_number=self.f_number)
        if self.f_number is None:
            self._refuse_without("f-number", "lens", units=self.units)
            if self.sensor is None:
                self._refuse_without("f-number", "sensor", focal_length=self.focal_length)
            if self.focal_length is None:
                self._refuse_without("f-number", "focal-length", sensor=self.sensor)
        else:
            refuse_ignored("with --f-number, which sets it", "without it", lens_radius=self.radius)
        if self.focal_length is not None and self.sensor is not None:
            refuse_ignored("with --focal-length and --sensor, which set it", "without one of them", fov=fov)

    def _refuse_without(self, *others: str, **option: Any) -> None:
        """Refuse an option that needs one of these others, of which those are named that the command has."""
        names = [f"--{name}" for name in others if name in self.known]
        words = " or ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)
        refuse_ignored(f"without {words}", "with it" if len(names) == 1 else "with one of them", **option)


def scene_camera_lens(
    name: str, camera: CameraChoice, lens: LensChoice = LensChoice(), choice: SceneChoice = SceneChoice()
) -> tuple[Scene, Camera, ThinLens]:
    """Load a scene and put the options over its suggested shot.

    A lens system is scaled so that its entrance pupil, open as far as it goes, has the lens radius, unless units are
    said; it sets the field of view.

    Raises
    ------
    InputError
        If there is no such scene or lens, an option would be ignored, or its value is not allowed.
    """
    parts = camera.parts()
    lens.check(camera.fov)
    fov = lens.fov()
    if fov is not None:
        parts["fov_y"] = fov
    system = None if lens.file is None else load_lens(lens.file)
    scene = choice.load(name)
    with as_typed(**_OPTIONS):
        seen = replace(scene.camera, **parts)
        thin = lens.thin(scene.lens, seen)
        if system is None:
            return scene, seen, thin
        if lens.units is not None:
            scale = 1000.0 * lens.metres()
        elif thin.radius == 0.0:
            raise InputError("lens-radius: got 0 with --lens; allowed is a size to which the lens is scaled, above 0")
        else:
            scale = entrance_pupil(system).radius / thin.radius
        count = 3 if lens.wavelengths is None else lens.wavelengths
        real = SystemLens(system, thin.focus_distance, lens.f_number, scale, count, not lens.no_vignetting)
    return scene, real.seen_by(seen), real


def photographic_facts(view: View, choice: LensChoice) -> dict[str, float]:
    """How circles of a thin lens that is said by an f-number compare with photographic ones; empty for others.

    The share is that of `refdof.optics.lens.photographic_share`.

    Raises
    ------
    InputError
        If the lens is focused within its focal length.
    """
    focal = choice.focal_mm(view.camera)
    if choice.f_number is None or focal is None or type(view.lens) is not ThinLens:
        return {}
    with as_typed(**_OPTIONS):
        share = photographic_share(focal / 1000.0 / choice.metres(), view.lens.focus_distance)
    return {
        "lens_radius": view.lens.radius,
        "focal_length_mm": round(focal, 6),
        "coc_over_photographic": round(share, 6),
    }


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


def size_of(text: str, name: str = "size") -> tuple[int, int]:
    """'WIDTHxHEIGHT' as two numbers; `name` is the option's."""
    width, _, height = text.lower().partition("x")
    if not all(side.isdecimal() and len(side) < 10 and 1 <= int(side) <= _LARGEST_SIDE for side in (width, height)):
        allowed = f"WIDTHxHEIGHT, such as 640x480, with sides of 1 to {_LARGEST_SIDE}"
        raise InputError(f"{name}: got {text!r:.80}; allowed is {allowed}")
    return int(width), int(height)


def _place(name: str, text: str) -> tuple[float, ...]:
    return _three(name, text, "X,Y,Z")


def _three(name: str, text: str, shape: str = "R,G,B") -> tuple[float, ...]:
    """Three numbers between commas."""
    try:
        place = tuple(float(word) for word in listed(text))
    except ValueError:
        place = ()
    if len(place) != 3:
        raise InputError(f"{name}: got {text!r}; allowed is {shape}, three numbers")
    return place

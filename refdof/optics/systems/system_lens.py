"""System lens: a lens system on a camera, focused. To methods that know thin lenses it is the thin lens of its pupil.

The film moves to focus; the camera's eye is the middle of the entrance pupil. What is said to be in focus is so in
yellow, at the d line.
"""

import math
from dataclasses import dataclass, field, replace

from refdof._check import InputError, as_bool, as_instance, as_number
from refdof.optics.aperture import Aperture
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens
from refdof.optics.systems.height_lens import HeightLens
from refdof.optics.systems.lens_map import LensMap, lens_map_of
from refdof.optics.systems.paraxial import entrance_pupil, image_scale, nearest_focus, sensor_for, stopped_down
from refdof.optics.systems.spectrum import wavelengths_of
from refdof.optics.systems.system import LensSystem

__all__ = ["FILM_HEIGHT", "SystemLens"]

FILM_HEIGHT = 24.0  # [mm], of the film that most lenses are made for


@dataclass(frozen=True, init=False)
class SystemLens(ThinLens):
    """A lens system, focused and stopped down.

    `radius` and `focus_distance` are of the thin lens with the same entrance pupil. Methods that trace rays take the
    system's own (`reference`, `accumulation`, `lensblur`); all others take the thin lens's circle of confusion.

    Parameters
    ----------
    system : LensSystem or HeightLens
    focus_distance : float
        From the entrance pupil to what is in focus near the axis [scene units], > 0; ``inf`` is allowed.
    f_number : float, optional
        Focal length over the entrance pupil's diameter; the lens's own if left out, or if it rounds to this.
    mm_per_unit : float
        How many of the prescription's millimetres a scene unit has: 1000 where the scene is in metres. Another number
        scales the lens.
    wavelengths : int
        At how many wavelengths a lens with dispersion is traced, 3 to 31; each takes as long as the whole picture of a
        lens without. 3: at 650, 510 and 475 nm for red, green and blue. More: over 400 to 700 nm, each weighed by the
        eye's response in linear Rec.709; some weights are below 0, and so may be pixels where colours come apart,
        since colours of the spectrum lie outside of Rec.709 (`refdof.optics.systems.spectrum`).
    vignetting : bool
        Whether all rims block light, as they do. False: only the stop's does, and the rim of a height lens.

    Raises
    ------
    InputError
        If the lens is not as fast as the f-number or cannot focus there, a number is out of range, or a glass is not
        transparent.
    """

    radius: float = field(init=False)
    focus_distance: float
    aperture: Aperture = field(init=False)
    system: LensSystem | HeightLens
    f_number: float | None
    mm_per_unit: float
    wavelengths: int
    vignetting: bool
    stopped: LensSystem = field(init=False)  # the system with the stop of the f-number; of a height lens, the paraxial

    def __init__(
        self,
        system: LensSystem | HeightLens,
        focus_distance: float,
        f_number: float | None = None,
        mm_per_unit: float = 1000.0,
        wavelengths: int = 3,
        vignetting: bool = True,
    ) -> None:
        given, system = system, system.paraxial if isinstance(system, HeightLens) else system
        as_instance("system", system, LensSystem)
        mm = as_number("mm_per_unit", mm_per_unit, above=0.0)
        focus_distance = as_number("focus_distance", focus_distance, above=0.0, finite=False)
        count, vignetting = len(wavelengths_of(wavelengths)), as_bool("vignetting", vignetting)
        if f_number is not None:
            f_number = as_number("f_number", f_number, above=0.0, maximum=1e4)
        try:
            stopped = system if f_number is None else stopped_down(system, f_number)
        except InputError as error:
            raise InputError(str(error).replace("f_stop:", "f_number:", 1)) from None
        pupil = entrance_pupil(stopped)
        if math.isinf(pupil.z):
            raise InputError(f"system: got {system.name!r}, whose entrance pupil is at infinity; allowed is another")
        nearest = nearest_focus(system)
        if not focus_distance * mm > nearest:
            allowed = f"more than {nearest / mm:.6g} scene units of {mm:g} mm"
            raise InputError(f"focus_distance: got {focus_distance:g}; allowed is {allowed}")
        sensor_for(system, focus_distance * mm)  # raises where there is no image behind the lens
        super().__init__(pupil.radius / mm, focus_distance)
        for name, value in {
            "system": given,
            "f_number": f_number,
            "mm_per_unit": mm,
            "wavelengths": count,
            "vignetting": vignetting,
            "stopped": stopped,
        }.items():
            object.__setattr__(self, name, value)
        self._disperses()  # raises where a glass is not transparent

    def seen_by(self, camera: Camera) -> Camera:
        """The camera with the field of view that a film of 24 mm height has at the distance in focus."""
        as_instance("camera", camera, Camera)
        half = FILM_HEIGHT / 2.0 / image_scale(self.stopped, self.focus_distance * self.mm_per_unit)
        return replace(camera, fov_y=math.degrees(2.0 * math.atan(half)))

    def map_of(self, camera: Camera, exponent: int = 0) -> LensMap:
        """The lens before a camera, for kernels: at its wavelengths, or one where its glass has no dispersion.

        Lengths in the scene are in 2^exponent scene units.
        """
        waves = wavelengths_of(self.wavelengths)
        lens: LensSystem | HeightLens = self.stopped
        if isinstance(self.system, HeightLens):
            lens = self.system.with_stop(self.stopped.surfaces[0].semi_diameter)
        made = lens_map_of(
            lens,
            camera,
            self.focus_distance,
            wavelengths_um=waves if self._disperses() else waves[1:2],
            millimetres=self.mm_per_unit,
            rims=self.vignetting,
        )
        return made._replace(scale=math.ldexp(made.scale, -exponent))

    def _disperses(self) -> bool:
        first, *others = (tuple(self.stopped.indices(wave)) for wave in wavelengths_of(self.wavelengths))
        return any(other != first for other in others)

"""refdof: a CPU reference implementation of depth-of-field rendering.

Conventions, everywhere:

- Camera space: x right, y up, looking down -z. Depth is the planar distance along the optical axis, > 0; inf is
  background.
- Images are (H, W, 3) float32, linear Rec.709 RGB, row 0 on top; pixel (x, y) is sampled at (x + 0.5, y + 0.5).
- Circle of confusion: signed radius in pixels, negative in front of the focal plane, positive behind it.
- A lens sample v (unit disc, x right, y up) sees a point of circle c displaced by +c v, y up.
"""

from importlib import import_module

TYPE_CHECKING = False  # typing takes as long to import as all else that the program does before it hears Ctrl-C
if TYPE_CHECKING:
    from refdof import cluster, metrics
    from refdof._check import InputError
    from refdof.filtering import filter_frame
    from refdof.frame.files import load_frame
    from refdof.frame.frame import Frame
    from refdof.methods import METHODS
    from refdof.optics.aperture import Aperture
    from refdof.optics.camera import Camera
    from refdof.optics.expressive_lens import ExpressiveLens
    from refdof.optics.lens import ThinLens
    from refdof.optics.lens_samples import lens_samples
    from refdof.optics.systems.height_lens import HeightLens
    from refdof.optics.systems.prescription import load_lens
    from refdof.optics.systems.system import LensSystem, ThickLens
    from refdof.optics.systems.system_lens import SystemLens
    from refdof.rendering import Result, render
    from refdof.scene.builtin import SCENES
    from refdof.scene.limits import Limits
    from refdof.scene.load import load_scene
    from refdof.scene.material import Light, Material
    from refdof.scene.scene import Part, Scene
    from refdof.stages import Stages
    from refdof.truth.forecast import Forecast, forecast
    from refdof.truth.reference import Reference, reference
    from refdof.view import View

__version__ = "0.1.0"

__all__ = [
    "METHODS",
    "SCENES",
    "Aperture",
    "Camera",
    "ExpressiveLens",
    "Forecast",
    "Frame",
    "HeightLens",
    "InputError",
    "LensSystem",
    "Light",
    "Limits",
    "Material",
    "Part",
    "Reference",
    "Result",
    "Scene",
    "Stages",
    "SystemLens",
    "ThickLens",
    "ThinLens",
    "View",
    "cluster",
    "filter_frame",
    "forecast",
    "lens_samples",
    "load_frame",
    "load_lens",
    "load_scene",
    "metrics",
    "reference",
    "render",
]

# Numba and Embree are slow to import: what nobody asks for, such as a command's help, does not wait for them.
_HOMES = {
    "Aperture": "optics.aperture",
    "Camera": "optics.camera",
    "ExpressiveLens": "optics.expressive_lens",
    "Forecast": "truth.forecast",
    "Frame": "frame.frame",
    "HeightLens": "optics.systems.height_lens",
    "InputError": "_check",
    "LensSystem": "optics.systems.system",
    "Light": "scene.material",
    "Limits": "scene.limits",
    "METHODS": "methods",
    "Material": "scene.material",
    "Part": "scene.scene",
    "Reference": "truth.reference",
    "Result": "rendering",
    "SCENES": "scene.builtin",
    "Scene": "scene.scene",
    "Stages": "stages",
    "SystemLens": "optics.systems.system_lens",
    "ThickLens": "optics.systems.system",
    "ThinLens": "optics.lens",
    "View": "view",
    "filter_frame": "filtering",
    "forecast": "truth.forecast",
    "lens_samples": "optics.lens_samples",
    "load_frame": "frame.files",
    "load_lens": "optics.systems.prescription",
    "load_scene": "scene.load",
    "reference": "truth.reference",
    "render": "rendering",
}


def __getattr__(name: str) -> object:
    if name in ("cluster", "methods", "metrics", "testing"):
        return import_module(f"refdof.{name}")
    if name not in _HOMES:
        raise AttributeError(f"module 'refdof' has no attribute {name!r}")
    globals()[name] = value = getattr(import_module(f"refdof.{_HOMES[name]}"), name)
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})

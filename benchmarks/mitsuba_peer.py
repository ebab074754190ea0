"""Mitsuba 3 as an independent renderer of the same picture: its own thin lens, samplers and ray tracer.

1. find LLVM and start Mitsuba                          `start`
2. hand over triangles, vertex colours, camera, lens    `new_peer`
3. render, with the compile time told apart             `render`

A scene must be unlit and without textures: every triangle shows its vertex colours.

References
----------
.. [1] Jakob et al. (2022), Mitsuba 3 renderer, https://mitsuba-renderer.org (the `thinlens` sensor).
"""

import ctypes.util
import os
import re
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import refdof

__all__ = ["FIRST_HIT", "Peer", "PeerMissing", "PeerPicture", "find_llvm", "new_peer", "render", "start"]

FIRST_HIT = "first_hit"  # our own integrator; any other name is a plugin of Mitsuba's, run to depth 1
_VARIANT = "llvm_ad_rgb"
_ATTRIBUTE = "vertex_color"
_LLVM_FOLDERS = (
    "/usr/lib/*-linux-gnu",
    "/usr/lib/llvm*/lib",
    "/usr/lib64",
    "/usr/lib",
    "/usr/local/lib",
    "/opt/homebrew/opt/llvm/lib",
    "/usr/local/opt/llvm/lib",
)


class PeerMissing(RuntimeError):
    """Mitsuba or its LLVM backend cannot be used here; the message says why."""


@dataclass(frozen=True, eq=False)
class Peer:
    """Mitsuba's scene and what is needed to make sensors for it."""

    mitsuba: Any
    scene: Any
    integrator: Any
    camera: refdof.Camera
    lens: refdof.ThinLens
    pixel_filter: str
    sampler: str


@dataclass(frozen=True, eq=False)
class PeerPicture:
    """A picture (H, W, 3) float32, the samples per pixel really spent, and seconds: wall, CPU, compiling."""

    image: np.ndarray
    samples: int
    seconds: float
    cpu_seconds: float
    compile_seconds: float


def find_llvm() -> str | None:
    """Path of the newest LLVM library: where ctypes finds one, then the usual folders. None: not found.

    Dr.Jit searches by itself; this also covers folders that it does not know.
    """
    named = ctypes.util.find_library("LLVM")
    paths = [Path(named)] if named and Path(named).is_absolute() else []
    for pattern in _LLVM_FOLDERS:
        folders = Path("/").glob(pattern.lstrip("/"))
        paths += [
            path for folder in folders for name in ("libLLVM*.so*", "libLLVM.dylib") for path in folder.glob(name)
        ]

    def version(path: Path) -> list[int]:
        return [int(number) for number in re.findall(r"\d+", path.name)]

    return str(max(paths, key=version)) if paths else None


def start(threads: int | None = None) -> Any:
    """The module `mitsuba`, ready to render on `threads` threads (None: all).

    Raises
    ------
    PeerMissing
        If Mitsuba is not installed or finds no LLVM. Set DRJIT_LIBLLVM_PATH to name one.
    """
    llvm = find_llvm()
    if llvm and not os.environ.get("DRJIT_LIBLLVM_PATH"):
        os.environ["DRJIT_LIBLLVM_PATH"] = llvm
    try:
        import drjit
        import mitsuba
    except ImportError as error:
        raise PeerMissing(f"Mitsuba is not installed ({error}); install refdof[peers]") from error
    try:
        mitsuba.set_variant(_VARIANT)
        drjit.eval(drjit.arange(mitsuba.Float, 2) + 1.0)
    except Exception as error:
        raise PeerMissing(f"Mitsuba cannot run {_VARIANT}: {error}; install LLVM") from error
    mitsuba.set_log_level(mitsuba.LogLevel.Error)
    if threads is not None:
        drjit.set_thread_count(threads)
    _register(mitsuba)
    return mitsuba


def new_peer(
    mitsuba: Any,
    scene: refdof.Scene,
    camera: refdof.Camera,
    lens: refdof.ThinLens,
    sampler: str = "independent",
    pixel_filter: str = "box",
    integrator: str = FIRST_HIT,
) -> Peer:
    """Hand a scene over; `pixel_filter` is as in `refdof.reference`.

    With a plugin of Mitsuba's as integrator every triangle is an area light, which shines to its front only (the
    side from which its corners run anticlockwise); with FIRST_HIT both sides show, as in refdof.
    """
    for material in scene.materials:
        plain = material.shading == "unlit" and material.texture is None
        if not plain or material.base_color != (1.0, 1.0, 1.0) or material.emission != (0.0, 0.0, 0.0):
            raise ValueError("every material must be unlit and white; colours belong to the vertices")
    words = {"type": integrator} if integrator == FIRST_HIT else {"type": integrator, "max_depth": 1}
    handed = {
        "type": "scene",
        "mesh": _mesh(mitsuba, scene),
        "background": {"type": "constant", "radiance": {"type": "rgb", "value": list(scene.background)}},
    }
    loaded = mitsuba.load_dict(handed)
    return Peer(mitsuba, loaded, mitsuba.load_dict(words), camera, lens, pixel_filter, sampler)


def render(peer: Peer, samples: int, seed: int) -> PeerPicture:
    """Render with `samples` per pixel; some samplers round up to what they can stratify."""
    import drjit

    sensor = _sensor(peer, samples)
    drjit.set_flag(drjit.JitFlag.KernelHistory, True)
    drjit.kernel_history_clear()
    start_wall, start_cpu = time.perf_counter(), time.process_time()
    image = np.array(peer.mitsuba.render(peer.scene, sensor=sensor, integrator=peer.integrator, seed=seed))
    cpu, wall = time.process_time() - start_cpu, time.perf_counter() - start_wall
    compiling = sum(k.get("codegen_time", 0.0) + k.get("backend_time", 0.0) for k in drjit.kernel_history()) / 1000.0
    return PeerPicture(image, sensor.sampler().sample_count(), wall - compiling, cpu - compiling, compiling)


def _mesh(mitsuba: Any, scene: refdof.Scene) -> Any:
    properties = mitsuba.Properties()
    properties["light"] = mitsuba.load_dict(
        {"type": "area", "radiance": {"type": "mesh_attribute", "name": _ATTRIBUTE}}
    )
    # Shading normals would decide which side of a triangle shines; the triangle itself should.
    properties["face_normals"] = True
    mesh = mitsuba.Mesh("mesh", len(scene.vertices), len(scene.faces), properties)
    mesh.add_attribute(_ATTRIBUTE, 3, scene.color.ravel())
    parameters = mitsuba.traverse(mesh)
    parameters["vertex_positions"] = scene.vertices.astype(np.float32).ravel()
    parameters["faces"] = scene.faces.astype(np.uint32).ravel()
    parameters.update()
    return mesh


def _sensor(peer: Peer, samples: int) -> Any:
    """Mitsuba's `thinlens` in the place of refdof's camera; `fov` is the vertical angle, lengths are the same."""
    camera, lens = peer.camera, peer.lens
    words = {
        # Both cameras have the picture's right at forward x up; Mitsuba only names its axes the other way round.
        "to_world": peer.mitsuba.ScalarTransform4f().look_at(camera.eye, camera.target, camera.up),
        "fov": camera.fov_y,
        "fov_axis": "y",
        "aperture_radius": lens.radius,
        "focus_distance": lens.focus_distance,
        "near_clip": 1e-4 * lens.focus_distance,
        "far_clip": 1e4 * lens.focus_distance,
        "film": {
            "type": "hdrfilm",
            "width": camera.width,
            "height": camera.height,
            "pixel_format": "rgb",
            "component_format": "float32",
            "rfilter": {"type": "box"},
        },
        "sampler": {"type": peer.sampler, "sample_count": samples},
    }
    return peer.mitsuba.load_dict({"type": "thinlens" if peer.pixel_filter == "box" else "centred_thinlens", **words})


def _register(mitsuba: Any) -> None:
    """Two plugins in Python; being traced, they run as fast as built-in ones."""
    import drjit

    class CentredThinLens(mitsuba.Sensor):
        """The `thinlens` sensor with every ray through its pixel's centre: an integral over the lens alone."""

        def __init__(self, properties: Any) -> None:
            words = {name: properties[name] for name in _LENS_WORDS}
            super().__init__(properties)
            transform = mitsuba.ScalarTransform4f(properties["to_world"].matrix)
            size = self.film().size()
            film = {
                "type": "hdrfilm",
                "width": int(size[0]),
                "height": int(size[1]),
                "rfilter": {"type": "box"},
            }
            self.lens = mitsuba.load_dict({"type": "thinlens", **words, "to_world": transform, "film": film})
            self.size = mitsuba.ScalarVector2f(size)

        def _centred(self, position: Any) -> Any:
            return (drjit.floor(position * self.size) + 0.5) / self.size

        def sample_ray(self, time, wavelength, position, aperture, active=True):
            return self.lens.sample_ray(time, wavelength, self._centred(position), aperture, active)

        def sample_ray_differential(self, time, wavelength, position, aperture, active=True):
            return self.lens.sample_ray_differential(time, wavelength, self._centred(position), aperture, active)

    class FirstHit(mitsuba.SamplingIntegrator):
        """The vertex colour of the first surface on a ray, or the background's: the least that a ray can do."""

        def sample(self, scene, sampler, ray, medium=None, active=True):
            flags = mitsuba.RayFlags.Minimal | mitsuba.RayFlags.UV
            hit = scene.ray_intersect(ray, flags, True, active)
            met = hit.is_valid()
            color = hit.shape.eval_attribute_3(_ATTRIBUTE, hit, active & met)
            beyond = scene.environment().eval(hit, active & ~met)
            return drjit.select(met, color, beyond), met, []

    mitsuba.register_sensor("centred_thinlens", CentredThinLens)
    mitsuba.register_integrator(FIRST_HIT, FirstHit)


_LENS_WORDS = ("fov", "fov_axis", "aperture_radius", "focus_distance", "near_clip", "far_clip")

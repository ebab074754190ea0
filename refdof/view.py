"""View: a scene through a camera and a lens, with every raster product that somebody asks for, made once.

Methods share the products of a comparison. The time of a product is booked as `prepare` to every method that
used it, whoever asked first; what nobody asks for is never made.
"""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float, Index, as_instance, as_integer
from refdof._jit import compilations
from refdof.optics.camera import Camera
from refdof.optics.expressive_lens import ExpressiveLens
from refdof.optics.lens import ThinLens
from refdof.optics.projection import Projection, projection_of
from refdof.optics.ray_map import RayMap
from refdof.optics.systems.system_lens import SystemLens
from refdof.raster.rays.embree import Tracer, new_tracer
from refdof.raster.rays.exact_layers import Layers, count_surfaces, exact_layers
from refdof.raster.rays.surfaces import Surfaces, surfaces_of
from refdof.raster.rays.umbra import umbra_step
from refdof.scene.scene import Scene

__all__ = ["Booking", "Pinhole", "Triangles", "View", "view_of"]

_WITHOUT_LENS = ("surfaces", "tracer", "triangles", "pinhole", "layers")  # products that no lens changes
_WITHOUT_SIZE = ("surfaces", "tracer", "triangles")  # nor the picture's size
_WITH_RADIUS = ("umbra layers", "surface counts", "lensblur")  # only its radius
_BEFORE_ALL = ("surfaces", "tracer", "ray map", "layers 1", "pinhole", "coc")  # what every method may start from
_SHARED = ("surfaces", "tracer", "triangles", "ray map", "pinhole", "coc")  # by many methods; small beside layers


class Pinhole(NamedTuple):
    """What a pinhole sees: color (H, W, 3) float32, linear RGB; depth (H, W) float64 [scene units], inf: background."""

    color: Float
    depth: Float


class Triangles(NamedTuple):
    """Triangles for a rasteriser: vertices (V, 3) float64 in camera space [scene units], faces (F, 3) int64."""

    vertices: Float
    faces: Index


@dataclass(eq=False)
class Booking:
    """The products used while it was open (seconds each took, without its ingredients), and the seconds spent on
    making some of them in that time.
    """

    used: dict[str, float] = field(default_factory=dict)
    spent: float = 0.0

    @property
    def prepare(self) -> float:
        """Seconds that all used products took when they were made."""
        return sum(self.used.values())

    @property
    def layers(self) -> float:
        """Those of products beyond the scene and the pinhole picture: layers, triangles for a rasteriser."""
        return sum(seconds for name, seconds in self.used.items() if name not in _BEFORE_ALL)


class View:
    """A scene, a camera and a lens, and the raster products made of them so far.

    With `times_warm_runs`, a product during whose making something was compiled is made once more, to time it.
    """

    def __init__(self, scene: Scene, camera: Camera, lens: ThinLens) -> None:
        for name, value, kind in (
            ("scene", scene, Scene),
            ("camera", camera, Camera),
            ("lens", lens, ThinLens),
        ):
            as_instance(name, value, kind)
        self.scene, self.camera, self.lens = scene, camera, lens
        self.times_warm_runs = False
        self._products: dict[str, tuple[Any, dict[str, float]]] = {}
        self._bookings: list[Booking] = []

    @contextmanager
    def booking(self) -> Iterator[Booking]:
        """Note the products used inside the block."""
        book = Booking()
        self._bookings.append(book)
        try:
            yield book
        finally:
            self._bookings.remove(book)

    def surfaces(self) -> Surfaces:
        """The scene as arrays for kernels."""
        return self.product("surfaces", lambda: surfaces_of(self.scene, self.camera))

    def tracer(self) -> Tracer:
        """Embree's acceleration structure in camera space."""

        def build() -> Tracer:
            surfaces = self.surfaces()
            vertices = np.ldexp(self.camera.camera_from_world(self.scene.vertices), -surfaces.exponent)
            return new_tracer(vertices, self.scene.faces, surfaces)

        return self.product("tracer", build)

    def projection(self) -> Projection:
        """Camera and lens for kernels."""
        return projection_of(self.camera, self.lens, self.surfaces().exponent)

    def ray_map(self) -> RayMap | None:
        """The lens's rays for kernels, in the unit of length of the surfaces; None is a plain thin lens."""

        def build() -> RayMap | None:
            lens, camera = self.lens, self.camera
            if isinstance(lens, SystemLens):
                return RayMap(lens.map_of(camera, self.surfaces().exponent), None)
            if isinstance(lens, ExpressiveLens):
                return RayMap(None, lens.map_of(camera, self.surfaces().exponent))
            return None

        return self.product("ray map", build)

    def pinhole(self) -> Pinhole:
        """Colour and depth through the pixel centres."""

        def build() -> Pinhole:
            first = self.layers(1)
            empty = first.triangle[0] < 0
            color = first.color[0].copy()
            color[empty] = self.scene.background
            return Pinhole(color, first.depth[0])

        return self.product("pinhole", build)

    def layers(self, count: int | None = None) -> Layers:
        """The nearest `count` surfaces through the pixel centres; None: all of them."""
        count = _as_count(count)

        def build() -> Layers:
            return exact_layers(self.surfaces(), self.tracer(), self.projection(), count)

        return self.product(f"layers {count or 'all'}", build)

    def seen_through(self) -> Layers | None:
        """All surfaces, for the colours of transparent ones; None: there is none."""
        return self.layers() if self.surfaces().blends else None

    def umbra_layers(self, count: int | None = None, extent_px: int = 2) -> Layers:
        """The nearest `count` surfaces that the lens can see past the ones before, `refdof.raster.rays.umbra`; None:
        all.
        """
        count, extent_px = _as_count(count), as_integer("extent_px", extent_px, minimum=1, maximum=2)

        def build() -> Layers:
            return exact_layers(self.surfaces(), self.tracer(), self.projection(), count, self._umbra_step(extent_px))

        return self.product(f"umbra layers {count or 'all'} extent {extent_px}", build)

    def surface_counts(self, extent_px: int = 0) -> Index:
        """How many surfaces lie at each pixel centre; with an extent of 1 or 2 px, how many umbra layers.

        Returns
        -------
        (H, W) int32
        """
        extent_px = as_integer("extent_px", extent_px, minimum=0, maximum=2)

        def build() -> Index:
            return count_surfaces(self.surfaces(), self.tracer(), self.projection(), self._umbra_step(extent_px))

        return self.product(f"surface counts extent {extent_px}", build)

    def _umbra_step(self, extent_px: int) -> float:
        """`umbra_step` in the unit of the surfaces; 0 for extent 0, inf where one surface hides all others."""
        if extent_px == 0:
            return 0.0
        with np.errstate(over="ignore"):
            return float(np.ldexp(umbra_step(self.camera, self.lens, extent_px), self.surfaces().exponent))

    def triangles(self) -> Triangles:
        """The triangles in camera space."""
        vertices = self.product("triangles", lambda: self.camera.camera_from_world(self.scene.vertices))
        return Triangles(vertices, self.scene.faces)

    def coc_px(self) -> Float:
        """Signed circle of confusion of the pinhole's depth: (H, W) float64 [px]."""
        return self.product("coc", lambda: self.lens.coc_px(self.pinhole().depth, self.camera))

    def with_lens(self, lens: ThinLens) -> "View":
        """The same scene and camera before another lens; products that the lens does not change are shared."""
        other = View(self.scene, self.camera, lens)
        kept: tuple[str, ...] = _WITHOUT_LENS
        if lens.radius == self.lens.radius and lens.aperture.reach == self.lens.aperture.reach:
            kept = (*kept, *_WITH_RADIUS)
        other.times_warm_runs = self.times_warm_runs
        other._products = {name: made for name, made in self._products.items() if name.startswith(kept)}
        return other

    def with_size(self, size: tuple[int, int]) -> "View":
        """The same scene, camera and lens at another size of the picture; what that does not change is shared."""
        other = View(self.scene, self.camera.with_size(size), self.lens)
        other.times_warm_runs = self.times_warm_runs
        other._products = {name: made for name, made in self._products.items() if name in _WITHOUT_SIZE}
        return other

    def at_frame(self, frame: float) -> "View":
        """The view of the scene at a frame of its animation: itself where nothing moves, or the scene is there.

        A camera that stands where the scene's does moves on with it.
        """
        scene, camera = self.scene.at_frame(frame), self.camera
        if scene is self.scene:
            return self
        before, after = self.scene.camera, scene.camera
        if (camera.eye, camera.target, camera.up) == (before.eye, before.target, before.up):
            camera = replace(camera, eye=after.eye, target=after.target, up=after.up)
        other = View(scene, camera, self.lens)
        other.times_warm_runs = self.times_warm_runs
        return other

    def forget_layers(self) -> None:
        """Make room: forget all products but those that many methods share. Who asks for one again gets a new one."""
        self._products = {name: made for name, made in self._products.items() if name in _SHARED}

    def product(self, name: str, build: Callable[[], Any]) -> Any:
        """The product `name`, made by `build` if it is not there yet. A method's own products are booked by this, too.

        The name must say all that `build` depends on besides the view.
        """
        if name not in self._products:
            before = compilations()
            with self.booking() as book:
                start = time.perf_counter()
                value = build()
                seconds = spent = time.perf_counter() - start - book.spent
            if self.times_warm_runs and compilations() != before:
                start = time.perf_counter()
                value = build()
                seconds = time.perf_counter() - start
                spent += seconds
            for other in self._bookings:
                other.spent += spent
            self._products[name] = value, {**book.used, name: seconds}
        value, used = self._products[name]
        for book in self._bookings:
            book.used.update(used)
        return value


def view_of(scene: Scene, camera: Camera | None = None, lens: ThinLens | None = None) -> View:
    """A view of `scene`; camera and lens default to the scene's suggested shot."""
    as_instance("scene", scene, Scene)
    return View(scene, scene.camera if camera is None else camera, scene.lens if lens is None else lens)


def _as_count(count: int | None) -> int | None:
    return None if count is None else as_integer("count", count, minimum=1)

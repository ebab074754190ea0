"""Frame: a picture made elsewhere with its depth, and a view of it for methods.

A frame has no triangles. What it has, its view gives to methods; who asks for more is told what is missing.
"""

from dataclasses import dataclass
from typing import NoReturn

import numpy as np

from refdof._check import Float, Index, InputError, as_color, as_depth, as_float, as_image, as_instance, as_integer
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens
from refdof.raster.rays.exact_layers import Layers
from refdof.raster.rays.surfaces import Surfaces
from refdof.raster.rays.umbra import survivors
from refdof.scene.scene import Scene
from refdof.view import Pinhole, Triangles, View

__all__ = ["Frame", "FrameView", "frame_camera"]

_PINHOLE = ThinLens(0.0, np.inf)


def frame_camera(fov_y: float, size: tuple[int, int]) -> Camera:
    """The camera of a frame, which stands at the origin.

    Parameters
    ----------
    fov_y : float
        Vertical field of view [degrees].
    size : (width, height)
        [px]

    Raises
    ------
    InputError
        If the angle or the size is not allowed.
    """
    return Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=fov_y, size=size)


@dataclass(frozen=True, eq=False)
class Frame:
    """A picture made elsewhere, with its depth, and the lens or the circles of confusion that shall blur it.

    Parameters
    ----------
    color : (H, W, 3)
        Linear RGB, what a pinhole sees; row 0 is the top row.
    depth : (H, W)
        Planar depth [scene units], > 0; inf is background. Of other kinds: `refdof.frame.depth_kinds.planar_depth`.
    camera : Camera
        Its size is the picture's; of the rest only its field of view counts.
    lens : ThinLens, optional
    coc : (H, W), optional
        Signed circle of confusion, a **radius** [px], negative in front of the focal plane; instead of a lens.
    layers : Layers, optional
        All surfaces of every pixel, front to back, for methods of layers.
    background : (r, g, b)
        Linear RGB of what methods of layers see behind all surfaces.
    name : str

    Raises
    ------
    InputError
        If shapes disagree, a value is not allowed, or there is not exactly one of lens and circles.
    """

    color: Float
    depth: Float
    camera: Camera
    lens: ThinLens | None = None
    coc: Float | None = None
    layers: Layers | None = None
    background: tuple[float, float, float] = (0.0, 0.0, 0.0)
    name: str = "frame"

    def __post_init__(self) -> None:
        camera = as_instance("camera", self.camera, Camera)
        shape = (camera.height, camera.width)
        as_instance("name", self.name, str)
        object.__setattr__(self, "background", as_color("background", self.background))
        object.__setattr__(self, "color", as_image("color", self.color, (*shape, 3), dtype=np.float32))
        object.__setattr__(self, "depth", as_depth(self.depth, shape, dtype=np.float64))
        if (self.lens is None) == (self.coc is None):
            got = "neither" if self.lens is None else "both"
            raise InputError(f"lens: got {got} lens and coc; allowed is one of the two")
        if self.lens is not None:
            as_instance("lens", self.lens, ThinLens)
        if self.coc is not None:
            object.__setattr__(self, "coc", as_float("coc", self.coc, shape, dtype=np.float64))
        if self.layers is not None:
            as_instance("layers", self.layers, Layers)

    def view(self) -> "FrameView":
        """What methods render."""
        return FrameView(self)


class FrameView(View):
    """A view whose products are a frame's."""

    def __init__(self, frame: Frame) -> None:
        lens = _PINHOLE if frame.lens is None else frame.lens
        super().__init__(Scene.from_parts(frame.name, [], frame.camera, lens, frame.background), frame.camera, lens)
        self.frame = frame

    def pinhole(self) -> Pinhole:
        """Its colour and depth."""
        return self.product("pinhole", lambda: Pinhole(self.frame.color, self.frame.depth))

    def coc_px(self) -> Float:
        """Its circles of confusion, or those of its depth."""
        given = self.frame.coc
        return super().coc_px() if given is None else self.product("coc", lambda: given)

    def layers(self, count: int | None = None) -> Layers:
        """Its nearest `count` surfaces; None: all of them."""
        return self._first("layers", self._all(), count)

    def umbra_layers(self, count: int | None = None, extent_px: int = 2) -> Layers:
        """The nearest `count` of its surfaces that the lens can see past the ones before; None: all."""
        whole = self._all()
        kept = self.product(f"survivors {extent_px}", lambda: self._survivors(whole, extent_px))
        return self._first(f"umbra layers {extent_px}", kept, count)

    def surface_counts(self, extent_px: int = 0) -> Index:
        """How many surfaces a pixel has, or how many the lens can see: (H, W) int32."""
        layers = self.umbra_layers(None, extent_px) if extent_px else self.layers()
        return (layers.triangle >= 0).sum(axis=0, dtype=np.int32)

    def triangles(self) -> Triangles:
        """None: raises."""
        self._missing("triangles")

    def tracer(self) -> NoReturn:
        """None: raises."""
        self._missing("triangles")

    def surfaces(self) -> Surfaces:
        """No triangle, for methods that only hand them on."""
        return super().surfaces()

    def _all(self) -> Layers:
        if self.frame.layers is None:
            self._missing("a deep file")
        return self.frame.layers

    def _survivors(self, layers: Layers, extent_px: int) -> Layers:
        kept = survivors(layers.depth, self.camera, self.lens, extent_px)
        if not len(kept):
            return layers
        place, empty = np.maximum(kept, 0), kept < 0
        return Layers(
            np.where(empty[..., None], np.float32(0.0), np.take_along_axis(layers.color, place[..., None], 0)),
            np.where(empty, np.inf, np.take_along_axis(layers.depth, place, 0)),
            np.zeros((*kept.shape, 3), np.float32),
            kept,
        )

    def _first(self, name: str, layers: Layers, count: int | None) -> Layers:
        """The first `count` of layers, and empty ones if there are not so many, as an opaque scene has them."""
        if count is None:
            return layers
        count = as_integer("count", count, minimum=1)

        def build() -> Layers:
            missing = max(0, min(count, len(layers.depth) + 1) - len(layers.depth))
            fill = (0.0, np.inf, 0.0, -1)
            return Layers(
                *(
                    np.concatenate([part[:count], np.full((missing, *part.shape[1:]), value, part.dtype)])
                    for part, value in zip(layers, fill, strict=True)
                )
            )

        return self.product(f"{name} {count}", build)

    def _missing(self, what: str) -> NoReturn:
        raise InputError(f"methods: the frame {self.frame.name!r} lacks {what}, which one needs; allowed is a scene")

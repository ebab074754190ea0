"""What a comparison holds: one scene, its reference, and one row per method."""

import math
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from refdof._check import Float, Index
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens

__all__ = ["Box", "Chart", "Comparison", "Motion", "Row"]


@dataclass(frozen=True)
class Box:
    """A window of pixels: left column x, top row y."""

    x: int
    y: int
    width: int
    height: int

    def of(self, image: Any) -> Any:
        """The part of `image` inside the window."""
        return image[self.y : self.y + self.height, self.x : self.x + self.width]


@dataclass(frozen=True, eq=False)
class Row:
    """One method's picture and scores against the reference.

    Attributes
    ----------
    image : (H, W, 3) float32, linear RGB
    scores : by name, see `refdof.metrics.METRICS`
    artefacts : by name, see `refdof.metrics.artefacts.LOCATED`; empty without a reference
    prepare_s, blur_s : seconds of a warm run spent on raster products, and of the method itself, the median
    preset : one of `refdof.rendering.PRESETS`, what parameters have that were not given
    runs : how many warm runs were timed
    spread_s : the longest `blur_s` of them minus the shortest; NaN of a single one
    flip_map : (H, W) float32, FLIP of each pixel; None where there is no reference
    """

    method: str
    params: dict[str, Any]
    image: Float
    scores: dict[str, float]
    prepare_s: float
    blur_s: float
    preset: str = "best"
    runs: int = 1
    spread_s: float = math.nan
    artefacts: dict[str, float] = field(default_factory=dict)
    flip_map: Float | None = None

    @property
    def name(self) -> str:
        """The method, and its preset unless that is the best one."""
        return self.method if self.preset == "best" else f"{self.method} ({self.preset})"


@dataclass(frozen=True, eq=False)
class Chart:
    """A chart in the plane in focus, seen through a real lens; see `refdof.scene.lens_chart`.

    Attributes
    ----------
    pictures : {name: (h, w, 3) float32}, linear RGB
        "reference", "reference, thin lens", and each row's name; from the picture's middle to its corner.
    """

    pictures: dict[str, Float]

    caption: ClassVar[str] = (
        "Lens chart: squares and small stars in the plane in focus, from the picture's middle (left) to its corner "
        "(right), twice as large. A thin lens has them sharp everywhere; where the field is curved, they blur outwards."
    )


@dataclass(frozen=True, eq=False)
class Motion:
    """Frames of a camera that moves on by a part of a pixel each; see `refdof.motion`.

    Names are "reference" and each row's.

    Attributes
    ----------
    step_px : how far the focal plane moves per frame [px]
    samples : mean lens samples per pixel of one of the reference's two pictures of each frame
    flicker : {name: float}, the reference's own, and each row's beyond that; NaN where no pixel is out of focus
    pictures : {name: (N, h, w, 3) uint8}, display images
    row : the row of pixels in which the reference's blurred pixels change most
    strips : {name: (N, w, 3) float32}, linear RGB of that row
    """

    step_px: float
    samples: int
    flicker: dict[str, float]
    pictures: dict[str, npt.NDArray[np.uint8]]
    row: int
    strips: dict[str, Float]

    @property
    def frames(self) -> int:
        """Their number."""
        return len(self.pictures["reference"])

    @property
    def size(self) -> tuple[int, int]:
        """Width and height [px]."""
        height, width = self.pictures["reference"].shape[1:3]
        return width, height


@dataclass(frozen=True, eq=False)
class Comparison:
    """Every method beside the reference, on one scene.

    Attributes
    ----------
    lens : None where circles of confusion were given instead
    pinhole : (H, W, 3) float32, linear RGB
    reference, standard_error : the same, or None where there is none; without a reference, rows have no scores
    samples, seconds : mean lens samples per pixel of the reference; NaN of one made elsewhere
    noise_floor_psnr : above this PSNR [dB] a score measures the reference's own noise; NaN: unknown
    kept : whether the reference, and its `seconds`, are of an earlier run of the same
    chart : of a real lens
    depth : (H, W) float64, of the pinhole picture [scene units]; inf is background
    coc_px : (H, W) float64, its signed circle of confusion, a radius [px]
    surface_counts : (H, W) int, surfaces at each pixel's centre; None where they are not known, as the two above
    crops : what a report shows enlarged; none: it chooses two
    motion : frames of a slow move, whose `flicker` the rows have among their artefacts; None: not made
    """

    scene: str
    camera: Camera
    lens: ThinLens | None
    pinhole: Float
    reference: Float | None
    standard_error: Float | None
    samples: float
    seconds: float
    noise_floor_psnr: float
    rows: tuple[Row, ...]
    kept: bool = False
    chart: Chart | None = None
    depth: Float | None = None
    coc_px: Float | None = None
    surface_counts: Index | None = None
    crops: tuple[Box, ...] = ()
    motion: Motion | None = None

    @property
    def standard(self) -> tuple[str, Float]:
        """Name and picture of what methods stand beside: the reference, or without one the pinhole's."""
        return ("pinhole", self.pinhole) if self.reference is None else ("reference", self.reference)

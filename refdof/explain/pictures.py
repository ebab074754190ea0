"""Pictures: what a single-image method is given, in the place of a view, so that its colours can be changed."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from refdof._check import Float
from refdof.methods import METHODS
from refdof.methods._image_validation import as_images
from refdof.stages import StageRecorder, Stages
from refdof.view import Pinhole, View

__all__ = ["Pictures", "given_pictures", "pictures_of", "run"]


@dataclass(frozen=True, eq=False)
class Pictures:
    """A pinhole picture with its depth and its circles of confusion.

    Attributes
    ----------
    color : (H, W, 3) linear RGB
    depth : (H, W)
        Planar depth, > 0; inf is background.
    coc : (H, W)
        Signed circle of confusion, radius [px].
    coc_scale, focus : float or None
        The thin lens whose circles they are, coc_scale (1 / focus - 1 / depth); None: not known.
    """

    color: Float
    depth: Float
    coc: Float
    coc_scale: float | None = None
    focus: float | None = None

    @property
    def size(self) -> tuple[int, int]:
        """Width and height [px]."""
        return self.coc.shape[1], self.coc.shape[0]

    def pinhole(self) -> Pinhole:
        """As `View.pinhole`."""
        return Pinhole(self.color, self.depth)

    def coc_px(self) -> Float:
        """As `View.coc_px`."""
        return self.coc

    def with_color(self, color: Float) -> "Pictures":
        """The same with other colours."""
        return replace(self, color=color)


def pictures_of(view: View) -> Pictures:
    """What single-image methods are given of a view."""
    pinhole, lens, camera = view.pinhole(), view.lens, view.camera
    scale = float(camera.pixels_per_tangent * lens.radius)
    return Pictures(pinhole.color, pinhole.depth, view.coc_px(), scale, float(lens.focus_distance))


def given_pictures(
    color: Float, depth: Float, coc: Float, coc_scale: float | None = None, focus: float | None = None
) -> Pictures:
    """Arrays of your own, in float32.

    Raises
    ------
    InputError
        If shapes disagree, an array is empty, a value is NaN, a colour or circle is infinite, or a depth is not
        above 0.
    """
    return Pictures(*as_images(np.asarray(color, dtype=np.float32), depth, coc), coc_scale, focus)


def run(
    method: str, given: Pictures | View, params: Any, stages: bool | Stages = False
) -> tuple[Float, dict[str, Any]]:
    """The method's picture (H, W, 3) and its stages."""
    recorder = StageRecorder(stages)
    image = METHODS[method].render(given, params, recorder)
    return image, recorder.stages

"""Maps: where in a picture each artefact of depth of field can show, from depth and signed circle alone.

A pixel is in focus if its circle has a radius of at most half a pixel: the disc lies within the pixel.

A depth edge lies between two neighbours whose signed circles differ by more than half a pixel. Seen from the rim of
the lens, a nearer surface moves against a farther one by just that difference: less shows nothing hidden. Circles of a
plane are affine over the picture, so a steep plane has no edge: the jump must also exceed the slope on either side by
half a pixel.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from refdof._check import Float, as_depth, as_float, as_image, as_map
from refdof.metrics.artefacts.reach import within

__all__ = ["FOCUS_PX", "ArtefactMaps", "Edges", "Mask"]

Mask: TypeAlias = npt.NDArray[np.bool_]

FOCUS_PX = 0.5  # circles up to this are in focus, jumps up to this are no edge
_TAILS = 2.0  # circles: a Gaussian of a disc's RMS radius has 0.03 % of its light beyond
_NOISE_WINDOW = 5  # px: 25 error bars of 4 estimates have 75 degrees of freedom, an own error of 8 %


class Edges(NamedTuple):
    """Neighbours along the first axis: pair k is of pixels k and k + 1.

    edge : bool
        A depth edge lies between them.
    near : float
        Signed circle of the nearer one [px].
    wide : float
        The larger radius of both [px].
    """

    edge: Mask
    near: Float
    wide: Float


@dataclass(frozen=True, eq=False)
class ArtefactMaps:
    """Depth and circles of a picture, and the masks that follow from them, made when they are asked for.

    Parameters
    ----------
    depth : (H, W)
        Planar depth of the nearest surface [any unit], > 0; inf is background.
    coc : (H, W)
        Signed circle of confusion, **radius** [px]: negative in front of the focal plane.
    color : (H, W, 3), optional
        What a pinhole sees, linear RGB. Without it, no lamps are found.
    standard_error : (H, W, 3), optional
        Of the reference. Without it, the reference has no noise.

    Raises
    ------
    InputError
        If shapes disagree, an array is empty, a value is NaN, a circle is infinite, or a depth is not above 0.
    """

    depth: Any
    coc: Any
    color: Any = None
    standard_error: Any = None

    def __post_init__(self) -> None:
        coc = as_float("coc", as_map("coc", self.coc, (None, None)), (None, None), dtype=np.float64)
        height, width = coc.shape
        far = 2.0 * (height + width)  # reaches the whole picture from anywhere in it
        object.__setattr__(self, "coc", np.clip(coc, -far, far))
        object.__setattr__(self, "depth", as_depth(self.depth, coc.shape, dtype=np.float64))
        if self.color is not None:
            object.__setattr__(self, "color", as_image("color", self.color, (height, width, 3), dtype=np.float64))
        if self.standard_error is not None:
            error = as_image("standard_error", self.standard_error, (height, width, 3), dtype=np.float64, minimum=0.0)
            object.__setattr__(self, "standard_error", error)

    @cached_property
    def in_focus(self) -> Mask:
        """Pixels with |coc| <= `FOCUS_PX`: (H, W)."""
        return np.asarray(np.abs(self.coc) <= FOCUS_PX)

    @cached_property
    def in_front(self) -> Mask:
        """Pixels with coc < -`FOCUS_PX`: (H, W)."""
        return np.asarray(self.coc < -FOCUS_PX)

    @cached_property
    def behind(self) -> Mask:
        """Pixels with coc > `FOCUS_PX`: (H, W)."""
        return np.asarray(self.coc > FOCUS_PX)

    @cached_property
    def edges(self) -> tuple[Edges, Edges]:
        """Depth edges between rows, and, of the transposed picture, between columns."""
        return _edges(self.depth, self.coc), _edges(self.depth.T, self.coc.T)

    @cached_property
    def foreground(self) -> tuple[Mask, Mask]:
        """Depth edges, as in `edges`, whose nearer side is in front of focus."""
        rows, columns = (found.edge & (found.near < -FOCUS_PX) for found in self.edges)
        return rows, columns

    @cached_property
    def occlusion(self) -> Mask:
        """The band around depth edges, to both sides, as wide as the circle of the nearer surface: (H, W).

        There, that surface is seen by a part of the lens only.
        """
        rows, columns = self.edges  # an edge is half a pixel from the centres beside it
        return within(self._beside_edges(np.abs(rows.near) - 0.5, np.abs(columns.near) - 0.5))

    @cached_property
    def sharp(self) -> Mask:
        """Pixels in focus beyond the discs of all pixels in front of focus, and one pixel more: (H, W).

        No blur belongs there. What lies outside of the picture, and may blur into it, is not known.
        """
        return self.in_focus & ~within(np.where(self.in_front, np.abs(self.coc) + 1.0, 0.0))

    @cached_property
    def continuous(self) -> Mask:
        """Pixels out of focus with no depth edge within twice their circle, or twice those beside the edge: (H, W)."""
        rows, columns = self.edges
        disturbed = within(self._beside_edges(_TAILS * rows.wide, _TAILS * columns.wide))
        return np.asarray(~(self.in_focus | disturbed) & (self._edge_distance() >= _TAILS * np.abs(self.coc)))

    @cached_property
    def noise(self) -> Float:
        """Standard error of the mean of the three channels: (H, W).

        It is the root mean square over 5 x 5 pixels, since few estimates make an unsteady error bar. Errors of the
        channels are taken for one and the same, which is the worst case.
        """
        from scipy.ndimage import uniform_filter  # slow to import

        if self.standard_error is None:
            return np.zeros_like(self.coc)
        square = uniform_filter(self.standard_error.mean(axis=2) ** 2, _NOISE_WINDOW)
        return np.asarray(np.sqrt(np.maximum(square, 0.0)))  # its running sums round

    def _edge_distance(self) -> Float:
        """From each pixel to the next one beside a depth edge: (H, W) [px]; inf if there is none."""
        from scipy.ndimage import distance_transform_edt  # slow to import

        beside = self._beside_edges(*(np.ones_like(found.near) for found in self.edges)) > 0.0
        return np.asarray(distance_transform_edt(~beside) if beside.any() else np.full(beside.shape, np.inf))

    def _beside_edges(self, rows: Float, columns: Float) -> Float:
        """The largest value that a pixel's edges have: (H, W); 0 where it has none. Values: as `edges`."""
        found = np.zeros_like(self.coc)
        for seen, edges, value in zip((found, found.T), self.edges, (rows, columns), strict=True):
            spread = np.where(edges.edge, value, 0.0)
            np.maximum(seen[1:], spread, out=seen[1:])
            np.maximum(seen[:-1], spread, out=seen[:-1])
        return np.asarray(found)


def _edges(depth: Float, coc: Float) -> Edges:
    jump, none = np.diff(coc, axis=0), np.zeros_like(coc[:1])
    before, after = np.concatenate([none, jump])[:-1], np.concatenate([jump, none])[1:]
    beyond = np.minimum(np.abs(jump - before), np.abs(jump - after))
    edge = (np.abs(jump) > FOCUS_PX) & (beyond > FOCUS_PX)
    near = np.where(depth[1:] < depth[:-1], coc[1:], coc[:-1])
    return Edges(edge, near, np.maximum(np.abs(coc[1:]), np.abs(coc[:-1])))

"""Artefact metrics: where an image differs from its reference, and in which way.

`ARTEFACTS` is the registry of what pictures show, `KERNEL_FACTS` of what one small light shows of a method, and
`MOTION_FACTS` of what a slow move shows. `LOCATED` has all: columns of tables and fields of JSON and CSV follow from
it, in its order. All are of linear values. docs/metrics.md tells formulas, good values and limits.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from refdof._check import as_instance
from refdof._jit import run_tasks
from refdof.metrics._pair import linear
from refdof.metrics.artefacts.excess import boundary_step, circle_range, leakage, neighbour_range, ringing
from refdof.metrics.artefacts.flicker import flicker
from refdof.metrics.artefacts.lamps import bokeh, lamps
from refdof.metrics.artefacts.maps import ArtefactMaps
from refdof.metrics.artefacts.moments import Moments, disc_radius, moments
from refdof.metrics.artefacts.regions import region_rmse

__all__ = [
    "ARTEFACTS",
    "KERNEL_FACTS",
    "LOCATED",
    "MOTION_FACTS",
    "Artefact",
    "ArtefactMaps",
    "Moments",
    "artefacts",
    "artefacts_of_many",
    "disc_radius",
    "flicker",
    "moments",
]


@dataclass(frozen=True)
class Artefact:
    """One artefact metric; its name is its key in `LOCATED`.

    Attributes
    ----------
    heading : heading of its column
    best : the value of a perfect picture; NaN where there is none
    decimals : digits after the point in a table
    note : what it measures, in a few words
    """

    heading: str
    best: float
    decimals: int
    note: str


ARTEFACTS: dict[str, Artefact] = {
    "rmse_in_focus": Artefact("in focus", 0.0, 5, "RMSE where the circle is 0.5 px or less"),
    "rmse_in_front": Artefact("in front", 0.0, 5, "RMSE in front of that"),
    "rmse_behind": Artefact("behind", 0.0, 5, "RMSE behind it"),
    "rmse_occlusion": Artefact("occlusion", 0.0, 5, "RMSE around depth edges, as far as the nearer side blurs"),
    "leakage": Artefact("leakage", 0.0, 5, "mean light in sharp regions that has no source within a pixel"),
    "leakage_worst": Artefact("worst leak", 0.0, 3, "the largest of it, light or darkness"),
    "boundary_step": Artefact("step", 0.0, 3, "largest step at foreground boundaries beyond the reference's"),
    "ringing": Artefact("ringing", 0.0, 5, "RMS over- and undershoot on continuous surfaces"),
    "lamps": Artefact("lamps", math.nan, 0, "isolated lamps out of focus, whose median spot the rest is of"),
    "bokeh_offset": Artefact("lamp offset [px]", 0.0, 2, "distance of a lamp's centroid from the reference's"),
    "bokeh_radius": Artefact("lamp radius", 1.0, 3, "its RMS radius over the reference's"),
    "bokeh_anisotropy": Artefact("lamp anisotropy", 0.0, 3, "its anisotropy minus the reference's"),
    "bokeh_energy": Artefact("lamp energy", 1.0, 3, "its light over the reference's"),
}

KERNEL_FACTS: dict[str, Artefact] = {
    "kernel_radius": Artefact("kernel radius / disc", 1.0, 3, "RMS radius of what a point becomes, circle 8 px"),
    "light_energy": Artefact("light of 1 px", 1.0, 3, "energy of a light of one pixel there over its own"),
}

MOTION_FACTS: dict[str, Artefact] = {
    "flicker": Artefact("flicker", 0.0, 5, "with --motion: mean size of second differences, beyond the reference's"),
}

LOCATED: dict[str, Artefact] = {**ARTEFACTS, **KERNEL_FACTS, **MOTION_FACTS}


def artefacts(maps: ArtefactMaps, reference: Any, image: Any) -> dict[str, float]:
    """Every artefact metric of `image` against `reference`.

    Parameters
    ----------
    maps : ArtefactMaps
        Of the same pixels.
    reference, image : (H, W, 3)
        Linear RGB.

    Returns
    -------
    dict
        A number for every name in `ARTEFACTS`; NaN where the picture has no such pixels.

    Raises
    ------
    InputError
        If shapes differ, or a value is not finite.
    """
    return _scorer(maps, reference)(image)


def artefacts_of_many(
    maps: ArtefactMaps,
    reference: Any,
    images: Sequence[Any],
    progress: Callable[[int, int], None] | None = None,
) -> list[dict[str, float]]:
    """`artefacts` of every image, beside each other; `progress(done, all)` is called between."""
    return run_tasks(_scorer(maps, reference), images, progress)


def _scorer(maps: ArtefactMaps, reference: Any) -> Callable[[Any], dict[str, float]]:
    """`artefacts` for any image, with what depends on the reference alone made once."""
    as_instance("maps", maps, ArtefactMaps)
    first = linear("reference", reference, (*maps.coc.shape, 3))
    grey = first.mean(axis=2)
    near, wide, found = neighbour_range(maps, grey), circle_range(maps, grey), lamps(maps)
    regions = {
        "rmse_in_focus": maps.in_focus,
        "rmse_in_front": maps.in_front,
        "rmse_behind": maps.behind,
        "rmse_occlusion": maps.occlusion,
    }

    def scores(image: Any) -> dict[str, float]:
        second = linear("image", image, first.shape)
        seen, error = second.mean(axis=2), second - first
        leak, worst = leakage(maps, near, seen)
        return {
            **{name: region_rmse(error, maps.standard_error, region) for name, region in regions.items()},
            "leakage": leak,
            "leakage_worst": worst,
            "boundary_step": boundary_step(maps, grey, seen),
            "ringing": ringing(maps, wide, seen),
            **bokeh(found, first, second),
        }

    return scores

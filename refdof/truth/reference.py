"""The reference: thin-lens pictures by ray casting, with an error bar at every pixel.

1. Split the picture into tiles; a tile's rays are made, traced and shaded at once   `refdof.truth.lens_rays`
2. Estimate every pixel R times with independent scrambles of one net                `refdof.optics.owen_sobol`
3. The mean is the picture; the spread of the R estimates is its error                `refdof.truth.error_bar`
4. With a tolerance, double the net of the pixels whose error is too large            `refdof.truth.tile_sampler`

Only the replicates are independent, so only they enter the error bar: the points inside one net repel each
other and their own variance says nothing about the error.

References
----------
.. [1] Cook, Porter & Carpenter (1984), Distributed Ray Tracing, SIGGRAPH.
.. [2] Haeberli & Akeley (1990), The Accumulation Buffer, SIGGRAPH.
.. [3] Owen (1997), Scrambled Net Variance for Integrals of Smooth Functions, Annals of Statistics 25(4).
"""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from refdof._check import Float, Index, as_bool, as_choice, as_function, as_instance, as_integer, as_number
from refdof.cluster import Cluster
from refdof.image.noise_floor import LEAST_GROUPS, floor_of_moments
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens
from refdof.optics.owen_sobol import MAX_LOG2
from refdof.scene.scene import Scene
from refdof.truth.tile_sampler import Spend, corners_of, power_of_two
from refdof.truth.tile_tasks import Tile, TileWork, for_each_tile
from refdof.view import View, view_of

__all__ = [
    "MAX_SAMPLES",
    "PIXEL_FILTERS",
    "REPLICATES",
    "STEADY_REPLICATES",
    "Reference",
    "as_most",
    "as_seed",
    "reference",
    "reference_of_view",
    "samples_taken",
]

PIXEL_FILTERS = ("centre", "box")
REPLICATES = 4  # nets of 64 points or more: fewer have no error bar that can be trusted, more make a worse picture
STEADY_REPLICATES = 16  # where fewer points miss a lamp, and with a tolerance, which rests on bars of single pixels
_LARGE_NET = 64
MAX_SAMPLES = 4096  # per pixel, where a tolerance is not met before
_MOST_REPLICATES = 4096


@dataclass(frozen=True, eq=False)
class Reference:
    """A reference picture and how far to trust it.

    Attributes
    ----------
    image, standard_error : (H, W, 3) float32
        Linear RGB, and the standard error of each value.
    low, high : (H, W, 3) float32
        A 95 % interval of each value. On blurred pixels of edges, slits and random cards it holds the truth in 94 to
        99 % of all cases at 16, 64, 256 and 1024 samples; `image` +- Student's quantile of `standard_error` alone does
        so in 65 to 83 % at 16, 85 to 91 % at 64, 92 to 95 % at 256 and 94 to 95 % at 1024 samples
        (`benchmarks/coverage.py`).
        Many pixels are counted together: one whose value is near a whole number of a net's points may do worse (86 %
        was seen).
    samples : (H, W) int64
        Lens samples spent on each pixel.
    seconds : float
    noise_floor_psnr : float
        PSNR [dB] that a perfect picture would score against this one: above it a comparison means nothing; inf without
        noise.
    unmet : float
        Share of pixels, 0 .. 1, that stopped at `max_samples` above the tolerance.
    """

    image: Float
    standard_error: Float
    low: Float
    high: Float
    samples: Index
    seconds: float
    noise_floor_psnr: float = math.inf
    unmet: float = 0.0


def reference(
    scene: Scene,
    camera: Camera | None = None,
    lens: ThinLens | None = None,
    samples: int = 1024,
    replicates: int | None = None,
    seed: int = 0,
    tolerance: float | None = None,
    pixel_filter: str = "centre",
    shared_pattern: bool = False,
    progress: Callable[[int, int], None] | None = None,
    max_samples: int = MAX_SAMPLES,
    cluster: Cluster | None = None,
) -> Reference:
    """Render the truth.

    Parameters
    ----------
    scene, camera, lens
        Camera and lens default to the scene's suggested shot.
    samples : int
        Lens samples per pixel in all; rounded up to `replicates` times a power of two, where nets are balanced.
    replicates : int, optional
        Independent estimates, 4 .. 4096: more make the error bar steadier and the picture worse, by the fourth root of
        their number. By default 4; 16 for fewer than 256 samples, where small nets miss lamps, and for a tolerance,
        which rests on the error bars of single pixels.
    seed : int
        0 .. 2^32 - 1. Another seed gives an independent picture.
    tolerance : float, optional
        Instead of `samples`: sample every pixel until the standard error of each channel is below
        tolerance * max(1, b), b its brightest channel, or until `max_samples`. Stopping early favours estimates that
        happen to agree, so such a picture is biased by a fraction of the tolerance. `refdof.forecast` tells the cost.
    pixel_filter : "centre" or "box"
        Sample pixels at their centres, as image-based methods do (no anti-aliasing), or over their area.
    shared_pattern : bool
        One lens pattern for all pixels, as an accumulation buffer has [2], instead of one per pixel [1]. The
        error is then the same in size but shows as ghost edges rather than as noise.
    progress : callable, optional
        Called with (tiles done, tiles).
    max_samples : int
        Lens samples at which a pixel stops although it is above the tolerance, 16 .. 2^20; rounded up to `replicates`
        times a power of two. `Reference.unmet` tells how many pixels did.
    cluster : Cluster, optional
        Sample the tiles there, with the same bits: `refdof.cluster.connected`.

    Returns
    -------
    Reference

    Raises
    ------
    InputError
        If an argument is of another kind or out of range.
    """
    view = view_of(scene, camera, lens)
    return reference_of_view(
        view, samples, replicates, seed, tolerance, pixel_filter, shared_pattern, progress, max_samples, cluster
    )


def reference_of_view(
    view: View,
    samples: int = 1024,
    replicates: int | None = None,
    seed: int = 0,
    tolerance: float | None = None,
    pixel_filter: str = "centre",
    shared_pattern: bool = False,
    progress: Callable[[int, int], None] | None = None,
    max_samples: int = MAX_SAMPLES,
    cluster: Cluster | None = None,
) -> Reference:
    """`reference` of a view whose products are shared."""
    as_instance("view", view, View)
    as_function("progress", progress)
    if cluster is not None:
        as_instance("cluster", cluster, Cluster)
    if replicates is not None:
        replicates = as_integer("replicates", replicates, minimum=REPLICATES, maximum=_MOST_REPLICATES)
    samples = as_integer("samples", samples, minimum=1, maximum=(replicates or REPLICATES) << MAX_LOG2)
    if replicates is None:
        replicates = STEADY_REPLICATES if tolerance is not None else _replicates_for(samples)
    if tolerance is not None:
        tolerance = as_number("tolerance", tolerance, above=0.0)
    spend = Spend(samples, tolerance, as_most(max_samples))
    return estimate(view, replicates, seed, spend, pixel_filter, shared_pattern, progress, cluster)


def samples_taken(samples: int) -> int:
    """Lens samples per pixel that the reference takes where `samples` are asked for, without a tolerance."""
    replicates = _replicates_for(samples)
    return replicates * int(power_of_two(samples / replicates))


def _replicates_for(samples: int) -> int:
    return REPLICATES if samples >= REPLICATES * _LARGE_NET else STEADY_REPLICATES


def as_most(max_samples: Any) -> int:
    """Return `max_samples` if it is allowed."""
    return as_integer("max_samples", max_samples, minimum=STEADY_REPLICATES, maximum=1 << MAX_LOG2)


def as_seed(seed: Any) -> int:
    """Return `seed` if it is allowed."""
    return as_integer("seed", seed, minimum=0, maximum=2**32 - 1)


def estimate(
    view: View,
    replicates: int,
    seed: int,
    spend: Spend,
    pixel_filter: str = "centre",
    shared_pattern: bool = False,
    progress: Callable[[int, int], None] | None = None,
    cluster: Cluster | None = None,
) -> Reference:
    """`reference_of_view` without the lower limit on replicates."""
    seed = as_seed(seed)
    box = as_choice("pixel_filter", pixel_filter, PIXEL_FILTERS) == "box"
    shared_pattern = as_bool("shared_pattern", shared_pattern)
    began = time.perf_counter()
    height, width = view.camera.height, view.camera.width
    image, standard_error, low, high = np.zeros((4, height, width, 3), dtype=np.float32)
    result = Reference(image, standard_error, low, high, np.ones((height, width), dtype=np.int64), 0.0)
    if view.lens.radius == 0.0 and not box:  # a pinhole: one ray is exact
        for picture in (image, low, high):
            picture[:] = view.pinhole().color
        return replace(result, seconds=time.perf_counter() - began)
    above = np.zeros((height, width), dtype=np.bool_)
    noise: dict[tuple[int, int], Float] = {}

    def keep(tile: Tile) -> None:
        (x, y), (rows, columns) = tile.corner, tile.samples.shape
        place = slice(y, y + rows), slice(x, x + columns)
        for picture, part in zip((image, standard_error, low, high), tile.pictures, strict=True):
            picture[place] = part
        result.samples[place], above[place], noise[tile.corner] = tile.samples, tile.above, tile.noise

    corners = corners_of(view.camera.size)
    work = TileWork(view, replicates, seed, spend, box, shared_pattern)
    for_each_tile(work, corners, keep, cluster, progress)
    floor = math.inf
    if replicates >= LEAST_GROUPS:  # summed in the order of the tiles, whichever ended first
        floor = floor_of_moments(np.sum([noise[corner] for corner in corners], axis=0), image.size, replicates)
    seconds = time.perf_counter() - began
    return replace(result, seconds=seconds, noise_floor_psnr=floor, unmet=float(above.mean()))

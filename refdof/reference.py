"""The reference: thin-lens pictures by ray casting, with an error bar at every pixel.

1. Split the picture into tiles; a tile's rays are made, traced and shaded at once   `refdof.lens_rays`
2. Estimate every pixel R times with independent scrambles of one net                `refdof.owen`
3. The mean is the picture; the spread of the R estimates is its error                `refdof.error_bar`
4. With a tolerance, double the net of the pixels whose error is too large            `refdof.error_bar`

Only the replicates are independent, so only they enter the error bar: the points inside one net repel each
other and their own variance says nothing about the error.

References
----------
.. [1] Cook, Porter & Carpenter (1984), Distributed Ray Tracing, SIGGRAPH.
.. [2] Haeberli & Akeley (1990), The Accumulation Buffer, SIGGRAPH.
.. [3] Owen (1997), Scrambled Net Variance for Integrals of Smooth Functions, Annals of Statistics 25(4).
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from refdof._check import Float, Index, as_choice, as_integer, as_number
from refdof._jit import run_tasks
from refdof.camera import Camera
from refdof.error_bar import grid_of, summarise, unfinished
from refdof.lens import ThinLens
from refdof.lens_rays import tile_order, trace_block
from refdof.noise_floor import noise_floor_psnr
from refdof.opening import opening_of
from refdof.owen import MAX_LOG2, block_of
from refdof.raster.raycast import new_packets, new_query
from refdof.scene import Scene
from refdof.small_lights import first_samples
from refdof.view import View

__all__ = ["PIXEL_FILTERS", "Reference", "reference", "reference_of_view"]

PIXEL_FILTERS = ("centre", "box")
_TILE = 16  # px; the working set of a tile stays in the nearest caches
_PACKETS = 16  # traced between generating and shading
_FIRST_POINTS = 8  # per replicate, before the first look at the error
_MAX_POINTS = 1 << 14  # per replicate, where a tolerance cannot be met


@dataclass(frozen=True, eq=False)
class Reference:
    """A reference picture and how far to trust it.

    Attributes
    ----------
    image, standard_error : (H, W, 3) float32
        Linear RGB, and the standard error of each value.
    low, high : (H, W, 3) float32
        A 95 % interval of each value, `refdof.error_bar`.
    samples : (H, W) int64
        Lens samples spent on each pixel.
    seconds : float
    skew : (H, W, 3) float32
        Cube root of the third central moment of each value's error, in the unit of the value.
    """

    image: Float
    standard_error: Float
    low: Float
    high: Float
    samples: Index
    seconds: float
    skew: Float

    @property
    def noise_floor_psnr(self) -> float:
        """PSNR [dB] that a perfect picture would score against this one: above it a comparison means nothing."""
        return noise_floor_psnr(self.image, self.standard_error)


def reference(
    scene: Scene,
    camera: Camera | None = None,
    lens: ThinLens | None = None,
    samples: int = 1024,
    replicates: int = 16,
    seed: int = 0,
    tolerance: float | None = None,
    pixel_filter: str = "centre",
    shared_pattern: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Reference:
    """Render the truth.

    Parameters
    ----------
    scene, camera, lens
        Camera and lens default to the scene's suggested shot.
    samples : int
        Lens samples per pixel in all; rounded up to `replicates` times a power of two, where nets are balanced.
    replicates : int
        Independent estimates, at least 16: fewer make an error bar that cannot be trusted.
    seed : int
        0 .. 2^32 - 1. Another seed gives an independent picture.
    tolerance : float, optional
        Instead of `samples`: sample every pixel until the standard error of each channel v is below
        tolerance * max(1, v), at most 2^14 points per replicate. Stopping early favours estimates that happen to
        agree, so such a picture is biased by a fraction of the tolerance (0.5 % of a small bright lamp's light).
    pixel_filter : "centre" or "box"
        Sample pixels at their centres, as image-based methods do (no anti-aliasing), or over their area.
    shared_pattern : bool
        One lens pattern for all pixels, as an accumulation buffer has [2], instead of one per pixel [1]. The
        error is then the same in size but shows as ghost edges rather than as noise.
    progress : callable, optional
        Called with (tiles done, tiles).

    Returns
    -------
    Reference
    """
    view = View(scene, camera or scene.camera, lens or scene.lens)
    return reference_of_view(view, samples, replicates, seed, tolerance, pixel_filter, shared_pattern, progress)


def reference_of_view(
    view: View,
    samples: int = 1024,
    replicates: int = 16,
    seed: int = 0,
    tolerance: float | None = None,
    pixel_filter: str = "centre",
    shared_pattern: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Reference:
    """`reference` of a view whose products are shared."""
    samples = as_integer("samples", samples, minimum=1, maximum=replicates << MAX_LOG2)
    replicates = as_integer("replicates", replicates, minimum=16, maximum=4096)
    if tolerance is not None:
        tolerance = as_number("tolerance", tolerance, above=0.0)
    return estimate(view, samples, replicates, seed, tolerance, pixel_filter, shared_pattern, progress)


def estimate(
    view: View,
    samples: int,
    replicates: int,
    seed: int,
    tolerance: float | None,
    pixel_filter: str,
    shared_pattern: bool,
    progress: Callable[[int, int], None] | None,
) -> Reference:
    """`reference_of_view` without the lower limit on replicates."""
    seed = as_integer("seed", seed, minimum=0, maximum=2**32 - 1)
    box = as_choice("pixel_filter", pixel_filter, PIXEL_FILTERS) == "box"
    began = time.perf_counter()
    height, width = view.camera.height, view.camera.width
    image, standard_error, skew, low, high = np.zeros((5, height, width, 3), dtype=np.float32)
    result = Reference(image, standard_error, low, high, np.ones((height, width), dtype=np.int64), 0.0, skew)
    if view.lens.radius == 0.0 and not box:  # a pinhole: one ray is exact
        for picture in (result.image, result.low, result.high):
            picture[:] = view.pinhole().color
        return _timed(result, began)

    surfaces, tracer, shot, opening = (
        view.surfaces(),
        view.tracer(),
        view.shot(),
        opening_of(view.lens.aperture),
    )
    if tolerance is None:
        first = np.full((height, width), _power_of_two(samples / replicates))
    else:
        wanted = _power_of_two(first_samples(view, tolerance) / replicates)
        first = np.clip(wanted, _FIRST_POINTS, _MAX_POINTS)

    def trace(pixels: Index, start: int, count: int) -> Float:
        """Sums (R, N, 3) over points start .. start + count - 1 of every replicate."""
        sums = np.zeros((replicates, len(pixels), 3))
        packets, query = new_packets(_PACKETS), new_query(coherent=True)
        block = block_of(start, count.bit_length() - 1)
        trace_block(
            surfaces, tracer.scene, tracer.packet, query, shot, opening, block,
            pixels, np.uint32(seed), shared_pattern, box, packets, sums,
        )  # fmt: skip
        return sums

    def tile(corner: tuple[int, int]) -> None:
        x, y = corner
        pixels = tile_order(x, y, min(x + _TILE, width), min(y + _TILE, height))
        rows, columns = pixels[:, 1], pixels[:, 0]
        sums, spent = np.zeros((replicates, len(pixels), 3)), first[rows, columns]
        for count in np.unique(spent):
            todo: Index = np.flatnonzero(spent == count)
            sums[:, todo] = trace(pixels[todo], 0, int(count))
        grid = grid_of(pixels)
        found = summarise(sums, spent, grid)
        while tolerance is not None:
            todo = np.flatnonzero(unfinished(found.mean, found.error, spent, grid, tolerance, _MAX_POINTS))
            if not len(todo):
                break
            have = int(spent[todo[0]])
            sums[:, todo] += trace(pixels[todo], have, have)
            spent[todo] += have
            found = summarise(sums, spent, grid)
        result.image[rows, columns] = found.mean
        result.standard_error[rows, columns] = found.error
        result.skew[rows, columns] = np.cbrt(found.third)
        result.low[rows, columns], result.high[rows, columns] = found.low, found.high
        result.samples[rows, columns] = spent * replicates

    corners = [(x, y) for y in range(0, height, _TILE) for x in range(0, width, _TILE)]
    run_tasks(tile, corners, progress)
    return _timed(result, began)


def _timed(result: Reference, began: float) -> Reference:
    return replace(result, seconds=time.perf_counter() - began)


def _power_of_two(count: Any) -> Any:
    """The smallest power of two that is not below `count`, at least 1."""
    return np.exp2(np.ceil(np.log2(np.maximum(count, 1)))).astype(np.int64)

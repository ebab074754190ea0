"""Forecast: what a reference with a tolerance will cost, from a first look at a few tiles.

1. Give a few tiles, spread over the picture, their first samples   `refdof.truth.tile_sampler`
2. Each of their pixels needs as many as its error asks for, since errors at edges fall as a power of N
3. The pilot's own rays per second give the time
"""

import time
from dataclasses import dataclass

import numpy as np

from refdof._check import as_instance, as_number
from refdof._jit import run_tasks
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens
from refdof.scene.scene import Scene
from refdof.truth.error_bar import excess
from refdof.truth.reference import MAX_SAMPLES, STEADY_REPLICATES, as_most, as_seed
from refdof.truth.tile_sampler import Spend, TileEstimate, TileSampler, corners_of, power_of_two
from refdof.view import View, view_of

__all__ = ["Forecast", "forecast", "forecast_of_view"]

_TILES = 48
_MOST_EXCESS = 1e8  # far beyond any cap, and 64 bits hold the samples that it asks for
_RATE = 0.65  # errors of nets at edges fall as N^-0.75 in the end, more slowly from 8 points on
_GOLDEN = 0.6180339887498949


@dataclass(frozen=True)
class Forecast:
    """What a tolerance will cost.

    Attributes
    ----------
    samples : float
        Lens samples per pixel, mean over the picture.
    seconds : float
        Time for tracing them on this machine.
    unmet : float
        Share of pixels, 0 .. 1, that will stop at `max_samples` above the tolerance.
    """

    samples: float
    seconds: float
    unmet: float

    def __str__(self) -> str:
        minutes, seconds = divmod(round(self.seconds), 60)
        duration = f"{minutes} min {seconds} s" if minutes else f"{seconds} s"
        stop = f"; {100.0 * self.unmet:.1f} % of the pixels will stop above the tolerance" if self.unmet > 0.0 else ""
        return f"about {self.samples:.0f} samples per pixel, {duration}{stop}"


def forecast(
    scene: Scene,
    camera: Camera | None = None,
    lens: ThinLens | None = None,
    tolerance: float = 0.01,
    max_samples: int = MAX_SAMPLES,
    seed: int = 0,
) -> Forecast:
    """Tell what `refdof.reference` with a tolerance will cost.

    Parameters
    ----------
    scene, camera, lens
        Camera and lens default to the scene's suggested shot.
    tolerance, max_samples, seed
        As of `refdof.reference`.

    Raises
    ------
    InputError
        As `refdof.reference`.
    """
    return forecast_of_view(view_of(scene, camera, lens), tolerance, max_samples, seed)


def forecast_of_view(view: View, tolerance: float, max_samples: int = MAX_SAMPLES, seed: int = 0) -> Forecast:
    """`forecast` of a view whose products are shared."""
    as_instance("view", view, View)
    seed = as_seed(seed)
    tolerance = as_number("tolerance", tolerance, above=0.0)
    most = as_most(max_samples)
    if view.lens.radius == 0.0:
        return Forecast(1.0, 0.0, 0.0)
    sampler = TileSampler(view, STEADY_REPLICATES, seed, Spend(1, tolerance, most), False, False)
    corners = corners_of(view.camera.size)
    chosen = sorted({int(len(corners) * (k * _GOLDEN % 1.0)) for k in range(min(_TILES, len(corners)))})
    sampler.tile(corners[chosen[0]], refine=False)  # compiles

    def pilot(k: int) -> TileEstimate:
        return sampler.tile(corners[k], refine=False)

    began = time.perf_counter()
    tiles = run_tasks(pilot, chosen)
    seconds = time.perf_counter() - began
    spent = np.concatenate([tile.spent for tile in tiles])
    over = np.concatenate([_spread(tile, excess(tile.found, tolerance)) for tile in tiles])
    most = np.minimum(over, _MOST_EXCESS)
    needed = np.maximum(spent, power_of_two(spent * np.maximum(most, 1.0) ** (1.0 / _RATE)))
    total = float(np.minimum(needed, sampler.most_points).mean()) * STEADY_REPLICATES
    rays = float(spent.sum()) * STEADY_REPLICATES
    pixels = sampler.width * sampler.height
    unmet = float(np.mean((needed > sampler.most_points) & (over > 1.0)))
    return Forecast(total, seconds * total * pixels / rays, unmet)


def _spread(tile: TileEstimate, over: np.ndarray) -> np.ndarray:
    """The largest excess (N,) within 2 px: neighbours of a pixel that needs samples get them, too."""
    from scipy.ndimage import maximum_filter

    y, x = tile.rows - tile.rows.min(), tile.columns - tile.columns.min()
    picture = np.zeros((y.max() + 1, x.max() + 1))
    picture[y, x] = over
    wide: np.ndarray = maximum_filter(picture, 5, mode="nearest")[y, x]
    return wide

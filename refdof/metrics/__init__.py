"""Metrics: how far an image is from its reference. The reference comes first, always.

`METRICS` is the registry: columns of tables, fields of JSON and CSV and the footnote of a report follow from it, in its
order. To add a metric, write its function and add one entry.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from refdof._check import Float
from refdof._jit import run_tasks, thread_count
from refdof.image.noise_floor import noise_floor_of_pair, noise_floor_psnr
from refdof.metrics._pair import Shown, shown
from refdof.metrics.perceptual import FLIP_PPD, Asker, flip, flip_here, flip_processes
from refdof.metrics.pointwise import max_abs, psnr, psnr_8bit, rel_mse, rmse
from refdof.metrics.structural import ssim

__all__ = [
    "FLIP_PPD",
    "METRICS",
    "Metric",
    "Scored",
    "flip",
    "max_abs",
    "noise_floor_of_pair",
    "noise_floor_psnr",
    "psnr",
    "psnr_8bit",
    "rel_mse",
    "rmse",
    "scored_of_many",
    "scores",
    "scores_of_many",
    "ssim",
]


@dataclass(frozen=True)
class Metric:
    """One metric; its name is its key in `METRICS`.

    Attributes
    ----------
    title : heading of its column, without the unit
    unit : "" where it has none
    better : "high" or "low"
    values : "display" (clipped to [0, 1], sRGB-encoded) or "linear"
        What the function compares. It takes linear images in both cases and encodes them itself.
    decimals : digits after the point in a table, enough to rank methods
    note : what a reader must know beside the title; "" where it says all
    function : (reference, image) -> float
    """

    title: str
    unit: str
    better: str
    values: str
    decimals: int
    note: str
    function: Callable[[Any, Any], float]

    @property
    def heading(self) -> str:
        """Title and unit."""
        return f"{self.title} [{self.unit}]" if self.unit else self.title


METRICS: dict[str, Metric] = {
    "psnr": Metric("PSNR", "dB", "high", "display", 2, "peak 1", psnr),
    "psnr_8bit": Metric("8-bit PSNR", "dB", "high", "display", 2, "peak 255, both images rounded", psnr_8bit),
    "ssim": Metric("SSIM", "", "high", "display", 4, "", ssim),
    "flip": Metric("FLIP", "", "low", "display", 4, f"{FLIP_PPD} pixels per degree", flip),
    "rmse": Metric("RMSE", "", "low", "linear", 5, "", rmse),
    "rel_mse": Metric("relMSE", "", "low", "linear", 5, "mean of d^2 / (r^2 + 0.01)", rel_mse),
    "max_abs": Metric("max", "", "low", "linear", 3, "largest absolute error", max_abs),
}


_FEW_VALUES = 500_000  # are scored faster than processes start


def scores(reference: Any, image: Any) -> dict[str, float]:
    """Every score of `image` against `reference`, both (H, W, 3) linear RGB of at least 11 x 11 pixels.

    Returns
    -------
    dict
        A number for every name in `METRICS`. PSNR [dB] of identical images is inf.

    Raises
    ------
    InputError
        If shapes differ, a value is not finite, or the image is smaller than SSIM's window.
    """
    first = shown("reference", reference)
    second = shown("image", image, first.shape)
    return {name: metric.function(first, second) for name, metric in METRICS.items()}


class Scored(NamedTuple):
    """`scores` of an image, and FLIP of each pixel, (H, W) float32; None: not known."""

    scores: dict[str, float]
    flip_map: Float | None


def scores_of_many(
    reference: Any, images: Sequence[Any], progress: Callable[[int, int], None] | None = None
) -> list[dict[str, float]]:
    """`scores` of every image; `progress(done, all)` is called between."""
    return [one.scores for one in scored_of_many(reference, images, progress)]


def scored_of_many(
    reference: Any, images: Sequence[Any], progress: Callable[[int, int], None] | None = None
) -> list[Scored]:
    """`scores` of every image and its map of FLIP; `progress(done, all)` is called between.

    Pictures are scored beside each other, and FLIP, which takes most of the time, in processes of its own.
    """
    first = shown("reference", reference)
    count = min(thread_count(), len(images))
    if count < 2 or len(images) * first.size < _FEW_VALUES:
        return run_tasks(lambda image: _scored(flip_here, first, image), images, progress)
    with flip_processes(count) as ask:
        return run_tasks(lambda image: _scored(ask, first, image), images, progress)


def _scored(ask: Asker, first: Shown, image: Any) -> Scored:
    """`scores`, while FLIP is worked out elsewhere."""
    second = shown("image", image, first.shape)
    answer = ask(first, second)
    found = {name: metric.function(first, second) for name, metric in METRICS.items() if metric.function is not flip}
    mean, errors = answer()
    return Scored({name: found.get(name, mean) for name in METRICS}, errors)

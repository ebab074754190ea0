"""Score: pictures made elsewhere beside their reference, and what the reference is worth."""

import math
import os
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from refdof._check import LARGEST_LIGHT, Float, InputError, as_image
from refdof.image.file import read_color
from refdof.metrics import METRICS, noise_floor_of_pair, noise_floor_psnr, scores_of_many
from refdof.metrics.structural import WINDOW
from refdof.report.rows import DISPLAY, is_at_floor, plain
from refdof.report.table import footnote_of_metrics, noise_in_words, scores_table

__all__ = ["Scores", "score_images"]

Path = str | os.PathLike[str]


class Scores(NamedTuple):
    """Scores of pictures by name of the metric, and the noise floor [dB] of their reference; NaN: unknown."""

    reference: str
    size: tuple[int, int]
    images: tuple[str, ...]
    scores: tuple[dict[str, float], ...]
    noise_floor_psnr: float

    def as_json(self) -> dict[str, Any]:
        """Strings, numbers, null, lists and dicts only."""
        rows = [
            {
                "image": name,
                **{metric: plain(found[metric]) for metric in METRICS},
                "at_noise_floor": is_at_floor(found, self.noise_floor_psnr),
            }
            for name, found in zip(self.images, self.scores, strict=True)
        ]
        floor = plain(self.noise_floor_psnr)
        about = {"image": self.reference, "size": list(self.size), "noise_floor_psnr": floor}
        return {"reference": about, "display": dict(DISPLAY), "rows": rows}

    def table(self, wide: bool = False) -> str:
        """For people: in 80 characters, or all columns and what they mean."""
        width, height = self.size
        worth = f"Reference: {self.reference}, {width} x {height}, {noise_in_words(self.noise_floor_psnr)}."
        files = [os.path.basename(name) for name in self.images]
        names = files if len(set(files)) == len(files) else self.images
        table = scores_table(names, self.scores, self.noise_floor_psnr, wide)
        return "\n\n".join([table, worth, *([footnote_of_metrics()] if wide else [])])


def score_images(
    reference: Path,
    images: Sequence[Path],
    variance: Path | None = None,
    second: Path | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Scores:
    """Read pictures and score them.

    Parameters
    ----------
    reference, images : paths
        As of `refdof.image.file.load_image`.
    variance : path, optional
        Of each value of the reference: its standard error squared.
    second : path, optional
        Another reference, independent and of as many samples.
    progress : callable, optional
        Called with (done, all).

    Raises
    ------
    InputError
        If a file cannot be read, sizes differ, or pictures are too small for SSIM's window.
    """
    truth = as_image("reference", read_color("reference", reference), dtype=np.float64)
    height, width = truth.shape[:2]
    if min(height, width) < WINDOW:
        raise InputError(f"reference: got {width}x{height} pixels; allowed for scores is at least {WINDOW}x{WINDOW}")
    pictures = [_like("image", path, truth) for path in images]
    floor = math.nan
    if variance is not None:
        floor = noise_floor_psnr(truth, np.sqrt(_like("variance", variance, truth, minimum=0.0)))
    elif second is not None:
        floor = noise_floor_of_pair(truth, _like("second", second, truth))
    found = scores_of_many(truth, pictures, progress)
    names = tuple(str(path) for path in images)
    return Scores(str(reference), (width, height), names, tuple(found), floor)


def _like(argument: str, path: Path, truth: Float, minimum: float = -LARGEST_LIGHT) -> Float:
    """A picture of the size of the reference; an error says which file."""
    try:
        return as_image(argument, read_color(argument, path), truth.shape, dtype=np.float64, minimum=minimum)
    except InputError as error:
        told = str(error)
        raise InputError(told if str(path) in told else f"{told} ({path})") from None

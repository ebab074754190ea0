"""Metrics: how far an image is from its reference. The reference comes first, always.

`rmse`, `rel_mse` and `max_abs` speak of linear values; `psnr`, `psnr_8bit`, `ssim` and `flip` of the display image
(clipped to [0, 1], sRGB-encoded), which they make themselves from linear images.
"""

from typing import Any

from refdof.metrics.perceptual import FLIP_PPD, flip
from refdof.metrics.pointwise import max_abs, psnr, psnr_8bit, rel_mse, rmse
from refdof.metrics.structural import ssim
from refdof.noise_floor import noise_floor_psnr

__all__ = [
    "FLIP_PPD",
    "flip",
    "max_abs",
    "noise_floor_psnr",
    "psnr",
    "psnr_8bit",
    "rel_mse",
    "rmse",
    "scores",
    "ssim",
]


def scores(reference: Any, image: Any) -> dict[str, float]:
    """Every score of `image` against `reference`, both (H, W, 3) linear RGB of at least 11 x 11 pixels.

    Returns
    -------
    dict
        "psnr" and, of pictures rounded to 8 bits, "psnr_8bit" [dB, inf if identical], "ssim" (1 is
        best), "flip" (0 is best), "rmse", "rel_mse", "max_abs".

    Raises
    ------
    InputError
        If shapes differ, a value is not finite, or the image is smaller than SSIM's window.
    """
    metrics = (psnr, psnr_8bit, ssim, flip, rmse, rel_mse, max_abs)
    return {metric.__name__: metric(reference, image) for metric in metrics}

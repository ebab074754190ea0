"""Structural similarity of display images: the only file that imports scikit-image.

References
----------
.. [1] Wang, Bovik, Sheikh & Simoncelli (2004), Image Quality Assessment: From Error Visibility to Structural
   Similarity, IEEE Transactions on Image Processing 13(4).
"""

from typing import Any

from refdof._check import InputError
from refdof.metrics._pair import display_pair

__all__ = ["WINDOW", "ssim"]

_SIGMA = 1.5  # [1], Section III-C: a circular Gaussian window, 1.5 px, K1 = 0.01, K2 = 0.03
WINDOW = 11  # [1]: 11 x 11


def ssim(reference: Any, image: Any) -> float:
    """Mean structural similarity [1] of the display images over all channels; 1 for identical ones.

    Windows that would cross the border are left out, as in [1].

    Parameters
    ----------
    reference, image : (H, W, 3)
        Linear RGB, at least 11 x 11 pixels.

    Raises
    ------
    InputError
        If shapes differ, a value is not finite, or a side is shorter than the window.
    """
    first, second = display_pair(reference, image)
    if min(first.shape[:2]) < WINDOW:
        raise InputError(
            f"reference: got {first.shape[1]} x {first.shape[0]} pixels; "
            f"allowed for SSIM are at least {WINDOW} x {WINDOW}, the size of its window"
        )
    from skimage.metrics import structural_similarity  # slow to import

    # In float64: E[x^2] - E[x]^2 cancels in flat regions.
    return float(
        structural_similarity(
            first.astype("float64"),
            second.astype("float64"),
            gaussian_weights=True,
            sigma=_SIGMA,
            use_sample_covariance=False,
            data_range=1.0,
            channel_axis=2,
        )
    )

"""What `benchmarks/raster.py` is measured against: scipy.ndimage and OpenCV, where they have the same operation."""

import cv2
import numpy as np
from scipy import ndimage

__all__ = [
    "cv_box",
    "cv_gaussian",
    "cv_pyramid",
    "cv_reads",
    "cv_windows",
    "ndi_box",
    "ndi_gaussian",
    "ndi_reads",
    "ndi_windows",
]


def cv_windows(depth, count):
    """Least and greatest values of windows of side 2^i that hang from their pixel."""
    kernels = [np.ones((1 << i, 1 << i), np.uint8) for i in range(count)]
    return [[work(depth, k, anchor=(0, 0)) for k in kernels] for work in (cv2.erode, cv2.dilate)]


def ndi_windows(depth, count):
    """As `cv_windows`."""
    found = []
    for work, outside in ((ndimage.minimum_filter, np.inf), (ndimage.maximum_filter, -np.inf)):
        levels = []
        for i in range(count):
            origin = -(1 << i >> 1)
            levels.append(work(depth, size=1 << i, origin=origin, mode="constant", cval=outside))
        found.append(levels)
    return found


def cv_box(image):
    """The chain of 2 x 2 means, the image left out."""
    levels = [image]
    while len(levels[-1]) > 1:
        half = len(levels[-1]) // 2
        levels.append(cv2.resize(levels[-1], (half, half), interpolation=cv2.INTER_AREA))
    return levels[1:]


def ndi_box(image):
    """As `cv_box`."""
    levels = [image]
    while len(levels[-1]) > 1:
        means = ndimage.uniform_filter(levels[-1], size=2, origin=-1, mode="nearest", axes=(0, 1))
        levels.append(np.ascontiguousarray(means[::2, ::2]))
    return levels[1:]


def _taps():
    """Per axis: three weights around a point midway between texels, each the mean of two."""
    side = np.exp(-0.5)
    return (np.array([side, 1.0 + side, 1.0 + side, side]) / (2.0 + 4.0 * side)).astype(np.float32)


def cv_gaussian(image):
    """One coarser level: nine bilinear reads around a point midway between texels are a filter of 4 x 4 taps."""
    taps = _taps()
    full = cv2.sepFilter2D(image, -1, taps, taps, anchor=(1, 1), borderType=cv2.BORDER_REPLICATE)
    return np.ascontiguousarray(full[::2, ::2])


def ndi_gaussian(image):
    """As `cv_gaussian`, and only every second row is filtered along x."""
    rows = ndimage.correlate1d(image, _taps(), 0, mode="nearest", origin=-1)[::2]
    return np.ascontiguousarray(ndimage.correlate1d(rows, _taps(), 1, mode="nearest", origin=-1)[:, ::2])


def cv_pyramid(image):
    """OpenCV's own pyramid level: 5 x 5 taps around every second texel. Another filter, shown for scale."""
    return cv2.pyrDown(image)


def cv_reads(image, x, y):
    """Bilinear reads at texels (H, W). (Before version 5, OpenCV rounded places to 1 / 32 of a texel.)"""
    return cv2.remap(image, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)


def ndi_reads(image, x, y):
    """Bilinear reads at texels (H, W), one channel after the other."""
    planes = [ndimage.map_coordinates(image[..., c], [y, x], order=1, mode="nearest") for c in range(image.shape[2])]
    return np.stack(planes, axis=-1)

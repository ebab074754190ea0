"""Beyond: causes that no model with the same parameters at every pixel gives; tried where those explain nothing.

The spiral turned by noise          `turned`: every pixel may have its own angle of the first tap
One picture read and written        `in_place`: pixel after pixel, taps read what is written already
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from refdof._check import Float
from refdof.oracle.diagnosis.emulate import emulator, spiral_of, tap_shares
from refdof.oracle.diagnosis.guides import guides_of
from refdof.oracle.diagnosis.reads import read, spots_of
from refdof.oracle.diagnosis.samples import Shot, choose, samples_of

__all__ = ["in_place", "turned"]

_ANGLES = 64
_SHOTS, _PIXELS = 3, 40
_LEFT = 0.25  # of the error, with the best of all angles: a step of 0.1 radians moves inner taps by little
_CUT = 1e6  # tolerances
_LARGEST = 4000  # pixels of a picture that is run pixel by pixel
_CLOSE = 10.0  # tolerances
_MOST = 0.9  # of the pixels


def turned(shots: Sequence[Shot]) -> float | None:
    """The share of the error that an angle of its own for every pixel explains, or None if that is too little."""
    before = after = 0.0
    for shot in shots[:_SHOTS]:
        samples = samples_of(shot, *choose(shot.off, _PIXELS))
        run = emulator(samples)

        angles = [samples.right.angle_start + k * 2.0 * math.pi / _ANGLES for k in range(_ANGLES)]
        images = (run(replace(samples.right, angle_start=angle)) for angle in angles)
        off = np.array([np.abs(samples.got - image).sum(axis=1) / samples.tolerance for image in images])
        errors = np.nan_to_num(off, nan=_CUT, posinf=_CUT)
        before += float(errors[0].sum())
        after += float(errors.min(axis=0).sum())
    return 1.0 - after / before if before > 0.0 and after <= _LEFT * before else None


def in_place(shots: Sequence[Shot]) -> float | None:
    """The share of pixels that a port gives that reads what it has written, row by row, or None if they are few."""
    small = [shot for shot in shots if shot.depth.size <= _LARGEST and (shot.off > 1.0).any()]
    if not small:
        return None
    shot = min(small, key=lambda shot: shot.depth.size)
    off = np.abs(_written(shot) - shot.got).max(axis=-1) / shot.tolerance
    share = float((off <= _CLOSE).mean())
    return share if share >= _MOST else None


def _written(shot: Shot) -> Float:
    """What a right port makes that reads and writes one picture: (H, W, 3)."""
    height, width = shot.depth.shape
    image = shot.color.reshape(-1, 3).astype(np.float64)
    spiral, columns = spiral_of(shot.right), np.arange(width)
    spots = spots_of(spiral[:, :2], shot.right.color_filter)
    for row in range(height):
        samples = samples_of(shot, columns, np.full(width, row))
        shares, own = tap_shares(shot.right, spiral[:, 2], guides_of(samples, shot.right, spiral))
        for column in range(width):
            here, there = np.array([column]), np.array([row])
            taps = read(samples, image, here, there, spots, shot.right.border_color)[0]
            at = row * width + column
            image[at] = own[column] * image[at] + shares[column] @ taps
    return image.reshape(height, width, 3)

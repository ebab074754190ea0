"""Radiance pictures: .hdr files of 8-bit mantissas that share an exponent, RGBE [1].

A value is mantissa 2^(exponent - 136); an exponent of 0 is black. Rows are plain or run-length encoded. Only pictures
that begin with the top left pixel, "-Y H +X W", are read.

References
----------
.. [1] Ward (1991), Real Pixels, Graphics Gems II.
"""

import math
import os
import re

import numpy as np

from refdof._check import Float, InputError
from refdof._files import as_plain_file
from refdof.image.exr import MOST_PIXELS

__all__ = ["read_radiance"]

_LONG_RUN = 128  # a count above it repeats a byte
_ENCODED = range(8, 32768)  # widths whose rows may be run-length encoded


def read_radiance(argument: str, path: str | os.PathLike[str]) -> Float:
    """Read a picture.

    Returns
    -------
    (H, W, 3) float32, linear

    Raises
    ------
    InputError
        If the file is missing, damaged, too large or holds XYZ.
    """
    try:
        content = as_plain_file(argument, path).read_bytes()
    except OSError as error:
        raise InputError(
            f"{argument}: cannot read {str(path)!r} ({error.strerror}); allowed is an image file"
        ) from None
    head = re.match(rb"#\?[^\n]*\n(.*?)\n\n-Y (\d{1,9}) \+X (\d{1,9})\n", content[:65536], re.DOTALL)
    if head is None or b"FORMAT=32-bit_rle_rgbe" not in head[1].split(b"\n"):
        raise InputError(
            f"{argument}: {str(path)!r} has another header; allowed is FORMAT=32-bit_rle_rgbe with -Y H +X W"
        )
    height, width = int(head[2]), int(head[3])
    if not 0 < height * width <= MOST_PIXELS:
        raise InputError(f"{argument}: {str(path)!r} has {width}x{height} pixels; allowed are 1 .. {MOST_PIXELS}")
    pixels, place = np.empty((height, width, 4), np.uint8), head.end()
    for row in pixels:
        place = _read_row(content, place, row)
        if place < 0:
            raise InputError(f"{argument}: {str(path)!r} is damaged; allowed is a whole picture")
    exponent = pixels[..., 3].astype(np.int32)
    scale = np.where(exponent > 0, np.ldexp(1.0, exponent - 136), 0.0)
    exposures = [
        float(number) for number in re.findall(rb"^EXPOSURE= *(\d+\.?\d*(?:[eE][+-]?\d+)?)\s*$", head[1], re.M)
    ]
    exposure = math.prod(exposures)  # what the values were multiplied by, one factor after the other
    if not 0.0 < exposure < math.inf:
        raise InputError(f"{argument}: {str(path)!r} says EXPOSURE={exposure:g}; allowed are finite numbers above 0")
    return (pixels[..., :3] * (scale[..., None] / exposure)).astype(np.float32)


def _read_row(content: bytes, place: int, row: np.ndarray) -> int:
    """Fill row (W, 4) from `place` on; returns where the next one begins, or -1."""
    width = len(row)
    if width not in _ENCODED or content[place : place + 4] != bytes((2, 2, width >> 8, width & 255)):
        flat = content[place : place + 4 * width]
        if len(flat) < 4 * width:
            return -1
        row[:] = np.frombuffer(flat, np.uint8).reshape(width, 4)
        old_runs = bool((row[:, :3] == 1).all(axis=1).any())  # an encoding of before 1991
        return -1 if old_runs else place + 4 * width
    place += 4
    for letter in range(4):
        x = 0
        while x < width:
            if place + 1 >= len(content):
                return -1
            count = content[place]
            long = count > _LONG_RUN
            count = count - _LONG_RUN if long else count
            if count == 0 or x + count > width:
                return -1
            values = content[place + 1 : place + 2] if long else content[place + 1 : place + 1 + count]
            if not long and len(values) < count:
                return -1
            row[x : x + count, letter] = np.frombuffer(values, np.uint8)
            place, x = place + 1 + len(values), x + count
    return place

"""Image files: linear images as PNG (8-bit display image), EXR or NPY (linear floats), chosen by the suffix.

The only file that imports imageio and OpenEXR.
"""

import os
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import imageio.v3 as imageio
import numpy as np
import OpenEXR

from refdof._check import Float, InputError, as_image, as_path
from refdof.image.atomic import atomic_path
from refdof.image.display import linear_from_display, to_8_bit

__all__ = ["PNG_STRATEGY", "SUFFIXES", "load_image", "png_bytes", "save_channels", "save_image"]

PNG_STRATEGY = zlib.Z_RLE  # a quarter of the time for files that are one to nine percent larger
SUFFIXES = (".png", ".exr", ".npy")
# What the decoders raise.
_UNREADABLE = (OSError, ValueError, RuntimeError, EOFError, SyntaxError, TypeError, MemoryError)


def save_image(path: str | os.PathLike[str], linear: Any) -> None:
    """Write a linear image; the suffix of `path` says how.

    ====  =====================================================================================
    .png  display image, 8 bits per channel: clipped to [0, 1] and sRGB-encoded
    .exr  linear RGB, float32, lossless (ZIP)
    .npy  linear RGB, float32 or float64 as given
    ====  =====================================================================================

    Parameters
    ----------
    path : path
        Written in one step: an interrupted run leaves the old file.
    linear : (H, W, 3)
        Linear RGB, finite.

    Raises
    ------
    InputError
        If the suffix is not one of the three, the image is empty, not finite, beyond 1e33 or of 8 or 16 bits, or
        the path cannot be written.
    """
    suffix = _known_suffix("out", path)
    image = as_image("image", linear)
    with atomic_path(path) as temporary:
        if suffix == ".png":
            temporary.write_bytes(png_bytes(image))
        elif suffix == ".exr":
            save_channels(temporary, {"RGB": image})
        else:
            with temporary.open("wb") as stream:
                np.save(stream, image, allow_pickle=False)


def save_channels(path: Path, channels: Mapping[str, Float]) -> None:
    """Write an EXR of float32, lossless (ZIP): {"RGB": (H, W, 3)} or channels of one number each, such as "Y"."""
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {name: values.astype(np.float32) for name, values in channels.items()}).write(str(path))


def png_bytes(linear: Any) -> bytes:
    """The content of a PNG file with the display image of `linear` (H, W, 3)."""
    return imageio.imwrite("<bytes>", to_8_bit(linear), extension=".png", plugin="pillow", compress_type=PNG_STRATEGY)


def load_image(path: str | os.PathLike[str]) -> Float:
    """Read a linear image written by `save_image` or by another program.

    Returns
    -------
    (H, W, 3) linear RGB
        float32, or float64 from an NPY of float64. A PNG is decoded from sRGB; its transparency is dropped.

    Raises
    ------
    InputError
        If the suffix is unknown, or the file is missing, damaged or not a finite RGB image.
    """
    suffix = _known_suffix("path", path)
    try:
        if suffix == ".png":
            pixels = imageio.imread(Path(path), plugin="pillow", mode="RGB")
            values = linear_from_display(pixels / np.float64(255.0))
        elif suffix == ".exr":
            values = _rgb_of_exr(path)
        else:
            values = np.load(path, allow_pickle=False)
    except InputError:
        raise
    except _UNREADABLE as error:
        reason = getattr(error, "strerror", None) or " ".join(str(error).split())
        raise InputError(f"path: cannot read {str(path)!r} ({reason}); allowed is an image file") from None
    return as_image("path", values)


def _rgb_of_exr(path: str | os.PathLike[str]) -> Float:
    with open(path, "rb"):  # a missing file gets the system's own words, not the decoder's
        pass
    with OpenEXR.File(str(path), separate_channels=True) as file:
        channels = file.channels()
        if not {"R", "G", "B"} <= set(channels):
            raise InputError(f"path: {str(path)!r} has channels {', '.join(channels)}; allowed are R, G, B")
        return np.stack([channels[name].pixels for name in "RGB"], axis=-1).astype(np.float32)


def _known_suffix(argument: str, path: str | os.PathLike[str]) -> str:
    suffix = as_path(argument, path).suffix.lower()
    if suffix not in SUFFIXES:
        raise InputError(f"{argument}: got {str(path)!r}; allowed are names that end in {', '.join(SUFFIXES)}")
    return suffix

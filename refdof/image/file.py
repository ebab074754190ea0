"""Image files: linear images as PNG (8-bit display image), EXR or NPY (linear floats), chosen by the suffix.

The only file that imports imageio.
"""

import os
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import imageio.v3 as imageio
import numpy as np

from refdof._check import Float, InputError, as_image, as_path
from refdof._files import as_plain_file
from refdof.image.atomic import atomic_path
from refdof.image.channel_choice import color_of, depth_of, split_layer
from refdof.image.display import linear_from_display, to_8_bit
from refdof.image.exr import DECODERS_RAISE, MOST_PIXELS, is_deep, read_layers, save_channels
from refdof.image.radiance import read_radiance

__all__ = ["PNG_STRATEGY", "SUFFIXES", "load_image", "png_bytes", "read_color", "read_numbers", "save_image"]

PNG_STRATEGY = zlib.Z_RLE  # a quarter of the time for files that are one to nine percent larger
SUFFIXES = (".png", ".exr", ".npy")
_NUMBERS = (".exr", ".npy")


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


def png_bytes(linear: Any) -> bytes:
    """The content of a PNG file with the display image of `linear` (H, W, 3)."""
    return imageio.imwrite("<bytes>", to_8_bit(linear), extension=".png", plugin="pillow", compress_type=PNG_STRATEGY)


def load_image(path: str | os.PathLike[str]) -> Float:
    """Read a linear image written by `save_image` or by another program: also a Radiance picture, .hdr.

    Returns
    -------
    (H, W, 3) linear RGB
        float32, or float64 from an NPY of float64. A PNG is decoded from sRGB; its transparency is dropped. Of an EXR
        with several layers the one that is plausible, or that of "FILE.exr:LAYER".

    Raises
    ------
    InputError
        If the suffix is unknown, or the file is missing, damaged, too large or not a finite RGB image.
    """
    return as_image("path", read_color("path", path))


def read_color(argument: str, path: str | os.PathLike[str]) -> Float:
    """`load_image` before it is validated; errors name `argument`."""
    text, layer = split_layer(str(as_path(argument, path)))
    suffix = _readable_suffix(argument, text)
    if suffix == ".exr":
        return color_of(argument, text, read_layers(argument, text), layer)
    if suffix == ".hdr":
        return read_radiance(argument, text)
    return _read_png(argument, text) if suffix == ".png" else read_npy(argument, text)


def read_numbers(argument: str, path: str | os.PathLike[str], by_name: bool = True) -> np.ndarray:
    """A number of each pixel, as stored, of an EXR or NPY: "FILE.exr:LAYER" is as for `load_image`.

    `by_name`: of several channels that which is named as depths are.

    Raises
    ------
    InputError
        If the file is missing, damaged, too large, deep or another kind of file.
    """
    text, layer = split_layer(str(as_path(argument, path)))
    suffix = _readable_suffix(argument, text)
    if suffix not in _NUMBERS:
        raise InputError(
            f"{argument}: got {text!r}, whose numbers have no unit; allowed are names that end in {', '.join(_NUMBERS)}"
        )
    if suffix == ".npy":
        values = read_npy(argument, text)
        return values[..., 0] if values.ndim == 3 and values.shape[2] == 1 else values
    channel = depth_of(argument, text, read_layers(argument, text), layer, by_name)
    if is_deep(channel):
        raise InputError(f"{argument}: {text!r} is a deep file; allowed is a flat one")
    return channel


def read_npy(argument: str, path: str) -> np.ndarray:
    """An array, which must be as long as its header says."""
    file = as_plain_file(argument, path)
    with _readable(argument, path):
        return np.array(np.load(file, mmap_mode="r", allow_pickle=False))


def _read_png(argument: str, path: str) -> Float:
    file = as_plain_file(argument, path)
    with _readable(argument, path):
        with file.open("rb") as stream:
            head = stream.read(26)
        width, height = (int.from_bytes(head[k : k + 4], "big") for k in (16, 20))
        if width * height > MOST_PIXELS:
            raise InputError(
                f"{argument}: {path!r} has {width}x{height} pixels; allowed are at most {MOST_PIXELS} of them"
            )
        if head[24:26] == b"\x10\x00":  # 16 bits of grey, which the decoder would cut off at 255
            grey = imageio.imread(file, plugin="pillow").astype(np.float64) / 65535.0
            return linear_from_display(np.repeat(grey[..., None], 3, axis=2))
        pixels = imageio.imread(file, plugin="pillow", mode="RGB")
    table = linear_from_display(np.arange(256.0).reshape(1, -1, 1).repeat(3, axis=2) / 255.0)[0, :, 0]
    return table[pixels]


@contextmanager
def _readable(argument: str, path: str) -> Iterator[None]:
    try:
        yield
    except InputError:
        raise
    except DECODERS_RAISE as error:
        reason = getattr(error, "strerror", None) or " ".join(str(error).split())
        raise InputError(f"{argument}: cannot read {path!r} ({reason}); allowed is an image file") from None


def _readable_suffix(argument: str, path: str) -> str:
    return _known_suffix(argument, path, (*SUFFIXES, ".hdr"))


def _known_suffix(argument: str, path: str | os.PathLike[str], known: Sequence[str] = SUFFIXES) -> str:
    suffix = as_path(argument, path).suffix.lower()
    if suffix not in known:
        raise InputError(f"{argument}: got {str(path)!r}; allowed are names that end in {', '.join(known)}")
    return suffix

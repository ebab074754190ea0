"""EXR files: parts, layers and channels by their names, of flat and of deep files.

The only file that imports OpenEXR. A channel's name is LAYER.LETTER, such as "ViewLayer.Combined.R"; one without a
point belongs to the layer "", or to the layer that its part is named by where a file has several parts.
"""

import io
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, redirect_stdout, suppress
from pathlib import Path
from threading import Lock
from tokenize import TokenError
from typing import Any

import numpy as np
import OpenEXR

from refdof._check import Float, InputError
from refdof._files import as_plain_file

__all__ = ["DECODERS_RAISE", "MOST_PIXELS", "is_deep", "read_layers", "save_channels"]

# What decoders of files raise.
DECODERS_RAISE = (
    OSError,
    ValueError,
    RuntimeError,
    EOFError,
    SyntaxError,
    TypeError,
    MemoryError,
    OverflowError,
    TokenError,  # NumPy, of a header that it takes for one of Python 2
)
MOST_PIXELS = 2**26  # of a picture that is read
_MOST_SIDE = 32768  # px, as of a camera
_MOST_BYTES = 2**31
_ONE_READER = Lock()  # standard streams are the process's
_STDERR = 2
_DEEP_BYTES = 128  # of an array of samples, which each channel of a deep pixel has


def save_channels(path: Path, channels: Mapping[str, Float]) -> None:
    """Write an EXR of float32, lossless (ZIP): {"RGB": (H, W, 3)} or channels of one number each, such as "Y"."""
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {name: values.astype(np.float32) for name, values in channels.items()}).write(str(path))


def read_layers(argument: str, path: str | os.PathLike[str]) -> dict[str, dict[str, np.ndarray]]:
    """The channels of a file by layer and letter.

    Returns
    -------
    {layer: {letter: (H, W)}}
        As stored, half, float or uint; of a deep file objects: arrays of samples, None where a pixel has none.

    Raises
    ------
    InputError
        If the file is missing, damaged or too large, its pixels are not square, or parts of it are cropped.
    """
    file = as_plain_file(argument, path)
    try:
        with open(file, "rb"):  # one that may not be read gets the system's own words, not the decoder's
            pass
        with _silence(), OpenEXR.File(str(file), separate_channels=True, header_only=True) as opened:
            counts = [_check_header(argument, path, part.header) for part in opened.parts]
        with _silence(), OpenEXR.File(str(file), separate_channels=True) as opened:
            parts = [(part.name() or "", {n: c.pixels for n, c in part.channels.items()}) for part in opened.parts]
        if [len(channels) for _, channels in parts] != counts:
            raise ValueError("pixels are damaged or missing")  # of which the decoder only warns
    except InputError:
        raise
    except DECODERS_RAISE as error:
        reason = getattr(error, "strerror", None) or " ".join(str(error).split())
        raise InputError(f"{argument}: cannot read {str(path)!r} ({reason}); allowed is an EXR file") from None
    return _by_layer(parts)


@contextmanager
def _silence() -> Iterator[None]:
    """Drop what the decoder prints about a damaged file: by Python, and into the process's stderr itself."""
    with _ONE_READER, redirect_stdout(io.StringIO()):
        kept = None
        with suppress(OSError):  # where it is closed
            kept = os.dup(_STDERR)
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, _STDERR)
            os.close(nowhere)
        try:
            yield
        finally:
            if kept is not None:
                os.dup2(kept, _STDERR)
                os.close(kept)


def is_deep(channel: np.ndarray) -> bool:
    """Whether a channel of `read_layers` has samples instead of numbers."""
    return channel.dtype == np.dtype(object)


def _by_layer(parts: list[tuple[str, dict[str, np.ndarray]]]) -> dict[str, dict[str, np.ndarray]]:
    layers: dict[str, dict[str, np.ndarray]] = {}
    for part, channels in parts:
        for name, pixels in channels.items():
            layer, _, letter = name.rpartition(".")
            layer = layer or (part if len(parts) > 1 else "")
            if letter in layers.get(layer, {}):  # two parts with the same names, as of stereo
                layer = f"{part}.{layer}" if layer != part else layer
            layers.setdefault(layer, {})[letter] = pixels
    return layers


def _check_header(argument: str, path: str | os.PathLike[str], header: Mapping[str, Any]) -> int:
    """How many channels a part has; raises before any pixel is read."""
    (left, top), (right, bottom) = (tuple(int(v) for v in corner) for corner in header["dataWindow"])
    window = tuple(tuple(int(v) for v in corner) for corner in header["displayWindow"])
    width, height, channels = right - left + 1, bottom - top + 1, len(header["channels"])
    deep = header["type"] in (OpenEXR.deepscanline, OpenEXR.deeptile)
    bytes_each = _DEEP_BYTES if deep else 4
    whole = width * height * channels * bytes_each
    if max(width, height) > _MOST_SIDE or width * height > MOST_PIXELS or whole > _MOST_BYTES:
        raise InputError(
            f"{argument}: {str(path)!r} has {width}x{height} pixels of {channels} channels; allowed are at most "
            f"{MOST_PIXELS} pixels and {_MOST_BYTES // 2**30} GiB, {bytes_each} bytes a channel"
        )
    if window != ((left, top), (right, bottom)):
        raise InputError(
            f"{argument}: {str(path)!r} holds pixels {left},{top} .. {right},{bottom} of {window[0][0]},{window[0][1]} "
            f".. {window[1][0]},{window[1][1]}; allowed is the whole picture"
        )
    if header.get("pixelAspectRatio", 1.0) != 1.0:
        raise InputError(
            f"{argument}: {str(path)!r} has pixels {header['pixelAspectRatio']:g} times as wide as high; allowed are "
            "square ones"
        )
    sampled = [c.name for c in header["channels"] if (c.xSampling, c.ySampling) != (1, 1)]
    if sampled:
        raise InputError(
            f"{argument}: channel {sampled[0]} of {str(path)!r} has fewer pixels than the picture; allowed is one each"
        )
    return channels

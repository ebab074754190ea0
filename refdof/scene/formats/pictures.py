"""Pictures that textures are made of: linear colours and opacity; what is broken is left out and told.

8-bit files of any kind that Pillow reads, and PNG files of 16 bits, which keep them.
"""

import io
import zlib
from typing import Any, NamedTuple

import numpy as np
from PIL import Image, UnidentifiedImageError

from refdof._check import Float
from refdof.scene.formats.png16 import depth_of_png, read_png16, refuse_lies
from refdof.scene.limits import Meter

__all__ = ["Picture", "Pictures", "decode_srgb", "encode_srgb"]

_BROKEN = (OSError, ValueError, SyntaxError, MemoryError, zlib.error)  # what Pillow and others raise


class Picture(NamedTuple):
    """h x w pixels; `opacity` is None where all are opaque."""

    color: Float  # (h, w, 3) float32, linear RGB
    opacity: Float | None  # (h, w) float32


class Pictures:
    """Every picture is read once and shared; `broken` has those that are left out, with the reason."""

    def __init__(self, meter: Meter) -> None:
        self._meter = meter
        self._known: dict[Any, Picture | None] = {}
        self.broken: dict[str, str] = {}

    def get(self, key: Any, name: str, data: bytes) -> Picture | None:
        """The picture of a file's bytes; None if they are broken, and `name` is told. One key is one picture."""
        if key not in self._known:
            try:
                self._known[key] = self._read(data)
            except UnidentifiedImageError:
                self._leave_out(key, name, "it is no picture")
            except _BROKEN as error:
                self._leave_out(key, name, str(error))
        return self._known[key]

    def of_image(self, key: Any, name: str, image: Any) -> Picture | None:
        """The same of an image that Pillow has opened."""
        if key not in self._known:
            try:
                self._meter.picture(image.width, image.height)
                self._known[key] = _picture(_stored(image))
            except _BROKEN as error:  # Pillow reads pixels only now
                self._leave_out(key, name, str(error))
        return self._known[key]

    def _leave_out(self, key: Any, name: str, reason: str) -> None:
        self._known[key] = None
        self.broken[name] = " ".join(reason.split())[:160]

    def _read(self, data: bytes) -> Picture:
        depth = depth_of_png(data)
        if depth is not None:
            self._meter.check(*depth[:2])
            refuse_lies(data)
            if depth[2] == 16:
                self._meter.picture(*depth[:2])
                return _picture(read_png16(data))
        largest, Image.MAX_IMAGE_PIXELS = Image.MAX_IMAGE_PIXELS, None  # the limit is the meter's
        try:
            with Image.open(io.BytesIO(data)) as image:
                self._meter.picture(image.width, image.height)
                return _picture(_stored(image))
        finally:
            Image.MAX_IMAGE_PIXELS = largest


def _stored(image: Any) -> np.ndarray:
    """(h, w, 3 or 4) uint8 or uint16."""
    if image.mode.startswith("I;16"):
        return np.repeat(np.asarray(image).astype(np.uint16)[:, :, None], 3, axis=2)
    clear = image.mode in ("RGBA", "LA", "PA", "RGBa", "La") or "transparency" in image.info
    return np.asarray(image.convert("RGBA" if clear else "RGB"))


def _picture(stored: np.ndarray) -> Picture:
    most = np.iinfo(stored.dtype).max
    shares = np.arange(most + 1) / most
    table = decode_srgb(shares).astype(np.float32)
    color = np.empty((*stored.shape[:2], 3), dtype=np.float32)
    for row, values in zip(color, stored, strict=True):  # a whole picture at once takes twice the memory
        np.take(table, values[:, :3], out=row)
    opacity = None
    if stored.shape[2] == 4 and (stored[:, :, 3] < most).any():
        opacity = shares.astype(np.float32)[stored[:, :, 3]]
    return Picture(color, opacity)


def encode_srgb(linear: Float) -> Float:
    """The inverse of `decode_srgb`."""
    return np.where(linear <= 0.0031308, linear * 12.92, 1.055 * np.maximum(linear, 0.0) ** (1 / 2.4) - 0.055)


def decode_srgb(encoded: Float) -> Float:
    """Linear values of sRGB-encoded ones, IEC 61966-2-1."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)

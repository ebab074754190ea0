"""Planes: what a page flips between, as text that a browser decodes.

A plane is embedded once: float16, the low and the high bytes apart, deflated and in base64, which is a third to a half
of plain base64. Finite values beyond 65504, the largest float16, are clipped to it; infinities and NaN stay. Depths and
circles are divided by a power of two before, which is exact, so that none is clipped. FLIP is rounded to 1/256.
Pictures of more than `FLOAT_LIMIT_PX` are embedded as 8-bit PNG, without maps.
"""

import base64
import math
import zlib
from typing import Any

import numpy as np

from refdof._check import Float
from refdof.comparison import Comparison
from refdof.image.file import png_bytes
from refdof.report.commands import picture_command
from refdof.report.crops import shown_crops
from refdof.report.rows import plain

__all__ = ["FLOAT_LIMIT_PX", "Planes", "float16_text", "png_text"]

FLOAT_LIMIT_PX = 2_200_000  # pictures with more pixels are embedded as PNG

_FLOAT16_MAX = 65504.0
_FLIP_STEPS = 256.0
_DIGITS = "1234567890"


class Planes:
    """The planes of a comparison: `about` tells the page of them, `payloads` are their texts.

    `kinds` has "float16" or "png" for each.
    """

    def __init__(self, comparison: Comparison, command: str = "", position: int = 0) -> None:
        height, width = comparison.standard[1].shape[:2]
        self.is_float = width * height <= FLOAT_LIMIT_PX
        self.payloads: list[str] = []
        self.kinds: list[str] = []
        self.images: list[dict[str, Any]] = []
        self._add_pictures(comparison, command, position)
        self._add_scalars(comparison)
        self.about = {
            "width": width,
            "height": height,
            "encoding": "float16" if self.is_float else "png",
            "scored": comparison.reference is not None,
            "images": self.images,
            "crops": [vars(crop) for crop in shown_crops(comparison)],
        }

    def _add_pictures(self, comparison: Comparison, command: str, position: int) -> None:
        standard, first = comparison.standard
        self._picture(standard, first, "r" if standard == "reference" else "p")
        if standard != "pinhole":
            self._picture("pinhole", comparison.pinhole, "p")
        for k, row in enumerate(comparison.rows):
            told = {
                "method": True,
                "params": [[key, str(plain(value))] for key, value in {"preset": row.preset, **row.params}.items()],
                "command": picture_command(command, row, position),
            }
            if self.is_float and row.flip_map is not None:
                told["flip"] = self._plane(np.rint(row.flip_map * _FLIP_STEPS) / _FLIP_STEPS)
            self._picture(row.name, row.image, _DIGITS[k : k + 1], told)
        if self.is_float and comparison.standard_error is not None:
            self._picture("standard error", comparison.standard_error, "s", {"error": True})

    def _add_scalars(self, comparison: Comparison) -> None:
        for name, values, key, facts in (
            ("depth", comparison.depth, "z", {"unit": "scene units", "empty": "background"}),
            ("circle of confusion", comparison.coc_px, "c", {"unit": "px", "signed": True}),
            ("layers", comparison.surface_counts, "l", {"unit": "surfaces at the pixel's centre"}),
        ):
            if values is not None:
                scale = scale_of(values)
                plane = self._plane(values / scale)
                self.images.append({"name": name, "key": key, "plane": plane, "scalar": True, "scale": scale, **facts})

    def _picture(self, name: str, image: Float, key: str, facts: dict[str, Any] | None = None) -> None:
        if self.is_float:
            plane = self._plane(image)
        else:
            plane = len(self.payloads)
            self.payloads.append(png_text(image))
            self.kinds.append("png")
        self.images.append({"name": name, "key": key, "plane": plane, **(facts or {})})

    def _plane(self, values: Float) -> int:
        """Embed an array; its number."""
        self.payloads.append(float16_text(values))
        self.kinds.append("float16")
        return len(self.payloads) - 1


def scale_of(values: Any) -> float:
    """The power of two that brings the largest finite magnitude of `values` into [2^14, 2^15); of none or 0: 1."""
    largest = float(np.abs(values[np.isfinite(values)]).max(initial=0.0))
    return math.ldexp(1.0, math.frexp(largest)[1] - 15) if largest > 0.0 else 1.0


def float16_text(values: Any) -> str:
    """An array as float16 in text."""
    clipped = np.where(np.isfinite(values), np.clip(values, -_FLOAT16_MAX, _FLOAT16_MAX), values)
    split = clipped.astype("<f2").view(np.uint8).reshape(-1, 2).T  # low bytes, then high bytes, which repeat
    return base64.b64encode(zlib.compress(split.tobytes(), 4)).decode("ascii")


def png_text(image: Float) -> str:
    """The display image as PNG in text."""
    return base64.b64encode(png_bytes(image)).decode("ascii")

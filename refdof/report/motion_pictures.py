"""Motion pictures: how the frames of a slow move look, as a moving picture and as strips for print.

A moving picture has the reference and every method side by side. A strip has one row of pixels over the frames, time
downwards, and beside it the size of its second differences: what moves evenly is dark there, what jumps is bright.
"""

import io
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np
import numpy.typing as npt
from matplotlib import get_data_path
from PIL import Image, ImageDraw, ImageFont

from refdof.comparison import Motion
from refdof.image.display import levels, to_8_bit
from refdof.image.file import PNG_STRATEGY
from refdof.metrics.artefacts import LOCATED

__all__ = ["DIFFERENCE_SCALE", "moving_png", "strips_png"]

DIFFERENCE_SCALE = 8

_WIDTH_PX = 1280  # at most; frames that are wider themselves are not made smaller
_MARGIN_PX, _GAP_PX, _NAME_PX, _VALUE_PX, _HEADER_PX = 16, 8, 16, 18, 24
_STRIP_PX = 64  # how high a strip is, or as many pixels as it has frames
_FRAME_MS, _LAST_MS = 80, 640  # the last frame stands longer, so that the way back is not taken for a jump
_INK, _PALE_INK = (17, 17, 17), (102, 102, 102)
_TIMES = "\N{MULTIPLICATION SIGN}"


def moving_png(motion: Motion) -> bytes:
    """An animated PNG: all pictures side by side, with names and flicker."""
    width, height = motion.size
    columns, bands, zoom = _grid(len(motion.pictures), width)
    cell, band = zoom * width + _GAP_PX, _NAME_PX + _VALUE_PX + zoom * height + _GAP_PX
    sheet = _blank(2 * _MARGIN_PX + columns * cell - _GAP_PX, 2 * _MARGIN_PX + bands * band - _GAP_PX)
    places = {}
    for k, name in enumerate(motion.pictures):
        x, y = _MARGIN_PX + k % columns * cell, _MARGIN_PX + k // columns * band
        _write(sheet, x, y, name, cell - _GAP_PX, bold=True)
        _write(sheet, x, y + _NAME_PX, _flicker_of(motion, name), cell - _GAP_PX)
        places[name] = x, y + _NAME_PX + _VALUE_PX
    frames = []
    for t in range(motion.frames):
        shown = sheet.copy()
        for name, place in places.items():
            picture = Image.fromarray(motion.pictures[name][t])
            shown.paste(picture.resize((zoom * width, zoom * height), Image.Resampling.NEAREST), place)
        frames.append(shown)
    return _png(frames)


def strips_png(motion: Motion) -> bytes:
    """A PNG: for each picture one row of pixels over the frames, and its second differences."""
    width, height = motion.size
    across = max(1, (_WIDTH_PX - 2 * _MARGIN_PX - _GAP_PX) // (2 * width))
    down = max(1, _STRIP_PX // motion.frames)
    left, right = _MARGIN_PX, _MARGIN_PX + across * width + _GAP_PX
    band = _NAME_PX + down * motion.frames + _GAP_PX
    sheet = _blank(right + across * width + _MARGIN_PX, 2 * _MARGIN_PX + _HEADER_PX + len(motion.strips) * band)
    about = f"Row {motion.row} of {height}, {motion.frames} frames, time downwards"
    _write(sheet, left, _MARGIN_PX, about, across * width, pale=True)
    difference = f"{DIFFERENCE_SCALE} {_TIMES} |second difference|, linear"
    _write(sheet, right, _MARGIN_PX, difference, across * width, pale=True)
    for k, (name, strip) in enumerate(motion.strips.items()):
        y = _MARGIN_PX + _HEADER_PX + k * band
        _write(sheet, left, y, name, across * width, bold=True)
        _write(sheet, right, y, _flicker_of(motion, name), across * width)
        change = np.minimum(DIFFERENCE_SCALE * np.abs(np.diff(strip, n=2, axis=0)), 1.0)
        _paste(sheet, to_8_bit(strip), (left, y + _NAME_PX), across, down)
        # Of a frame, its neighbours and the one between: the first and the last frame have none.
        _paste(sheet, levels(change), (right, y + _NAME_PX + down), across, down)
    return _png([sheet])


def _grid(count: int, width: int) -> tuple[int, int, int]:
    """Columns, bands, and how many times pictures are enlarged: as often as takes no further band."""

    def bands_at(zoom: int) -> int:
        columns = max(1, (_WIDTH_PX - 2 * _MARGIN_PX + _GAP_PX) // (zoom * width + _GAP_PX))
        return -(-count // columns)

    bands, zoom = bands_at(1), 1
    while zoom < 4 and bands_at(zoom + 1) == bands and (zoom + 1) * width <= _WIDTH_PX - 2 * _MARGIN_PX:
        zoom += 1
    return -(-count // bands), bands, zoom


def _flicker_of(motion: Motion, name: str) -> str:
    return f"flicker {motion.flicker[name]:.{LOCATED['flicker'].decimals}f}"


def _blank(width: int, height: int) -> Image.Image:
    return Image.new("RGB", (width, height), "white")


def _paste(sheet: Image.Image, pixels: npt.NDArray[np.uint8], place: tuple[int, int], across: int, down: int) -> None:
    """Pixels (h, w, 3) enlarged, its top left corner at `place`."""
    height, width = pixels.shape[:2]
    sheet.paste(Image.fromarray(pixels).resize((across * width, down * height), Image.Resampling.NEAREST), place)


def _write(sheet: Image.Image, x: int, y: int, text: str, room: int, *, bold: bool = False, pale: bool = False) -> None:
    """Text in a line, its top left at pixel (x, y), cut off after `room` pixels."""
    line = _blank(room, _VALUE_PX)
    font = _font("DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf")
    ImageDraw.Draw(line).text((0, 0), text, fill=_PALE_INK if pale else _INK, font=font)
    sheet.paste(line.crop((0, 0, room, _NAME_PX)), (x, y))


@cache
def _font(file: str) -> ImageFont.FreeTypeFont:
    """A font that comes with matplotlib, set letter by letter: the same on every machine."""
    path = Path(get_data_path()) / "fonts" / "ttf" / file
    return ImageFont.truetype(str(path), 13, layout_engine=ImageFont.Layout.BASIC)


def _png(frames: Sequence[Image.Image]) -> bytes:
    stream = io.BytesIO()
    first, *others = frames
    how: dict[str, object] = {"compress_type": PNG_STRATEGY}
    if others:
        times = [*([_FRAME_MS] * len(others)), _LAST_MS]
        how |= {"save_all": True, "append_images": others, "duration": times, "loop": 0}
    first.save(stream, format="PNG", **how)
    return stream.getvalue()

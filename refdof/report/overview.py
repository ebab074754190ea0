"""Overview: every method beside the reference in one figure, with two crops and the error each.

Each cell shows, from top to bottom: name and scores, the picture,
crops at a whole zoom factor (so that every pixel is equally large), and four times the absolute error of the
display image; under the reference four times its standard error. Methods are broken into bands of at most
five, each of which begins with the reference. Below them stands a real lens's chart, a strip for each.
"""

import math
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import cycle
from textwrap import wrap
from typing import TypeAlias

import numpy as np
import numpy.typing as npt
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.text import Text
from PIL import Image

from refdof._check import Float
from refdof.comparison import Box, Chart, Comparison
from refdof.image.atomic import atomic_path
from refdof.image.display import display, display_slope
from refdof.image.file import PNG_STRATEGY
from refdof.report.crops import crops_of, placed, squared_error
from refdof.report.table import noise_in_words, texts

__all__ = ["ERROR_SCALE", "write_overview"]

Levels: TypeAlias = npt.NDArray[np.uint8]

ERROR_SCALE = 4

_WIDTH_PX = 1600
_CELL_PX = 480  # at most, where few methods leave much room
_METHODS_PER_BAND = 5
_MARGIN_PX, _GAP_PX, _CROP_GAP_PX = 16, 12, 4
_HEADER_PX, _TITLE_PX, _LABEL_PX, _BAND_GAP_PX = 40, 46, 22, 22
_TALLEST = 1.6  # height / width of a picture; taller ones are made narrower
_FONT, _DPI = "DejaVu Sans", 100  # the font comes with matplotlib
_CROP_COLORS = ("#ff8c1a", "#19b5e8", "#7bc043", "#d65db1")
_TIMES = "\N{MULTIPLICATION SIGN}"
_INK, _PALE_INK = "#111111", "#666666"


@dataclass(frozen=True)
class _Layout:
    """Sizes in pixels of the figure; `crop`: of those that are chosen; `crops`: how high they stand, enlarged."""

    columns: int
    bands: int
    cell: int
    picture: tuple[int, int]
    crop: tuple[int, int]
    crops: int

    @property
    def band_height(self) -> int:
        return _TITLE_PX + 2 * self.picture[1] + _CROP_GAP_PX + self.crops + _LABEL_PX + _BAND_GAP_PX

    @property
    def size(self) -> tuple[int, int]:
        width = 2 * _MARGIN_PX + self.columns * (self.cell + _GAP_PX) - _GAP_PX
        return width, _HEADER_PX + self.bands * self.band_height


@dataclass(frozen=True, eq=False)
class _Cell:
    """What one cell shows: images (H, W, 3); where there is no error, nothing."""

    title: str
    scores: str
    image: Levels
    error_label: str
    error: Levels | None


def write_overview(comparison: Comparison, path: str | os.PathLike[str]) -> None:
    """Draw the figure into the PNG file `path`: at most 1600 px wide, as high as the methods need."""
    layout = _layout(comparison)
    width, height = layout.size
    strips = _strips(comparison.chart, width - 2 * _MARGIN_PX)
    bottom, height = height, height + sum(_LABEL_PX + strip.shape[0] for _, strip in strips) + bool(strips) * _MARGIN_PX
    figure = Figure(figsize=(width / _DPI, height / _DPI), dpi=_DPI, facecolor="white")
    FigureCanvasAgg(figure)
    _header(figure, comparison, width)

    canvas = np.full((height, width, 3), 255, dtype=np.uint8)
    (reference, *methods), crops = _cells(comparison, layout)
    for band in range(layout.bands):
        first = band * (layout.columns - 1)
        shown = [reference, *methods[first : first + layout.columns - 1]]
        for column, cell in enumerate(shown):
            x = _MARGIN_PX + column * (layout.cell + _GAP_PX)
            _draw_cell(figure, canvas, layout, cell, crops, x, _HEADER_PX + band * layout.band_height)
    for name, strip in strips:
        _text(figure, _MARGIN_PX, bottom + 3, name, 12, color=_PALE_INK)
        high, wide = strip.shape[:2]
        canvas[bottom + _LABEL_PX : bottom + _LABEL_PX + high, _MARGIN_PX : _MARGIN_PX + wide] = strip
        bottom += _LABEL_PX + high
    figure.figimage(canvas)

    with atomic_path(path) as temporary:
        how = {"compress_type": PNG_STRATEGY}
        figure.savefig(temporary, format="png", dpi=_DPI, metadata={"Software": None}, pil_kwargs=how)


def _layout(comparison: Comparison) -> _Layout:
    height, width = comparison.standard[1].shape[:2]
    count = len(comparison.rows)
    bands = max(1, math.ceil(count / _METHODS_PER_BAND))
    columns = 1 + math.ceil(count / bands)
    cell = min(_CELL_PX, (_WIDTH_PX - 2 * _MARGIN_PX + _GAP_PX) // columns - _GAP_PX)

    ratio = height / width
    picture_width = max(24, round(cell * min(1.0, _TALLEST / ratio)))
    picture_height = min(max(8, round(picture_width * ratio)), round(cell * _TALLEST))

    # A crop is about a fifth of the picture wide and fills, magnified, half of the cell's picture.
    room = (picture_width - _CROP_GAP_PX) // 2
    zoom = max(1, round(room / (width / 5.0)))
    crop_width = min(width, max(1, room // zoom))
    crop_height = min(height, max(1, round(crop_width * min(max(ratio, 0.5), 1.5))))
    crops = comparison.crops or (Box(0, 0, crop_width, crop_height),)
    _, crops_height = placed(crops, picture_width, _CROP_GAP_PX)
    return _Layout(columns, bands, cell, (picture_width, picture_height), (crop_width, crop_height), crops_height)


def _cells(comparison: Comparison, layout: _Layout) -> tuple[list[_Cell], tuple[Box, ...]]:
    """The reference's cell, or the pinhole's, then one for each method; and the crops. Pictures are encoded once."""
    name, first = comparison.standard
    standard, scored = display(first), comparison.reference is not None
    label, noise = "", None
    if comparison.standard_error is not None:
        label = f"{ERROR_SCALE} {_TIMES} standard error"
        noise = _levels(ERROR_SCALE * display_slope(first) * comparison.standard_error)
    shown = [_Cell(name, _noise(comparison), _levels(standard), label, noise)]
    total = np.zeros(standard.shape[:2])
    for row in comparison.rows:
        score = texts(row)
        told = f"{score['psnr']} dB · {score['ssim']} · {score['flip']}" if scored else ""
        image = display(row.image)
        total += squared_error(image, standard)
        error = _levels(ERROR_SCALE * np.abs(image - standard))
        what = "error" if scored else "difference"
        shown.append(_Cell(row.name, told, _levels(image), f"{ERROR_SCALE} {_TIMES} |{what}|", error))
    if comparison.crops:
        return shown, comparison.crops
    return shown, crops_of(total, squared_error(display(comparison.pinhole), standard), *layout.crop)


def _strips(chart: Chart | None, width: int) -> list[tuple[str, Levels]]:
    """A chart's rows, each words and the picture below them, none wider than `width`; first the caption, without."""
    if chart is None:
        return []
    lines = wrap(chart.caption, max(20, width // 7))  # a letter is 6 or 7 px wide
    rows: list[tuple[str, Levels]] = [(line, np.zeros((0, 0, 3), np.uint8)) for line in lines]
    for name, image in chart.pictures.items():
        levels = _levels(display(image))
        zoom = max(1, width // levels.shape[1])
        levels = levels.repeat(zoom, axis=0).repeat(zoom, axis=1)
        if levels.shape[1] > width:
            size = width, max(1, round(levels.shape[0] * width / levels.shape[1]))
            levels = np.asarray(Image.fromarray(levels).resize(size, Image.Resampling.HAMMING))
        rows.append((name, levels))
    return rows


def _levels(values: Float) -> Levels:
    """Of 0 .. 1, cut to it, in 8 bits: the figure holds every picture at full size until it is drawn."""
    levels: Levels = np.rint(255.0 * np.clip(values, 0.0, 1.0)).astype(np.uint8)
    return levels


def _noise(comparison: Comparison) -> str:
    return "no reference" if comparison.reference is None else noise_in_words(comparison.noise_floor_psnr)


def _header(figure: Figure, comparison: Comparison, width: int) -> None:
    height, columns = comparison.standard[1].shape[:2]
    about = f"{columns} {_TIMES} {height} px"
    if not math.isnan(comparison.samples):
        about += f", {comparison.samples:.0f} samples per pixel"
    name = _text(figure, _MARGIN_PX, 12, comparison.scene, 17, weight="bold")
    end = name.get_window_extent(figure.canvas.get_renderer()).x1  # type: ignore[attr-defined]
    _text(figure, end + 14, 15, about, 13, color=_PALE_INK)
    if width > 900 and comparison.reference is not None:
        _text(
            figure,
            width - _MARGIN_PX,
            15,
            "PSNR · SSIM · FLIP of the display image",
            13,
            color=_PALE_INK,
            align="right",
        )


def _draw_cell(
    figure: Figure, canvas: Levels, layout: _Layout, cell: _Cell, crops: Sequence[Box], x: int, y: int
) -> None:
    """Pictures into `canvas`, frames and words into `figure`; the cell's top left pixel is (x, y)."""
    width, height = layout.picture
    _text(figure, x, y + 4, cell.title, 15, weight="bold")
    _text(figure, x, y + 24, cell.scores, 13)
    y += _TITLE_PX
    _draw_picture(figure, canvas, cell.image, crops, (x, y, width, height))
    y += height + _CROP_GAP_PX
    for crop, color, (left, top, wide, high) in zip(
        crops, _colors(), placed(crops, width, _CROP_GAP_PX)[0], strict=False
    ):
        _draw_image(canvas, crop.of(cell.image), (x + left, y + top, wide, high))
        _draw_frame(figure, (x + left, y + top, wide, high), color, 2.0)
    y += layout.crops
    _text(figure, x, y + 5, cell.error_label, 12, color=_PALE_INK)
    if cell.error is not None:
        _draw_picture(figure, canvas, cell.error, crops, (x, y + _LABEL_PX, width, height))


def _draw_picture(
    figure: Figure, canvas: Levels, image: Levels, crops: Sequence[Box], place: tuple[int, int, int, int]
) -> None:
    _draw_image(canvas, image, place)
    x, y, width, height = place
    across, down = width / image.shape[1], height / image.shape[0]
    for crop, color in zip(crops, _colors(), strict=False):
        window = (x + crop.x * across, y + crop.y * down, crop.width * across, crop.height * down)
        _draw_frame(figure, window, color, 1.4)


def _colors() -> Iterator[str]:
    """A colour for each crop, and again from the first."""
    return cycle(_CROP_COLORS)


def _draw_image(canvas: Levels, image: Levels, place: tuple[int, int, int, int]) -> None:
    """An image at (left, top, width, height), smoothly made smaller, or with pixels repeated."""
    x, y, width, height = place
    smaller = width < image.shape[1] or height < image.shape[0]
    how = Image.Resampling.HAMMING if smaller else Image.Resampling.NEAREST
    shown = Image.fromarray(np.ascontiguousarray(image)).resize((width, height), how)
    canvas[y : y + height, x : x + width] = np.asarray(shown)


def _draw_frame(figure: Figure, place: tuple[float, float, float, float], color: str, line_width: float) -> None:
    """A frame around (left, top, width, height) [px]."""
    x, y, width, height = place
    corner = (x, _full_size(figure)[1] - y - height)
    figure.add_artist(
        Rectangle(corner, width, height, transform=None, fill=False, edgecolor=color, linewidth=line_width)
    )


def _full_size(figure: Figure) -> tuple[int, int]:
    width, height = figure.get_size_inches() * _DPI
    return round(width), round(height)


def _text(
    figure: Figure,
    x: float,
    y: float,
    text: str,
    size: float,
    *,
    color: str = _INK,
    weight: str = "normal",
    align: str = "left",
) -> Text:
    """Text with its top left (or right) at pixel (x, y); `size` in pixels. A "$" is only a "$"."""
    full_width, full_height = _full_size(figure)
    return figure.text(
        x / full_width,
        1.0 - y / full_height,
        text,
        fontsize=size * 72.0 / _DPI,
        color=color,
        fontweight=weight,
        fontfamily=_FONT,
        horizontalalignment=align,
        verticalalignment="top",
        parse_math=False,
    )

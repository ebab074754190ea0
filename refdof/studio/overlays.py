"""Overlays: circles of confusion, the focal surface, depth, layers and error as colours, with a scale."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from refdof._check import Float
from refdof.image.display import display, levels
from refdof.view import View

__all__ = ["Legend", "draw_overlay", "error_map"]

Levels = npt.NDArray[np.uint8]
Colors = tuple[tuple[float, float, float], ...]

_SIGNED = ((0.13, 0.40, 0.85), (1.0, 1.0, 1.0), (0.80, 0.20, 0.10))  # in front of, in and behind the focus
_GREYS = ((1.0, 1.0, 1.0), (0.1, 0.1, 0.1))  # near and far
_EMPTY = (0.15, 0.15, 0.17)  # background
_HIGHLIGHT = (1.0, 0.55, 0.0)
_HEAT = ((0.0, 0.0, 0.0), (0.55, 0.05, 0.35), (0.95, 0.45, 0.10), (1.0, 1.0, 0.75))
_SHARE = 98.0  # percent of the circles that the scale spans: few large ones do not make all others white
_SHARP_PX = 1.0  # radius of a circle that still looks sharp
_MOST_LAYERS = 8  # more have the last colour
_LARGEST_ERROR = 0.25  # of display values


class Legend(NamedTuple):
    """The ends of a scale, what it measures, and its colours from low to high, #rrggbb."""

    low: float
    high: float
    unit: str
    colors: tuple[str, ...]


def draw_overlay(overlay: str, view: View, image: Float | None) -> tuple[Levels, Legend]:
    """The overlay "coc", "focus" (over a linear picture), "depth" or "layers" of a view: levels (H, W, 3)."""
    if overlay == "coc":
        coc = view.coc_px()
        seen = np.isfinite(view.pinhole().depth)
        most = max(float(np.percentile(np.abs(coc[seen]), _SHARE)) if seen.any() else 0.0, _SHARP_PX)
        return levels(_ramp(coc, (-most, 0.0, most), _SIGNED)), Legend(-most, most, "px", _names(_SIGNED))
    if overlay == "focus":
        assert image is not None
        sharp = np.clip(2.0 - np.abs(view.coc_px()) / _SHARP_PX, 0.0, 1.0)[..., None] * 0.6
        mixed = display(image) * (1.0 - sharp) + np.array(_HIGHLIGHT) * sharp
        return levels(mixed.astype(np.float32)), Legend(0.0, _SHARP_PX, "px in focus", _names((_HIGHLIGHT,)))
    if overlay == "depth":
        depth = view.pinhole().depth
        seen = np.isfinite(depth)
        near, far = (float(depth[seen].min()), float(depth[seen].max())) if seen.any() else (1.0, 1.0)
        shade = np.array([near, max(far, near * (1.0 + 1e-9))])
        colors = _ramp(-1.0 / np.where(seen, depth, far), tuple(-1.0 / shade), _GREYS)
        colors[~seen] = _EMPTY
        return levels(colors), Legend(near, far, "scene units", _names(_GREYS))
    counts = view.surface_counts(2).astype(np.float64)
    steps = np.linspace(0.0, _MOST_LAYERS, len(_HEAT))
    return levels(_ramp(counts, tuple(steps), _HEAT)), Legend(0.0, float(_MOST_LAYERS), "layers", _names(_HEAT))


def error_map(image: Float, reference: Float, samples: int) -> tuple[Levels, Legend]:
    """The largest difference of the display channels of two linear pictures: levels (H, W, 3)."""
    error = np.abs(display(image) - display(reference)).max(axis=2)
    root = float(np.sqrt(np.mean((display(image).astype(np.float64) - display(reference)) ** 2)))
    steps = np.linspace(0.0, _LARGEST_ERROR, len(_HEAT))
    unit = f"of white; RMSE {root:.4f} beside {samples} lens samples a pixel"
    return levels(_ramp(error, tuple(steps), _HEAT)), Legend(0.0, _LARGEST_ERROR, unit, _names(_HEAT))


def _names(colors: Colors) -> tuple[str, ...]:
    return tuple("#" + "".join(f"{round(255 * value):02x}" for value in color) for color in colors)


def _ramp(values: Float, places: tuple[float, ...], colors: Colors) -> Float:
    """Display colours (H, W, 3) float32 of values, linear between places in growing order."""
    channels = [np.interp(values, places, channel) for channel in zip(*colors, strict=True)]
    return np.stack(channels, axis=2).astype(np.float32)

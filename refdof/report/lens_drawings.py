"""Drawings of a lens: cross-section with rays, spots, longitudinal aberration and field curvature.

The file of lenses that imports matplotlib. The same lens gives the same bytes.
"""

import math
import os
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from refdof._check import Float
from refdof.optics.systems.data_sheet import HEIGHTS
from refdof.optics.systems.field import bundle, chief_rays, focal_surfaces, longitudinal_aberration, spot
from refdof.optics.systems.glass import LINE_D
from refdof.optics.systems.paraxial import entrance_pupil
from refdof.optics.systems.system import LensSystem, Surface
from refdof.optics.systems.trace import trace, trace_path
from refdof.report.text import one_line

__all__ = ["draw_lens"]

RGB_UM = {"red": 0.650, "green": 0.510, "blue": 0.475}  # of Lee, Eisemann & Seidel 2010 [um]
_COLORS = {"red": "#c62828", "green": "#2e7d32", "blue": "#1565c0"}
_FIELD_COLORS = ("#1565c0", "#2e7d32", "#c62828")
_GLASS, _FLINT, _EDGE, _INK = "#d6e6f5", "#b3cbe6", "#4a6178", "#222222"
_DENSE = 1.62  # n_d from which glass is drawn darker
_DPI = 100
_RAYS = 7  # of each bundle in the cross-section
_WIDEST, _TALLEST, _SIDES = 10.0, 7.5, 1.0  # [inches] of the cross-section's axes, and what is beside them
_AHEAD = 0.35  # of the lens's length, drawn in front of it


def draw_lens(system: LensSystem, distance: float, paths: Sequence[str | os.PathLike[str]]) -> None:
    """Write four PNG files: cross-section, spots, longitudinal aberration, field curvature.

    Parameters
    ----------
    system : LensSystem
        Focused at `distance` [mm] before its entrance pupil; ``inf`` is allowed.
    paths : four paths, in this order
    """
    drawings: tuple[Callable[[LensSystem, float], Figure], ...] = (
        _cross_section,
        _spots,
        _longitudinal,
        _field_curvature,
    )
    for draw, path in zip(drawings, paths, strict=True):
        figure = draw(system, distance)
        FigureCanvasAgg(figure).print_png(path, metadata={"Software": None})


def _cross_section(system: LensSystem, distance: float) -> Figure:
    """The lens cut along its axis, with bundles of three film heights, and the film."""
    top = 1.2 * max(HEIGHTS[-1], *(surface.semi_diameter for surface in system.surfaces))
    ahead = _AHEAD * system.sensor
    left, right = -ahead, system.sensor + 0.04 * (system.sensor + ahead)
    scale = min(_WIDEST / (right - left), _TALLEST / (2.0 * top))  # inches per mm
    width, height_in = scale * (right - left) + _SIDES, scale * 2.0 * top + _SIDES
    figure = Figure(figsize=(width, height_in), dpi=_DPI)
    axes = figure.add_axes(
        (0.7 / width, 0.55 / height_in, scale * (right - left) / width, scale * 2.0 * top / height_in)
    )
    for color, height in zip(_FIELD_COLORS, (HEIGHTS[0], HEIGHTS[1], HEIGHTS[-1]), strict=True):
        for line in _bundle_lines(system, distance, height, ahead):
            axes.plot(line[:, 2], line[:, 1], color=color, linewidth=0.8, zorder=3)
        axes.plot([], [], color=color, label=f"film height {height:g} mm")
    _draw_glass(axes, system)
    axes.plot([system.sensor] * 2, [-HEIGHTS[-1], HEIGHTS[-1]], color=_INK, linewidth=2.0, zorder=4)
    axes.text(system.sensor, -HEIGHTS[-1], "film", va="top", ha="center", fontsize=9)
    axes.axhline(0.0, color=_INK, linewidth=0.5, linestyle=(0, (8, 3, 2, 3)), zorder=1)
    axes.set_aspect("equal")
    axes.set_xlim(left, right)
    axes.set_ylim(-top, top)
    axes.set_xlabel("z [mm]")
    axes.set_ylabel("y [mm]")
    axes.set_title(f"{one_line(system.name)}, focused at {_words(distance)}", fontsize=11)
    axes.legend(loc="upper left", fontsize=8, framealpha=0.9)
    return figure


def _bundle_lines(system: LensSystem, distance: float, height: float, ahead: float) -> list[Float]:
    """Rays of one film height in the plane of the drawing: points (S + 2, 3) from `ahead` to the film."""
    chief = chief_rays(system, np.array([height]))
    if not np.isfinite(chief.origins).all():
        return []
    reach = 3.0 * system.surfaces[0].semi_diameter + entrance_pupil(system).radius
    low, high = -reach, reach
    for count in (2000, _RAYS):
        y = np.linspace(low, high, count)
        rays = bundle(system, chief, np.column_stack([np.zeros(count), y]), distance)
        passed = trace(system, *rays, LINE_D).passed
        if not passed.any():
            return []
        low, high = float(y[passed].min()), float(y[passed].max())
    path = trace_path(system, *rays, LINE_D)[passed]
    ends = trace(system, *rays, LINE_D)
    at_film = ends.origins + (system.sensor - ends.origins[:, 2:]) / ends.directions[:, 2:] * ends.directions
    start = path[:, 1] + (-ahead - path[:, 1, 2:]) / rays.directions[passed][:, 2:] * rays.directions[passed]
    return list(np.concatenate([start[:, None], path[:, 1:], at_film[passed][:, None]], axis=1))


def _draw_glass(axes: Any, system: LensSystem) -> None:
    """Every piece of glass, filled between its two surfaces, and the stop as two bars."""
    for k, (surface, z) in enumerate(zip(system.surfaces, system.vertices.tolist(), strict=True)):
        front = _arc(surface, z)
        if surface.glass.index(LINE_D) > 1.0:
            behind = system.surfaces[k + 1]
            back = _arc(behind, float(system.vertices[k + 1]))
            rim = max(surface.semi_diameter, behind.semi_diameter)  # the narrower surface has a flat flange
            outline = np.concatenate([_flanged(front, rim), _flanged(back, rim)[::-1], _flanged(front, rim)[:1]])
            color = _FLINT if surface.glass.index(LINE_D) > _DENSE else _GLASS
            axes.fill(*outline.T, facecolor=color, edgecolor=_EDGE, linewidth=1.0, zorder=2)
        if surface.is_stop:
            edge, top = surface.sag(surface.semi_diameter) + z, surface.semi_diameter
            outer = top + max(0.25 * top, 1.0)
            for sign in (-1.0, 1.0):
                axes.plot(
                    [edge] * 2, [sign * top, sign * outer], color=_INK, linewidth=3.0, solid_capstyle="butt", zorder=5
                )
            axes.text(edge, outer, "stop", va="bottom", ha="center", fontsize=9, zorder=5)


def _arc(surface: Surface, z: float) -> Float:
    """The surface in the drawing: (61, 2) of z and y, from below to above."""
    heights = np.linspace(-surface.semi_diameter, surface.semi_diameter, 61)
    return np.array([[z + surface.sag(abs(height)), height] for height in heights])


def _flanged(arc: Float, rim: float) -> Float:
    """An arc with straight ends that reach as far from the axis as `rim`."""
    return np.concatenate([[[arc[0, 0], -rim]], arc, [[arc[-1, 0], rim]]])


def _spots(system: LensSystem, distance: float) -> Figure:
    """Where the rays of a point meet the film, for film heights and three wavelengths."""
    figure = Figure(figsize=(11.0, 3.6), dpi=_DPI)
    figure.subplots_adjust(0.06, 0.12, 0.99, 0.79, wspace=0.3)
    figure.suptitle(f"{one_line(system.name)}, focused at {_words(distance)}: spots", fontsize=11)
    for axes, height in zip(figure.subplots(1, len(HEIGHTS)), HEIGHTS, strict=True):
        points = {name: 1000.0 * spot(system, height, distance, um) for name, um in RGB_UM.items()}
        everything = np.concatenate(list(points.values()))
        for name in ("red", "blue", "green"):
            axes.scatter(*points[name].T, s=2.0, color=_COLORS[name], linewidths=0.0, alpha=0.6)
        if len(everything):
            low, high = everything.min(axis=0), everything.max(axis=0)
            middle, half = 0.5 * (low + high), 0.55 * max(float((high - low).max()), 1.0)
            axes.set_xlim(middle[0] - half, middle[0] + half)
            axes.set_ylim(middle[1] - half, middle[1] + half)
            rms = math.sqrt(float(((points["green"] - points["green"].mean(axis=0)) ** 2).sum(axis=1).mean()))
            note = f"green: {rms:.{1 if rms < 100.0 else 0}f} \N{MICRO SIGN}m rms"
        else:
            note = "no light"
        axes.set_title(f"{height:g} mm\n{note}", fontsize=9)
        axes.set_aspect("equal")
        axes.tick_params(labelsize=7)
        axes.set_xlabel("x [\N{MICRO SIGN}m]", fontsize=8)
    figure.axes[0].set_ylabel("y [\N{MICRO SIGN}m]", fontsize=8)
    return figure


def _longitudinal(system: LensSystem, distance: float) -> Figure:
    """Where rays of the axis cross it, by their height in the pupil, for three wavelengths."""
    figure, axes = _plot(f"{one_line(system.name)}, focused at {_words(distance)}:\nlongitudinal aberration")
    fractions = np.linspace(0.01, 1.0, 100)
    for name, um in RGB_UM.items():
        where = longitudinal_aberration(system, fractions, distance, um)
        axes.plot(where, fractions, color=_COLORS[name], label=f"{name}, {1000.0 * um:g} nm")
    axes.set_ylim(0.0, 1.0)
    axes.set_ylabel("height in the entrance pupil / its radius")
    axes.legend(fontsize=8)
    return figure


def _field_curvature(system: LensSystem, distance: float) -> Figure:
    """Where narrow bundles are sharp, by film height: rays beside the chief ray, and above and below it."""
    figure, axes = _plot(f"{one_line(system.name)}, focused at {_words(distance)}:\nfield curvature")
    heights = np.linspace(0.0, HEIGHTS[-1], 50)
    sagittal, tangential = focal_surfaces(system, heights, distance)
    axes.plot(sagittal, heights, color=_COLORS["blue"], label="sagittal")
    axes.plot(tangential, heights, color=_COLORS["red"], linestyle="--", label="tangential")
    axes.set_ylim(0.0, HEIGHTS[-1])
    axes.set_ylabel("film height [mm]")
    axes.legend(fontsize=8)
    return figure


def _plot(title: str) -> tuple[Figure, Any]:
    """A graph over the distance from the film."""
    figure = Figure(figsize=(5.0, 5.0), dpi=_DPI)
    axes = figure.add_axes((0.14, 0.11, 0.82, 0.79))
    axes.axvline(0.0, color=_INK, linewidth=0.8)
    axes.set_xlabel("from the film along the axis [mm]; below 0: in front of it")
    axes.set_title(title, fontsize=10)
    axes.grid(color="#dddddd")
    axes.set_axisbelow(True)
    return figure, axes


def _words(distance: float) -> str:
    return "infinity" if math.isinf(distance) else f"{distance / 1000.0:g} m"

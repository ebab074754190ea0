"""Measures of what is seen past a blurred foreground: detail through bars, and branches that appear apart."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy import ndimage

from refdof._check import Float
from refdof.claims.bench import Bench, params_of, preset_of
from refdof.rendering import render_view
from refdof.truth.reference import reference_of_view
from refdof.view import View

__all__ = ["OCCLUSION"]

Render = Mapping[str, Any]
_DARK = 0.7  # of white: what is darker belongs to a branch
_WIDE_PX = 2.0  # gaps that are looked at
_ALIKE_PX = 1.0  # gaps as good as equal
_SAMPLES = 256


def hidden_detail(bench: Bench, shot: Mapping[str, Any], renders: Sequence[Render]) -> float:
    """Share of the variance of what the reference shows through bars that a render shows, too; the most of renders.

    Of pixels whose pinhole sees a bar more than 2 px out of focus, grey values less their mean over a few pixels of
    bar, so that the bars' own shading does not count; the square of the correlation.
    """
    bars = bench.view(shot).coc_px() < -2.0
    truth = _detail(bench.truth(shot), bars)
    found = [np.corrcoef(truth, _detail(bench.image(shot, render), bars))[0, 1] for render in renders]
    return max(float(max(value, 0.0) ** 2) for value in found)


def _detail(image: Float, bars: Any) -> Float:
    grey, inside = image.mean(axis=-1).astype(np.float64), bars.astype(np.float64)
    weight = np.maximum(ndimage.gaussian_filter(inside, 2.0), 1e-9)
    detail: Float = (grey - ndimage.gaussian_filter(grey * inside, 2.0) / weight)[bars]
    return detail


def branches_apart(bench: Bench, size: str, renders: Sequence[Render]) -> float:
    """Share of columns in which a render shows the gap between two crossing branches that the reference shows.

    The barks of `branches`, black before white; gaps of 2 px or more, shown within 1 px; the most of renders.
    """
    view, truth = bench.keep(["branches apart", size], lambda: _black_branches(bench, size))
    middle = view.camera.width // 2
    columns = range(middle - view.camera.width // 4, middle - view.camera.width // 32)
    right = {x: gap for x in columns if (gap := _gap(truth[:, x])) is not None and gap >= _WIDE_PX}
    shares = []
    for render in renders:
        image = render_view(render["method"], view, preset=preset_of(render), **params_of(render)).image[..., 0]
        gaps = [(true, _gap(image[:, x])) for x, true in right.items()]
        shares.append(np.mean([gap is not None and abs(gap - true) <= _ALIKE_PX for true, gap in gaps]))
    return float(max(shares))


def _black_branches(bench: Bench, size: str) -> tuple[View, Float]:
    shot = bench.view({"scene": "branches", "size": size})
    scene = shot.scene
    depth = -scene.camera.camera_from_world(scene.vertices)[scene.faces][..., 2].max(axis=1)
    kept = (depth < 1.5) & (scene.face_material < 2)  # without screen, flowers and butterfly
    black = tuple(replace(material, texture=None, base_color=(0.0,) * 3) for material in scene.materials)
    scene = replace(scene, faces=scene.faces[kept], face_material=scene.face_material[kept], materials=black)
    view = View(replace(scene, background=(1.0,) * 3), shot.camera, shot.lens)
    return view, reference_of_view(view, _SAMPLES).image[..., 0]


def _gap(column: Float) -> float | None:
    """Length [px] of the bright part of a column between its first two dark runs; None: there is none."""
    edge = np.flatnonzero((column[:-1] < _DARK) != (column[1:] < _DARK))
    if len(edge) < 4:
        return None
    at = edge + (_DARK - column[edge]) / (column[edge + 1] - column[edge])
    return float(at[2] - at[1])


OCCLUSION: dict[str, Any] = {function.__name__: function for function in (hidden_detail, branches_apart)}

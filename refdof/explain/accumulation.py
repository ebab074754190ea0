"""Accumulation: the rays of a pixel through the lens: what each sees, and where it left the lens and met a surface.

1. Trace one point of the net at a time: its colour      `refdof.truth.lens_rays.trace_block`
2. Trace it through surfaces that show their depth and number instead of their colour       `_measured`
3. Trace it against a card close to the lens that shows its place: where the ray leaves the lens   `_lens_points`
"""

from typing import Any

import numpy as np

from refdof._check import Float
from refdof.explain.explanation import COLOR, Explanation
from refdof.methods.accumulation import render
from refdof.optics.aperture_sampling import aperture_sampler_of
from refdof.optics.owen_sobol import block_of
from refdof.raster.materials.texel import TEXTURE_COLUMNS
from refdof.raster.rays.embree import Tracer, new_packets, new_query, new_tracer
from refdof.raster.rays.surfaces import Surfaces
from refdof.scene.material import SHADINGS
from refdof.stages import StageRecorder
from refdof.truth.lens_rays import Aim, Traversal, trace_block
from refdof.truth.tile_sampler import power_of_two
from refdof.view import View

__all__ = ["explain"]

_COLUMNS = ("ray", "lens_x", "lens_y", "triangle", "x", "y", "depth", "coc", *COLOR, "weight")
_WHAT = "rays: each colour is what the method traces for that lens point alone; no triangle: the background"


def explain(view: View, params: Any, pixel: tuple[int, int]) -> Explanation:
    """Every ray."""
    x, y = pixel
    seen = view.pinhole()
    value = render(view, params, StageRecorder())[y, x].astype(np.float64)
    if view.lens.radius == 0.0:
        row = [0, 0.0, 0.0, np.nan, x + 0.5, y + 0.5, seen.depth[y, x], 0.0, *value, 1.0]
        rows, what = np.array([row]), "the pinhole's ray: the lens is a point"
    else:
        rows, what = _rays(view, params, pixel), _WHAT
    return Explanation(
        "accumulation", "image", pixel, view.camera.size, value, what, _COLUMNS, rows, picture=seen.color
    )


def _rays(view: View, params: Any, pixel: tuple[int, int]) -> Float:
    """`_COLUMNS` of every ray; x and y: where the pinhole would see what the ray meets [px]."""
    count = int(power_of_two(params.samples))
    aim = Aim(
        view.projection(), aperture_sampler_of(view.lens.aperture), np.uint32(params.seed), params.shared_pattern, False
    )
    surfaces, camera = view.surfaces(), view.camera
    colors = _traced(surfaces, view.tracer(), aim, pixel, count)
    depth, triangle = _measured(surfaces, view.tracer(), aim, pixel, count)
    points = _lens_points(view, aim, pixel, count)
    coc = np.full(count, np.nan)
    met = ~np.isnan(triangle)
    coc[met] = view.lens.coc_px(depth[met], camera)
    place = np.array([side + 0.5 for side in pixel]) + coc[:, None] * points * [-1.0, 1.0]
    return np.column_stack([np.arange(count), points, triangle, place, depth, coc, colors, np.full(count, 1.0 / count)])


def _traced(surfaces: Surfaces, tracer: Tracer, aim: Aim, pixel: tuple[int, int], count: int) -> Float:
    """What each of `count` rays sees: (count, 3)."""
    query, packets = new_query(tracer, coherent=True), new_packets(1)
    traversal = Traversal(tracer.scene, tracer.packet, query, packets)
    sums = np.zeros((count, 1, 1, 3))
    for n in range(count):
        trace_block(surfaces, traversal, aim, block_of(n, 0), np.array([pixel], dtype=np.int64), sums[n])
    return sums[:, 0, 0]


def _measured(surfaces: Surfaces, tracer: Tracer, aim: Aim, pixel: tuple[int, int], count: int) -> tuple[Float, Float]:
    """Depth [scene units] and triangle of what each ray meets, (count,) each; NaN: nothing."""
    corner = surfaces.corner.reshape(-1, 3, 3)
    values = np.ones_like(corner)
    values[..., 0] = -corner[..., 2]
    values[..., 1] = np.arange(len(corner))[:, None]
    depth, number, there = _traced(_showing(surfaces, corner, values), tracer, aim, pixel, count).T
    nothing = there < 0.5
    return np.where(nothing, np.nan, depth * 2.0**surfaces.exponent), np.where(nothing, np.nan, np.rint(number))


def _lens_points(view: View, aim: Aim, pixel: tuple[int, int], count: int) -> Float:
    """Where each ray leaves the lens, in units of its radius, x right, y up: (count, 2)."""
    projection = aim.projection
    depth = min(projection.lens_radius, 0.5 / projection.inverse_focus if projection.inverse_focus > 0.0 else np.inf)
    side = 4.0 * (projection.lens_radius + depth * max(view.camera.size) / projection.pixels_per_tangent)
    corners = np.array([[-side, -side, -depth], [3.0 * side, -side, -depth], [-side, 3.0 * side, -depth]])
    card = _showing(view.surfaces(), corners[None], corners[None])
    on_card = _traced(card, new_tracer(corners, np.array([[0, 1, 2]])), aim, pixel, count)[:, :2]
    tangent = np.array([pixel[0] + 0.5, -pixel[1] - 0.5]) - 0.5 * np.array([projection.width, -projection.height])
    straight = tangent / projection.pixels_per_tangent * depth
    return (on_card - straight) / (1.0 - depth * projection.inverse_focus) / projection.lens_radius


def _showing(surfaces: Surfaces, corner: Float, values: Float) -> Surfaces:
    """Triangles (F, 3, 3) that show the values (F, 3, 3) of their corners, before black."""
    count = len(values)
    attribute = np.zeros((count, 24), dtype=np.float32)
    attribute[:, :9] = values.reshape(count, 9)
    light = surfaces.light.copy()
    light[5] = 0.0
    return surfaces._replace(
        corner=np.ascontiguousarray(corner.reshape(count, 9)),
        attribute=attribute,
        face_material=np.zeros(count, dtype=np.int32),
        shading=np.array([SHADINGS.index("unlit")], dtype=np.int32),
        base_color=np.ones((1, 3)),
        emission=np.zeros((1, 3)),
        specular=np.zeros((1, 3)),
        shininess=np.ones(1),
        texture=np.zeros((1, TEXTURE_COLUMNS), dtype=np.int64),
        emission_texture=np.zeros((1, TEXTURE_COLUMNS), dtype=np.int64),
        light=light,
    )

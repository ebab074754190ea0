"""Tile rays: the lens rays of a tile of neighbouring pixels, where they can hit, and where they leave the picture.

1. cut the rays of each pixel to the depths at which they can hit     `cut_rays`
   (rays of a lens system are traced through it here, and kept)
2. aim one ray of each pixel                                          `aim`
3. find out where it comes into the picture, if not inside it         `enter`
4. after the walk, tell whether a ray without a hit is a miss         `is_missed`

References
----------
.. [1] Lee, Eisemann & Seidel (2010), Real-Time Lens Blur Effects and Focus Control, Section 3.
"""

import numpy as np

from refdof._jit import inline
from refdof.methods.lensblur.footprint import narrow, ray_bounds
from refdof.methods.lensblur.texel_walk import PACK, Ray, enter_picture
from refdof.optics.ray_map import even_light, ray_block
from refdof.optics.systems.lens_map import new_scratch

__all__ = ["aim", "brightness", "cut_rays", "enter", "is_mapped", "is_missed", "new_mapped_memory"]


@inline
def new_mapped_memory(ray_map, pixels, rays):
    """Memory (5, pixels, rays) for what a lens system does with each ray; a thin lens needs none."""
    return np.empty((5, 0, 0)) if ray_map is None else np.empty((5, pixels, rays))


@inline
def cut_rays(stack, shared, own, points, chosen, left, y, near, far, inside):
    """Where the rays of pixels left .. of row y can hit: near, far (G, count); and whether they stay in the picture.

    A lens system's rays and weights come to `own` (5, pixels, R). Returns whether all rays stay in the picture.
    """
    packs, focus, top = stack.packs, shared.focus, shared.top
    height, width, scalar = packs.shape[1], packs.shape[2], packs.dtype.type
    rays = np.empty((4, points.shape[1]), dtype=packs.dtype)
    nearest, within = max(top.max(), scalar(0.0)), True
    reach = np.inf if is_mapped(shared.ray_map) else _reach(shared.spread, focus, nearest, width, height)
    for k in range(near.shape[1]):
        x, half = left + k, scalar(0.5)
        center = scalar(x) + half, scalar(y) + half, focus
        inside[k] = reach < min(x, y) and x + 1 + reach < width and y + 1 + reach < height
        if shared.stride > 0 or not inside[k]:
            _aim_all(shared.ray_map, shared, own, k, points[chosen[k]], center, rays)
            inside[k] = _all_inside(rays, nearest, width, height)
            within = within and inside[k]
        for group in range(len(near)):
            near[group, k], far[group, k] = narrow(
                stack, group, rays, shared.stride, center, top[group], scalar(0.0), shared.iterations
            )
    return within


@inline
def _reach(spread, focus, near, width, height):
    """How far [px] a ray may stray from its pixel between u = near and infinity, with room for roundings."""
    return max(near - focus, focus) * spread + _room(spread, focus, near, width, height)


@inline
def _room(spread, focus, near, width, height):
    """More than what is lost [px] to roundings of the place of a ray."""
    return (width + height + (focus + near) * spread) * 1e-5


@inline
def is_mapped(ray_map):
    """Whether rays are a lens system's; the compiler knows."""
    return ray_map is not None


@inline
def _aim_all(ray_map, shared, own, k, lens, center, rays):
    """Rays (4, R) of one pixel, the k-th of its tile, for lens points (R, 2)."""
    if ray_map is None:
        _aim_thin_lens(lens, center, rays)
    else:
        _aim_mapped(ray_map, shared, own, k, lens, center, rays)


@inline
def _aim_mapped(ray_map, shared, own, k, lens, center, rays):
    """Rays (4, R) of a lens system for points (R, 2) of the unit square; those that are blocked repeat another."""
    scalar, projection = rays.dtype.type, shared.projection
    pixels = projection.pixels_per_tangent
    middle_x, middle_y = 0.5 * projection.width, 0.5 * projection.height
    mine, good = own[:, k], -1
    for n in range(len(lens)):
        mine[0, n], mine[1, n], mine[2, n], mine[3, n] = lens[n, 0], lens[n, 1], center[0], center[1]
    scratch = new_scratch()
    ray_block(ray_map, shared.wavelength, scratch, mine[2], mine[3], mine[0], mine[1], mine[2], mine[3], mine[4])
    for n in range(len(lens)):
        x, y, dx, dy = mine[0, n], mine[1, n], mine[2, n], mine[3, n]
        rays[0, n], rays[1, n] = scalar(middle_x + pixels * dx), scalar(middle_y - pixels * dy)
        rays[2, n], rays[3, n] = scalar(x / projection.lens_radius), scalar(-y / projection.lens_radius)
        if mine[4, n] != 0.0:
            good = n
    for n in range(len(lens)):
        if mine[4, n] == 0.0 and good >= 0:
            for c in range(4):
                rays[c, n] = rays[c, good]
        for c in range(4):
            mine[c, n] = rays[c, n]


@inline
def _aim_thin_lens(lens, center, rays):
    """Rays (4, R): through the pixel's centre at u = focus, apart by the lens points (R, 2) per px of parallax."""
    for n in range(len(lens)):
        wx, wy = lens[n, 0], lens[n, 1]
        rays[0, n], rays[1, n] = center[0] - center[2] * wx, center[1] - center[2] * wy
        rays[2, n], rays[3, n] = wx, wy


@inline
def _all_inside(rays, near, width, height):
    """Whether no ray (4, R) leaves the picture between u = near and infinity (u = 0)."""
    x0, y0, x1, y1 = ray_bounds(rays, 1, near, rays.dtype.type(0.0))
    return x0 >= 0.0 and y0 >= 0.0 and x1 < width and y1 < height


@inline
def aim(ray_map, own, focus, points, weights, chosen, n, y, lanes, weight, count):
    """The n-th rays of a tile's pixels and their weights, with nothing met so far; rays without weight are missed."""
    if ray_map is None:
        _aim_thin_lenses(focus, points, weights, chosen, n, y, lanes, weight, count)
    else:
        _aim_mapped_rays(own, n, lanes, weight, count)


@inline
def _aim_mapped_rays(own, n, lanes, weight, count):
    scalar = lanes.ax.dtype.type
    for k in range(count):
        lanes.ax[k], lanes.ay[k] = scalar(own[0, k, n]), scalar(own[1, k, n])
        lanes.wx[k], lanes.wy[k] = scalar(own[2, k, n]), scalar(own[3, k, n])
        weight[k] = own[4, k, n]
        lanes.border[k] = scalar(np.inf) if weight[k] != 0.0 else scalar(-np.inf)
        lanes.layer[k], lanes.best[k], lanes.hit_x[k], lanes.hit_y[k] = scalar(-1), scalar(-1), scalar(0), scalar(0)


@inline
def _aim_thin_lenses(focus, points, weights, chosen, n, y, lanes, weight, count):
    scalar = points.dtype.type
    center_y, infinity, nothing = scalar(y) + scalar(0.5), scalar(np.inf), scalar(-1.0)
    for k in range(count):
        lanes.wx[k], lanes.wy[k] = points[chosen[k], n, 0], points[chosen[k], n, 1]
        weight[k] = weights[chosen[k], n]
        lanes.border[k] = infinity if weight[k] != 0.0 else -infinity
    for k in range(count):
        wx, wy = lanes.wx[k], lanes.wy[k]
        lanes.ax[k], lanes.ay[k] = lanes.center[k] - focus * wx, center_y - focus * wy
        lanes.layer[k], lanes.best[k], lanes.hit_x[k], lanes.hit_y[k] = nothing, nothing, scalar(0.0), scalar(0.0)


@inline
def brightness(ray_map, own, k, rays):
    """The light of a pixel, the k-th of its tile, through all of the lens; 1 for thin and expressive lenses."""
    return 1.0 if ray_map is None else _brightness(ray_map, own, k, rays)


@inline
def _brightness(ray_map, own, k, rays):
    return 1.0 if even_light(ray_map) else own[4, k].sum() / rays


@inline
def enter(tops, shared, inside, lanes, count):
    """Where rays come into the picture; those that do not, or do so behind the surfaces at its border, are missed.

    tops (H, W): the first layer.
    """
    scalar, height, width = tops.dtype.type, tops.shape[0], tops.shape[1]
    near = max(shared.top.max(), scalar(0.0))
    room = _room(shared.spread, shared.focus, near, width, height)
    for k in range(count):
        if inside[k] or lanes.border[k] < 0.0:
            continue
        ray = Ray(lanes.ax[k], lanes.ay[k], lanes.wx[k], lanes.wy[k])
        x, y = ray.ax + near * ray.wx, ray.ay + near * ray.wy
        if room < min(x, y, ray.ax, ray.ay) and max(x, ray.ax) < width - room and max(y, ray.ay) < height - room:
            continue
        border = enter_picture(width, height, ray)
        if 0.0 <= border < np.inf:
            i = int(min(max(ray.ax + border * ray.wx, scalar(0.0)), scalar(width - 1)))
            j = int(min(max(ray.ay + border * ray.wy, scalar(0.0)), scalar(height - 1)))
            if tops[j, i] > border:
                border = scalar(-np.inf)
        lanes.border[k] = border if border >= 0.0 else scalar(-np.inf)


@inline
def is_missed(stack, ray, border, inside):
    """Whether it is not known what a ray that meets nothing sees."""
    packs, last = stack.packs, stack.last
    if border < 0.0:
        return True
    if inside and last < 0:
        return False
    if not (0.0 <= ray.ax < packs.shape[2] and 0.0 <= ray.ay < packs.shape[1]):
        return True
    return last >= 0 and packs[last // PACK, int(ray.ay), int(ray.ax), last % PACK] > 0.0

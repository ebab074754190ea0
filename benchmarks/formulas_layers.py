"""Formulas of layers: where they end, how they blend, what they hide, and how far lens rays see them apart."""

import numpy as np
from formula import Formula, beside, near_one, product_plus, spread_over, wide

from refdof.methods.cascaded.layers import inverse_coc
from refdof.methods.cascaded.matting import layer_coordinate
from refdof.raster.rays.umbra import reach_beyond

__all__ = ["FORMULAS"]


def _bound_naive(scale, focus, circle):
    return 1 / (1 / focus - circle / scale)


def _bound_ours(scale, focus, circle):
    return focus * (scale / product_plus(-circle, focus, scale))


def _bound_code(scale, focus, circle):
    rows = zip(scale, focus, circle, strict=True)
    return np.array([float(inverse_coc(wide(c), float(s), float(f))) for s, f, c in rows])


def _draw_bound(random, count):
    scale, focus = spread_over(random, 1.0, 1e4, count), spread_over(random, 1e-1, 1e3, count)
    share = 1.0 - np.exp(random.uniform(np.log(3e-7), np.log(0.9), count))
    share = np.where(random.random(count) < 0.8, share, -10.0 * share)
    return scale, focus, (scale / wide(focus) * share).astype(np.float32)


def _ramp_naive(depth, low, high):
    slope = 1 / (high - low)
    return depth * slope - low * slope


def _ramp_ours(depth, low, high):
    return (depth - low) / (high - low)


def _ramp_code(depth, low, high):
    rows = zip(depth, low, high, strict=True)
    found = [layer_coordinate(wide([z]), wide([a, b, 4 * b]), dtype=np.float64)[0] for z, a, b in rows]
    return np.array(found)


def _draw_ramp(random, count):
    low = spread_over(random, 1e-2, 1e4, count)
    high = (low * near_one(random, count, 1e-5)).astype(np.float32)
    depth = (low + (wide(high) - low) * random.uniform(0.01, 0.99, count)).astype(np.float32)
    kept = (depth > low) & (depth < high)
    return depth[kept], low[kept], high[kept]


def _open_naive(depth, low):
    return 1 - low / depth


def _open_ours(depth, low):
    return (depth - low) / depth


def _open_code(depth, low):
    rows = zip(depth, low, strict=True)
    found = [layer_coordinate(wide([z]), wide([a, np.inf]), dtype=np.float64)[0] for z, a in rows]
    return np.array(found)


def _draw_open(random, count):
    low = spread_over(random, 1e-2, 1e4, count)
    return (low * near_one(random, count, 1e-6, 1e3)).astype(np.float32), low


def _parallax_naive(scale, first, second):
    return scale / first - scale / second


def _parallax_ours(scale, first, second):
    return scale / first * ((second - first) / second)


def _parallax_code(scale, first, second):
    # `lensblur` stores parallax in float32, and rays subtract it: the naive form.
    ours = [(wide(scale) / wide(depth)).astype(np.float32) for depth in (first, second)]
    return ours[0] - ours[1]


def _draw_parallax(random, count):
    first = spread_over(random, 1e-1, 1e3, count)
    return spread_over(random, 1.0, 1e4, count), first, beside(random, first)


def _umbra_naive(radius, half, depth):
    return depth + depth * (depth * half) / (radius - depth * half)


def _umbra_ours(radius, half, depth):
    return depth * (radius / product_plus(-depth, half, radius))


def _umbra_code(radius, half, depth):
    rows = zip(radius, half, depth, strict=True)
    return np.array([1.0 / reach_beyond(1.0 / float(d), float(h) / float(r)) for r, h, d in rows])


def _draw_umbra(random, count):
    radius, half = spread_over(random, 1e-3, 1.0, count), spread_over(random, 1e-4, 1e-2, count)
    share = 1.0 - np.exp(random.uniform(np.log(3e-7), np.log(0.9), count))
    return radius, half, (radius / wide(half) * share).astype(np.float32)


FORMULAS = [
    Formula(
        "depth_of_circle",
        "Depth at which a circle is reached",
        "Bounds of layers and of the depth of field, printed as D2. `circle` is at most that of the background.",
        "For circles near the background's the depth grows without end, and so does its error.",
        _bound_naive,
        _bound_ours,
        """float depth_of_circle(float scale, float focus, float circle) {
    return focus * (scale / product_plus(-circle, focus, scale));
}""",
        _draw_bound,
        2.5,
        7.0,
        "`inverse_coc` of `refdof.methods.cascaded`, the naive form in float64",
        _bound_code,
    ),
    Formula(
        "ramp",
        "Blend between two layers",
        "From 0 at `low` to 1 at `high`, two depths close together. The naive form is one scale and one bias.",
        "Scale and bias are large where the layers are close.",
        _ramp_naive,
        _ramp_ours,
        """float ramp(float depth, float low, float high) {
    return (depth - low) / (high - low);
}""",
        _draw_ramp,
        2.0,
        4.5,
        "`refdof.methods.cascaded.matting.layer_coordinate`",
        _ramp_code,
    ),
    Formula(
        "open_ramp",
        "Blend into the layer that ends at infinity",
        "Linear in the inverse depth.",
        "Just behind `low`. As a weight it is harmless there, since it is next to nothing.",
        _open_naive,
        _open_ours,
        """float open_ramp(float depth, float low) {
    return isinf(depth) ? 1.0 : (depth - low) / depth;
}""",
        _draw_open,
        1.5,
        4.0,
        "`refdof.methods.cascaded.matting.layer_coordinate`, the naive form in float64, which infinity suits",
        _open_code,
    ),
    Formula(
        "parallax",
        "Parallax of two surfaces",
        "How far apart a lens point one radius from the middle sees them [px].",
        "Two surfaces close together, seen through a wide lens.",
        _parallax_naive,
        _parallax_ours,
        """float parallax(float scale, float first, float second) {
    return scale / first * ((second - first) / second);
}""",
        _draw_parallax,
        3.0,
        7.0,
        "`lensblur` stores parallax in float32 as the paper does and subtracts, so it has the naive form's error: "
        "2^-24 of a surface's parallax, in px. That is one of its known defects. `multiview` stores circles",
        _parallax_code,
    ),
    Formula(
        "umbra",
        "End of an umbra",
        "A blocker at `depth` of half a size `half` `depth` before a lens of `radius`.",
        "Where the blocker is as large as the lens the umbra grows without end.",
        _umbra_naive,
        _umbra_ours,
        """float umbra(float radius, float half_, float depth) {
    return depth * (radius / product_plus(-depth, half_, radius));
}""",
        _draw_umbra,
        2.5,
        7.0,
        "`refdof.raster.rays.umbra.reach_beyond`, as a step of the inverse depth in float64. `multiview` skips layers "
        "by whole pixels, one more than the largest circle, and cancels nothing",
        _umbra_code,
    ),
]

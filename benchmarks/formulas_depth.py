"""Formulas of depth: what a buffer holds as a distance, and a pixel as a direction."""

import numpy as np
from formula import Formula, exp, expm1, log, log1p, near_one, spread_over, sqrt, wide

from refdof.frame.depth_kinds import planar_of
from refdof.optics.projection import Projection, pixel_ray

__all__ = ["FORMULAS"]


def _planes(random, count):
    near = spread_over(random, 1e-2, 1.0, count)
    far = (near * near_one(random, count, 10.0, 1e6)).astype(np.float32)
    depth = np.exp(random.uniform(np.log(near), np.log(far)))
    return near, far, np.clip(depth, near, far)


def _decoded(kind):
    def code(near, far, device):
        rows = zip(near, far, device, strict=True)
        return np.array([planar_of(wide([d]), kind, np.ones(1), float(n), float(f))[0] for n, f, d in rows])

    return code


def _standard_naive(near, far, device):
    return near * far / (far - device * (far - near))


def _standard_ours(near, far, device):
    return near * far / ((1 - device) * far + device * near)


def _draw_standard(random, count):
    near, far, depth = _planes(random, count)
    device = (far * (depth - near) / (depth * (wide(far) - near))).astype(np.float32)
    kept = device < 1
    return near[kept], far[kept], device[kept]


def _signed_naive(near, far, signed):
    return 2 * near * far / (far + near - signed * (far - near))


def _signed_ours(near, far, signed):
    return 2 * near * far / ((1 - signed) * far + (1 + signed) * near)


def _draw_signed(random, count):
    near, far, device = _draw_standard(random, count)
    signed = (2 * wide(device) - 1).astype(np.float32)
    kept = signed < 1
    return near[kept], far[kept], signed[kept]


def _reversed_naive(near, far, device):
    return near * far / (near + device * (far - near))


def _reversed_ours(near, far, device):
    return near * far / ((1 - device) * near + device * far)


def _draw_reversed(random, count):
    near, far, depth = _planes(random, count)
    device = (near * (far - depth) / (depth * (wide(far) - near))).astype(np.float32)
    kept = device > 0
    return near[kept], far[kept], device[kept]


def _logarithmic_naive(slope, far, device):
    return (exp(device * log(slope * far + 1)) - 1) / slope


def _logarithmic_ours(slope, far, device):
    return expm1(device * log1p(slope * far)) / slope


def _draw_logarithmic(random, count):
    slope, far = spread_over(random, 1e-3, 1.0, count), spread_over(random, 1e2, 1e5, count)
    depth = np.exp(random.uniform(np.log(1e-3), np.log(1.0), count))
    return slope, far, (np.log1p(slope * depth) / np.log1p(slope * wide(far))).astype(np.float32)


def _radial_naive(distance, right, up):
    length = sqrt(right * right + up * up + 1)
    x, y = distance * right / length, distance * up / length
    return sqrt(distance * distance - x * x - y * y)


def _radial_ours(distance, right, up):
    return distance / sqrt(right * right + up * up + 1)


def _radial_code(distance, right, up):
    lengths = np.sqrt(1.0 + wide(right) ** 2 + wide(up) ** 2)
    return planar_of(wide(distance), "radial", lengths, None, None)


def _draw_radial(random, count):
    return spread_over(random, 0.1, 1e3, count), *(spread_over(random, 1e-2, 50.0, count) for _ in range(2))


def _slope_naive(column, width, pixels):
    ndc = 2 * ((column + 0.5) / width) - 1
    return ndc * (width / (2 * pixels))


def _slope_ours(column, width, pixels):
    return (column + 0.5 - 0.5 * width) / pixels


def _slope_code(column, width, pixels):
    rows = zip(column, width, pixels, strict=True)
    return np.array([pixel_ray(Projection(int(w), 1, float(p), 0.0, 0.0), int(x), 0)[0] for x, w, p in rows])


def _draw_slope(random, count):
    width = random.integers(200, 32768, count)
    beside = np.exp(random.uniform(0.0, np.log(width / 2.0))).astype(np.int64)
    column = np.clip(width // 2 + np.where(random.random(count) < 0.5, beside, -beside), 0, width - 1)
    return column.astype(np.float32), width.astype(np.float32), spread_over(random, 1e2, 1e5, count)


FORMULAS = [
    Formula(
        "standard_depth",
        "Depth of a standard buffer",
        "`device` is 0 at the near plane and 1 at the far plane.",
        "Far away `device` is near 1, and what is left of `far` has lost its digits.",
        _standard_naive,
        _standard_ours,
        """float standard_depth(float near, float far, float device) {
    return near * far / ((1.0 - device) * far + device * near);
}""",
        _draw_standard,
        3.5,
        5.5,
        "`refdof.frame.depth_kinds.planar_depth`",
        _decoded("device"),
    ),
    Formula(
        "signed_depth",
        "Depth of OpenGL's normalised coordinate",
        "`signed` is -1 at the near plane and 1 at the far plane.",
        "As of a standard buffer.",
        _signed_naive,
        _signed_ours,
        """float signed_depth(float near, float far, float signed_) {
    return 2.0 * near * far / ((1.0 - signed_) * far + (1.0 + signed_) * near);
}""",
        _draw_signed,
        4.0,
        6.0,
        "nowhere; give (1 + z) / 2 as `device`",
    ),
    Formula(
        "reversed_depth",
        "Depth of a reversed buffer",
        "`device` is 1 at the near plane and 0 at the far plane.",
        "It hardly does: all terms are above 0. This is why buffers are reversed.",
        _reversed_naive,
        _reversed_ours,
        """float reversed_depth(float near, float far, float device) {
    return near * far / ((1.0 - device) * near + device * far);
}""",
        _draw_reversed,
        3.5,
        5.5,
        "`refdof.frame.depth_kinds.planar_depth`",
        _decoded("reversed"),
    ),
    Formula(
        "logarithmic_depth",
        "Depth of a logarithmic buffer",
        "`device` is log(`slope` depth + 1) / log(`slope` `far` + 1).",
        "Near the eye the power is 1 but for its last digits.",
        _logarithmic_naive,
        _logarithmic_ours,
        """float logarithmic_depth(float slope, float far, float device) {
    return expm1_(device * log1p_(slope * far)) / slope;
}""",
        _draw_logarithmic,
        6.0,
        24.0,
        "nowhere; decode it yourself and give `planar`",
    ),
    Formula(
        "radial_depth",
        "Planar depth of a distance to the eye",
        "`right` and `up` are the slopes of the pixel's ray.",
        "At wide angles the squares of x and y are nearly that of the distance.",
        _radial_naive,
        _radial_ours,
        """float radial_depth(float distance_, float right, float up) {
    return distance_ / sqrt(right * right + up * up + 1.0);
}""",
        _draw_radial,
        3.0,
        6.5,
        "`refdof.frame.depth_kinds.planar_depth`",
        _radial_code,
    ),
    Formula(
        "slope",
        "Slope of a pixel's ray",
        "`column` counts from 0; `pixels` is P. Pixels near the middle of wide pictures.",
        "The texture coordinate is rounded before a half is taken away.",
        _slope_naive,
        _slope_ours,
        """float slope(float column, float width, float pixels) {
    return (column + 0.5 - 0.5 * width) / pixels;
}""",
        _draw_slope,
        1.0,
        3.5,
        "`refdof.optics.projection.pixel_ray`, by the inverse of P in float64",
        _slope_code,
    ),
]

"""Formulas of weights: Gaussians, what is left to blur, mip levels, parts of discs, and the scatter of samples."""

import numpy as np
from formula import Formula, acos, exp, expm1, log, log1p, log2, near_one, spread_over, sqrt, wide

from refdof.methods.cascaded.layers import _with_steps
from refdof.methods.mipmap.upsample import _level_of
from refdof.methods.scatter.disc import _under_arc
from refdof.optics.lens_maps import gaussian_stretch

__all__ = ["FORMULAS", "GLSL_HELPERS"]

GLSL_HELPERS = """float product_plus(float a, float b, float c) {
    precise float p = a * b;
    precise float s = 4097.0 * a, a_high = s - (s - a), a_low = a - a_high;
    precise float t = 4097.0 * b, b_high = t - (t - b), b_low = b - b_high;
    precise float rest = ((a_high * b_high - p) + a_high * b_low + a_low * b_high) + a_low * b_low;
    precise float sum = (p + c) + rest;
    return sum;
}

float log1p_(float x) {
    if (abs(x) > 0.5) return log(1.0 + x);
    float s = x / (2.0 + x), t = s * s;
    float sum = 1.0 / 11.0 + t / 13.0;
    sum = 1.0 / 7.0 + t * (1.0 / 9.0 + t * sum);
    return 2.0 * s * (1.0 + t * (1.0 / 3.0 + t * (0.2 + t * sum)));
}

float expm1_(float x) {
    if (abs(x) > 0.5) return exp(x) - 1.0;
    float sum = 1.0 + x / 6.0 * (1.0 + x / 7.0 * (1.0 + x / 8.0));
    return x * (1.0 + x / 2.0 * (1.0 + x / 3.0 * (1.0 + x / 4.0 * (1.0 + x / 5.0 * sum))));
}

float asin_(float x) {  // 0 .. 1
    bool large = x > 0.5;
    float u = large ? sqrt((1.0 - x) / 2.0) : x, z = u * u;
    float sum = 0.0749885507 + z * (0.0450013809 + z * (0.0265545378 + z * 0.0380850315));
    float turn = u + u * z * (0.166666724 + z * sum);  // a Chebyshev fit, right to 2e-8
    return large ? 1.57079633 - 2.0 * turn : turn;
}"""


def _gaussian_naive(distance, sigma):
    return exp(-(distance * distance) / (2 * sigma * sigma))


def _gaussian_ours(distance, sigma):
    share = distance / sigma
    return exp(-0.5 * share * share)


def _draw_gaussian(random, count):
    sigma = spread_over(random, 1e-25, 1e25, count)
    return (sigma * random.uniform(0.0, 3.0, count)).astype(np.float32), sigma


def _left_naive(whole, done):
    return sqrt(whole * whole - done * done)


def _left_ours(whole, done):
    return sqrt((whole - done) * (whole + done))


def _left_code(whole, done):
    rows = zip(wide(whole), wide(done), strict=True)
    return np.array([_with_steps(np.arange(3.0), np.array([b, a]), 0).step[1] for a, b in rows])


def _draw_left(random, count):
    done = spread_over(random, 0.1, 100.0, count)
    return (done * near_one(random, count, 1e-6)).astype(np.float32), done


def _level_naive(circle):
    return 1 + log2(circle * 2 / 3)


def _level_ours(circle):
    return log2(circle * 4 / 3)


def _level_code(circle):
    return np.array([float(_level_of(c)) for c in circle])


def _draw_level(random, count):
    return ((0.75 * near_one(random, count, 1e-5, 1e3)).astype(np.float32),)


def _blend_naive(first, second, weight):
    return first + (second - first) * weight


def _blend_ours(first, second, weight):
    return first * (1 - weight) + second * weight


def _draw_blend(random, count):
    second = spread_over(random, 1e-2, 1e2, count)
    first = (second * near_one(random, count, 1.0, 1e7)).astype(np.float32)
    weight = 1.0 - np.exp(random.uniform(np.log(1e-9), np.log(0.9), count))
    return first, second, weight.astype(np.float32)


def _cap_naive(radius, middle):
    return radius * radius * acos(middle / radius) - middle * sqrt(radius * radius - middle * middle)


def _cap_ours(radius, middle):
    s = np.sqrt((radius - middle) / (2 * radius))
    turn = 4 * np.arcsin(s)
    t = turn * turn
    small = turn * t / 12 * (1 - t / 20 * (1 - t / 42 * (1 - t / 72 * (1 - t / 110))))
    large = turn / 2 - 2 * s * np.sqrt(1 - s * s) * (1 - 2 * s * s)
    return radius * radius * np.where(turn < 1.5, small, large)


def _cap_code(radius, middle):
    rows = zip(wide(radius), wide(middle), strict=True)
    return np.array([2.0 * (_under_arc(r, r) - _under_arc(d, r)) for r, d in rows])


def _draw_cap(random, count):
    radius = spread_over(random, 0.5, 1e3, count)
    share = np.exp(random.uniform(np.log(1e-6), np.log(0.9), count))
    return radius, (radius * (1.0 - share)).astype(np.float32)


def _scatter_naive(a, b, c):
    mean = (a + b + c) / 3
    return (a * a + b * b + c * c) / 3 - mean * mean


def _scatter_ours(a, b, c):
    first, second = b - a, c - a
    mean = (first + second) / 3
    return (mean * mean + (first - mean) * (first - mean) + (second - mean) * (second - mean)) / 3


def _draw_scatter(random, count):
    first = spread_over(random, 1e-2, 1e2, count)
    share = np.exp(random.uniform(np.log(1e-5), np.log(0.5), (2, count)))
    return first, (first * (1.0 + share[0])).astype(np.float32), (first * (1.0 - share[1])).astype(np.float32)


def _aperture_naive(light, deviation):
    double = 2 * deviation * deviation
    return sqrt(-double * log(1 - light * (1 - exp(-1 / double))))


def _aperture_ours(light, deviation):
    double = 2 * deviation * deviation
    return sqrt(-double * log1p(light * expm1(-1 / double)))


def _aperture_code(light, deviation):
    rows = zip(np.sqrt(wide(light)), wide(deviation), strict=True)
    return np.array([r * gaussian_stretch(r, 0.0, s) for r, s in rows])


def _draw_aperture(random, count):
    return spread_over(random, 1e-6, 0.99, count), spread_over(random, 0.1, 100.0, count)


FORMULAS = [
    Formula(
        "gaussian",
        "Gaussian weight",
        "At a distance of up to three standard deviations; any unit.",
        "Squares leave float32 below 1e-19 and above 1e19: 0 / 0 or infinity over infinity.",
        _gaussian_naive,
        _gaussian_ours,
        """float gaussian(float distance_, float sigma) {
    float share = distance_ / sigma;
    return exp(-0.5 * share * share);
}""",
        _draw_gaussian,
        9.0,
        48.0,
        "`refdof.methods.cascaded.gaussian`",
    ),
    Formula(
        "deviation_left",
        "What is left to blur",
        "The standard deviation that takes `done` to `whole`.",
        "Steps between layers whose blurs are alike.",
        _left_naive,
        _left_ours,
        """float deviation_left(float whole, float done) {
    return sqrt((whole - done) * (whole + done));
}""",
        _draw_left,
        1.5,
        4.0,
        "`refdof.methods.cascaded.layers`, the naive form in float64",
        _left_code,
    ),
    Formula(
        "mip_level",
        "Mip level of a circle",
        "1 + log2(2 r / 3), above 0.75 px. Its error is a share of a level, since a level's fraction is a weight.",
        "It does not; one rounding less is no matter. What counts is the logarithm: some hardware's has few digits.",
        _level_naive,
        _level_ours,
        """float mip_level(float circle) {
    return log2(circle * 4.0 / 3.0);
}""",
        _draw_level,
        6.0,
        30.0,
        "`refdof.methods.mipmap.upsample`, in float64 and rounded once",
        _level_code,
        lambda circle: np.ones_like(circle),
    ),
    Formula(
        "blend",
        "Blend of two numbers of any ratio",
        "Of depths between texels, or of a light and what is dark beside it.",
        "Where the first is much larger, a weight near 1 does not give the second, and a weight of 1 does not either.",
        _blend_naive,
        _blend_ours,
        """float blend(float first, float second, float weight) {
    return first * (1.0 - weight) + second * weight;
}""",
        _draw_blend,
        2.0,
        2.0,
        "`mix_of_four` of `refdof.methods.singlepass` for depth; colours, as GPUs, have the naive form",
    ),
    Formula(
        "cap",
        "Part of a disc beyond a line",
        "Beyond a chord `middle` from the centre [px^2]: what a pixel at the rim of a disc is covered by.",
        "A thin rim of a wide disc is a small difference of a sector and a triangle.",
        _cap_naive,
        _cap_ours,
        """float cap(float radius, float middle) {
    float s = sqrt((radius - middle) / (2.0 * radius));
    float turn = 4.0 * asin_(s), t = turn * turn, square = radius * radius;
    if (turn >= 1.5) return square * (turn / 2.0 - 2.0 * s * sqrt(1.0 - s * s) * (1.0 - 2.0 * s * s));
    return square * turn * t / 12.0 * (1.0 - t / 20.0 * (1.0 - t / 42.0 * (1.0 - t / 72.0 * (1.0 - t / 110.0))));
}""",
        _draw_cap,
        16.0,
        40.0,
        "`refdof.methods.scatter.disc`, as differences of areas in float64: right to 1e-15 of the disc's square of the "
        "radius, and cut at 0",
        _cap_code,
    ),
    Formula(
        "scatter",
        "Variance of samples",
        "Three samples; any number goes the same way, from the first one on.",
        "Samples that agree: the mean of squares is the square of the mean but for its last digits.",
        _scatter_naive,
        _scatter_ours,
        """float scatter(float a, float b, float c) {
    float first = b - a, second = c - a, mean = (first + second) / 3.0;
    return (mean * mean + (first - mean) * (first - mean) + (second - mean) * (second - mean)) / 3.0;
}""",
        _draw_scatter,
        8.0,
        16.0,
        "`refdof.truth.error_bar`, in float64",
    ),
    Formula(
        "gaussian_aperture",
        "Radius on a Gaussian aperture",
        "Inside which a share `light` of the light passes; `deviation` in lens radii.",
        "A lens that is nearly even, and points near its middle.",
        _aperture_naive,
        _aperture_ours,
        """float gaussian_aperture(float light, float deviation) {
    float two = 2.0 * deviation * deviation;
    return sqrt(-two * log1p_(light * expm1_(-1.0 / two)));
}""",
        _draw_aperture,
        5.0,
        24.0,
        "`refdof.optics.lens_maps`",
        _aperture_code,
    ),
]

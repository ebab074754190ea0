"""Mipmap interpolation: every pixel reads a mip level as coarse as its blur, made without leaks from sharp pixels.

1. Take the circle of confusion as degree of blur                           `blur`
2. Build mip levels of circles, and of colour without what is sharper       `refdof.raster.anisotropic.halve`
3. Find the blur of nearer neighbours at the last level                     `refdof.raster.anisotropic.foreground_blur`
4. Magnify it, and read the degree of blur as coarse as that                `_smooth`
5. Blend two mip levels of colour at nine points of a circle                `_magnify`

Stages: "coc" (H, W) px, "degree" (H, W) px, "neighbours" (H, W) px, "smoothed" (H, W) px, "level" (H, W),
"color 1", "color 2", ... (h, w, 3).

The lens size E of [1] is a **diameter**, and so is its C; its degree of blur is sigma = C / 2, the radius that refdof
calls circle of confusion. [1] takes sigma for the standard deviation of a Gaussian; what the steps really give is a
blur of 0.31 C or less. That is how the method is, and it is left so.

Departures from the paper
-------------------------
- Depth is kept as the signed circle of confusion: it has the order of depth, is 0 in the focal plane and finite for the
  background. Coarser levels thus average inverse depth, as those of a z-buffer do.
- Equation (8) reads level l - 1, which does not exist for l = 0, and blurs where equation (6) says "no effect". Here
  the level read is max(m - 1, 0) and the circle has a radius of min(m, 1) texels: nothing happens at m = 0.
- Equations (7) and (8) print a geometric blend of levels. Section 6 reads a level that is not whole, which blends
  linearly, and finds the difference marginal: `blend`.
- The operator H of equation (9) stands for G in equation (8), says the text. Figure 6 and step 3 apply it where levels
  are made, equation (1), and so does this. Its p and q are read at the finer level, so that p itself always counts.
- The Gaussian's standard deviation, the places of its taps and the offset delta are not given: one finer texel, one
  finer texel around the coarse centre, and 0.5 px. Diagonal taps keep the weight G(sqrt 2) after they moved inwards.
- Only the last level of equation (10) is ever read. It looks at blurs of the level before it, so no other is made.
- The last level is that of the largest blur in the picture, not of a bound set beforehand.

References
----------
.. [1] Lee, Kim, Choi (2009), Real-Time Depth-of-Field Rendering Using Anisotropically Filtered Mipmap Interpolation,
   IEEE Transactions on Visualization and Computer Graphics 15(3).
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from refdof._check import Float, InputError, as_choice, as_number
from refdof._jit import borrow, inline, kernel, prange
from refdof.fetches import LARGEST_RADIUS, level_shares
from refdof.methods._images import as_images, within
from refdof.raster.anisotropic import Chain, depth_of_chain, foreground_blur, halve, new_chain
from refdof.raster.gpu_model import LLVMPIPE, store
from refdof.trace import Trace
from refdof.view import View

__all__ = ["CITATION", "INPUTS", "PROMISES", "RECONSTRUCTION", "SOURCE", "Params", "blur", "fetch_units", "render"]

CITATION = "lee2009mipmap"
SOURCE = "Lee, Kim, Choi 2009"
RECONSTRUCTION = False
INPUTS = ("pinhole colour", "pinhole depth")
PROMISES = ("constant", "pinhole", "focus", "convexity", "symmetry")

K_SIGMA = 2.0 / 3.0  # [1], equations (5) and (6)
_DIAGONAL = math.sqrt(0.5)
# Centre, axes, diagonals of the unit circle (figure 4b), and G(q - p) at the places of figure 4a.
_CIRCLE = np.array([(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, 1), (1, -1), (-1, -1)], dtype=float)
_GAUSSIAN = np.exp(-0.5 * (_CIRCLE**2).sum(axis=1))
_CIRCLE[5:] *= _DIAGONAL


@dataclass(frozen=True)
class Params:
    """What the paper leaves open.

    Parameters
    ----------
    delta : float >= 0
        How much sharper than its centre a pixel may be to enter a blurred background [px]; inf lets all in: isotropic.
    foreground_points : 0, 5 or 9
        Points of the circle that smooths the foreground's boundary; 0 leaves it as it is.
    blend : "linear" or "geometric"
        Of two mip levels.
    depth_format : "f32" or "f16"
        Texture of depth and blur. 16 bits are rounded towards zero at every level, as render targets do.
    """

    delta: float = 0.5
    foreground_points: int = 5
    blend: str = "linear"
    depth_format: str = "f32"

    def __post_init__(self) -> None:
        object.__setattr__(self, "delta", as_number("delta", self.delta, minimum=0.0, finite=False))
        if self.foreground_points not in (0, 5, 9):
            raise InputError(f"foreground_points: got {self.foreground_points!r}; allowed are 0, 5, 9")
        as_choice("blend", self.blend, ("linear", "geometric"))
        as_choice("depth_format", self.depth_format, ("f32", "f16"))


def render(view: View, params: Params, trace: Trace) -> Float:
    """Render `view`: (H, W, 3) float32 linear RGB."""
    pinhole, coc = view.pinhole(), within(np.float32, view.coc_px())
    return _blur(pinhole.color, coc, params, trace)


def blur(color: Float, depth: Float, coc: Float, params: Params = Params()) -> Float:
    """Blur a pinhole image.

    Parameters
    ----------
    color : (H, W, 3) float32 or float64
        Linear RGB, >= 0 if `blend` is "geometric"; its type is the type of all arithmetic.
    depth : (H, W)
        Planar depth [any unit], > 0; inf is background. Only checked: circles of confusion have its order.
    coc : (H, W)
        Signed circle of confusion, **radius** [px]: the paper's C is twice its size.
    params : Params

    Returns
    -------
    (H, W, 3) of the type of `color`.

    Raises
    ------
    InputError
        If shapes disagree, an array is empty, a value is NaN, a depth is not above 0, or a colour is negative where
        the blend is geometric.

    Notes
    -----
    Costs the same for any blur, but for mip levels, which add a third. A blur wider than the picture is cut.
    """
    color, depth, coc = as_images(color, depth, coc)
    if params.blend == "geometric" and color.min() < 0:
        raise InputError(f"color: smallest value is {color.min():g}; allowed with blend 'geometric' are values >= 0")
    return _blur(color, coc, params, Trace())


def fetch_units(params: Params, width: int, height: int, largest: float = LARGEST_RADIUS) -> float:
    """Texture reads per pixel [1, table 1], for a largest circle of confusion of radius `largest` [px]."""
    shares = level_shares(width, height, _last_level(largest, width, height))
    taps = 9 + 9  # circles, and colour, of the finer level
    smoothing = params.foreground_points + 1 if params.foreground_points and shares else 0
    return taps * math.fsum(shares) + smoothing + len(_CIRCLE)


def _blur(color: Float, coc: Float, params: Params, trace: Trace) -> Float:
    degree = np.abs(coc)
    height, width = coc.shape
    last = _last_level(float(degree.max()), width, height)
    circles = new_chain(_rounded(np.stack([coc, degree], axis=-1), params), last)
    colors = new_chain(color, last)
    for k in range(last):
        halve(colors.level(k), circles.level(k), params.delta, colors.level(k + 1), circles.level(k + 1))
        circles.level(k + 1)[:] = _rounded(circles.level(k + 1), params)
    if last and params.foreground_points:
        nearer = foreground_blur(circles.level(last - 1), int(circles.heights[last]), int(circles.widths[last]))
        points = params.foreground_points
    else:
        nearer, points = np.zeros((1, 1), dtype=color.dtype), 0
    weights = _GAUSSIAN[: max(points, 1)] / _GAUSSIAN[: max(points, 1)].sum()
    tables = _tables(circles, color.dtype)
    neighbours, smoothed, levels = _smooth(
        circles.texels, *tables, _rounded(nearer, params), _CIRCLE.astype(color.dtype), weights.astype(color.dtype)
    )
    trace.record("coc", lambda: coc)
    trace.record("degree", lambda: degree)
    trace.record("neighbours", lambda: neighbours)
    trace.record("smoothed", lambda: smoothed)
    trace.record("level", lambda: levels)
    for k in range(1, last + 1):
        trace.record(f"color {k}", lambda k=k: colors.level(k))  # type: ignore[misc]
    weights = (_GAUSSIAN / _GAUSSIAN.sum()).astype(color.dtype)
    return _magnify(
        colors.texels, *tables, smoothed, levels, _CIRCLE.astype(color.dtype), weights, params.blend == "geometric"
    )


def _last_level(largest: float, width: int, height: int) -> int:
    """M: the level of the largest degree of blur [px], if the picture has it."""
    if K_SIGMA * largest <= 0.5:
        return 0
    return min(math.ceil(1.0 + math.log2(K_SIGMA * largest)), depth_of_chain(width, height))  # Eq. (6)


def _rounded(values: Float, params: Params) -> Float:
    if params.depth_format == "f32":
        return values
    return store(values.astype(np.float32), "f16", LLVMPIPE).astype(values.dtype)


def _tables(chain: Chain, dtype: Any) -> tuple[Any, Any, Any, Float, Float]:
    """Starts, heights and widths of the levels, and texels per pixel of the picture down and right."""
    down, right = ((sides / sides[0]).astype(dtype) for sides in (chain.heights, chain.widths))
    return chain.starts, chain.heights, chain.widths, down, right


@kernel
def _smooth(circles, starts, heights, widths, down, right, nearer, circle, weights):
    """Blur of nearer neighbours, smoothed degree of blur and continuous level: (H, W) each.

    circles is a chain's (T, 2), nearer the last level's (h, w), circle (9, 2), weights (points,).
    """
    height, width, last = heights[0], widths[0], len(starts) - 1
    neighbours = np.empty((height, width), dtype=circles.dtype)
    smoothed, levels = np.empty_like(neighbours), np.empty_like(neighbours)
    for y in prange(height):
        own = circles.dtype.type
        texels, front = borrow(circles), borrow(nearer)
        reach = own(2.0**last)
        for x in range(width):
            rho = own(0)
            if len(weights) > 1:
                for k in range(len(weights)):
                    u, wx = _split((x + own(0.5) + circle[k, 0] * reach) * right[last], front.shape[1])
                    v, wy = _split((y + own(0.5) + circle[k, 1] * reach) * down[last], front.shape[0])
                    u1, v1 = min(u + 1, front.shape[1] - 1), min(v + 1, front.shape[0] - 1)
                    a = front[v, u] + (front[v, u1] - front[v, u]) * wx
                    b = front[v1, u] + (front[v1, u1] - front[v1, u]) * wx
                    rho += weights[k] * (a + (b - a) * wy)
            sigma = texels[y * width + x, 1]
            n = min(_level_of(rho), own(last))  # Eq. (11)
            if n > own(0):
                level = int(n)
                share = n - own(level)
                sigma = _blur_at(texels, starts, heights, widths, down, right, level, x, y)
                if share > own(0):
                    sigma += (_blur_at(texels, starts, heights, widths, down, right, level + 1, x, y) - sigma) * share
            neighbours[y, x], smoothed[y, x], levels[y, x] = rho, sigma, _level_of(sigma)
    return neighbours, smoothed, levels


@kernel
def _magnify(colors, starts, heights, widths, down, right, smoothed, levels, circle, weights, geometric):
    """Equation (8): nine points of a circle, each between two levels. colors is a chain's (T, 3)."""
    height, width, last = heights[0], widths[0], len(starts) - 1
    out = np.empty((height, width, 3), dtype=colors.dtype)
    for y in prange(height):
        own = colors.dtype.type
        texels, sizes, places, shares = borrow(colors), borrow(smoothed), borrow(circle), borrow(weights)
        for x in range(width):
            m = levels[y, x]
            if m <= own(0):
                for c in range(3):
                    out[y, x, c] = texels[y * width + x, c]
                continue
            # 2^(m - 1) is K_SIGMA sigma.
            radius = min(own(K_SIGMA) * sizes[y, x], own(2.0**last)) if m > own(1) else m
            lod = min(max(m - own(1), own(0)), own(last))
            level = int(lod)
            beta = lod - own(level)
            red, green, blue = own(0), own(0), own(0)
            for k in range(9):
                u, v = x + own(0.5) + places[k, 0] * radius, y + own(0.5) + places[k, 1] * radius
                r, g, b = _color_at(texels, starts, heights, widths, down, right, level, u, v)
                if beta > own(0):
                    r1, g1, b1 = _color_at(texels, starts, heights, widths, down, right, level + 1, u, v)
                    if geometric:
                        r, g, b = _power(r, r1, beta), _power(g, g1, beta), _power(b, b1, beta)
                    else:
                        r, g, b = r + (r1 - r) * beta, g + (g1 - g) * beta, b + (b1 - b) * beta
                red, green, blue = red + shares[k] * r, green + shares[k] * g, blue + shares[k] * b
            out[y, x, 0], out[y, x, 1], out[y, x, 2] = red, green, blue
    return out


@inline
def _level_of(sigma):
    """Equation (6): the continuous level of a degree of blur [px]."""
    scaled = K_SIGMA * np.float64(sigma)
    return type(sigma)(1.0 + np.log2(scaled)) if scaled > 0.5 else type(sigma)(0)


@inline
def _power(a, b, beta):
    """a^(1 - beta) b^beta of numbers >= 0."""
    return type(a)(np.float64(a) ** (1.0 - np.float64(beta)) * np.float64(b) ** np.float64(beta))


@inline
def _split(place, size):
    """The first of two texels around `place` [texels from the corner], cut at the border, and the second's weight."""
    centred = min(max(place - type(place)(0.5), type(place)(0)), type(place)(size - 1))
    first = int(centred)
    return first, centred - type(place)(first)


@inline
def _color_at(texels, starts, heights, widths, down, right, level, u, v):
    """A bilinear read of one level at u, v [px of the picture]."""
    width, height = widths[level], heights[level]
    x, wx = _split(u * right[level], width)
    y, wy = _split(v * down[level], height)
    first = starts[level] + y * width
    second = first + (width if y + 1 < height else 0)
    x1 = min(x + 1, width - 1)
    p, q, r, s = first + x, first + x1, second + x, second + x1
    return (
        _between(texels[p, 0], texels[q, 0], texels[r, 0], texels[s, 0], wx, wy),
        _between(texels[p, 1], texels[q, 1], texels[r, 1], texels[s, 1], wx, wy),
        _between(texels[p, 2], texels[q, 2], texels[r, 2], texels[s, 2], wx, wy),
    )


@inline
def _blur_at(texels, starts, heights, widths, down, right, level, x, y):
    """Degree of blur of one level at the centre of pixel (x, y)."""
    half = type(down[0])(0.5)
    i, wx = _split((x + half) * right[level], widths[level])
    j, wy = _split((y + half) * down[level], heights[level])
    first = starts[level] + j * widths[level]
    second = first + (widths[level] if j + 1 < heights[level] else 0)
    i1 = min(i + 1, widths[level] - 1)
    return _between(texels[first + i, 1], texels[first + i1, 1], texels[second + i, 1], texels[second + i1, 1], wx, wy)


@inline
def _between(p, q, r, s, wx, wy):
    a, b = p + (q - p) * wx, r + (s - r) * wx
    return a + (b - a) * wy

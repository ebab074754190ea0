"""Maps from the unit square to apertures for kernels: every part of the square gets its share of the light.

1. disc: a square ring becomes a circle, and angles are linear along its sides, [1]   `concentric_disc`
2. Gaussian: the disc's radii are stretched                                           `gaussian_stretch`
3. polygon: the disc's circles become outlines of the polygon                         `fan_point`
4. image: a row, then a texel of the row                                              `image_point`

References
----------
.. [1] Shirley & Chiu (1997), A Low Distortion Map Between Disk and Square, Journal of Graphics Tools 2(3).
"""

import math

import numpy as np

from refdof._jit import inline

__all__ = ["concentric_disc", "fan_point", "gaussian_stretch", "image_point"]

_EDGE = 2.0**-24  # share of a texel
_S = tuple((-1.0) ** k / math.factorial(2 * k + 1) for k in range(1, 9))  # sine / phi, in powers of phi^2
_C = tuple((-1.0) ** k / math.factorial(2 * k) for k in range(1, 9))


@inline
def concentric_disc(u, v):
    """Area-uniform point (x, y) of the unit disc from a point of the unit square, [1].

    Sine and cosine are Taylor polynomials on [-pi/4, pi/4] (error below 1e-15), so that no machine's
    mathematics library changes a bit.
    """
    a, b = 2.0 * u - 1.0, 2.0 * v - 1.0
    steep = abs(a) > abs(b)
    r = a if steep else b
    other = b if steep else a
    phi = (np.pi / 4.0) * (other / (r if r != 0.0 else 1.0))
    p = phi * phi
    sine = _S[4] + p * (_S[5] + p * (_S[6] + p * _S[7]))
    sine = 1.0 + p * (_S[0] + p * (_S[1] + p * (_S[2] + p * (_S[3] + p * sine))))
    cosine = _C[4] + p * (_C[5] + p * (_C[6] + p * _C[7]))
    cosine = 1.0 + p * (_C[0] + p * (_C[1] + p * (_C[2] + p * (_C[3] + p * cosine))))
    along, across = r * cosine, r * phi * sine
    return (along if steep else across), (across if steep else along)


@inline
def gaussian_stretch(x, y, deviation):
    """Factor that takes an area-uniform point of the unit disc to one of a Gaussian cut at radius 1.

    The squared radius q of a uniform point is uniform on 0 .. 1, so it is the light inside the radius r looked for:
    q = (1 - exp(-r^2 / (2 s^2))) / (1 - exp(-1 / (2 s^2))).
    """
    double = 2.0 * deviation * deviation
    q = min(x * x + y * y, 1.0)
    inside = -np.expm1(-1.0 / double)
    if q * inside < 1e-12:  # the middle, where the density is even: r^2 = 2 s^2 q inside
        return np.sqrt(double * inside)
    if q * inside >= 1.0:  # the rim of a lens whose outer parts are darker than a rounding
        return np.sqrt(1.0 / q)
    return min(np.sqrt(-double * np.log1p(-q * inside) / q), np.sqrt(1.0 / q))


@inline
def fan_point(boundary, u, v):
    """Area-uniform point (x, y) of a polygon, boundary (K, 2), whose K triangles with the centre have equal areas.

    The point of the disc at radius r and t turns comes to r times the outline's point that t of the area lies before.
    """
    corners = boundary.shape[0]
    a, b = 2.0 * u - 1.0, 2.0 * v - 1.0
    if abs(a) > abs(b):
        r, turn = abs(a), (1.0 if a > 0.0 else 0.5) + 0.125 * (b / a)
        turn -= 1.0 if turn >= 1.0 else 0.0
    else:
        r, turn = abs(b), (0.25 if b > 0.0 else 0.75) - 0.125 * (a / (b if b != 0.0 else 1.0))
    sector = turn * corners
    k = min(int(sector), corners - 1)
    following = k + 1 if k + 1 < corners else 0
    along = sector - k
    x = r * ((1.0 - along) * boundary[k, 0] + along * boundary[following, 0])
    y = r * ((1.0 - along) * boundary[k, 1] + along * boundary[following, 1])
    return x, y


@inline
def image_point(row_sums, texel_sums, u, v):
    """Point (x, y) of the square -1 .. 1 with the density of an image: v picks a row, u a texel of it.

    row_sums (h + 1,) and texel_sums (h, w + 1) are cumulated transmissions, from 0 to 1.
    """
    height, width = texel_sums.shape[0], texel_sums.shape[1] - 1
    row, down = _invert(row_sums, v)
    column, right = _invert(texel_sums[row], u)
    return (column + right) / width * 2.0 - 1.0, 1.0 - (row + down) / height * 2.0


@inline
def _invert(sums, value):
    """Index and fraction at which the non-decreasing `sums` reach `value` in [0, 1]: never where they do not grow.

    The fraction keeps off 0 and 1, so that no rounding takes a point to the texel beside.
    """
    value = min(value, 1.0 - 2.0**-53)
    low = min(max(np.searchsorted(sums, value, side="right") - 1, 0), len(sums) - 2)
    return low, min(max((value - sums[low]) / (sums[low + 1] - sums[low]), _EDGE), 1.0 - _EDGE)

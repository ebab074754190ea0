"""Height field: a surface given by its sag on a square grid, and the first point where a ray meets it.

1. interpolate the samples by a bicubic spline                          `spline_of`
2. bound its sag, slope and second derivatives over the clear disc      `limits_of`
3. evaluate sag and slope at a point                                    `sag_and_slope`
4. step along a ray to the surface, never past it                       `first_hit`
5. refract there, and go on to the next surface                         `through_fields`

The spline's curvature is continuous. With the grid's spacing h, its sag is wrong by h^4 and its slope, which refraction
takes, by h^3; with Catmull-Rom it would be h^3 and h^2, and every grid line would be a jump of the lens's power.

Let G < 0 be the height of a ray above the surface, [2]. Its rate G' is at most the ray's speed along the axis plus the
steepest slope times that across it, and G'' is at most the greatest second derivative times the square of the latter.
A step to where such a bound reaches 0 passes no root. The larger of the two steps is taken: far away that is the one by
G', and near a root the one by G'', which is Newton's method from one side. So the first hit is found, whatever follows.

References
----------
.. [1] de Boor (1978), A Practical Guide to Splines, chapters 4 and 11.
.. [2] Hart (1996), Sphere Tracing: A Geometric Method for the Antialiased Ray Tracing of Implicit Surfaces.
.. [3] Lee, Eisemann & Seidel (2010), Real-Time Lens Blur Effects and Focus Control, section 3.1.
"""

from typing import NamedTuple

import numpy as np

from refdof._check import Float
from refdof._jit import inline

__all__ = ["FieldSurface", "first_hit", "limits_of", "sag_and_slope", "spline_of", "through_fields"]

_STEPS = 200  # of a ray at one surface; a lens's smooth surface takes 3 to 6
_ROOM = 1e-3  # of the clear radius: what is added to the bounds of the sag


class FieldSurface(NamedTuple):
    """One height field, as a ray meets it: a spline, and numbers of one type."""

    spline: Float  # (N + 2, N + 2)
    limits: Float  # (5,), of `limits_of`
    vertex: float  # z [mm]
    rim: float  # square of the clear radius [mm^2]
    ratio: float  # index before over index behind
    forward: float  # 1; -1 for a ray from the sensor


def spline_of(sag: Float) -> Float:
    """Coefficients (N + 2, N + 2) of the bicubic B-spline through samples (N, N), not-a-knot at its ends, [1].

    Row and column k lie at sample k - 1.
    """
    from scipy.linalg import solve_banded  # slow to import

    count = len(sag)
    bands = np.zeros((9, count + 2))  # row 4 + r - c of column c holds the entry (r, c)
    for shift, weight in ((3, 1.0 / 6.0), (4, 4.0 / 6.0), (5, 1.0 / 6.0)):
        bands[5 - (shift - 3), (shift - 3) : count + shift - 3] = weight
    for k, weight in enumerate((1.0, -4.0, 6.0, -4.0, 1.0)):  # the third derivative does not jump
        bands[4 - k, k] = weight
        bands[4 + k, count + 1 - k] = weight

    spline = sag
    for _ in range(2):
        right = np.zeros((count + 2, spline.shape[1]))
        right[1:-1] = spline
        spline = solve_banded((4, 4), bands, right).T
    return np.ascontiguousarray(spline)


def limits_of(spline: Float, half: float) -> Float:
    """(5,): least and greatest sag, steepest slope, greatest second derivative over the disc, and its radius `half`.

    A spline lies between its coefficients, and its derivatives between theirs.
    """
    cell = 2.0 * half / (len(spline) - 3)
    at = (np.arange(len(spline)) - 1.0) * cell - half

    def largest(values: Float) -> float:
        """Of those that touch the disc: a coefficient reaches two cells, in x and in y."""
        x, y = (at[: values.shape[axis]] + 0.5 * cell * (len(at) - values.shape[axis]) for axis in (1, 0))
        return float(values[np.hypot(x, y[:, None]) <= half + 3.0 * cell].max())

    dx, dy = (np.abs(np.diff(spline, axis=axis)) / cell for axis in (1, 0))
    mixed = largest(np.abs(np.diff(np.diff(spline, axis=0), axis=1))) / cell**2
    second = max(largest(np.abs(np.diff(spline, n=2, axis=axis))) for axis in (0, 1)) / cell**2
    low, high = -largest(-spline), largest(spline)
    room = _ROOM * half
    return np.array([low - room, high + room, np.hypot(largest(dx), largest(dy)), second + mixed, half])


@inline
def sag_and_slope(spline, half, x, y):
    """Sag of a spline (N + 2, N + 2) over the square -half .. half at (x, y), and its slopes along x and y."""
    scalar, cells = spline.dtype.type, len(spline) - 3
    cells_per_length = scalar(cells) / (half + half)
    u, v = (x + half) * cells_per_length, (y + half) * cells_per_length
    i, j = min(max(int(u), 0), cells - 1), min(max(int(v), 0), cells - 1)
    across, along_x = _weights(spline, u - scalar(i))
    down, along_y = _weights(spline, v - scalar(j))
    sag = slope_x = slope_y = scalar(0.0)
    for row in range(4):
        a, b, c, d = spline[j + row, i], spline[j + row, i + 1], spline[j + row, i + 2], spline[j + row, i + 3]
        value = across[0] * a + across[1] * b + across[2] * c + across[3] * d
        sag += down[row] * value
        slope_y += along_y[row] * value
        slope_x += down[row] * (along_x[0] * a + along_x[1] * b + along_x[2] * c + along_x[3] * d)
    return sag, slope_x * cells_per_length, slope_y * cells_per_length


@inline
def _weights(spline, t):
    """Weights of four coefficients at a place 0 .. 1 of a cell, and their derivatives, [1]."""
    scalar = spline.dtype.type
    half, two, sixth = scalar(0.5), scalar(2.0), scalar(1.0 / 6.0)
    s = scalar(1.0) - t
    t2, s2 = t * t, s * s
    return (
        (sixth * s2 * s, sixth * (scalar(4.0) - scalar(3.0) * t2 * (two - t)),
         sixth * (scalar(4.0) - scalar(3.0) * s2 * (two - s)), sixth * t2 * t),
        (-half * s2, half * t * (scalar(3.0) * t - scalar(4.0)), half * s * (scalar(4.0) - scalar(3.0) * s), half * t2),
    )  # fmt: skip


@inline
def first_hit(face, begin, x, y, z, dx, dy, dz):
    """Distance along a ray to the first hit behind `begin`, the slopes there, and whether there is one.

    What comes in from the side, behind the surface, meets nothing.
    """
    scalar, spline = face.spline.dtype.type, face.spline
    zero = scalar(0.0)
    half = face.limits[4]
    ahead = face.forward * dz
    if not ahead > zero:
        return zero, zero, zero, False

    # Keep the part of the ray between the planes of the least and the greatest sag.
    first, last = (face.limits[0], face.limits[1]) if face.forward > zero else (face.limits[1], face.limits[0])
    start = max((face.vertex + first - z) / dz, begin)
    length = (face.vertex + last - z) / dz - start
    x, y, z = x + start * dx, y + start * dy, z + start * dz - face.vertex

    # Of it, keep what lies over the clear disc.
    across, along = dx * dx + dy * dy, x * dx + y * dy
    wide = half * scalar(1.000001)  # a rounding: the rim is cut when the ray has hit
    beyond = x * x + y * y - wide * wide
    square = along * along - across * beyond
    t = zero
    if beyond > zero:
        if not (along < zero and square > zero):
            return zero, zero, zero, False
        t = beyond / (np.sqrt(square) - along)
    if square > zero and across > zero:
        length = min(length, (np.sqrt(square) - along) / across)

    # Step to where a bound of the height above the surface is 0.
    fastest, bend = ahead + face.limits[2] * np.sqrt(across), face.limits[3] * across
    close = scalar(8.0) * scalar(np.finfo(spline.dtype).eps) * half
    for count in range(_STEPS):
        if not t <= length:
            break
        sag, slope_x, slope_y = sag_and_slope(spline, half, x + t * dx, y + t * dy)
        gap = face.forward * (z + t * dz - sag)
        if gap >= zero:
            return start + t, slope_x, slope_y, count > 0
        speed = ahead - face.forward * (slope_x * dx + slope_y * dy)
        root = np.sqrt(speed * speed - (bend + bend) * gap)
        step = -gap / fastest
        if speed > zero:
            step = max(step, -(gap + gap) / (speed + root))
        elif bend > zero:
            step = max(step, (root - speed) / bend)
        if step <= close:
            return start + t + step, slope_x, slope_y, speed > zero
        t += step
    return zero, zero, zero, False


@inline
def through_fields(table, reverse, x, y, z, dx, dy, dz):
    """Point, direction and whether the ray passed, as `trace_ray` has them, through all surfaces of a `SurfaceTable`.

    The first may lie behind the origin, as the ray is a line; then it goes on only.
    """
    scalar, count = table.vertex.dtype.type, len(table.vertex)
    side, forward = (1, scalar(-1.0)) if reverse else (0, scalar(1.0))
    begin, passed = scalar(-np.inf), True
    for step in range(count):
        k = count - 1 - step if reverse else step
        ratio = table.ratio[side, k]
        face = FieldSurface(table.splines[k], table.limits[k], table.vertex[k], table.rim[k], ratio, forward)
        x, y, z, dx, dy, dz, passed = _refract(face, begin, x, y, z, dx, dy, dz)
        if not passed:
            break
        begin = scalar(0.0)
    return x, y, z, dx, dy, dz, passed


@inline
def _refract(face, begin, x, y, z, dx, dy, dz):
    """Point and direction behind the first hit after `begin`, and whether the ray passes rim and refraction."""
    one = face.forward * face.forward
    zero = one - one
    t, slope_x, slope_y, met = first_hit(face, begin, x, y, z, dx, dy, dz)
    if not met:
        return x, y, z, dx, dy, dz, False
    x, y, z = x + t * dx, y + t * dy, z + t * dz
    if not x * x + y * y <= face.rim:
        return x, y, z, dx, dy, dz, False

    # The normal is (-slope_x, -slope_y, 1), made a unit vector that points along the ray.
    scale = face.forward / np.sqrt(one + slope_x * slope_x + slope_y * slope_y)
    nx, ny, nz = -slope_x * scale, -slope_y * scale, scale
    cosine = nx * dx + ny * dy + nz * dz
    refracted = one - face.ratio * face.ratio * (one - cosine * cosine)
    if not (cosine > zero and refracted > zero):
        return x, y, z, dx, dy, dz, False
    turn = np.sqrt(refracted) - face.ratio * cosine
    return x, y, z, face.ratio * dx + turn * nx, face.ratio * dy + turn * ny, face.ratio * dz + turn * nz, True

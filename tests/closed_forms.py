"""Closed forms of what a thin lens with a round aperture sees, derived from the geometry of the unit disc."""

import numpy as np
from scipy.special import j1


def half_disc(t):
    """Share of the unit disc with x < t: half, and the strip between 0 and t of height 2 sqrt(1 - x^2)."""
    t = np.clip(t, -1.0, 1.0)
    return 0.5 + (t * np.sqrt(1.0 - t * t) + np.arcsin(t)) / np.pi


def two_discs(distance, r, rho):
    """Area common to discs of radii r and rho whose centres are `distance` apart: two circular segments."""
    if distance >= r + rho:
        return 0.0
    if distance <= abs(r - rho):
        return np.pi * min(r, rho) ** 2
    a = np.arccos((distance**2 + r**2 - rho**2) / (2 * distance * r))
    b = np.arccos((distance**2 + rho**2 - r**2) / (2 * distance * rho))
    return r * r * (a - np.sin(2 * a) / 2) + rho * rho * (b - np.sin(2 * b) / 2)


def mean_reciprocal(k):
    """Mean of 1 / (1 - k x) over the unit disc, |k| < 1: the integral of (2 / pi) sqrt(1 - x^2) / (1 - k x)."""
    return 2.0 * (1.0 - np.sqrt(1.0 - k * k)) / (k * k)


def jinc(a):
    """Mean of cos(a x) over the unit disc."""
    return 2.0 * j1(a) / a


def circle_of_confusion(pixels_per_tangent, radius, focus, depth):
    """Signed radius [px]: two similar triangles, from the lens to the focal plane and from there to the depth."""
    return pixels_per_tangent * radius * (depth - focus) / (depth * focus)

"""Spectrum: the wavelengths at which a lens with dispersion is traced, and what each adds to red, green and blue.

Three wavelengths are those of [1], one for each channel. More stand for the whole of visible light:

1. the midpoints of N equal steps over 400 to 700 nm         `wavelengths_of`
2. the standard observer's response at each                  `color_matching`
3. its colour in Rec.709's primaries, for each channel over the sum of all, so that light of equal energy at all
   wavelengths is white                                      `channel_weights`

Channel c of a pixel is the sum over all wavelengths of weight times channel c of the picture at that wavelength.
Spectral colours lie outside of Rec.709, so that some weights are below 0; so may be pixels, where colours come apart.

The response is next to nothing at both ends of that range, where midpoints lose no point to them, and of what it holds
0.5 % at most lies outside, all of it at the blue end.

References
----------
.. [1] Lee, Eisemann & Seidel (2010), Real-Time Lens Blur Effects and Focus Control, section 4.
.. [2] Wyman, Sloan & Shirley (2013), Simple Analytic Approximations to the CIE XYZ Color Matching Functions, JCGT 2(2).
.. [3] ITU-R BT.709-6 (2015), Parameter values for the HDTV standards, item 1.3.
"""

import math

import numpy as np

from refdof._check import Float, as_integer, as_number

__all__ = ["MOST_WAVELENGTHS", "RGB_WAVELENGTHS", "add_wave", "channel_weights", "color_matching", "wavelengths_of"]

RGB_WAVELENGTHS = (0.650, 0.510, 0.475)  # [um], of red, green and blue, [1]
MOST_WAVELENGTHS = 31  # steps below 10 nm, at which spectra are tabulated; more change nothing that is seen
_FIRST, _LAST = 0.400, 0.700  # [um]

# Lobes of [2], section 2.2: height, place, widths below and above it [nm].
_LOBES = (
    ((1.056, 599.8, 37.9, 31.0), (0.362, 442.0, 16.0, 26.7), (-0.065, 501.1, 20.4, 26.2)),
    ((0.821, 568.8, 46.9, 40.5), (0.286, 530.9, 16.3, 31.1)),
    ((1.217, 437.0, 11.8, 36.0), (0.681, 459.0, 26.0, 13.8)),
)
_PRIMARIES = ((0.640, 0.330), (0.300, 0.600), (0.150, 0.060))  # x and y of red, green and blue, [3]


def wavelengths_of(count: int) -> tuple[float, ...]:
    """`count` wavelengths [um], 3 to 31: those of red, green and blue, or more from violet to red.

    Raises
    ------
    InputError
        If the count is out of range.
    """
    count = as_integer("wavelengths", count, minimum=3, maximum=MOST_WAVELENGTHS)
    if count == 3:
        return RGB_WAVELENGTHS
    return tuple(_FIRST + (k + 0.5) / count * (_LAST - _FIRST) for k in range(count))


def color_matching(wavelength_um: float) -> tuple[float, float, float]:
    """x, y and z of the CIE's standard observer of 1931 at a wavelength [um]: the sums of lobes of [2].

    They are within 0.015 of the CIE's table, whose largest values are 1.06, 1.00 and 1.78.
    """
    place = 1000.0 * as_number("wavelength_um", wavelength_um, minimum=0.3, maximum=2.5)

    def lobe(height: float, centre: float, below: float, above: float) -> float:
        return height * math.exp(-0.5 * ((place - centre) / (below if place < centre else above)) ** 2)

    x, y, z = (sum(lobe(*numbers) for numbers in lobes) for lobes in _LOBES)
    return x, y, z


def channel_weights(count: int) -> Float:
    """(count, 3) float64: what the picture at each of `wavelengths_of` adds to each channel; the sums are 1.

    One picture alone, of a lens without dispersion, is all channels.
    """
    if count == 1:
        return np.ones((1, 3))
    wavelengths = wavelengths_of(count)
    if count == 3:
        return np.eye(3)
    response = np.array([color_matching(wavelength) for wavelength in wavelengths])

    # A channel is what is left when both other primaries are taken out, in a unit that the sum takes out.
    red, green, blue = (np.array([x, y, 1.0 - x - y]) for x, y in _PRIMARIES)
    others = np.cross([green, blue, red], [blue, red, green])
    weights = (response[:, None, :] * others).sum(axis=2)
    return weights / weights.sum(axis=0)


def add_wave(total: Float, weights: Float, picture: Float) -> None:
    """Add the picture at one wavelength, (.., 3), to the float64 `total`, by its row of `channel_weights`."""
    for channel in np.flatnonzero(weights):
        total[..., channel] += weights[channel] * picture[..., channel]

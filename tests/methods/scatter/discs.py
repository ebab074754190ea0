"""One pixel's part of a disc, by the function that fills a row of them."""

import numpy as np

from refdof.methods.scatter.disc import covered_in_row, start_of_arc


def covered(i, j, radius):
    """Area [px^2] of pixel (i, j), both >= 0, inside a disc around the centre of pixel (0, 0)."""
    areas = np.full(i + 1, np.nan)
    sides = start_of_arc(max(j - 0.5, 0.0), radius), start_of_arc(j + 0.5, radius)
    covered_in_row(j, radius, i, i + 1, *sides, 0, np.zeros(i + 1), np.full(i + 1, -1), areas)
    return areas[i]

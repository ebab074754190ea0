"""Coefficients: complex Gaussians whose products are a disc, and the taps that they make.

References
----------
.. [1], [2] as in `method`.
"""

from typing import NamedTuple

import numpy as np

from refdof._check import Float

__all__ = ["COMPONENTS", "FITTED", "RADIUS", "WRONG_B", "Kernels", "kernels"]

RADIUS = 8  # taps to each side
FITTED = 1.10  # where the fitted disc is half as high
WRONG_B = 15.227561  # the generator's second B of four components, without its minus

# (a, b, A, B) of each component, [1] for one and two, its generator for the others.
COMPONENTS: dict[int, tuple[tuple[float, float, float, float], ...]] = {
    1: ((0.862325, 1.624835, 0.767583, 1.862321),),
    2: ((0.886528, 5.268909, 0.411259, -0.548794), (1.960518, 1.558213, 0.513282, 4.561110)),
    3: (
        (2.176490, 5.043495, 1.621035, -2.105439),
        (1.019306, 9.027613, -0.280860, -0.162882),
        (2.815110, 1.597273, -0.366471, 10.300301),
    ),
    4: (
        (4.338459, 1.553635, -5.767909, 46.164397),
        (3.839993, 4.693183, 9.795391, -WRONG_B),
        (2.791880, 8.178137, -3.048324, 0.302959),
        (1.342190, 12.328289, 0.010001, 0.244650),
    ),
    5: (
        (4.892608, 1.685979, -22.356787, 85.912460),
        (4.711870, 4.998496, 35.918936, -28.875618),
        (4.052795, 8.244168, -13.212253, -1.578428),
        (2.929212, 11.900859, 0.507991, 1.816328),
        (1.512961, 16.116382, 0.138051, -0.010000),
    ),
}


class Kernels(NamedTuple):
    """Taps of the two passes for places 0 .. RADIUS, which count on both sides.

    first : (RADIUS + 1, n, 2), real and imaginary part of each component
    second : (RADIUS + 1, n, 2), what the first pass's parts are multiplied by: A Re + B Im of the complex product
    """

    first: Float
    second: Float


def kernels(components: int, transition: float, misprinted: bool = False) -> Kernels:
    """Normalised taps, float64; `misprinted` takes the generator's sign in four components."""
    table = np.array(COMPONENTS[components])
    if misprinted and components == 4:
        table[1, 3] = WRONG_B
    a, b, real_share, imaginary_share = table.T
    x = np.abs(np.arange(-RADIUS, RADIUS + 1))[:, None] * (1.0 + transition) / RADIUS
    taps = np.exp(-a * x * x) * np.exp(1j * b * x * x)
    total = taps.sum(axis=0) ** 2
    taps = taps[RADIUS:] / np.sqrt((real_share * total.real + imaginary_share * total.imag).sum())
    first = np.stack([taps.real, taps.imag], axis=2)
    second = np.stack(
        [real_share * taps.real + imaginary_share * taps.imag, imaginary_share * taps.real - real_share * taps.imag],
        axis=2,
    )
    return Kernels(first, second)

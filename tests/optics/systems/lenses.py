"""Lenses that the tests share, with numbers that are published elsewhere."""

import math

from refdof.optics.systems.glass import AIR, Glass, glass_of
from refdof.optics.systems.system import LensSystem, Surface, ThickLens

# pbrt's dgauss.50mm.dat: Tronnier, US patent 2,673,491, scaled to 50 mm. Radius, thickness, index, diameter [mm];
# radius 0 is the stop. The last thickness is our own: the back focal distance, rounded.
DOUBLE_GAUSS_ROWS = [
    (29.475, 3.76, 1.67, 25.2),
    (84.83, 0.12, 1.0, 25.2),
    (19.275, 4.025, 1.67, 23.0),
    (40.77, 3.275, 1.699, 23.0),
    (12.75, 5.705, 1.0, 18.0),
    (0.0, 4.5, 1.0, 17.1),
    (-14.495, 1.18, 1.603, 17.0),
    (40.77, 6.065, 1.658, 20.0),
    (-20.385, 0.19, 1.0, 20.0),
    (437.065, 3.22, 1.717, 20.0),
    (-39.73, 36.0, 1.0, 20.0),
]


def double_gauss() -> LensSystem:
    surfaces = [
        Surface(
            math.inf if radius == 0 else radius,
            thickness,
            AIR if index == 1.0 else Glass(f"index {index}", index),
            diameter / 2,
            is_stop=radius == 0,
        )
        for radius, thickness, index, diameter in DOUBLE_GAUSS_ROWS
    ]
    return LensSystem("double Gauss 50 mm f/2", tuple(surfaces), "US 2,673,491")


def singlet() -> LensSystem:
    """Biconvex, of N-BK7."""
    return ThickLens(60.0, -80.0, 6.0, 25.0, glass_of("N-BK7")).system("singlet")


def doublet() -> LensSystem:
    """Cemented, crown in front of flint, as in catalogues of 100 mm achromats; the stop is flat and stands in front."""
    return LensSystem(
        "doublet",
        (
            Surface(math.inf, 2.0, AIR, 12.0, is_stop=True),
            Surface(61.47, 6.0, glass_of("N-BK7"), 12.5),
            Surface(-44.64, 2.5, glass_of("N-SF5"), 12.5),
            Surface(-129.94, 95.0, AIR, 12.5),
        ),
    )

"""Make optiland_rays.npz: skew rays through the lenses of `lenses.py`, traced by optiland (0.6, PyPI, MIT).

For each lens: origins, directions, and where optiland's rays leave the last surface, for rays that no rim stops. For
two corrected lenses of data/lenses: the spot of a distant point of the axis, in paraxial focus. Glass by name comes
from optiland's own catalogue, not from this project.

    pip install '.[optiland]' && python tests/optics/systems/make_optiland_rays.py
"""

import math
import sys
from pathlib import Path

import numpy as np
from optiland.analysis import SpotDiagram
from optiland.materials import IdealMaterial, Material
from optiland.optic import Optic
from optiland.rays import RealRays

RAYS, WAVELENGTH = 1000, 0.51  # [um]
ACROSS, LINE_D = 400, 0.5875618  # rays of a spot; [um]

# Radius (inf: flat), thickness, index or glass behind, semi-diameter, stop. Written out again: nothing here is the
# project's own.
LENSES: dict[str, list] = {
    "double_gauss": [
        (29.475, 3.76, 1.67, 12.6, False),
        (84.83, 0.12, 1.0, 12.6, False),
        (19.275, 4.025, 1.67, 11.5, False),
        (40.77, 3.275, 1.699, 11.5, False),
        (12.75, 5.705, 1.0, 9.0, False),
        (math.inf, 4.5, 1.0, 8.55, True),
        (-14.495, 1.18, 1.603, 8.5, False),
        (40.77, 6.065, 1.658, 10.0, False),
        (-20.385, 0.19, 1.0, 10.0, False),
        (437.065, 3.22, 1.717, 10.0, False),
        (-39.73, 36.0, 1.0, 10.0, False),
    ],
    "singlet": [(60.0, 6.0, "N-BK7", 12.5, True), (-80.0, 65.0, 1.0, 12.5, False)],
    "doublet": [
        (math.inf, 2.0, 1.0, 12.0, True),
        (61.47, 6.0, "N-BK7", 12.5, False),
        (-44.64, 2.5, "N-SF5", 12.5, False),
        (-129.94, 95.0, 1.0, 12.5, False),
    ],
}
CORRECTED: dict[str, list] = {
    "double_gauss": LENSES["double_gauss"],
    "cooke_triplet": [
        (22.01359, 3.258956, "N-SK16", 9.5, False),
        (-435.7604, 6.007551, 1.0, 9.5, False),
        (-22.21328, 0.999975, "F2", 5.0, False),
        (20.29192, 4.750409, 1.0, 3.8062, True),
        (79.68366, 2.952076, "N-SK16", 7.5, False),
        (-18.39533, 42.0, 1.0, 7.5, False),
    ],
}


def optic_of(rows: list, distance: float = 100.0, wavelength: float = WAVELENGTH) -> Optic:
    """The lens in optiland; rims are checked here and not there."""
    lens = Optic()
    lens.surfaces.add(index=0, radius=math.inf, thickness=distance)
    for k, (radius, thickness, glass, _, stop) in enumerate(rows):
        material = Material(glass, reference="schott") if isinstance(glass, str) else IdealMaterial(n=glass)
        lens.surfaces.add(index=k + 1, radius=radius, thickness=thickness, material=material, is_stop=stop)
    lens.surfaces.add(index=len(rows) + 1)
    lens.set_aperture("EPD", 2.0)
    lens.fields.set_type("angle")
    lens.fields.add(y=0.0)
    lens.wavelengths.add(wavelength, is_primary=True)
    return lens


def spot_radius(rows: list) -> float:
    """RMS radius [mm] of the spot of a distant point of the axis in paraxial focus, through all that the rims leave."""
    lens = optic_of(rows, math.inf, LINE_D)
    lens.set_aperture("EPD", 2.0 * highest_ray(lens, rows))
    lens.updater.image_solve()
    diagram = SpotDiagram(lens, num_rings=ACROSS, distribution="uniform", reference="centroid")
    return float(diagram.rms_spot_radius()[0][0])


def highest_ray(lens: Optic, rows: list) -> float:
    """How far from the axis [mm] a ray along it may come that passes all rims, by bisection."""
    low, high = 0.0, rows[0][3]
    for _ in range(50):
        height = (low + high) / 2.0
        inside = trace(lens, rows, np.array([[0.0, height, -10.0]]), np.array([[0.0, 0.0, 1.0]]), LINE_D)[2]
        low, high = (height, high) if inside[0] else (low, height)
    return low


def rays_of(rows: list, count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Origins in front of the first surface and unit directions."""
    random = np.random.default_rng(seed)
    aim = random.uniform(-rows[0][3], rows[0][3], (count, 2))
    slope = random.uniform(-0.3, 0.3, (count, 2))
    directions = np.column_stack([slope, np.ones(count)])
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    origins = np.column_stack([aim, np.zeros(count)]) - 40.0 * directions
    return origins, directions


def trace(
    lens: Optic, rows: list, origins: np.ndarray, directions: np.ndarray, wavelength: float = WAVELENGTH
) -> tuple:
    """Points and directions behind the last surface, and which rays are inside every rim."""
    ones = np.ones(len(origins))
    rays = RealRays(*origins.T, *directions.T, ones, wavelength * ones)
    inside = ones > 0
    for surface, row in zip(lens.surfaces.surfaces[1:-1], rows, strict=True):
        surface.trace(rays)
        inside &= np.hypot(rays.x, rays.y) < row[3]
    return np.column_stack([rays.x, rays.y, rays.z]), np.column_stack([rays.L, rays.M, rays.N]), inside


def made() -> dict[str, np.ndarray]:
    """All that the file holds."""
    found = {}
    for seed, (name, rows) in enumerate(LENSES.items()):
        lens = optic_of(rows)
        origins, directions = rays_of(rows, 8 * RAYS, seed)
        points, ways, inside = trace(lens, rows, origins, directions)
        inside &= np.isfinite(points).all(axis=1) & np.isfinite(ways).all(axis=1)
        kept = np.flatnonzero(inside)[:RAYS]
        assert len(kept) == RAYS, len(kept)
        found[f"{name}_rays"] = np.stack([origins[kept], directions[kept], points[kept], ways[kept]])
        found[f"{name}_focal_length"] = np.array(float(np.ravel(lens.paraxial.f2())[0]))
    for name, rows in CORRECTED.items():
        found[f"{name}_spot"] = np.array(spot_radius(rows))
    return found


def main() -> None:
    found = made()
    for name, value in found.items():
        print(name, value if value.ndim == 0 else value.shape)
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).with_name("optiland_rays.npz")
    np.savez_compressed(path, **found)


if __name__ == "__main__":
    main()

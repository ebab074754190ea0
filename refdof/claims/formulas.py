"""Measures without pictures: sums, formulas and constants that the sources print, worked out anew.

Each takes a `Bench`, which it does not need, and the arguments of a claim.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from refdof.claims.bench import Bench
from refdof.focus.moving_least_squares import moving_least_squares
from refdof.methods import METHODS
from refdof.methods.cascaded.layers import inverse_coc
from refdof.methods.mipmap.upsample import CIRCLE
from refdof.methods.singlepass import Params as Spiral
from refdof.methods.singlepass import spiral
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens
from refdof.optics.lens_samples import lens_samples
from refdof.optics.pixel_samples import mean_nearest_distance
from refdof.optics.systems.data_sheet import focused
from refdof.optics.systems.field import focal_surfaces, longitudinal_aberration
from refdof.optics.systems.glass import GLASSES, LINE_D
from refdof.optics.systems.paraxial import focal_length
from refdof.optics.systems.prescription import load_lens
from refdof.raster.rays.umbra import survivors, worst_case_layers

__all__ = ["FORMULAS"]


def texture_reads(_: Bench, methods: Sequence[str], width: int, height: int) -> float | dict[str, float]:
    """Texture reads per pixel that methods make at this size; of a single one a number."""
    found = {name: METHODS[name].METHOD.reads_per_pixel(width, height) for name in methods}
    return found if len(found) > 1 else found[methods[0]]


def sum_of_terms(_: Bench, terms: Sequence[tuple[float, Sequence[float]]]) -> float:
    """The sum of printed terms, each a factor times the sum of 1 / side^2."""
    return math.fsum(factor * math.fsum(1.0 / side**2 for side in sides) for factor, sides in terms)


def mismatch_of_totals(_: Bench, rows: Sequence[Sequence[float]]) -> float:
    """The largest difference between a printed total, a row's last number, and the sum of the others."""
    return max(abs(sum(row[:-1]) - row[-1]) for row in rows)


def circular_taps(_: Bench) -> float:
    """Reads of the circular filter besides the pixel's own."""
    return float(len(CIRCLE) - 1)


def cone(_: Bench, samples: int, circle: float, share: float, level: bool = False, seeds: int = 10) -> float:
    """Diameter of a cone where the circle of confusion has a radius of `circle` [px], or the mip level of as many px.

    It is `share` times the mean distance of Poisson-disc points to their nearest neighbours, the mean of some sets.
    """
    width = np.mean([mean_nearest_distance(lens_samples(samples, "poisson", seed)[0]) for seed in range(seeds)])
    return float(np.log2(share * width * circle)) if level else float(share * width * circle)


def golden_angle(_: Bench) -> float:
    """The golden angle [radians]."""
    return math.pi * (3.0 - math.sqrt(5.0))


def spiral_taps(_: Bench, scales: Sequence[float]) -> dict[str, float]:
    """Taps of the single pass by RAD_SCALE."""
    return {f"{scale:g}": float(len(spiral(Spiral(rad_scale=scale)))) for scale in scales}


def inner_share(_: Bench) -> float:
    """Share of the single pass's taps within half of the radius, over the share of area, a quarter."""
    radius = spiral()[:, 2]
    return float(np.mean(radius < Spiral().bound / 2.0)) / 0.25


def listing_circle(_: Bench) -> float:
    """Largest deviation of the listing's blur size from a thin lens's circle of confusion, over the largest size.

    focusScale is P E / MAX_BLUR_SIZE; depths run from before to behind the focal plane, inside the clamp.
    """
    camera, lens = Camera((0, 0, 0), (0, 0, -1), size=(640, 480)), ThinLens(0.05, 2.0)
    depth = np.linspace(1.0, 50.0, 1000)
    largest = Spiral().max_blur_size
    scale = camera.pixels_per_tangent * lens.radius / largest
    listed = np.clip((1.0 / lens.focus_distance - 1.0 / depth) * scale, -1.0, 1.0) * largest
    exact = np.clip(lens.coc_px(depth, camera), -largest, largest)
    return _beyond_rounding(np.abs(listed - exact).max() / np.abs(exact).max())


def thin_lens(_: Bench) -> float:
    """Largest relative deviation between our circle of confusion and the printed E F (d - df) / ((df - F) d).

    Ours has a field of view and no sensor: pixels are P / u_f per unit of the sensor, u_f = F df / (df - F).
    """
    camera = Camera((0, 0, 0), (0, 0, -1), size=(800, 600))
    focal, radius, focus = 0.05, 0.0125, 3.0
    depth = np.geomspace(0.5, 100.0, 500)
    printed = radius * focal * (depth - focus) / ((focus - focal) * depth)
    pixels = camera.pixels_per_tangent / (focal * focus / (focus - focal))
    ours = ThinLens(radius, focus).coc_px(depth, camera)
    return _beyond_rounding(np.abs(ours / (pixels * printed) - 1.0).max())


def circle_bound(_: Bench) -> float:
    """Circle of confusion at 1e9 times the focal distance, over the printed bound K = E F / (df - F)."""
    camera, lens = Camera((0, 0, 0), (0, 0, -1), size=(800, 600)), ThinLens(0.0125, 3.0)
    focal = 0.05
    bound = lens.radius * focal / (lens.focus_distance - focal)
    pixels = camera.pixels_per_tangent * (lens.focus_distance - focal) / (focal * lens.focus_distance)
    return float(lens.coc_px(np.array([3e9]), camera)[0]) / (pixels * bound)


def printed_inverse(_: Bench) -> float:
    """Largest relative deviation of printed D1 and D2 from the depths that have those circles of confusion."""
    focal, stop, focus = 0.1, 1.4, 3.0
    d = np.linspace(1e-5, 0.9 * focal**2 / (stop * (focus - focal)), 200)
    printed = [focus * focal**2 / (focal**2 + sign * d * stop * (focus - focal)) for sign in (1.0, -1.0)]
    # A diameter d on the sensor is a radius of d / 2 in pixels of size 1; P is then the distance of the sensor.
    scale = focal * focus / (focus - focal) * focal / (2.0 * stop)
    ours = [inverse_coc(sign * d / 2.0, scale, focus) for sign in (-1.0, 1.0)]
    return _beyond_rounding(max(np.abs(a / b - 1.0).max() for a, b in zip(printed, ours, strict=True)))


def _beyond_rounding(deviation: Any) -> float:
    """0 for what roundings of float64 are, which differ from machine to machine."""
    return float(deviation) if deviation > 1e-12 else 0.0


def eye_circle(_: Bench, focus_mm: float) -> float:
    """The diameter [px] of Eqs. (3) and (4) in the paper's example: an eye, a screen at 3 m, an object at 300 mm."""
    lens, focal, depth, dots, screen, retina = 4.0, 17.0, 300.0, 0.32, 3000.0, 24.0
    on_retina = lens * focal / (focus_mm - focal) * abs(depth - focus_mm) / depth
    return dots * screen / retina * on_retina


def umbra_offset(_: Bench) -> float:
    """The printed offset d s / (E - s) over the one found by casting rays from the lens's rim past a blocker."""
    ratios = []
    for lens, size, depth in ((0.009, 0.0009, 1.0), (0.05, 0.02, 3.0), (1.0, 0.3, 10.0)):
        # The ray from the lens's upper rim past the blocker's upper edge comes down to the axis.
        slope = (size - lens) / depth
        ratios.append(depth * size / (lens - size) / (-lens / slope - depth))
    return max(ratios, key=lambda ratio: abs(ratio - 1.0))


def umbra_layers(_: Bench, far: float) -> float:
    """Layers that the printed camera needs at worst: 30 degrees, 600 rows, lens radius 9 mm, from 1 m to `far`."""
    return float(worst_case_layers(*_printed_camera(), 1.0, far))


def dense_stack_layers(_: Bench, surfaces: int) -> float:
    """Layers that umbra peeling keeps of so many surfaces between 1 m and 10^6 m behind one pixel."""
    depth = 1.0 / np.linspace(1.0, 1e-6, surfaces)
    return float(len(survivors(depth[:, None, None], *_printed_camera(width=1, height=1))))


def pinhole_layers(_: Bench, surfaces: int) -> float:
    """Layers that umbra peeling keeps of so many surfaces if the lens is a point."""
    camera, _lens = _printed_camera(width=1, height=1)
    depth = np.linspace(1.0, 100.0, surfaces)
    return float(len(survivors(depth[:, None, None], camera, ThinLens(0.0, 2.0))))


def _printed_camera(width: int = 800, height: int = 600) -> tuple[Camera, ThinLens]:
    """A picture of another height has the field of view that its pixels have in 600 rows."""
    fov = 2.0 * math.degrees(math.atan(height / 600.0 * math.tan(math.radians(15.0))))
    return Camera((0, 0, 0), (0, 0, -1), fov_y=fov, size=(width, height)), ThinLens(0.009, 2.0)


def disc_over_deviation(_: Bench) -> float:
    """Diameter of an evenly lit disc over its standard deviation along an axis."""
    points, _weights = lens_samples(1 << 16, "vogel")
    return 2.0 / float(points[:, 0].std())


def printed_ramp_jump(_: Bench) -> float:
    """How far the weight of Eq. (4), to the letter, jumps where it leaves the layer's core, at z_k."""
    z0, z1 = 2.0, 4.0
    after = (z0 - z0 * (1.0 + 1e-12)) / (z0 - z1)
    return abs(1.0 - after)


def foremost_weights(_: Bench) -> float:
    """Share of depths before z_1 to which Eq. (3), to the letter with z_(-2) = z_(-1) = z_0 = -inf, gives a weight."""
    minus = -math.inf
    found = [_matte_as_printed(z, (minus, minus, minus)) for z in np.linspace(0.1, 2.0, 20)]
    return float(np.mean([math.isfinite(weight) and weight > 0.0 for weight in found]))


def _matte_as_printed(z: float, anchors: tuple[float, float, float]) -> float:
    """Eq. (3): anchors z_(k-2), z_(k-1), z_k."""
    first, second, third = anchors
    if first < z < second:
        return (z - first) / (second - first)
    return 1.0 if second <= z <= third else 0.0


def glass_error(_: Bench, wavelengths: Sequence[float]) -> float:
    """Largest difference of index between N-BK7 of its maker and the printed coefficients."""
    return max(abs(GLASSES["N-BK7"].index(w) - GLASSES["paper-BK7"].index(w)) for w in wavelengths)


def glass_indices(_: Bench, wavelengths: Mapping[str, float]) -> dict[str, float]:
    """Refractive index by colour [um], of the printed coefficients."""
    return {color: GLASSES["paper-BK7"].index(w) for color, w in wavelengths.items()}


def lensmaker(_: Bench) -> float:
    """Focal length by the printed lensmaker's equation over that of rays next to the axis."""
    system = load_lens("biconvex")
    front, back = system.surfaces[0], system.surfaces[1]
    n, t, r1, r2 = front.glass.index(LINE_D), front.thickness, front.radius, back.radius
    power = (n - 1.0) * (1.0 / r1 - 1.0 / r2 + (n - 1.0) * t / (n * r1 * r2))
    return 1.0 / power / focal_length(system)


def rim_focus(_: Bench) -> float:
    """Where rays of a spherical lens's rim cross the axis, from where those next to it do [mm]; below 0: nearer."""
    system = focused(load_lens("biconvex"), math.inf)
    near, rim = longitudinal_aberration(system, np.array([0.01, 1.0]), math.inf, LINE_D)
    return float(rim - near)


def field_focus(_: Bench, height_mm: float) -> float:
    """Where light of the field is sharp, from where that of the middle is [mm], mean of both directions."""
    system = focused(load_lens("biconvex"), math.inf)
    found = np.mean(focal_surfaces(system, np.array([0.0, height_mm]), math.inf), axis=0)
    return float(found[1] - found[0])


def surface_error(_: Bench) -> float:
    """Largest difference between the focal surface at its points and their values."""
    random = np.random.default_rng(2)
    points, values = random.random((6, 2)), 1.0 + random.random((6, 1))
    found = moving_least_squares(points, values, np.ones(6), np.full(6, 3.0), points)
    return float(np.abs(found - values).max())


def far_influence(_: Bench, falloffs: Sequence[float]) -> dict[str, float]:
    """How far a point moves the focal surface beyond a third of the picture from itself, by beta.

    The mean over 24 points and all such places of a picture of side 1, for a point's value that grows by 1.
    """
    random = np.random.default_rng(2)
    points = random.random((24, 2))
    places = np.stack(np.meshgrid(np.linspace(0.0, 1.0, 21), np.linspace(0.0, 1.0, 21)), axis=-1).reshape(-1, 2)
    far = np.hypot(*(places[:, None] - points).transpose(2, 0, 1)) > 1.0 / 3.0

    def moved(beta: float) -> float:
        influence = moving_least_squares(points, np.eye(24), np.ones(24), np.full(24, beta), places)
        return float(np.abs(influence)[far].mean())

    return {f"{beta:g}": moved(beta) for beta in falloffs}


FORMULAS: dict[str, Any] = {
    function.__name__: function
    for function in (
        texture_reads, sum_of_terms, mismatch_of_totals, circular_taps, cone, golden_angle, spiral_taps, inner_share,
        listing_circle, thin_lens, circle_bound, printed_inverse, eye_circle, umbra_offset, umbra_layers,
        dense_stack_layers, pinhole_layers, disc_over_deviation, printed_ramp_jump, foremost_weights, glass_error,
        glass_indices, lensmaker, rim_focus, field_focus, surface_error, far_influence,
    )
}  # fmt: skip

"""Figure: what the misprints and gaps of the paper behind `cascaded` do, one panel for each.

1. Eq. (4): rings of a white slanted plane in front of black         `rings`
2. the boundary statement: the edge of a card in the first layer     `boundary`
3. units: d taken for a radius, or lens radius for diameter          `units`
4. the size of the sensor, which the paper does not give             `sensor`

Run it from the root of the repository: ``python benchmarks/cascaded_errata.py --out out/cascaded_errata.png``.
"""

import argparse
import math
from dataclasses import replace
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")

import numpy as np
from matplotlib import pyplot as plt
from PIL import Image
from scipy.special import erf

from refdof import Camera, ThinLens
from refdof.methods.cascaded import Params, blur_buffers, layering_of

FOCUS, P = 0.8, 400.0
LENS = ThinLens.from_f_number(0.1, 1.4, FOCUS)
ROWS, F, F_NUMBER = 1024, 0.1, 1.4  # the paper's pictures and lens [px, m]


def camera(width, height):
    fov = 2.0 * math.degrees(math.atan(height / (2.0 * P)))
    return Camera.look_at((0, 0, 0), (0, 0, -1), fov_y=fov, size=(width, height))


def depth_of(coc, lens):
    return 1.0 / (1.0 / FOCUS - coc / (P * lens.radius))


def rings(axes):
    """Darkness along a white plane that is slanted through the focal plane, in front of black."""
    width, height = 420, 80
    coc = np.linspace(-12.0, 8.0, width)
    depth = np.stack([np.broadcast_to(depth_of(coc, LENS), (height, width)), np.full((height, width), np.inf)])
    color = np.zeros((2, height, width, 3))
    color[0] = 1.0
    for ramp in ("none", "as_printed", "corrected"):
        image = blur_buffers(color, depth, camera(width, height), LENS, Params(ramp=ramp, boundary="extrapolate"))
        axes.semilogy(coc[40:-40], np.maximum(1.0 - image[height // 2, 40:-40, 0], 1e-6), label=f'ramp="{ramp}"')
    axes.set(title="Eq. (4): rings on a slanted plane", xlabel="circle of confusion [px]", ylabel="1 - brightness")


def edge(lens, coc, **options):
    """Brightness across the edge of a white card in front of a black wall in focus, its circles of radius |coc|."""
    width, height = 240, 60
    on_card = np.broadcast_to(np.arange(width) < width // 2, (height, width))
    depth = np.stack([np.where(on_card, depth_of(coc, LENS), FOCUS), np.where(on_card, FOCUS, np.nan)])
    color = np.zeros((2, height, width, 3))
    color[0][on_card] = 1.0
    image = blur_buffers(color, depth, camera(width, height), lens, Params(**options))
    return np.arange(width) + 0.5 - width / 2, image[height // 2, :, 0]


def meant(axes, sigma):
    x = np.linspace(-40, 40, 200)
    axes.plot(x, 0.5 - 0.5 * erf(x / (sigma * math.sqrt(2.0))), "k:", label=f"Gaussian, sigma {sigma:.3g} px")
    axes.set(xlabel="from the edge [px]", ylabel="brightness", xlim=(-40, 40))


def boundary(axes):
    coc = -2.0 * math.sqrt(30.0)  # exactly four steps in front of focus
    for rule in ("extrapolate", "hard", "as_printed"):
        axes.plot(*edge(LENS, coc, boundary=rule), label=f'boundary="{rule}"')
    meant(axes, -coc / 2.0)
    axes.set(title="Boundary: a card in the first layer")


def units(axes):
    coc = -2.0 * math.sqrt(30.0)
    for factor, words in ((0.5, "radius taken for diameter"), (1.0, "as meant"), (2.0, "diameter taken for radius")):
        lens = replace(LENS, radius=LENS.radius * factor)
        axes.plot(*edge(lens, coc, boundary="hard"), label=words)
    meant(axes, -coc / 2.0)
    axes.set(title="Units: d = 2 r = 4 sigma")


def sensor(axes):
    """Diameter of the background's circle of confusion over the height of the sensor."""
    heights = np.linspace(8.0, 40.0, 60)  # mm
    for focus in (3.0, 18.5):
        diameter = F**2 / (F_NUMBER * (focus - F)) * ROWS / (heights / 1000.0)
        axes.semilogy(heights, diameter, label=f"focus at {focus:g} m")
        for height in (12.0, 24.0, 36.0):
            shown = F**2 / (F_NUMBER * (focus - F)) * ROWS / (height / 1000.0)
            axes.annotate(
                f"{layers_behind(focus, height)} layers", (height, shown), textcoords="offset points", xytext=(2, 5)
            )
            axes.plot(height, shown, "k.")
    axes.set(
        title="Sensor: blur at infinity, layers from focus on", xlabel="sensor height [mm]", ylabel="diameter [px]"
    )


def layers_behind(focus, sensor_mm):
    tangent = sensor_mm / 1000.0 / (2.0 * F * focus / (focus - F))
    view = Camera.look_at((0, 0, 0), (0, 0, -1), fov_y=2.0 * math.degrees(math.atan(tangent)), size=(ROWS, ROWS))
    lens = ThinLens.from_f_number(F, F_NUMBER, focus)
    return len(layering_of(np.full((1, 2, 2), np.inf), view, lens).deviation)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--out", type=Path, default=Path("out/cascaded_errata.png"))
    arguments = parser.parse_args()
    figure, axes = plt.subplots(2, 2, figsize=(10, 7), layout="constrained", dpi=80)
    for panel, draw in zip(axes.flat, (rings, boundary, units, sensor), strict=True):
        draw(panel)
        panel.legend(fontsize=8)
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    figure.canvas.draw()
    picture = Image.fromarray(np.asarray(figure.canvas.buffer_rgba())[..., :3].copy())  # type: ignore[attr-defined]
    picture.quantize(32).save(arguments.out, optimize=True)
    print(arguments.out)


if __name__ == "__main__":
    main()

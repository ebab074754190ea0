"""How often intervals of the reference hold the truth: edges and slits, whose exact pictures are areas on the lens.

Prints, for each number of samples, the share of blurred pixels whose value lies inside `low` .. `high`, and inside
`image` +- Student's quantile of `standard_error`; and the root mean square of the mean error over all seeds beside its
own error, which is 1 without bias.

    python benchmarks/coverage.py [--seeds 100] [--circle 8]
"""

import argparse
import math

import numpy as np

import refdof
from refdof import Camera, Material, Part, Scene, ThinLens

WIDTH, HEIGHT, P = 80, 12, 32.0
ROUNDING = 1e-6  # float32


def half_disc(t: np.ndarray) -> np.ndarray:
    """Share of the unit disc with x < t."""
    t = np.clip(t, -1.0, 1.0)
    return 0.5 + (t * np.sqrt(1.0 - t * t) + np.arcsin(t)) / np.pi


def card(left: float, right: float, circle: float) -> tuple[Scene, np.ndarray]:
    """A white card at depth 2 between two edges [px from the middle], focus at 1: the scene and its exact picture."""
    fov_y = 2.0 * math.degrees(math.atan(HEIGHT / (2.0 * P)))
    camera = Camera.look_at((0, 0, 0), (0, 0, -1), fov_y=fov_y, size=(WIDTH, HEIGHT))
    x0, x1 = left * 2.0 / P, right * 2.0 / P
    corners = np.array([[x0, -99, -2], [x1, -99, -2], [x1, 99, -2], [x0, 99, -2]], dtype=float)
    part = Part(corners, np.array([[0, 1, 2], [0, 2, 3]]), Material("unlit", base_color=(1.0, 1.0, 1.0)))
    scene = Scene.from_parts("card", [part], camera, ThinLens(circle / (P * 0.5), 1.0), (0.0, 0.0, 0.0))
    x = np.arange(WIDTH) + 0.5 - WIDTH / 2
    return scene, np.broadcast_to(half_disc((right - x) / circle) - half_disc((left - x) / circle), (HEIGHT, WIDTH))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--circle", type=float, default=8.0, help="circle of confusion [px]")
    words = parser.parse_args()
    print(f"{'scene':12}{'samples':>8}{'low .. high':>13}{'Student':>13}{'rms of mean':>13}")
    for name, places in (("half-plane", (-999.0, 0.3)), ("slit", (-2.3, 1.1))):
        scene, truth = card(*places, words.circle)
        blurred = (truth > 0.0) & (truth < 1.0)
        for samples, student in ((16, 2.131), (64, 2.131), (256, 3.182), (1024, 3.182)):  # of 16 and 4 replicates
            total, variance, inside, within = np.zeros(()), np.zeros(()), [], []
            for seed in range(words.seeds):
                result = refdof.reference(scene, samples=samples, seed=seed)
                low, high, bar = (
                    x[..., 0][blurred].astype(float) for x in (result.low, result.high, result.standard_error)
                )
                error = result.image[..., 0][blurred] - truth[blurred]
                total, variance = total + error, variance + bar**2
                inside.append(np.mean((low - ROUNDING <= truth[blurred]) & (truth[blurred] <= high + ROUNDING)))
                within.append(np.mean(np.abs(error) <= student * bar + ROUNDING))
            rms = np.sqrt(np.mean(total**2 / variance))
            print(f"{name:12}{samples:8}{np.mean(inside):13.3f}{np.mean(within):13.3f}{rms:13.3f}", flush=True)


if __name__ == "__main__":
    main()

"""How fast pictures sharpen: the error at edges of every direction falls as N^-3/4 does, the best there is.

For half-planes no choice of points beats N^-3/4 in the mean square (Beck 1987; Alexander 1991); independent points
reach N^-1/2.
"""

import numpy as np
import pytest

import refdof
from refdof import Part, ThinLens
from tests import flat_scene
from tests.closed_forms import half_disc

COUNTS = 2 ** np.arange(6, 13)
EDGES, SIDE = 64, 5


@pytest.fixture(scope="module")
def edges():
    """(scene, truth (H, W)) of half-planes at random directions and places, seen with a circle of 4 pixels."""
    random = np.random.default_rng(0)
    shot, lens = flat_scene.camera(SIDE, SIDE, 8.0), ThinLens(1.0, 1.0)
    x, y = (8.0 * t for t in flat_scene.tangents(SIDE, SIDE, 8.0))
    pairs = []
    for angle, place in zip(random.uniform(0, 2 * np.pi, EDGES), random.uniform(-2, 2, EDGES), strict=True):
        normal, along = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
        foot = place * normal
        corners = [
            foot - 99 * along,
            foot + 99 * along,
            foot + 99 * along - 99 * normal,
            foot - 99 * along - 99 * normal,
        ]
        points = np.column_stack([np.array(corners) * 2.0 / 8.0, np.full(4, -2.0)])  # at depth 2
        scene = flat_scene.scene_of([Part(points, [[0, 1, 2], [0, 2, 3]], flat_scene.paint((1.0,) * 3))], shot, lens)
        # 8 px * 1 * (1 / 1 - 1 / 2) = 4 px.
        pairs.append((scene, half_disc((place - x * normal[0] - y * normal[1]) / 4.0)))
    return pairs


def slope(edges, draw):
    """Least-squares slope of log RMSE over log N, of pixels with blur."""
    errors = []
    for count in COUNTS:
        squares = [
            ((draw(scene, int(count), k) - truth) ** 2)[(truth > 0) & (truth < 1)]
            for k, (scene, truth) in enumerate(edges)
        ]
        errors.append(np.sqrt(np.mean(np.concatenate(squares))))
    return np.polyfit(np.log(COUNTS), np.log(errors), 1)[0], errors


# Some 1500 pixels: each RMSE is known to 2 to 3 %, so that the slope over a factor of 64 is known to 0.01.
def test_one_net(edges):
    fitted, errors = slope(
        edges, lambda scene, n, k: refdof.render("accumulation", scene, samples=n, seed=k).image[..., 0]
    )
    assert fitted <= -0.7
    # An edge's best: 5e-3 at 256 points; independent ones have sqrt(1/6 / 256) = 2.6e-2 on average.
    assert errors[2] < 0.01


def test_sixteen_nets(edges):
    fitted, errors = slope(edges, lambda scene, n, k: refdof.reference(scene, samples=n, seed=k).image[..., 0])
    assert fitted <= -0.7
    # Independent nets of N / 16 points: at N^-3/4 each, 16^(3/4 - 1/2) = 2 times the error of one net.
    assert errors[-1] < 0.01


def test_replicates_are_independent(edges):
    # Their mean must have the variance of one over their number: 16 and 64 replicates of 64 points each.
    errors = []
    for replicates in (16, 64):
        squares = [
            (
                (refdof.reference(scene, samples=64 * replicates, replicates=replicates).image[..., 0] - truth) ** 2
            ).ravel()
            for scene, truth in edges
        ]
        errors.append(np.mean(np.concatenate(squares)))
    # 1600 squares of relative spread sqrt(2) or more: 4 % each, 6 % for the ratio; 4 of these.
    assert errors[1] / errors[0] == pytest.approx(0.25, rel=0.24)

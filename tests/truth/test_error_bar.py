"""Error bars over many seeds: no bias, intervals that cover, a noise floor that is met; against exact pictures."""

import numpy as np
import pytest

import refdof
from refdof import ThinLens
from refdof.image.display import display
from refdof.image.noise_floor import floor_of_moments, noise_moments
from refdof.truth.error_bar import student_quantile
from tests import flat_scene
from tests.cards import TRUTH_ERROR, lens_shares, random_cards
from tests.closed_forms import half_disc

P, WIDTH, HEIGHT, CIRCLE = 32.0, 48, 6, 8.0
SEEDS = 100
ROUNDING = 1e-6  # float32


def edges(*places):
    """A white card between edges at x = `places` [px from the middle], seen with a circle of 8 px; scene, truth."""
    shot, lens = flat_scene.camera(WIDTH, HEIGHT, P), ThinLens(0.5, 1.0)  # 32 * 0.5 * (1 / 1 - 1 / 2) = 8 px at depth 2
    left, right = places
    card = flat_scene.rectangle(left * 2 / P, right * 2 / P, -99, 99, 2.0)
    x = np.arange(WIDTH) + 0.5 - WIDTH / 2
    truth = half_disc((right - x) / CIRCLE) - half_disc((left - x) / CIRCLE)
    return [(flat_scene.scene_of([card], shot, lens), np.broadcast_to(truth[:, None], (HEIGHT, WIDTH, 3)), 0.0)]


def cards():
    """Eight random scenes of cards, and their exact pictures."""
    return [(c.scene, c.truth, TRUTH_ERROR) for c in (random_cards(seed) for seed in range(8))]


SCENES = {"half-plane": lambda: edges(-99.0, 0.3), "slit": lambda: edges(-2.3, 1.1), "cards": cards}


@pytest.mark.slow
@pytest.mark.parametrize("samples", [16, 64, 256, 1024])
@pytest.mark.parametrize("name", SCENES)
def test_no_bias_and_intervals_that_cover(name, samples):
    squares, covered = [], []
    for scene, truth, doubt in SCENES[name]():
        total, variance = np.zeros(truth.shape), np.zeros(truth.shape)
        blurred = (refdof.reference(scene, samples=1024).standard_error > 0) & (truth > doubt)
        for seed in range(SEEDS):
            result = refdof.reference(scene, samples=samples, seed=seed)
            total += result.image - truth
            variance += result.standard_error.astype(np.float64) ** 2
            room = doubt + ROUNDING
            inside = (result.low - room <= truth) & (truth <= result.high + room)
            covered.append(inside[blurred])
        noisy = blurred & (variance > 1e-20)  # channels in which cards agree have roundings for noise
        squares.append(total[noisy] ** 2 / variance[noisy])
    if samples >= 64:  # with 16, a pixel of which the lens sees 1 / 1000 has 1 hit in 600 pictures
        # A sum over 100 seeds beside the error that their bars give it: 1, known to 5 % from some 200 pixels.
        assert 0.85 <= np.sqrt(np.concatenate(squares).mean()) <= 1.15
    # The promise of `Reference`.
    assert 0.94 <= np.concatenate(covered).mean() <= 0.995


def test_student_quantile():
    # Any printed table of Student's t, 97.5 %.
    assert student_quantile(4) == pytest.approx(3.1824, abs=5e-5)
    assert student_quantile(16) == pytest.approx(2.1314, abs=5e-5)
    assert student_quantile(31) == pytest.approx(2.0423, abs=5e-5)


LAMP, BACK = 30.0, 0.01


def lamp():
    """Small bright lamps before a dark wall: scene and exact picture; most pixels of their discs see 1/200 of one."""
    p, width, height, radius, focus = 32.0, 40, 30, 0.5, 1.0
    places = [(-9.0, 2.0, 2.0), (8.0, -4.0, 2.0), (3.0, 6.0, 1.7)]  # x, y [px], depth
    outlines, depths = [], []
    for x, y, depth in places:
        half = 0.5 * depth / p
        outlines.append(half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) + np.array([x, y]) * depth / p)
        depths.append(depth)
    share = lens_shares(outlines, depths, flat_scene.tangents(width, height, p), radius, focus)
    truth = share[..., :-1].sum(axis=-1) * LAMP + share[..., -1] * BACK
    parts = [
        flat_scene.rectangle(*o[[0, 1], 0], *o[[1, 2], 1], d, (LAMP,) * 3)
        for o, d in zip(outlines, depths, strict=True)
    ]
    shot = flat_scene.camera(width, height, p)
    return flat_scene.scene_of(parts, shot, ThinLens(radius, focus), (BACK,) * 3), np.repeat(
        truth[..., None], 3, axis=-1
    )


@pytest.mark.parametrize("samples", [64, 256, 1024])
def test_the_noise_floor_of_small_lamps(samples):
    scene, truth = lamp()
    shown = display(truth).astype(np.float64)
    squares, floors = [], []
    for seed in range(16):
        result = refdof.reference(scene, samples=samples, seed=seed)
        squares.append(((display(result.image) - shown) ** 2).mean())
        floors.append(result.noise_floor_psnr)
    # 16 pictures of 1200 pixels, most of their noise in 600 of them: the mean square is known to 2 %, 0.1 dB.
    assert np.mean(floors) == pytest.approx(-10.0 * np.log10(np.mean(squares)), abs=0.5)


@pytest.mark.parametrize("replicates", [4, 6, 32])
def test_the_noise_floor_of_normal_noise(replicates):
    # Normal noise of 0.01 around 0.5: the mean's variance is 1e-4 / R, the curve's slope at 0.5 is
    # 1.055 / 2.4 * 0.5^(1 / 2.4 - 1) = 0.6586.
    sums = np.random.default_rng(5).normal(0.5, 0.01, (replicates, 4000, 3)) * 7
    moments = noise_moments(sums, np.full(4000, 7))
    # 12 000 values: the variance of eight of 16 groups is known to sqrt(2 / 12000 / 4) = 0.7 %, and enters three times;
    # that of two of 4 to 0.9 %, and enters twice.
    floor = -10 * np.log10(0.6586**2 * 1e-4 / replicates)
    assert floor_of_moments(moments, 12000, replicates) == pytest.approx(floor, abs=0.15)
    assert floor_of_moments(np.zeros(len(moments)), 12000, replicates) == np.inf


def test_a_picture_without_blur_has_no_noise():
    scene, _ = lamp()
    sharp = refdof.reference(scene, lens=ThinLens(0.0, 1.0), samples=16)
    assert sharp.noise_floor_psnr == np.inf
    np.testing.assert_array_equal(sharp.low, sharp.high)

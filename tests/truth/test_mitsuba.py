"""The reference against Mitsuba 3, a renderer with its own thin lens, samplers, ray tracer and film.

Both pictures are means of independent runs, so each has its own variance at every pixel, and their difference in
units of both variances follows Student's t. Set REFDOF_REQUIRE_PEERS=1 to fail where Mitsuba is missing.
"""

import os
from dataclasses import replace

import numpy as np
import pytest
from scipy import ndimage, stats

import refdof
from tests.truth.mitsuba_scene import lopsided, mitsuba_peer

pytestmark = pytest.mark.mitsuba

RUNS = 64  # on either side: t with some 126 degrees of freedom, close to Gaussian
BLOCK = 4  # px; averages of 16 pixels see a bias that a single pixel's noise hides
# Each limit below is exceeded by chance once in 10^4 correct runs of one test.
CHANCE = 1e-4
# Mitsuba shades in float32 and adds samples up in float32: some ten roundings of values near 1.
ROUNDING = 10 * float(np.finfo(np.float32).eps)


@pytest.fixture(scope="module")
def mitsuba():
    try:
        return mitsuba_peer.start()
    except mitsuba_peer.PeerMissing as error:
        if os.environ.get("REFDOF_REQUIRE_PEERS") == "1":
            pytest.fail(f"REFDOF_REQUIRE_PEERS=1, but {error}")
        pytest.skip(str(error))


@pytest.fixture(scope="module")
def scene():
    return lopsided()


@pytest.fixture(scope="module")
def truth(mitsuba, scene):
    """Mitsuba's mean and its variance for the stock plugins: `thinlens`, `path`, box filter."""
    return mitsuba_mean(mitsuba, scene, "box", "path")


def mitsuba_mean(mitsuba, scene, pixel_filter, integrator):
    peer = mitsuba_peer.new_peer(mitsuba, scene, scene.camera, scene.lens, "multijitter", pixel_filter, integrator)
    runs = np.stack([mitsuba_peer.render(peer, 64, seed).image for seed in range(RUNS)]).astype(np.float64)
    return runs.mean(axis=0), runs.var(axis=0, ddof=1) / RUNS


def refdof_mean(scene, camera=None, lens=None, pixel_filter="box"):
    result = refdof.reference(
        scene, camera, lens, samples=RUNS * 64, replicates=RUNS, pixel_filter=pixel_filter, seed=11
    )
    return result.image.astype(np.float64), result.standard_error.astype(np.float64) ** 2


def smallest_chances(ours, theirs):
    """Sidak-corrected chances of the largest deviation: of a pixel, of a block average, of the whole mean."""
    (a, va), (b, vb) = ours, theirs
    difference, variance = a - b, va + vb + ROUNDING**2
    pixel = 2.0 * stats.t.sf(np.abs(difference) / np.sqrt(variance), _freedom(va, vb))

    def blocks(x):
        height, width, _ = x.shape
        return x.reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK, 3).sum(axis=(1, 3))

    block = 2.0 * stats.norm.sf(np.abs(blocks(difference)) / np.sqrt(blocks(variance)))
    whole = 2.0 * stats.norm.sf(np.abs(difference.sum(axis=(0, 1))) / np.sqrt(variance.sum(axis=(0, 1))))
    return {"pixel": _sidak(pixel), "block": _sidak(block), "whole": _sidak(whole)}


def _freedom(va, vb):
    """Welch and Satterthwaite: degrees of freedom of the difference of two means with their own variances."""
    with np.errstate(invalid="ignore"):
        freedom = (va + vb) ** 2 * (RUNS - 1) / (va**2 + vb**2)
    return np.where(va + vb > 0.0, freedom, RUNS - 1)


def _sidak(chances):
    """Chance that the least of n independent chances is as small as the one seen."""
    return -np.expm1(chances.size * np.log1p(-min(float(chances.min()), 1.0 - 1e-12)))


def test_agrees_with_mitsuba_within_both_error_bars(scene, truth):
    chances = smallest_chances(refdof_mean(scene), truth)
    assert min(chances.values()) > CHANCE, chances


def test_error_bars_of_both_have_the_right_size(scene, truth):
    """The squared deviations in units of their variances average to 1, up to their own scatter."""
    (a, va), (b, vb) = refdof_mean(scene), truth
    a, va, b, vb = (x[..., 1] for x in (a, va, b, vb))  # the channels of a pixel share their rays: take one
    # refdof's error bar has a floor, a share 1 / samples of the contrast of 3 x 3 pixels; here the noise is meant.
    contrast = ndimage.maximum_filter(a, 3) - ndimage.minimum_filter(a, 3)
    noisy = va > (2.0 * contrast / (RUNS * 64)) ** 2 + (10.0 * ROUNDING) ** 2
    assert noisy.sum() > 200  # the blurred edges; elsewhere both nets are exact to rounding
    squares = (a - b)[noisy] ** 2 / (va + vb)[noisy]
    freedom = _freedom(va, vb)[noisy]
    # Mean and variance of t^2 with f degrees of freedom; averages of some 10^3 pixels are Gaussian.
    expected = freedom / (freedom - 2)
    scatter = 2.0 * freedom**2 * (freedom - 1) / ((freedom - 2) ** 2 * (freedom - 4))
    z = (squares - expected).sum() / np.sqrt(scatter.sum())
    assert abs(z) < stats.norm.isf(CHANCE / 2.0), (z, squares.mean())


def test_pixel_centres_agree_with_mitsuba(mitsuba, scene):
    """The integral over the lens alone; Mitsuba's `thinlens` is then led through the pixel centres."""
    theirs = mitsuba_mean(mitsuba, scene, "centre", mitsuba_peer.FIRST_HIT)
    chances = smallest_chances(refdof_mean(scene, pixel_filter="centre"), theirs)
    assert min(chances.values()) > CHANCE, chances


@pytest.mark.parametrize("mistake", ["radius", "focus", "field of view", "eye", "mirrored", "upside down", "centre"])
def test_comparison_finds_small_mistakes(scene, truth, mistake):
    """What would pass with a wrong lens proves nothing: mistakes of a few per cent must show."""
    camera, lens, pixel_filter = scene.camera, scene.lens, "box"
    if mistake == "radius":
        lens = replace(lens, radius=lens.radius * 1.03)
    elif mistake == "focus":
        lens = replace(lens, focus_distance=lens.focus_distance * 1.02)
    elif mistake == "field of view":
        camera = replace(camera, fov_y=camera.fov_y * 1.005)
    elif mistake == "eye":
        camera = replace(camera, eye=(camera.eye[0] + 0.005, *camera.eye[1:]))
    elif mistake == "centre":
        pixel_filter = "centre"
    image, variance = refdof_mean(scene, camera, lens, pixel_filter)
    if mistake == "mirrored":
        image, variance = image[:, ::-1], variance[:, ::-1]
    elif mistake == "upside down":
        image, variance = image[::-1], variance[::-1]
    chances = smallest_chances((image, variance), truth)
    assert min(chances.values()) < CHANCE**2, chances

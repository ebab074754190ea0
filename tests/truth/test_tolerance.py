"""Sampling until an error is met: the promise, its price, and what the first samples can miss."""

import numpy as np
import pytest

import refdof
from refdof import ThinLens
from tests import flat_scene
from tests.cards import random_cards

FIRST, LAST = 16 * 8, 16 << 14  # samples per pixel: the first look, and where doubling ends
STUDENT = 2.131


@pytest.mark.parametrize("tolerance", [1e-2, 2e-3])
def test_every_pixel_keeps_the_tolerance(tolerance):
    error, standard_error = [], []
    for seed in range(25):
        cards = random_cards(seed)
        result = refdof.reference(cards.scene, tolerance=tolerance, seed=seed, max_samples=LAST)
        allowed = tolerance * np.maximum(1.0, result.image.max(axis=-1, keepdims=True))
        capped = (result.samples >= LAST)[..., None]
        assert ((result.standard_error <= allowed * (1 + 1e-6)) | capped).all()  # float32
        assert (result.samples >= FIRST).all()
        powers = np.log2(result.samples / 16)
        assert (powers == np.round(powers)).all()
        error.append((result.image - cards.truth)[cards.blurred])
        standard_error.append(result.standard_error[cards.blurred])
    error, standard_error = np.concatenate(error), np.concatenate(standard_error)
    # Stopping when the error bar looks small favours bars that are too small, by one doubling at most.
    assert np.sqrt((error**2).mean()) <= tolerance
    assert np.mean(np.abs(error) <= STUDENT * standard_error) >= 0.90
    assert np.abs(error).max() <= 6.0 * tolerance  # Student's t of 15 degrees beyond 6: one in 40000


def test_sharp_pixels_stop_early():
    p, size = 32.0, 64
    shot, lens = flat_scene.camera(size, 8, p), ThinLens(0.1, 1.0)
    # Left: a striped wall in focus. Right: a card at depth 4 with an edge at 16 px, blurred by 2.4 px.
    wall = flat_scene.strips(np.linspace(-1, 0, 33), np.full(33, 1.0), -1, 1, np.arange(33) / 32)
    card = flat_scene.rectangle(16 * 4 / p, 99, -99, 99, 4.0)
    result = refdof.reference(flat_scene.scene_of([wall, card], shot), shot, lens, tolerance=1e-3)
    x = np.arange(size) + 0.5 - size / 2
    coc = p * 0.1 * (1 - 1 / 4)
    # The error bar of a blurred pixel reaches its next neighbours, and theirs keep two more pixels open.
    assert (result.samples[:, np.abs(x - 16) > coc + 3] == FIRST).all()
    assert (result.standard_error[:, np.abs(x - 16) > coc + 1] < 1e-12).all()
    # Binary pixels with a standard error of 1e-3 need thousands of points even at N^-3/4.
    assert (result.samples[:, np.abs(x - 16) < coc / 2] >= 8 * FIRST).all()


@pytest.mark.parametrize("seed", [0, 3, 6, 15])
def test_the_disc_of_a_small_bright_lamp_is_complete(seed):
    p, size, coc, side, flux = 16.0, 31, 8.0, 0.3, 250.0
    shot, lens = flat_scene.camera(size, size, p), ThinLens(1.0, 1.0)  # 16 (1 / 1 - 1 / 2) = 8 px at depth 2
    half = side / 2 * 2 / p
    lamp = flat_scene.rectangle(-half, half, -half, half, 2.0, (flux / side**2,) * 3)
    result = refdof.reference(flat_scene.scene_of([lamp], shot), shot, lens, tolerance=0.1, seed=seed, max_samples=LAST)
    x, y = np.meshgrid(np.arange(size) - size // 2, np.arange(size) - size // 2)
    inside = np.hypot(x, y) < coc - side
    # All of these pixels have the value 250 / (pi 8^2) = 1.24: none may be off by more than 6 of the errors
    # of 0.1 * 1.24 that were asked for.
    off = np.abs(result.image[..., 0] - flux / (np.pi * coc**2))[inside]
    assert (off <= 6 * 0.1 * 1.24).all(), f"{(off > 0.75).sum()} of {inside.sum()} pixels miss the lamp"

"""The reference on random scenes of cards against exact areas on the lens: its error, and its word about it."""

import numpy as np
import pytest

import refdof
from tests.cards import TRUTH_ERROR, random_cards

SCENES = 60
STUDENT_16, STUDENT_4 = 2.131, 3.182  # 97.5 % quantiles of Student's t with 15 and 3 degrees of freedom
ROUNDING = 1e-6  # colours are stored in float32, whose roundings are below 6e-8, twice


@pytest.fixture(scope="module")
def scenes():
    return [random_cards(seed) for seed in range(SCENES)]


def errors(scenes, samples, replicates=None):
    """Error and standard error (N, 3) of all pixels with blur; each scene has a seed of its own."""
    pairs = []
    for k, cards in enumerate(scenes):
        result = refdof.reference(cards.scene, samples=samples, replicates=replicates, seed=k)
        pairs.append([(result.image - cards.truth)[cards.blurred], result.standard_error[cards.blurred]])
    return [np.concatenate(x) for x in zip(*pairs, strict=True)]


def test_there_is_something_to_test(scenes):
    assert sum(cards.blurred.sum() for cards in scenes) > 3000
    assert sum((~cards.blurred).sum() for cards in scenes) > 1000


def test_pixels_of_one_colour_have_that_colour(scenes):
    off = []
    for cards in scenes:
        image = refdof.reference(cards.scene, samples=256).image
        off.append(np.abs(image - cards.truth)[~cards.blurred].ravel())
    off = np.concatenate(off)
    # Where less than TRUTH_ERROR of the lens sees another colour, 256 points may meet it: then it counts 1 / 256, and
    # at most a share of 256 * TRUTH_ERROR = 0.3 % of these pixels does. Allow one point, at three times as many.
    assert off.max() <= 1 / 256 + ROUNDING
    assert np.mean(off > TRUTH_ERROR + ROUNDING) <= 0.01


@pytest.mark.parametrize(("samples", "student"), [(64, STUDENT_16), (256, STUDENT_4), (1024, STUDENT_4)])
def test_the_error_bar_is_honest(scenes, samples, student):
    error, standard_error = errors(scenes, samples)
    covered = np.abs(error) <= student * standard_error
    # 3 channels of 3400 pixels: the figure itself is known to 0.4 %.
    assert 0.90 <= covered.mean() <= 0.99
    # The mean square is free of Student's tails. Its own error: binary pixels' squares have a kurtosis near 3, so
    # sqrt(2 / 3400) = 2.4 %, more where few pixels have most of the variance; 15 % leaves room for that.
    assert (error**2).sum() / (standard_error**2).sum() == pytest.approx(1.0, abs=0.15)


def test_no_bias(scenes):
    error, standard_error = errors(scenes, 1024)
    # The error of the sum of independent pixels; 4 standard errors. Channels of a pixel are not independent.
    total = np.sqrt((standard_error.astype(np.float64) ** 2).sum(axis=0))
    assert (np.abs(error.sum(axis=0)) <= 4.0 * total + TRUTH_ERROR * len(error)).all()
    # Student's t with 15 degrees passes 6 in 2e-5 of all cases: 0.2 of 10^4. Pixels of which the lens sees a sliver
    # of a colour are far from normal: a share p unseen by 1024 points is below 10 / 1024 but for e^-10.
    assert (np.abs(error) <= 6.0 * standard_error + 10.0 / 1024).all()


def test_the_picture_sharpens_as_promised(scenes):
    few, _ = errors(scenes, 64, replicates=16)
    many, _ = errors(scenes, 1024, replicates=16)
    # Edges: N^-3/4 at best and N^-1/2 at worst, 1/8 and 1/4 of the error at 16 times the points; +- 10 %.
    ratio = np.sqrt((many**2).mean() / (few**2).mean())
    assert 0.125 * 0.9 <= ratio <= 0.25 * 1.1


def test_ghost_edges_have_the_same_error(scenes):
    own, shared = [], []
    for k, cards in enumerate(scenes):
        for where, pattern in ((own, False), (shared, True)):
            result = refdof.reference(cards.scene, samples=256, seed=k, shared_pattern=pattern)
            where.append(((result.image - cards.truth) ** 2)[cards.blurred].sum())
    # Pixels of a scene share their pattern, so a scene counts once: 60 of them with squares of relative spread 1
    # give 13 % each, 18 % for the ratio; 3 of these.
    assert sum(shared) / sum(own) == pytest.approx(1.0, abs=0.55)

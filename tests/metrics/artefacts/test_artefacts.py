"""Artefact metrics of pictures with planted faults of known size, and the naive twin."""

import math

import numpy as np
import pytest

from refdof import InputError
from refdof.metrics.artefacts import ARTEFACTS, ArtefactMaps, artefacts, artefacts_of_many
from tests.metrics.artefacts import naive
from tests.metrics.artefacts.test_maps import bar, random_scene

pytestmark = pytest.mark.fast


def grey(value, size=(12, 30)):
    return np.full((*size, 3), value)


def test_a_perfect_picture_has_no_artefacts():
    maps = bar()
    picture = np.random.default_rng(1).random((12, 30, 3))
    found = artefacts(maps, picture, picture)
    assert list(found) == list(ARTEFACTS)
    for name, value in found.items():
        assert value == 0.0 or math.isnan(value)
        assert math.isnan(value) == (name in ("rmse_behind", "lamps") or name.startswith("bokeh"))


def test_the_error_is_found_where_it_was_put():
    maps = bar()  # 10 columns near, 20 in focus, 6 in the band, 3 of them in front
    image = grey(0.5)
    image[:, 2] += 0.3  # in front, not in the band
    image[:, 20] -= 0.1  # in focus, not in the band
    found = artefacts(maps, grey(0.5), image)
    # One column of 10 and one of 20. Tolerance: roundings of float64.
    assert found["rmse_in_front"] == pytest.approx(0.3 / math.sqrt(10), rel=1e-12)
    assert found["rmse_in_focus"] == pytest.approx(0.1 / math.sqrt(20), rel=1e-12)
    assert found["rmse_occlusion"] == 0.0
    image[:, 10, 0] += 0.6  # one channel of three, one column of six
    assert artefacts(maps, grey(0.5), image)["rmse_occlusion"] == pytest.approx(0.6 / math.sqrt(18), rel=1e-12)


def test_the_variance_of_the_reference_is_taken_off():
    random = np.random.default_rng(2)
    shape, noise = (120, 160, 3), 0.05
    coc = np.full(shape[:2], 3.0)
    estimates = 0.5 + random.normal(0.0, noise * 2.0, (4, *shape))  # the mean of 4 has half the deviation
    reference, error = estimates.mean(axis=0), estimates.std(axis=0, ddof=1) / 2.0
    maps = ArtefactMaps(np.ones(coc.shape), coc, standard_error=error)
    assert artefacts(ArtefactMaps(np.ones(coc.shape), coc), reference, grey(0.5, shape[:2]))["rmse_behind"] > 0.045
    # Squares of 57600 normal values have a mean with a relative error of sqrt(2 / 57600) = 0.6 %; that of the error
    # bars, of 3 degrees of freedom, sqrt(2 / 3 / 57600) = 0.34 %. Together 0.7 % of 0.0025: 4 times that.
    room = 4 * 0.007 * noise**2
    assert artefacts(maps, reference, grey(0.5, shape[:2]))["rmse_behind"] <= math.sqrt(room)
    biased = artefacts(maps, reference, grey(0.6, shape[:2]))["rmse_behind"]
    # The product of bias and noise adds 2 * 0.1 * 0.05 / sqrt(57600).
    assert abs(biased**2 - 0.01) < room + 4 * 2 * 0.1 * noise / math.sqrt(57600)
    # Perfect pictures and a noisy reference: nothing local is found.
    found = artefacts(maps, reference, grey(0.5, shape[:2]))
    assert found["ringing"] == 0.0


@pytest.mark.parametrize("color", [None, grey(0.5)])
def test_a_leak_of_known_energy(color):
    maps = bar()  # 17 sharp columns of 12 pixels
    maps = ArtefactMaps(maps.depth, maps.coc, color)
    image = grey(0.5)
    image[3:5, 20:23] += (0.3, 0.6, 0.9)  # six pixels of 0.6
    image[9, 25] -= 0.4
    image[:, 11] += 5.0  # not in a sharp pixel: the card's blur belongs there
    found = artefacts(maps, grey(0.5), image)
    assert found["leakage"] == pytest.approx((6 * 0.6 - 0.4) / (17 * 12), rel=1e-12)
    assert found["leakage_worst"] == pytest.approx(0.6, rel=1e-12)
    image[9, 25] -= 0.4
    assert artefacts(maps, grey(0.5), image)["leakage_worst"] == pytest.approx(0.8, rel=1e-12)


def test_what_neighbours_have_is_no_leak():
    maps = bar()
    reference = grey(0.2)
    reference[:, 20:] = 0.8
    soft = reference.copy()
    soft[:, 19:21] = 0.5  # a sharp edge, half a pixel wide
    assert artefacts(maps, reference, soft)["leakage_worst"] == 0.0
    soft[:, 18] = 0.3  # that edge is farther than a pixel
    found = artefacts(maps, reference, soft)
    assert found["leakage_worst"] == pytest.approx(0.1, rel=1e-12)
    assert found["leakage"] == pytest.approx(0.1 / 17, rel=1e-12)
    # Nor is what the pinhole's picture has there.
    lit = ArtefactMaps(maps.depth, maps.coc, soft)
    assert artefacts(lit, reference, soft)["leakage_worst"] == 0.0


def test_a_known_step_at_a_foreground_boundary():
    maps = bar()
    reference = grey(0.0) + np.clip((np.arange(30) - 6.5) / 6.0, 0.0, 1.0)[:, None]  # fades out over 6 px
    sharp = grey(0.0)
    sharp[:, 10:] = 1.0
    # The reference's own step from pixel to pixel is 1 / 6.
    assert artefacts(maps, reference, sharp)["boundary_step"] == pytest.approx(1.0 - 1.0 / 6.0, rel=1e-12)
    assert artefacts(maps, reference, reference.mean(axis=1, keepdims=True) + 0 * sharp)["boundary_step"] == 0.0
    # Four standard errors of the difference of two pixels of 0.01 are taken off; noise is even, so pooled as it is.
    noisy = ArtefactMaps(maps.depth, maps.coc, standard_error=grey(0.01))
    expected = 1.0 - 1.0 / 6.0 - 4.0 * math.sqrt(2.0) * 0.01
    assert artefacts(noisy, reference, sharp)["boundary_step"] == pytest.approx(expected, rel=1e-9)
    # In the other direction, too.
    turned = ArtefactMaps(maps.depth.T, maps.coc.T)
    found = artefacts(turned, reference.transpose(1, 0, 2), sharp.transpose(1, 0, 2))
    assert found["boundary_step"] == pytest.approx(1.0 - 1.0 / 6.0, rel=1e-12)


def test_a_sine_of_known_amplitude_as_ringing():
    maps = ArtefactMaps(np.ones((16, 64)), np.full((16, 64), 6.0))
    wave = 0.2 * np.sin(2 * np.pi * (np.arange(64) + 0.5) / 8.0)[None, :, None]
    reference = grey(0.5, (16, 64))
    # Whole periods: the mean of sin^2 is a half.
    assert artefacts(maps, reference, reference + wave)["ringing"] == pytest.approx(0.2 / math.sqrt(2), rel=1e-12)
    # The same wave in the reference is no ringing, wherever its crests are: a period fits in 17 px, or 9 at the border.
    assert artefacts(maps, reference + wave, reference + np.roll(wave, 3, axis=1))["ringing"] < 1e-15
    # Twice the wave goes beyond it, where 2 sin is above 1.
    values = np.maximum(2 * np.abs(wave) - np.abs(wave).max(), 0.0)
    found = artefacts(maps, reference + wave, reference + 2 * wave)["ringing"]
    assert found == pytest.approx(math.sqrt(float((values**2).mean())), rel=1e-12)


@pytest.mark.parametrize("seed", range(12))
def test_metrics_match_the_naive_twin(seed):
    depth, coc, color, error, reference, image = random_scene(seed)
    found = artefacts(ArtefactMaps(depth, coc, color, error), reference, image)
    expected = naive.artefacts(*(part.tolist() for part in (depth, coc, color, error, reference, image)))
    assert set(found) - set(expected) == {"lamps", *(name for name in found if name.startswith("bokeh"))}
    for name, value in expected.items():
        # Sums of some hundred float64 in another order; running sums of squared errors cancel to 1e-14 of the largest.
        assert found[name] == pytest.approx(value, rel=1e-9, abs=1e-12, nan_ok=True), name


def test_every_metric_is_met_by_the_twin():
    found = [naive.artefacts(*(part.tolist() for part in random_scene(seed))) for seed in range(12)]
    for name in found[0]:
        assert sum(one[name] != 0.0 and not math.isnan(one[name]) for one in found) >= 2, name


def test_many_are_as_one_by_one():
    maps, picture = bar(), grey(0.5)
    images = [picture + 0.1, picture, picture - 0.1]
    told = []
    many = artefacts_of_many(maps, picture, images, lambda done, count: told.append((done, count)))
    for one, image in zip(many, images, strict=True):
        assert repr(one) == repr(artefacts(maps, picture, image))
    assert told[-1] == (3, 3)


def test_bad_pictures_are_named():
    maps = bar()
    with pytest.raises(InputError, match="reference: got shape"):
        artefacts(maps, grey(0.5, (30, 12)), grey(0.5))
    with pytest.raises(InputError, match="image: got shape"):
        artefacts(maps, grey(0.5), grey(0.5, (30, 12)))
    with pytest.raises(InputError, match="image: has 1080 NaN values"):
        artefacts(maps, grey(0.5), grey(math.nan))
    with pytest.raises(InputError, match="maps: got dict; allowed is a ArtefactMaps"):
        artefacts({}, grey(0.5), grey(0.5))

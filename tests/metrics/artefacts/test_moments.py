"""Moments of spots whose moments are known, and what lamps with such spots are given."""

import math

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from refdof import InputError
from refdof.metrics.artefacts import ArtefactMaps, artefacts, disc_radius, moments
from refdof.metrics.artefacts.lamps import Lamp, bokeh, lamps
from tests.metrics.artefacts import naive

pytestmark = pytest.mark.fast


def ellipse(x, y, p, q, size=64, parts=8):
    """Coverage (size, size) of an ellipse with half axes p and q by parts x parts points per pixel."""
    place = (np.arange(size * parts) + 0.5) / parts
    inside = ((place - x) / p) ** 2 + ((place[:, None] - y) / q) ** 2 <= 1.0
    return inside.reshape(size, parts, size, parts).mean(axis=(1, 3))


def gaussian(size, deviation):
    """A Gaussian around the middle of size x size pixels, of unit energy."""
    place = np.arange(size) - (size - 1) / 2.0
    line = np.exp(-0.5 * (place / deviation) ** 2)
    return np.outer(line, line) / line.sum() ** 2


def test_a_disc():
    found = moments(ellipse(30.25, 33.0, 12.0, 12.0))
    # Points on a grid of 1/8 px: the disc's rim, 75 px long, has 600 of them, each right within 1/64 px^2: 0.4 of 452.
    # Spread evenly, they move nothing else by more than 1e-3 of the radius. Pixels add 1/6 to the variance.
    assert found.energy == pytest.approx(math.pi * 144.0, abs=4 * 0.4)
    assert (found.x, found.y) == pytest.approx((30.25, 33.0), abs=0.012)
    assert found.radius == pytest.approx(math.sqrt(72.0 + 1.0 / 6.0), rel=1e-3)
    assert found.anisotropy < 2e-3
    assert disc_radius(12.0) == pytest.approx(math.sqrt(72.0), rel=1e-15)


def test_a_disc_that_is_moved_by_a_quarter_of_a_pixel():
    first, second = (moments(ellipse(30.0 + shift, 33.0, 12.0, 12.0)) for shift in (0.0, 0.25))
    # The light of a pixel counts at its centre. That moves what 75 pixels of the rim hold by 0.1 px or less each, at
    # random: sqrt(75) * 0.1 of 452.
    assert second.x - first.x == pytest.approx(0.25, abs=2e-3)
    assert second.y - first.y == pytest.approx(0.0, abs=1e-12)


def test_an_ellipse():
    found = moments(ellipse(32.0, 32.0, 15.0, 5.0))
    # Variances p^2 / 4 and q^2 / 4, and 1/12 of a pixel in each. Tolerance as above.
    assert found.radius == pytest.approx(math.sqrt((225.0 + 25.0) / 4.0 + 1.0 / 6.0), rel=2e-3)
    assert found.anisotropy == pytest.approx((225.0 - 25.0) / (225.0 + 25.0 + 2.0 / 3.0), rel=4e-3)


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.0, 2.2])
def test_anisotropy_does_not_depend_on_the_direction(angle):
    y, x = np.indices((61, 61)) - 30.0
    u, v = x * math.cos(angle) + y * math.sin(angle), y * math.cos(angle) - x * math.sin(angle)
    spot = np.exp(-0.5 * ((u / 6.0) ** 2 + (v / 3.0) ** 2))
    # Sums over pixels of a Gaussian of deviation 3 px are its integrals to 1e-20; 30 px are 5 of the longer, 4e-6.
    assert moments(spot).anisotropy == pytest.approx((36.0 - 9.0) / (36.0 + 9.0), abs=1e-4)


@pytest.mark.parametrize("deviation", [2.0, 5.0, 8.0])
def test_a_gaussian_has_a_radius_of_the_root_of_two_deviations(deviation):
    found = moments(gaussian(201, deviation))
    # 12 deviations to each side: only rounding of 40000 terms is left.
    assert found.radius == pytest.approx(math.sqrt(2.0) * deviation, rel=1e-10)
    assert found.energy == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_moments_match_the_naive_twin(seed):
    spot = np.random.default_rng(seed).random((5, 8)) ** 4
    # The twin tries a direction every 1/20 degree: the variance is stationary there, so it errs by (pi / 7200)^2.
    assert tuple(moments(spot)) == pytest.approx(naive.moments(spot.tolist()), abs=1e-6)
    channels = moments(np.stack([spot, 0.0 * spot, 2.0 * spot], axis=2))
    assert tuple(channels) == pytest.approx(tuple(moments(3.0 * spot)), rel=1e-12)


def test_a_point_and_nothing():
    spot = np.zeros((3, 4))
    spot[2, 1] = 2.0
    assert moments(spot) == (2.0, 1.5, 2.5, 0.0, 0.0)
    assert moments(0.0 * spot)[0] == 0.0
    assert all(map(math.isnan, moments(0.0 * spot)[1:]))
    with pytest.raises(InputError, match="spot: got shape"):
        moments(np.zeros(3))
    with pytest.raises(InputError, match="spot: has 1 NaN"):
        moments([[math.nan]])


def night(*places, circle=6.0, size=120):
    """A dark wall behind focus with lamps of 2 x 2 px: maps, and the picture that has an ideal disc of each."""
    color = np.full((size, size, 3), 0.1)
    reference = color.copy()
    for x, y in places:
        color[y - 1 : y + 1, x - 1 : x + 1] = (30.0, 20.0, 10.0)
        disc = ellipse(x, y, circle, circle, size)
        reference += (disc / disc.sum())[..., None] * 4.0 * np.array([30.0, 20.0, 10.0])
    return ArtefactMaps(np.ones((size, size)), np.full((size, size), circle), color), reference


def test_only_isolated_lamps_count():
    maps, _ = night((40, 40), (80, 80))
    assert [(lamp.x, lamp.y, lamp.circle, lamp.window) for lamp in lamps(maps)] == [
        (40.0, 40.0, 6.0, 10.0),  # 1.5 circles and half of 2 px
        (80.0, 80.0, 6.0, 10.0),
    ]
    # Window and ring are 12 px, the other disc 6, its farthest pixels a half beyond: 18 px to the next pixel's centre.
    assert len(lamps(night((40, 40), (59, 40))[0])) == 2
    assert len(lamps(night((40, 40), (58, 40))[0])) == 0
    assert len(lamps(night((12, 40))[0])) == 1
    assert len(lamps(night((11, 40))[0])) == 0  # 12 px would leave the picture
    for circle, count in ((1.9, 0), (2.1, 1)):
        point, _ = night((40, 40), circle=circle)
        point.color[39, 39:41] = point.color[40, 39] = 0.1
        assert len(lamps(point)) == count
    focus = ArtefactMaps(maps.depth, 0.0 * maps.coc, maps.color)
    assert lamps(focus) == []
    assert lamps(ArtefactMaps(maps.depth, maps.coc)) == []


def test_a_lamp_as_large_as_its_circle_is_none():
    maps, _ = night((40, 40), circle=3.0)
    assert len(lamps(maps)) == 1
    maps.color[38:42, 38:42] = 9.0
    assert lamps(ArtefactMaps(maps.depth, maps.coc, maps.color)) == []


def test_what_a_method_makes_of_lamps():
    places = (40, 40), (80, 80), (80, 40)
    maps, reference = night(*places)
    perfect = artefacts(maps, reference, reference)
    assert (perfect["lamps"], perfect["bokeh_offset"], perfect["bokeh_radius"]) == (3.0, 0.0, 1.0)
    assert (perfect["bokeh_anisotropy"], perfect["bokeh_energy"]) == (0.0, 1.0)
    # A whole pixel to the right, and half of the light. Roundings only: the background is the same.
    image = np.roll(reference, 1, axis=1)
    found = artefacts(maps, reference, image)
    assert (found["bokeh_offset"], found["bokeh_radius"]) == pytest.approx((1.0, 1.0), abs=1e-9)
    assert artefacts(maps, reference, 0.1 + (reference - 0.1) / 2.0)["bokeh_energy"] == pytest.approx(0.5, rel=1e-9)
    # A Gaussian kernel of 2 px of the points, which has sqrt(8 + the lamp's own); the disc has sqrt(18 + 1/6).
    points = np.full(reference.shape, 0.1)
    for x, y in places:
        points[y - 1 : y + 1, x - 1 : x + 1] += (30.0, 20.0, 10.0)
    image = np.stack([gaussian_filter(points[..., c], 2.0, truncate=5.0) for c in range(3)], axis=2)
    found = artefacts(maps, reference, image)
    # The lamp's 2 x 2 points have a variance of 1/4 + 1/4. Beyond the window of 5 deviations are 4e-6 of the light.
    # The disc is half as large as above, and twice as wrong.
    assert found["bokeh_radius"] == pytest.approx(math.sqrt(8.5 / (18.0 + 1.0 / 6.0)), rel=4e-3)
    assert found["bokeh_energy"] == pytest.approx(1.0, abs=1e-5)
    assert found["bokeh_anisotropy"] == pytest.approx(0.0, abs=2e-3)


def test_an_anisotropic_spot():
    maps, reference = night((60, 60))
    wide = ellipse(60.0, 60.0, 8.0, 4.0, 120)
    image = 0.1 + (wide / wide.sum())[..., None] * 4.0 * np.array([30.0, 20.0, 10.0])
    found = artefacts(maps, reference, image)
    # Half axes 8 and 4: (64 - 16) / (64 + 16), pixels as above.
    assert found["bokeh_anisotropy"] == pytest.approx(48.0 / (80.0 + 2.0 / 3.0), abs=8e-3)


@pytest.mark.parametrize("light", [1.0, 2.0**-9])
@pytest.mark.parametrize("turned", [lambda a: a[:, ::-1], lambda a: a[::-1], lambda a: a.transpose(1, 0, 2)])
def test_a_mirrored_lamp_is_the_same_lamp_in_any_light(turned, light):
    reference, image = np.random.default_rng(8).random((2, 21, 21, 3))
    reference[8:11, 8:11] += 5.0
    image[7:12, 8:11] += 3.0
    # The ring ends at 15.75, beyond the centre of the last pixel that it cuts, and begins at 2.75, beyond the first's.
    place = np.zeros((21, 21, 1))
    place[9, 9] = 1.0
    y, x = np.argwhere(turned(place)[..., 0])[0]
    places = {9: 9.25, 11: 11.75}
    lamp, other = Lamp(9.25, 9.25, 3.0, 4.5), Lamp(places[x], places[y], 3.0, 4.5)
    found, wanted = bokeh([other], light * turned(reference), light * turned(image)), bokeh([lamp], reference, image)
    assert found == pytest.approx(wanted, rel=1e-9)  # sums of a hundred numbers in another order

"""Lens samples: exact counts, moments, spacing and evenness, against closed forms and SciPy's discrepancy."""

import math

import numpy as np
import pytest
from scipy.spatial.distance import pdist, squareform
from scipy.stats import qmc

from refdof._check import InputError
from refdof.optics.aperture import Aperture
from refdof.optics.lens_samples import PATTERNS, lens_samples

pytestmark = pytest.mark.fast

HEXAGON = Aperture.polygon(6, rotation=7.0, curvature=0.3)


def square_of_disc(points):
    """Inverse of the concentric map, by angle and radius."""
    radius, angle = np.hypot(*points.T), np.arctan2(points[:, 1], points[:, 0])
    side = np.floor(angle / (np.pi / 2) + 0.5)
    along = radius * (angle - side * np.pi / 2) / (np.pi / 4)
    turn = side * np.pi / 2
    cosine, sine = np.round(np.cos(turn)), np.round(np.sin(turn))
    return (np.stack([cosine * radius - sine * along, sine * radius + cosine * along], axis=1) + 1.0) / 2.0


@pytest.mark.parametrize("pattern", PATTERNS)
def test_exactly_as_many_points_as_asked_all_on_the_lens(pattern):
    for count in range(1, 71):
        points, weights = lens_samples(count, pattern, seed=count)
        assert points.shape == (count, 2)
        assert points.dtype == weights.dtype == np.float64
        assert np.hypot(*points.T).max() <= 1.0 + 1e-15  # a few roundings of 1.1e-16
        assert (weights == 1.0).all()
        assert len(np.unique(points, axis=0)) == count


@pytest.mark.parametrize("pattern", PATTERNS)
def test_same_seed_same_bits_other_seed_other_points(pattern):
    first, _ = lens_samples(33, pattern, 5, HEXAGON)
    again, _ = lens_samples(33, pattern, 5, HEXAGON)
    other, _ = lens_samples(33, pattern, 6, HEXAGON)
    np.testing.assert_array_equal(first, again)
    assert (first != other).any(axis=1).sum() >= 32  # at most one point may fall together


@pytest.mark.parametrize("pattern", PATTERNS)
def test_moments_of_the_disc(pattern):
    count = 256
    x, y = lens_samples(count, pattern, seed=1)[0].T
    # x has variance 1/4; x^2 has 1/8 - 1/16 = 1/16; x y has 1/24. No pattern may be worse than five standard
    # errors of independent points.
    error = 5.0 / math.sqrt(count)
    np.testing.assert_allclose([x.mean(), y.mean()], 0.0, atol=0.5 * error)
    np.testing.assert_allclose([np.mean(x * x), np.mean(y * y)], 0.25, atol=0.25 * error)
    assert abs(np.mean(x * y)) < error / math.sqrt(24.0)


def test_the_spiral_has_the_radii_of_equal_rings():
    for count in (1, 7, 32, 100):
        x, y = lens_samples(count, "vogel", seed=3)[0].T
        # r^2 = (k + 1/2) / N by definition; the map back to the disc rounds a few times.
        np.testing.assert_allclose(x * x + y * y, (np.arange(count) + 0.5) / count, atol=1e-14)
        turn = np.diff(np.unwrap(np.arctan2(y, x)))
        golden = np.pi * (3.0 - math.sqrt(5.0))
        np.testing.assert_allclose(np.cos(turn), np.cos(golden), atol=1e-13)


@pytest.mark.parametrize("pattern", ["sobol", "halton"])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_low_discrepancy_is_lower_than_random(pattern, seed):
    even = qmc.discrepancy(square_of_disc(lens_samples(256, pattern, seed)[0]), method="L2-star")
    random = qmc.discrepancy(square_of_disc(lens_samples(256, "random", seed)[0]), method="L2-star")
    # Random points have an L2-star discrepancy of order N^-1/2, scrambled nets N^-1 log N: about 8 times less
    # at 256. Half of that leaves room for lucky random points.
    assert even < random / 4.0


@pytest.mark.parametrize("count", [32, 64, 256])
def test_a_sobol_net_has_one_point_in_every_elementary_cell(count):
    square = square_of_disc(lens_samples(count, "sobol", seed=4)[0])
    for columns in [2**k for k in range(count.bit_length())]:
        rows = count // columns
        # 1e-12: mapping there and back rounds, and points of a scrambled net stay away from borders by more.
        cell = np.floor(square * [columns, rows] + 1e-12).astype(int)
        assert len(np.unique(cell[:, 0] * rows + cell[:, 1])) == count


@pytest.mark.parametrize(("count", "rows", "columns"), [(64, 8, 8), (12, 3, 4), (56, 7, 8), (1, 1, 1)])
def test_jittered_grid_has_one_point_in_every_cell(count, rows, columns):
    square = square_of_disc(lens_samples(count, "jittered", seed=2)[0])
    column, row = np.floor(square * [columns, rows]).astype(int).T
    assert len(np.unique(row * columns + column)) == count
    assert (np.bincount(column) == rows).all()  # both projections are even
    assert (np.bincount(row) == columns).all()


@pytest.mark.parametrize("count", [7, 13, 31, 61])
def test_jittered_rows_of_a_prime_count_have_equal_areas(count):
    square = square_of_disc(lens_samples(count, "jittered", seed=2)[0])
    rows = round(math.sqrt(count))
    sizes = [count // rows + (k < count % rows) for k in range(rows)]
    borders = np.cumsum([0, *sizes]) / count
    for k in range(rows):
        inside = (square[:, 1] >= borders[k]) & (square[:, 1] < borders[k + 1])
        assert sorted(np.floor(square[inside, 0] * sizes[k]).astype(int)) == list(range(sizes[k]))


@pytest.mark.parametrize("count", [2, 3, 16, 32, 61, 200])
def test_poisson_points_keep_their_distance(count):
    # The densest packing of `count` points has distance sqrt(2 pi / (sqrt(3) count)); darts keep 0.7 of it.
    largest = math.sqrt(2.0 * math.pi / (math.sqrt(3.0) * count))
    for seed in range(5):
        assert pdist(lens_samples(count, "poisson", seed)[0]).min() >= 0.7 * largest * (1 - 1e-12)  # roundings


def test_poisson_spacing_of_the_2009_multiview_paper():
    nearest = []
    for seed in range(30):
        distance = squareform(pdist(lens_samples(32, "poisson", seed)[0]))
        np.fill_diagonal(distance, np.inf)
        nearest.append(distance.min(axis=1).mean() / 2.0)
    # Lee, Eisemann and Seidel print 0.137 for 32 samples. Sets differ by a standard deviation of 0.0033, the mean of 30
    # by 0.0006. Darts that fall on the lens alone crowd at its rim and give 0.137; ours, spread evenly, lie 2 % closer.
    assert np.mean(nearest) == pytest.approx(0.137 * 0.98, abs=3 * 0.0006)


@pytest.mark.parametrize("pattern", PATTERNS)
@pytest.mark.parametrize("count", [16, 64])
def test_points_are_spread_evenly_from_the_middle_to_the_rim(pattern, count):
    # The squared distance from the middle is uniform in 0 .. 1: mean 1/2, variance 1/12. Patterns are not worse than
    # independent points: five standard errors of 40 sets.
    squared = [(lens_samples(count, pattern, seed)[0] ** 2).sum(axis=1).mean() for seed in range(40)]
    assert np.mean(squared) == pytest.approx(0.5, abs=5 * math.sqrt(1 / 12 / count / 40))
    if pattern == "poisson":  # darts on the lens alone would have 0.554 and 0.535
        assert np.mean(squared) == pytest.approx(0.5, abs=0.012)


@pytest.mark.parametrize("pattern", PATTERNS)
def test_polygons_get_the_same_pattern(pattern):
    x, y = lens_samples(512, pattern, seed=0, aperture=Aperture.polygon(4))[0].T
    assert (np.abs(x) + np.abs(y)).max() <= 1.0 + 1e-15  # the square on its corner
    # Its second moment is 1/6 for each axis; x^2 has variance 1/15 - 1/36. Five standard errors.
    error = 5.0 * math.sqrt((1 / 15 - 1 / 36) / 512)
    np.testing.assert_allclose([np.mean(x * x), np.mean(y * y)], 1 / 6, atol=error)


def image_moments(weights):
    """Mean (2,) and mean square (2, 2) of an image's light over the square, texel by texel."""
    height, width = weights.shape
    mean, square = np.zeros(2), np.zeros((2, 2))
    for j in range(height):
        for i in range(width):
            share = weights[j, i] / weights.sum()
            x, y = (2 * i + 1) / width - 1, 1 - (2 * j + 1) / height
            mean += share * np.array([x, y])
            # A texel's own variance is a twelfth of its width squared.
            square += share * np.array([[x * x + 1 / (3 * width**2), x * y], [x * y, y * y + 1 / (3 * height**2)]])
    return mean, square


def blob(size=12):
    """Transmission (size, size): a clear half with a darker corner, opaque elsewhere and outside the lens circle."""
    weights = np.zeros((size, size))
    weights[: size // 2] = 1.0
    weights[size // 4 : size // 2, size // 2 :] = 0.5
    return Aperture.image(weights).weights


@pytest.mark.long
@pytest.mark.parametrize("pattern", PATTERNS)
@pytest.mark.parametrize("count", [64, 512])
def test_points_of_an_image_have_its_moments(pattern, count):
    aperture = Aperture.image(blob())
    mean, square = image_moments(blob())
    sums = np.zeros(3)
    for seed in range(8):
        points, weights = lens_samples(count, pattern, seed, aperture)
        assert (weights == 1.0).all()
        assert (aperture.transmission(points) > 0.0).all()  # none is spent on an opaque texel
        x, y = points.T
        sums += [np.mean(1 + 2 * x - y), np.mean(3 * x * x + y * y), np.mean(x * y)]
    exact = [1 + 2 * mean[0] - mean[1], 3 * square[0, 0] + square[1, 1], square[0, 1]]
    # Each of the three has a variance below 1.5. Independent points: five standard errors of the mean of all; Poisson
    # discs have the moments themselves.
    room = 1e-10 if pattern == "poisson" else 5 * math.sqrt(1.5 / 8 / count)
    np.testing.assert_allclose(sums / 8, exact, atol=room)


@pytest.mark.parametrize("pattern", PATTERNS)
@pytest.mark.parametrize("count", [1, 2, 8])
def test_the_smallest_hole_gets_all_points(pattern, count):
    image = np.zeros((101, 101))
    image[50, 60] = 1.0
    points, weights = lens_samples(count, pattern, 0, Aperture.image(image))
    assert (np.abs(points - (20 / 101, 0)) <= 1 / 101).all()
    assert (weights == 1.0).all()


half_gaussian = (0.5 - math.exp(-2) / (1 - math.exp(-2))) / 2  # (2 s^2 - q / (1 - q)) / 2 with q = exp(-1 / (2 s^2))
OPENINGS = {  # aperture, covariance, area by closed forms
    "disc": (Aperture.disc(), [[1 / 4, 0], [0, 1 / 4]], math.pi),
    "ellipse": (Aperture.disc(0.4), [[0.04, 0], [0, 1 / 4]], 0.4 * math.pi),
    "triangle": (Aperture.polygon(3), [[1 / 8, 0], [0, 1 / 8]], 0.75 * math.sqrt(3)),
    "square": (Aperture.polygon(4, 20.0), [[1 / 6, 0], [0, 1 / 6]], 2.0),
    "gaussian": (Aperture.gaussian(0.5), [[half_gaussian, 0], [0, half_gaussian]], None),
    "image": (Aperture.image(blob()), None, None),
}


def best_distance(name, points):
    """Of the densest packing of as many points at each point's density: sqrt(2 / (sqrt 3 n)) at n points per area."""
    aperture_sampler, _, area = OPENINGS[name]
    count = len(points)
    if name == "gaussian":  # exp(-2 r^2) over its integral, pi / 2 (1 - e^-2)
        area = np.pi / 2 * (1 - np.exp(-2)) * np.exp(2 * (points**2).sum(axis=1))
    if name == "image":  # texels of 1/6 x 1/6
        area = blob().sum() / 36 / aperture_sampler.transmission(points)
    best = np.broadcast_to(np.sqrt(2 / np.sqrt(3) * np.asarray(area) / count), count)
    i, j = np.triu_indices(count, 1)
    return np.minimum(best[i], best[j])


@pytest.mark.parametrize("name", OPENINGS)
@pytest.mark.parametrize("count", [3, 8, 32, 100])
def test_poisson_discs_have_mean_and_covariance_of_the_aperture_and_keep_their_distance(name, count):
    aperture_sampler, covariance, _ = OPENINGS[name]
    mean = np.zeros(2)
    if name == "image":
        mean, square = image_moments(blob())
        covariance = square - np.outer(mean, mean)
    for seed in range(3):
        points, _ = lens_samples(count, "poisson", seed, aperture_sampler)
        assert (pdist(points) >= 0.7 * best_distance(name, points) * (1 - 1e-12)).all()  # roundings
        off = points - points.mean(axis=0)
        if name == "image" and count == 3:
            continue  # three points in two halves cannot have them
        # The moves end below 1e-14.
        np.testing.assert_allclose(points.mean(axis=0), mean, atol=2e-14)
        np.testing.assert_allclose(off.T @ off / count, covariance, atol=2e-14)


def test_one_and_two_poisson_points():
    assert lens_samples(1, "poisson", 4)[0].tolist() == [[0.0, 0.0]]
    first, second = lens_samples(2, "poisson", 4)[0]
    np.testing.assert_allclose(first, -second, atol=1e-15)
    assert first @ first == pytest.approx(0.5, rel=1e-12)  # mean r^2 of the disc


@pytest.mark.parametrize(
    ("aperture", "square"), [(Aperture.disc(0.05), 0.25 * (1 + 0.05**2)), (Aperture.polygon(4, ratio=0.1), None)]
)
def test_two_poisson_points_are_centred_on_a_narrow_aperture(aperture, square):
    for seed in range(20):
        first, second = lens_samples(2, "poisson", seed, aperture)[0]
        np.testing.assert_allclose(first, -second, atol=1e-15)
        assert square is None or first @ first == pytest.approx(square, rel=1e-12)  # mean x^2 + y^2 of the ellipse


# Root mean square distance of the mean from the middle on the disc, and mean of the least distance over the densest
# packing's, on the disc, a hexagon and a triangle: 20 sets each. Poisson discs are centred. The spiral on a polygon
# follows its outline, and its least distance falls (to 0.86 and 0.60 of the disc's); no other pattern loses a fifth.
TABLE = {
    ("sobol", 8): (0.0434, 0.468, 0.453, 0.438),
    ("sobol", 32): (0.0069, 0.332, 0.328, 0.310),
    ("sobol", 100): (0.0050, 0.211, 0.206, 0.180),
    ("halton", 8): (0.0996, 0.471, 0.468, 0.438),
    ("halton", 32): (0.0287, 0.304, 0.298, 0.262),
    ("halton", 100): (0.0107, 0.246, 0.242, 0.210),
    ("vogel", 8): (0.0567, 0.812, 0.805, 0.620),
    ("vogel", 32): (0.0162, 0.812, 0.746, 0.530),
    ("vogel", 100): (0.0052, 0.812, 0.701, 0.490),
    ("poisson", 8): (0.0, 0.738, 0.740, 0.738),
    ("poisson", 32): (0.0, 0.711, 0.709, 0.707),
    ("poisson", 100): (0.0, 0.706, 0.706, 0.706),
    ("jittered", 8): (0.0932, 0.408, 0.411, 0.416),
    ("jittered", 32): (0.0240, 0.259, 0.249, 0.234),
    ("jittered", 100): (0.0073, 0.161, 0.154, 0.158),
    ("random", 8): (0.2346, 0.247, 0.251, 0.263),
    ("random", 32): (0.1190, 0.099, 0.103, 0.107),
    ("random", 100): (0.0674, 0.071, 0.069, 0.066),
}


@pytest.mark.long
@pytest.mark.parametrize(("pattern", "count"), TABLE)
def test_centre_and_spacing_of_every_pattern(pattern, count):
    centre, *spacing = TABLE[pattern, count]
    shapes = (
        (Aperture.disc(), math.pi),
        (Aperture.polygon(6), 1.5 * math.sqrt(3)),
        (Aperture.polygon(3), 0.75 * 3**0.5),
    )
    for (aperture_sampler, area), expected in zip(shapes, spacing, strict=True):
        sets = [lens_samples(count, pattern, seed, aperture_sampler)[0] for seed in range(20)]
        off = math.sqrt(np.mean([(points.mean(axis=0) ** 2).sum() for points in sets]))
        least = np.mean([pdist(points).min() for points in sets]) / math.sqrt(2 * area / (math.sqrt(3) * count))
        assert least == pytest.approx(expected, abs=0.0006)  # as printed
        if aperture_sampler is shapes[0][0]:
            assert off == pytest.approx(centre, abs=0.00006)
        assert off <= math.sqrt(1 / 2 / count)  # independent points on the disc have this; polygons are smaller
    assert spacing[1] > (0.85 if pattern == "vogel" else 0.95) * spacing[0]
    assert spacing[2] > (0.60 if pattern == "vogel" else 0.80) * spacing[0]


BAD = [
    ({"count": 0}, "count"),
    ({"count": 2.5}, "count"),
    ({"count": 2**20 + 1}, "count"),
    ({"count": math.nan}, "count"),
    ({"pattern": "grid"}, "pattern"),
    ({"seed": -1}, "seed"),
    ({"seed": None}, "seed"),
]


@pytest.mark.parametrize(("bad", "name"), BAD)
def test_bad_arguments_are_named(bad, name):
    with pytest.raises(InputError, match=f"^{name}: got "):
        lens_samples(**{"count": 4, "pattern": "sobol", "seed": 0, **bad})

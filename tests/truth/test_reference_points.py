"""The reference's points are independent between pixels, replicates, seeds and axes: what a picture shows of it.

Cards close to the lens are seen by every pixel at the same place, so that a pixel's value is a mean over its lens
points alone, and its error tells one set of points from another.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from refdof import Part, ThinLens, reference, render
from tests import flat_scene

pytestmark = pytest.mark.fast
WIDTH, HEIGHT, P, CLOSE = 9, 5, 20.0, 2.0**-10


def shot():
    return flat_scene.camera(WIDTH, HEIGHT, P)


def ramp_on_the_lens():
    """Red grows by 1/8 per lens radius to the right, green upwards."""
    corners = np.array([[-3.0, -3.0], [3.0, -3.0], [3.0, 3.0], [-3.0, 3.0]])
    color = np.concatenate([0.5 + corners / 8.0, np.full((4, 1), 0.5)], axis=1)
    part = Part(
        np.concatenate([corners, np.full((4, 1), -CLOSE)], axis=1), [[0, 1, 2], [0, 2, 3]], flat_scene.paint((1, 1, 1)),
        color=color,
    )  # fmt: skip
    return flat_scene.scene_of([part], shot(), ThinLens(1.0, 2.0))


def errors_of(**words):
    """Errors (N, 2) of all pixels, and standard errors: the mean of a linear function is its value at the centre."""
    truth = reference(ramp_on_the_lens(), **words)
    right, up = flat_scene.tangents(WIDTH, HEIGHT, P)
    exact = np.stack([0.5 + CLOSE * right / 8.0, 0.5 + CLOSE * up / 8.0], axis=-1)
    return (truth.image[..., :2] - exact).reshape(-1, 2), truth.standard_error[..., :2].reshape(-1, 2)


def apart(errors, others):
    """Whether no error (N, 2) is one of the others; equal points give the same but for a float32 rounding, 6e-8."""
    return np.abs(errors[:, None] - others[None]).max(axis=-1) > 3e-7


def test_no_two_pixels_share_their_points():
    # 9 x 5 pixels: neither x + y nor x + 5 y tells them apart.
    errors, _ = errors_of(samples=32)
    assert np.abs(errors).max() < 0.1
    assert (apart(errors, errors) | np.eye(len(errors), dtype=bool)).all()


def test_a_shared_pattern_is_shared_by_all_pixels():
    errors, _ = errors_of(samples=32, shared_pattern=True)
    assert not apart(errors, errors).any()
    assert np.abs(errors).max() > 1e-5


def test_seeds_share_no_points():
    pictures = [errors_of(samples=32, seed=seed)[0] for seed in (0, 1, 2, 2**32 - 1)]
    for k, errors in enumerate(pictures):
        for others in pictures[:k]:
            assert apart(errors, others).all()


@pytest.mark.parametrize("points", [1, 4])
def test_the_spread_of_replicates_is_the_error(points):
    errors, bars = errors_of(samples=4 * points, replicates=4, seed=3)
    # 90 independent values, whose bars come from 4 replicates: the ratio of mean squares is 1 with a deviation of
    # sqrt(2 / 90 + 2 / (90 3)) = 0.172. Replicates that share their points have no spread, in pairs too little.
    ratio = np.mean(errors**2) / np.mean(bars**2)
    assert 1.0 - 3 * 0.172 < ratio < 1.0 + 3 * 0.172
    # One point of an even disc has the variance 1/4 along each axis; red and green grow by 1/8 a radius.
    if points == 1:
        assert_allclose(np.sqrt(np.mean(bars**2)), 0.125 * 0.5 / 2.0, rtol=0.15)  # 270 degrees of freedom: 4 %


def quarters_on_the_lens():
    """Red to the upper right, green to the upper left, blue to the lower left, black to the lower right."""
    cards = [
        flat_scene.rectangle(0, 3, 0, 3, CLOSE, (1, 0, 0)),
        flat_scene.rectangle(-3, 0, 0, 3, CLOSE, (0, 1, 0)),
        flat_scene.rectangle(-3, 0, -3, 0, CLOSE, (0, 0, 1)),
        flat_scene.rectangle(0, 3, -3, 0, CLOSE, (0, 0, 0)),
    ]
    return flat_scene.scene_of(cards, flat_scene.camera(WIDTH, HEIGHT, 1e6), ThinLens(1.0, 2.0))


def test_every_quarter_of_the_lens_is_hit_as_often():
    # 45 pixels of 16 single points: 720 throws; a share of 1/4 then deviates by 0.016.
    shares = reference(quarters_on_the_lens(), samples=16).image.mean(axis=(0, 1))
    assert_allclose(shares, 0.25, atol=4 * 0.016)


def test_four_points_of_a_net_lie_in_the_four_quarters():
    # The concentric map takes each quarter of the square, which holds one point of four, to one of the disc.
    truth = reference(quarters_on_the_lens(), samples=64)
    assert_array_equal(truth.image, 0.25)
    assert_array_equal(truth.samples, 64)


def quarters_of_pixels():
    """Every pixel is cut into quarters of four colours, as in `quarters_on_the_lens`; depth 1, in focus."""
    colors = {(1, 1): (1, 0, 0), (0, 1): (0, 1, 0), (0, 0): (0, 0, 1), (1, 0): (0, 0, 0)}
    size = 0.5 / P
    cards = []
    for i in range(2 * WIDTH):
        for j in range(2 * HEIGHT):
            x, y = (i - WIDTH) * size, (j - HEIGHT) * size
            # Column i - WIDTH starts at a pixel's border where i is even, as the picture's does; rows from below too.
            cards.append(flat_scene.rectangle(x, x + size, y, y + size, 1.0, colors[i % 2, j % 2]))
    return cards


def test_every_quarter_of_a_pixel_is_hit_as_often():
    scene = flat_scene.scene_of(quarters_of_pixels(), shot(), ThinLens(0.0, 1.0))
    shares = reference(scene, samples=16, pixel_filter="box").image.mean(axis=(0, 1))
    assert_allclose(shares, 0.25, atol=4 * 0.016)  # as on the lens


@pytest.mark.parametrize(("lens_side", "pixel_side"), [("x", "x"), ("y", "y"), ("x", "y"), ("y", "x")])
def test_the_place_in_the_pixel_does_not_follow_the_lens_point(lens_side, pixel_side):
    # A black card hides one half of the lens; of what the other half sees, one half of each pixel is white: 1/4. Single
    # points: 720 throws with a deviation of sqrt(3) / 4 each. Points of 4 axes out of one sequence do better than that
    # with 16 each; lens and pixel axes that are the same would see 0 or 1/2 in every replicate, 1/16 in the mean of 16.
    size = 1.0 / P
    hidden = (0, 3, -3, 3) if lens_side == "x" else (-3, 3, 0, 3)
    cards = [flat_scene.rectangle(*hidden, CLOSE, (0, 0, 0))]
    for k in range(-WIDTH, WIDTH):
        low, high = k * size + 0.5 * size * (WIDTH % 2), (k + 0.5) * size + 0.5 * size * (WIDTH % 2)
        stripe = (low, high, -9, 9) if pixel_side == "x" else (-9, 9, low, high)
        cards.append(flat_scene.rectangle(*stripe, 1.0, (1, 1, 1)))
    scene = flat_scene.scene_of(cards, shot(), ThinLens(1.0, 1.0))
    single = reference(scene, samples=16, pixel_filter="box").image[..., 0]
    assert_allclose(single.mean(), 0.25, atol=4 * 0.433 / np.sqrt(720))
    many = reference(scene, samples=256, pixel_filter="box", camera=shot().with_size((3, 5))).image[..., 0]
    assert np.sqrt(np.mean((many - 0.25) ** 2)) < 0.433 / 16.0


def test_a_box_averages_what_a_slanted_edge_covers():
    # The half plane below y = 0.3 + x / 4 [px, from the middle of the picture]. Each pixel's covered share is exact: a
    # trapezoid, from the integral of the edge cut at the pixel's border.
    slope, offset = 0.25, 0.3
    x = np.array([-30.0, 30.0])
    y = offset + slope * x
    corners = np.array([[x[0], -30, -P], [x[1], -30, -P], [x[1], y[1], -P], [x[0], y[0], -P]])
    scene = flat_scene.scene_of(
        [Part(corners, [[0, 1, 2], [0, 2, 3]], flat_scene.paint((1, 1, 1)))], shot(), ThinLens(0.0, 1.0)
    )
    fine = (np.arange(64) + 0.5) / 64.0
    left = np.arange(WIDTH) - WIDTH / 2.0
    bottom = HEIGHT / 2.0 - 1.0 - np.arange(HEIGHT)
    edge = offset + slope * (left[:, None] + fine)
    covered = np.clip(edge[None] - bottom[:, None, None], 0.0, 1.0).mean(axis=-1)  # midpoints: exact but for two kinks
    truth = reference(scene, samples=128, pixel_filter="box")
    # Of 128 independent points the share would deviate by at most 1/2 / sqrt(128) = 0.044; a net's does by less.
    assert_allclose(truth.image[..., 0], covered, atol=3 * 0.044)
    assert np.sqrt(np.mean((truth.image[..., 0] - covered) ** 2)) < 0.044
    inner = (covered == 0.0) | (covered == 1.0)
    assert_array_equal(truth.image[..., 0][inner], covered[inner])


def colored_pixels(width, height):
    """A card for every pixel, each of another colour, at depth 1: the picture, and the cards."""
    picture = np.random.default_rng(5).integers(1, 256, (height, width, 3)) / 256.0  # exact in float32
    size = 1.0 / P
    cards = []
    for j, i in np.ndindex(height, width):
        left, top = (i - width / 2) * size, (height / 2 - j) * size
        cards.append(flat_scene.rectangle(left, left + size, top - size, top, 1.0, tuple(picture[j, i].tolist())))
    return picture, flat_scene.scene_of(cards, flat_scene.camera(width, height, P), ThinLens(1e-3, 1.0))


@pytest.mark.parametrize("size", [(7, 7), (17, 1), (1, 3), (3, 2)])
@pytest.mark.parametrize(("replicates", "samples"), [(16, 16), (20, 40)])
def test_what_is_in_focus_is_the_pixels_own(size, replicates, samples):
    # 49 and 17 pixels leave one over after packets of 16; 20 replicates leave 4.
    picture, scene = colored_pixels(*size)
    truth = reference(scene, samples=samples, replicates=replicates)
    assert_array_equal(truth.image, picture.astype(np.float32))
    assert_allclose(truth.standard_error, 0.0, atol=1e-15)  # roundings of barycentrics in float64


@pytest.mark.parametrize("samples", [1, 4, 64, 256])
def test_accumulation_of_what_is_in_focus_is_the_pixels_own(samples):
    # From 64 points on, neighbouring cells of the lens share a packet.
    picture, scene = colored_pixels(5, 3)
    assert_array_equal(render("accumulation", scene, samples=samples).image, picture.astype(np.float32))


def test_counts_are_rounded_up_to_powers_of_two():
    _, scene = colored_pixels(2, 1)
    for samples, spent in ((1, 16), (17, 32), (255, 256), (256, 256), (257, 512)):
        assert_array_equal(reference(scene, samples=samples).samples, spent)
    assert_array_equal(reference(scene, samples=41, replicates=20).samples, 80)


def test_a_tolerance_doubles_the_net_until_it_is_kept():
    # A net goes on where it left off: a repeated one would keep its error for ever.
    corners = np.array([[-3.0, -3.0], [3.0, -3.0], [3.0, 3.0], [-3.0, 3.0]])
    color = np.repeat(0.5 + corners[:, :1] / 8.0, 3, axis=1)
    part = Part(
        np.concatenate([corners, np.full((4, 1), -CLOSE)], axis=1), [[0, 1, 2], [0, 2, 3]], flat_scene.paint((1, 1, 1)),
        color=color,
    )  # fmt: skip
    scene = flat_scene.scene_of([part], flat_scene.camera(3, 2, 1e6), ThinLens(1.0, 2.0))
    few = reference(scene, samples=16 * 8)
    truth = reference(scene, tolerance=float(few.standard_error.min()) / 8.0)
    assert (truth.samples > 16 * 8).all()
    # Nets take 4 times the points for an eighth of the error, here 16 times; independent points would take 64.
    assert (truth.samples <= 16 * 256).all()
    # The bound holds for every bar by construction; the picture keeps it as a bar of 16 replicates does: 4 deviations.
    assert np.abs(truth.image - 0.5).max() < 4.0 * float(few.standard_error.min()) / 8.0


def test_the_background_is_seen_past_the_edge():
    # A card hides the left half of the lens from all pixels; of four points of a net, two lie there.
    scene = flat_scene.scene_of(
        [flat_scene.rectangle(-3, 0, -3, 3, CLOSE, (1, 0, 0))],
        flat_scene.camera(4, 3, 1e6),
        ThinLens(1.0, 2.0),
        (0.0, 1.0, 0.5),
    )
    truth = reference(scene, samples=64)
    assert_array_equal(truth.image, np.broadcast_to(np.float32([0.5, 0.5, 0.25]), (3, 4, 3)))


def test_a_tolerance_starts_with_eight_points_a_replicate():
    # Fewer could agree by chance; here all are wanted to.
    _, scene = colored_pixels(2, 1)
    assert_array_equal(reference(scene, tolerance=100.0).samples, 16 * 8)


def test_accumulation_takes_one_net_through_pixel_centres():
    # Four points of one net lie in the four quarters of the lens, two and two of two nets need not.
    assert_array_equal(render("accumulation", quarters_on_the_lens(), samples=4).image, 0.25)
    # A card that ends a quarter of a pixel beyond the centre of column 4 covers that pixel, and nothing of the next.
    card = flat_scene.rectangle(-9, 0.25 / P, -9, 9, 1.0)
    scene = flat_scene.scene_of([card], shot(), ThinLens(1e-3, 1.0))
    red = render("accumulation", scene, samples=4).image[..., 0]
    assert_array_equal(red, np.broadcast_to([1.0] * 5 + [0.0] * 4, red.shape))


def test_accumulation_shares_one_pattern_if_asked_and_never_the_references_points():
    right, _ = flat_scene.tangents(WIDTH, HEIGHT, P)

    def errors(**words):
        return render("accumulation", ramp_on_the_lens(), samples=4, **words).image[..., 0] - 0.5 - CLOSE * right / 8.0

    assert np.ptp(errors(shared_pattern=True)) < 3e-7  # float32 roundings
    assert np.ptp(errors()) > 1e-3
    assert np.abs(errors() - errors(seed=0)).max() > 1e-3

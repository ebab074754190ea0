"""Mipmap interpolation: the equations pixel by pixel, hand numbers, leaks, foreground edges and measured blur."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from refdof import InputError, ThinLens, View
from refdof.methods import mipmap
from refdof.methods.mipmap import Params, anisotropic, blur, texture_reads
from refdof.methods.mipmap.anisotropic import downsample, foreground_blur
from refdof.raster.filters.mip_chain import gaussian_mipmaps
from refdof.raster.gpu.gpu_model import LLVMPIPE, store
from refdof.stages import StageRecorder
from tests import flat_scene
from tests.methods.mipmap import naive

pytestmark = pytest.mark.fast

SIZES = [(1, 1), (1, 7), (13, 1), (8, 8), (7, 11)]
CHOICES = [{}, {"delta": math.inf}, {"foreground_points": 9}, {"foreground_points": 0}, {"blend": "geometric"}]


def images(seed, height, width, largest=9.0):
    """Colour, depth and circles of both signs: whole patches of one circle and noise beside each other."""
    random = np.random.default_rng(seed)
    coc = random.uniform(-1.0, 1.0, (height, width)) ** 3 * largest
    coc[: height // 2] = np.round(coc[: height // 2] / 3.0) * 3.0
    depth = 1.0 / (0.5 - 0.4 * coc / largest)
    return random.random((height, width, 3)), depth, coc


def stages_of(color, coc, params):
    trace = StageRecorder(on=True)
    return mipmap.method._blur(color, coc, params, trace), trace.stages


def flat(coc, height=48, width=48):
    return np.full((height, width), 2.0), np.full((height, width), float(coc))


@pytest.mark.parametrize("choice", CHOICES)
@pytest.mark.parametrize("size", SIZES)
def test_picture_and_stages_are_the_papers_equations(size, choice):
    color, _, coc = images(1, *size)
    words = dict(choice)
    geometric = words.pop("blend", "linear") == "geometric"
    image, stages = stages_of(color, coc, Params(**choice))
    expected, twin = naive.mipmap(color, coc, geometric=geometric, **words)
    # Numbers up to 1 in colours and 9 px in circles, a hundred roundings in float64.
    np.testing.assert_allclose(image, expected, rtol=0, atol=1e-13)
    for name in ("neighbours", "smoothed", "level"):
        np.testing.assert_allclose(stages[name], twin[name], rtol=0, atol=1e-12)
    for k, level in enumerate(twin["colors"], start=1):
        np.testing.assert_allclose(stages[f"color {k}"], level, rtol=0, atol=1e-13)


@pytest.mark.parametrize("choice", CHOICES)
@pytest.mark.parametrize("size", SIZES)
def test_texture_reads_are_the_reads_that_were_counted(size, choice):
    color, _, coc = images(1, *size)
    words = dict(choice)
    geometric = words.pop("blend", "linear") == "geometric"
    reads = naive.mipmap(color, coc, geometric=geometric, **words)[1]["reads"]
    units = texture_reads(Params(**choice), size[1], size[0], largest=np.abs(coc).max())
    assert units * size[0] * size[1] == pytest.approx(reads, rel=1e-12)


def test_single_precision_is_the_same_picture():
    color, depth, _ = images(2, 24, 31)
    coc = np.random.default_rng(2).uniform(-9.0, 9.0, (24, 31))  # no ties: the comparisons of (9) and (10) fall alike
    exact = blur(color, depth, coc)
    image = blur(color.astype(np.float32), depth, coc)
    assert image.dtype == np.float32
    # Places up to 31 texels are rounded to 2^-19 of one, and neighbours differ by up to 1: 4e-6 with nine reads.
    np.testing.assert_allclose(image, exact, rtol=0, atol=1e-5)


def test_isotropic_levels_are_gaussian_mipmaps():
    color, _, coc = images(3, 16, 21)
    stages = stages_of(color, coc, Params(delta=math.inf))[1]
    levels = gaussian_mipmaps(color)
    for k in (1, 2, 3):
        np.testing.assert_allclose(stages[f"color {k}"], levels[k], rtol=0, atol=1e-14)


@pytest.mark.parametrize(
    ("sigma", "level"),
    [
        (0.0, 0.0),
        (0.75, 0.0),  # k sigma = 0.5: equation (6) is continuous
        (1.5, 1.0),  # sigma = 3/2 2^(m - 1), equation (5)
        (3.0, 2.0),
        (12.0, 4.0),
        # Section 8: E = 4 mm across, F = 17 mm, focus 3 m, object 0.3 m: C = 0.32 * 125 * 4 * 17 / 2983 * 9 = 8.206 px.
        (8.206 / 2, 1 + math.log2(8.206 / 3)),
    ],
)
@pytest.mark.parametrize("sign", [-1, 1])
def test_levels_by_hand(sigma, level, sign):
    color = np.zeros((16, 16, 3))
    stages = stages_of(color, np.full((16, 16), sign * sigma), Params())[1]
    np.testing.assert_allclose(stages["level"], level, rtol=0, atol=1e-12)
    assert np.array_equal(stages["degree"], np.full((16, 16), sigma))


def test_one_pixel_of_blur_by_hand():
    # sigma = 1.5, m = 1: level 0, points one pixel away, (1, e^-1/2, e^-1) with diagonals at sqrt(1/2).
    color = np.zeros((5, 5, 3))
    color[2, 2] = 1.0
    image = blur(color, *flat(1.5, 5, 5))
    total = 1 + 4 * math.exp(-0.5) + 4 * math.exp(-1)
    inward = math.sqrt(0.5)
    assert image[2, 2, 0] == pytest.approx((1 + 4 * math.exp(-1) * (1 - inward) ** 2) / total, rel=1e-14)
    beside = math.exp(-0.5) + 2 * math.exp(-1) * inward * (1 - inward)
    assert image[2, 1, 0] == pytest.approx(beside / total, rel=1e-14)
    assert image[1, 1, 0] == pytest.approx(math.exp(-1) * inward**2 / total, rel=1e-14)


def circles_of(row, height=2):
    """Circles (H, W, 2) of equal rows: signed radius and size."""
    signed = np.tile(np.array(row, float), (height, 1))
    return np.stack([signed, np.abs(signed)], axis=-1)


def coarse_red(circles, delta):
    """The next level's red, where column x of the finer one has red 4^x; with its columns as rows, too."""
    height, width = circles.shape[:2]
    color = np.zeros((height, width, 4))
    color[..., 0] = 4.0 ** np.arange(width)
    out = []
    for turn in (lambda image: image, lambda image: np.ascontiguousarray(image.swapaxes(0, 1))):
        fine, sizes = turn(color), turn(circles)
        half = fine.shape[0] // 2, fine.shape[1] // 2
        red, coarse = np.empty((*half, 4)), np.empty((*half, 2))
        downsample(fine, sizes, delta, red, coarse)
        out.append(turn(red)[0, :, 0])
    np.testing.assert_allclose(out[0], out[1], rtol=1e-14)
    return out[0]


def weighted(left, centre, right, keep):
    """Mean of three taps, Gaussian at distance 1, 0, 1, of those to keep."""
    weights = np.array([math.exp(-0.5), 1.0, math.exp(-0.5)]) * keep
    return weights @ [left, centre, right] / weights.sum()


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_rows_may_be_shared_among_threads(monkeypatch, dtype):
    # Large levels take parallel loops, small ones do not: the same bits.
    random = np.random.default_rng(11)
    color, coc = random.random((37, 42, 4)).astype(dtype), random.uniform(-6.0, 6.0, (37, 42)).astype(dtype)
    circles = np.stack([coc, np.abs(coc)], axis=-1)
    found = []
    for small in (anisotropic._SMALL, 0):
        monkeypatch.setattr(anisotropic, "_SMALL", small)
        coarse, sizes = np.empty((18, 21, 4), dtype), np.empty((18, 21, 2), dtype)
        downsample(color, circles, 1.0, coarse, sizes)
        found.append((coarse, sizes, foreground_blur(circles, 18, 21)))
    for small, large in zip(*found, strict=True):
        np.testing.assert_array_equal(small, large)


def test_a_tap_may_be_sharper_by_delta_and_no_more():
    # Four columns: the coarse texels' taps are read at columns 0, 1/2, 3/2 and at 3/2, 5/2, 3: reds (1, 2.5, 10) and
    # (10, 40, 64). Blur 1, 1, 0, 0 makes 1, 1, 1/2 and 1/2, 0, 0; turned round 0, 0, 1/2 and 1/2, 1, 1.
    one, two = (1.0, 2.5, 10.0), (10.0, 40.0, 64.0)
    for delta, kept in ((0.5, True), (0.4375, False), (0.0, False), (math.inf, True)):
        red = coarse_red(circles_of([1, 1, 0, 0]), delta)
        np.testing.assert_allclose(red, [weighted(*one, [1, 1, kept]), weighted(*two, [1, 1, 1])], rtol=1e-14)
        red = coarse_red(circles_of([0, 0, 1, 1]), delta)
        np.testing.assert_allclose(red, [weighted(*one, [1, 1, 1]), weighted(*two, [kept, 1, 1])], rtol=1e-14)


def test_only_a_blurred_background_leaves_taps_out():
    # Taps 0: -1, 0 and 1/2 at centre, sizes 1, 1, 1/2. In focus on the whole, and in front of it: all taps count.
    one = (1.0, 2.5, 10.0)
    for row in ([-1, 1, 0, 0], [-1, -1, 0, 0], [-1.5, 1, 0, 0]):
        assert coarse_red(circles_of(row), 0.25)[0] == pytest.approx(weighted(*one, [1, 1, 1]), rel=1e-14)
    # A little behind: sizes 1, 9/8, 5/8; the right tap is 1/2 sharper.
    assert coarse_red(circles_of([-1, 1.25, 0, 0]), 0.25)[0] == pytest.approx(weighted(*one, [1, 1, 0]), rel=1e-14)


@pytest.mark.parametrize(
    ("row", "blur_of_nearer"),
    [
        ([-1, -1, -1, -4], [0, 4]),  # taps -1, -1, -1 and -1, -5/2, -4
        ([-4, -1, -1, -1], [4, 0]),
        ([-3, -3, -3, -3], [0, 0]),  # as near as the centre is not nearer
        ([-4, -4, -1, -1], [0, 2.5]),  # taps -4, -4, -5/2 and -5/2, -1, -1
        ([2, 2, 2, -1], [0, 1]),  # the centre 1/2 behind
        ([3, 3, 3, 1], [0, 0]),  # nearer, but behind the focal plane
    ],
)
def test_the_blur_of_nearer_neighbours_by_hand(row, blur_of_nearer):
    # Taps as in the test above, at columns 0, 1/2, 3/2 and 3/2, 5/2, 3.
    circles = circles_of(row)
    np.testing.assert_array_equal(foreground_blur(circles, 1, 2), [blur_of_nearer])
    upright = np.ascontiguousarray(circles.swapaxes(0, 1))
    np.testing.assert_array_equal(foreground_blur(upright, 2, 1)[:, 0], blur_of_nearer)


def test_only_what_is_in_front_blurs_its_neighbours():
    # Left half blurred by 6 px: m = 1 + log2 4 = 3, texels of 8 px. Right half sharp.
    half = np.where(np.arange(32) < 16, 6.0, 0.0)[None].repeat(32, axis=0)
    color = np.zeros((32, 32, 3))
    near, far = (stages_of(color, sign * half, Params())[1] for sign in (-1, 1))
    assert (near["smoothed"][:, 16:22] > 0).all()
    assert not near["smoothed"][:, 24:].any()  # a texel away
    np.testing.assert_allclose(near["smoothed"][:, :4], 6.0, rtol=1e-12)
    assert not far["neighbours"].any()
    assert np.array_equal(far["smoothed"], half)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("choice", CHOICES)
def test_constant_colour_stays(choice, dtype):
    _, depth, coc = images(4, 13, 17)
    color = np.broadcast_to(np.array([0.1, 0.7, 30.0], dtype=dtype), (13, 17, 3))
    image = blur(color, depth, coc, Params(**choice))
    # At most four levels and a circle: nine shares each, whose sum is 1 but for roundings, and powers.
    np.testing.assert_allclose(image, color, rtol=100 * np.finfo(dtype).eps)


@pytest.mark.parametrize("choice", CHOICES)
def test_no_blur_changes_no_bit(choice):
    color, depth, coc = images(5, 9, 10)
    assert np.array_equal(blur(color, depth, 0.0 * coc, Params(**choice)), color)
    assert np.array_equal(blur(color, depth, np.clip(coc, -0.75, 0.75), Params(**choice)), color)  # equation (6)


@settings(max_examples=15, deadline=None)
@given(st.integers(1, 9), st.integers(1, 9), st.sampled_from(CHOICES), st.integers(0, 10**6))
def test_every_pixel_is_a_mean_of_the_picture(height, width, choice, seed):
    color, depth, coc = images(seed, height, width)
    image = blur(color, depth, coc, Params(**choice))
    assert (image >= color.min(axis=(0, 1)) - 1e-14).all()
    assert (image <= color.max(axis=(0, 1)) + 1e-14).all()


@pytest.mark.parametrize("choice", CHOICES)
def test_mirrored_picture_gives_the_mirrored_result(choice):
    color, depth, coc = images(6, 12, 17)
    image = blur(color, depth, coc, Params(**choice))
    mirrored = blur(color[:, ::-1], depth[:, ::-1], coc[:, ::-1], Params(**choice))
    np.testing.assert_allclose(mirrored[:, ::-1], image, rtol=0, atol=1e-13)


def test_blends_differ_where_levels_do():
    color, depth, coc = images(7, 16, 16)
    linear, geometric = blur(color, depth, coc), blur(color, depth, coc, Params(blend="geometric"))
    assert np.abs(linear - geometric).max() > 1e-4
    assert (geometric <= linear + 1e-14).all()  # of weighted means, the geometric one is the lower


def test_geometric_blend_of_black_is_black():
    color, depth, coc = images(7, 16, 16)
    color[..., 1] = 0.0
    image = blur(color, depth, coc, Params(blend="geometric"))
    assert np.isfinite(image).all()
    assert not image[..., 1].any()


def test_short_circles_are_rounded_at_every_level():
    color, depth, coc = (a.astype(np.float32) for a in images(8, 12, 15))

    def short(circles):
        return store(circles.astype(np.float32), "f16", LLVMPIPE).astype(float)

    image = blur(color, depth, coc, Params(depth_format="f16"))
    expected = naive.mipmap(color, coc, store=short)[0]
    # A float32 on the other side of a step of 2^-11 changes blur by that share: 5e-4 of 9 px and neighbours' contrast.
    np.testing.assert_allclose(image, expected, rtol=0, atol=2e-3)
    assert np.quantile(np.abs(image - expected), 0.9) < 1e-5
    full = blur(color, depth, coc)
    assert 1e-6 < np.abs(image - full).max() < 0.02  # it makes a difference, a small one


@pytest.mark.parametrize("largest", [1e-30, 3e38, 1e5])
def test_extreme_circles_stay_finite(largest):
    color, depth, _ = (a.astype(np.float32) for a in images(9, 6, 7))
    coc = np.where(np.indices((6, 7)).sum(axis=0) % 2, np.float32(largest), np.float32(-largest))
    for depth_format in ("f32", "f16"):
        assert np.isfinite(blur(color, depth, coc, Params(depth_format=depth_format))).all()


def test_rendering_records_its_stages():
    shot, lens = flat_scene.camera(24, 18, 24.0), ThinLens(0.5, 4.0)
    view = View(
        flat_scene.scene_of([flat_scene.rectangle(-0.5, 0.5, -0.5, 0.5, 2.0, (0.8, 0.4, 0.2))], shot, lens), shot, lens
    )
    trace = StageRecorder(on=True)
    image = mipmap.render(view, Params(), trace)
    np.testing.assert_allclose(trace.stages["degree"], 3.0, rtol=0, atol=1e-6)  # -3 px on the card, 3 px behind it
    names = ["coc", "degree", "neighbours", "smoothed", "level", "color 1", "color 2"]
    assert list(trace.stages) == names  # 1 + log2(2 / 3 * 3) = 2
    assert np.array_equal(image, blur(view.pinhole().color, view.pinhole().depth, trace.stages["coc"]))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"color": np.zeros((2, 3))}, "color: got shape"),
        ({"color": np.zeros((0, 3, 3)), "depth": np.zeros((0, 3)), "coc": np.zeros((0, 3))}, "color: got shape"),
        ({"color": np.full((2, 3, 3), np.nan)}, "color: has 18 NaN"),
        ({"depth": np.zeros((2, 3))}, "depth: smallest value is 0"),
        ({"depth": np.ones((3, 2))}, "depth: got shape"),
        ({"coc": np.full((2, 3), np.inf)}, "coc: has 6 infinite"),
        (
            {"color": np.full((2, 3, 3), -1.0), "params": Params(blend="geometric")},
            "color: smallest value is -1; allowed",
        ),
    ],
)
def test_bad_images_are_named(change, words):
    good = {"color": np.zeros((2, 3, 3)), "depth": np.ones((2, 3)), "coc": np.zeros((2, 3))}
    with pytest.raises(InputError, match=words):
        blur(**{**good, **change})


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ({"delta": -1}, "delta: got -1; allowed is a number >= 0"),
        ({"foreground_points": 4}, "foreground_points: got 4; allowed are 0, 5, 9"),
        ({"blend": "cubic"}, "blend: got 'cubic'; allowed are linear, geometric"),
        ({"depth_format": "f64"}, "depth_format: got 'f64'; .*allowed are f32, f16"),
    ],
)
def test_bad_parameters_are_named(value, words):
    with pytest.raises(InputError, match=words):
        Params(**value)

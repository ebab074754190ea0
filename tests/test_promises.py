"""Every promise of every method, in one scene with everything at once: `full_scene`. Small scenes hide faults."""

import math

import full_scene as full
import numpy as np
import pytest
from scipy import ndimage

from refdof import METHODS, ThinLens, render
from refdof.method_record import PROMISES, REACH

SAMPLING = ("triangles",)  # the inputs of methods that send rays
NOISE = 64**-0.75  # of the smallest default count of lens samples, at an edge of contrast 1 (one standard deviation)


def promising(promise):
    assert promise in PROMISES
    return [name for name, module in METHODS.items() if promise in module.METHOD.promises]


@pytest.mark.parametrize("name", promising("constant"))
def test_constant(name):
    color = (0.3, 0.6, 9.0)
    image = render(name, full.scene(color)).image
    # Sums of up to 400 equal float32 terms: 400 roundings of half an ulp, which mostly cancel; 1e-5 bounds the worst.
    np.testing.assert_allclose(image, np.broadcast_to(color, image.shape), rtol=1e-5)


@pytest.mark.parametrize("name", promising("pinhole"))
def test_pinhole(name):
    image = render(name, full.scene(lens=ThinLens(0.0, full.FOCUS))).image
    np.testing.assert_allclose(image, full.pinhole()[0], rtol=1e-5)  # as above


@pytest.mark.parametrize("name", promising("focus"))
def test_focus(name):
    picture, depth = full.pinhole()
    largest = full.SCALE * full.RADIUS * (1 / full.NEAR - 1 / full.FOCUS)
    undisturbed = ndimage.distance_transform_edt(depth == full.FOCUS) > REACH * largest
    assert undisturbed[0].any()
    assert undisturbed[-1].any()
    assert undisturbed.sum() > 4000
    image = render(name, full.scene()).image
    np.testing.assert_allclose(image[undisturbed], picture[undisturbed], rtol=1e-5)  # as above
    assert np.abs(image - picture)[depth != full.FOCUS].max() > 1.0  # the lamp, at least, is blurred


@pytest.mark.parametrize("name", promising("convexity"))
def test_convexity(name):
    image = render(name, full.scene()).image
    assert image.min() >= 0.1 * (1 - 1e-5)  # roundings, as above
    assert image.max(axis=(0, 1)) == pytest.approx(image.max(axis=(0, 1)).clip(max=(8, 0.9, 0.9)), rel=1e-5)


@pytest.mark.parametrize("name", promising("energy"))
def test_energy(name):
    x0, y0, x1, y1 = full.LAMP
    power = (x1 - x0) * (y1 - y0) * (full.LAMP_RED - full.LAMP_OFF[0])
    for focus in (full.BEHIND, full.FOCUS):
        lens = ThinLens(full.RADIUS, focus)
        on, off = (render(name, full.scene(lamp_red=red, lens=lens)).image for red in (8.0, full.LAMP_OFF[0]))
        # The 6 x 6 px lamp spread by 2 px has less than 100 pixels on its rim.
        room = 4 * NOISE * 7.9 * math.sqrt(100) if focus != full.BEHIND else 1e-5 * power
        assert (on - off)[..., 0].sum(dtype=float) == pytest.approx(power, abs=room)
        assert np.abs((on - off)[..., 1:]).max() == 0.0


@pytest.mark.parametrize("size", [(160, 120), (51, 37)])  # no edge meets a pixel centre
@pytest.mark.parametrize("name", promising("symmetry"))
def test_symmetry(name, size):
    camera = full.CAMERA.with_size(size)
    image = render(name, full.scene(), camera).image
    mirrored = render(name, full.scene(mirrored=True), camera).image[:, ::-1]
    if METHODS[name].METHOD.inputs == SAMPLING:
        difference = (image - mirrored)[..., 1:]  # contrasts below 0.8
        assert np.abs(difference).max() < 5 * 0.8 * NOISE * math.sqrt(2)
        assert abs(difference.mean()) < 0.001
    else:
        np.testing.assert_allclose(mirrored, image, rtol=0, atol=8e-5)  # 1e-5 of the brightest, as above


def seen_past_the_bar(name):
    """The column of the hidden stripe (H, 3), and what it should be."""
    # Seen from the stripe, half-way before it, the bar hides a band through the lens, 0.375 radii to each side.
    half = (full.BAR[2] - full.BAR[0]) / 2 * full.NEAR / full.SCALE * 2 / full.RADIUS
    hidden = 2 / math.pi * (half * math.sqrt(1 - half**2) + math.asin(half))
    expected = hidden * np.array(full.BAR_COLOR) + (1 - hidden) * np.array(full.STRIPE_COLOR)
    return render(name, full.scene()).image[:, full.STRIPE[0]], expected


@pytest.mark.parametrize("name", promising("occlusion"))
def test_occlusion(name):
    column, expected = seen_past_the_bar(name)
    assert np.abs(column.mean(axis=0) - expected).max() < 0.1
    assert np.abs(column - expected).max() < 0.1 + 4 * 0.8 * NOISE


@pytest.mark.parametrize("name", [name for name, module in METHODS.items() if "pinhole depth" in module.METHOD.inputs])
def test_one_picture_does_not_show_what_it_hides(name):
    column, expected = seen_past_the_bar(name)
    assert np.abs(column.mean(axis=0) - expected).max() > 0.3

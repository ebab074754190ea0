"""The emulation of ports gives what the method gives, with every parameter that both have."""

import math
from dataclasses import asdict

import numpy as np
import pytest

from refdof.methods.singlepass import Params, blur
from refdof.oracle.diagnosis.emulate import emulator, spiral_of
from refdof.oracle.diagnosis.model import Model, model_of
from refdof.oracle.diagnosis.samples import Shot, choose, samples_of

pytestmark = pytest.mark.fast

PARAMS = [
    Params(),
    Params(row_order="up"),
    Params(rad_scale=0.8, max_blur_size=12.0, behind_factor=1.0),
    Params(angle_start=1.0, angle_step=2.3, radius_start=1.5, loop_bound=9.0),
    Params(max_taps=50, order="size"),
    Params(order="always", scale_x=0.7, scale_y=1.3),
    Params(color_filter="nearest", border="mirror"),
    Params(border="repeat", shift_x=1.0, shift_y=-2.0),
    Params(shift_x=0.3, shift_y=-0.2, color_filter="bilinear"),
    Params(depth_filter="bilinear"),
    Params(depth_filter="bilinear_depth"),
]


def picture(width=23, height=17):
    random = np.random.default_rng(5)
    color = random.random((height, width, 3))
    depth = random.uniform(1.0, 9.0, (height, width))
    return color, depth, 44.0 * (1.0 / 2.0 - 1.0 / depth)


def shot_of(got, right):
    color, depth, coc = picture()
    zero = np.zeros(depth.shape)
    return Shot("", color, depth, coc, 44.0, 2.0, depth.min(), depth.max(), got, got, 1e-5, zero, right)


def emulated(model):
    """A model at all pixels of the picture."""
    height, width = picture()[1].shape
    y, x = (part.ravel() for part in np.indices((height, width)))
    got = emulator(samples_of(shot_of(np.zeros((height, width, 3)), model), x, y))(model)
    return got.reshape(height, width, 3)


@pytest.mark.parametrize("params", PARAMS, ids=lambda params: "")
def test_a_model_of_a_case_is_the_method(params):
    expected = blur(*picture(), params)
    got = emulated(model_of(asdict(params), "down"))
    assert np.abs(got - expected).max() < 2e-6


def test_no_taps_leave_the_picture_and_a_center_that_does_not_count_none_of_it():
    color, *_ = picture()
    assert emulated(Model(max_taps=0)) == pytest.approx(color)
    # With one tap that counts fully, the mean of both is half of each: without the center, half of the tap.
    one = Model(max_taps=1, size_floor=20.0, behind_factor=math.inf)
    taps = 2.0 * emulated(one) - color
    assert emulated(Model(max_taps=1, size_floor=20.0, behind_factor=math.inf, center_share=0.0)) == pytest.approx(
        taps / 2.0, abs=1e-6
    )


def test_mean_rules_by_hand():
    """Two taps, one of weight 0: (c + c) / 2 after the first as a mean, c / 2 where a miss adds nothing."""
    color, *_ = picture()
    sharp = {"max_taps": 1, "coc_scale": 0.0}
    assert emulated(Model(**sharp)) == pytest.approx(color)
    assert emulated(Model(**sharp, mean_rule="nothing")) == pytest.approx(color / 2.0)
    assert emulated(Model(**sharp, mean_rule="weighted")) == pytest.approx(color)
    assert emulated(Model(**sharp, initial_total=3.0)) == pytest.approx((color + color / 3.0) / 4.0)


def test_what_is_done_to_pictures():
    color, *_ = picture()
    none = {"max_taps": 0}
    assert emulated(Model(**none, flip="y")) == pytest.approx(color[::-1])
    assert emulated(Model(**none, image_shift=(1, 0)))[:, 1:] == pytest.approx(color[:, :-1])
    assert emulated(Model(**none, after=(("BGR", 0.0), ("gain", 2.0)))) == pytest.approx(2.0 * color[..., ::-1])
    assert emulated(Model(**none, after=(("gamma", 0.5),))) == pytest.approx(np.sqrt(color))
    assert emulated(Model(**none, before=(("clamp", 0.5),))) == pytest.approx(np.minimum(color, 0.5))


def test_spirals():
    assert len(spiral_of(Model())) == 398
    assert spiral_of(Model(axes="sc"))[:, :2] == pytest.approx(spiral_of(Model())[:, 1::-1])
    assert len(spiral_of(Model(tap_fault=(0, 2)))) == 399
    assert len(spiral_of(Model(growth="constant"))) == 39  # 0.5, 1.0 .. 19.5


def test_the_worst_pixels_are_among_those_chosen():
    off = np.zeros((40, 50))
    off[7, 11], off[20, 3] = 9.0, np.nan
    x, y = choose(off, 30)
    assert {(11, 7), (3, 20)} <= set(zip(x.tolist(), y.tolist(), strict=True))
    assert len(x) <= 30

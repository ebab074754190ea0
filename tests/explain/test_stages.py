"""Explanations of stages: formulas, means after some taps, pictures on the way, and plain values."""

import numpy as np
import pytest

from refdof import METHODS, InputError
from refdof.explain import explain_pictures
from refdof.explain.pictures import given_pictures
from refdof.methods import singlepass
from refdof.oracle.inputs import cards
from refdof.stages import Stages

PICTURE = cards(16, 12)


def explained(method, stage, pixel=(7, 5)):
    return explain_pictures(method, given_pictures(*PICTURE), METHODS[method].Params(), pixel, stage)


@pytest.mark.fast
def test_circles_are_explained_by_the_thin_lens():
    found = explained("poisson", "coc")
    made = PICTURE.coc_scale * (1 / PICTURE.focus - 1 / float(PICTURE.depth[5, 7]))
    assert found.value == pytest.approx([made], rel=1e-6)
    assert f"{made:.9g} px" in found.notes[1]


def test_means_are_the_taps_so_far():
    params = singlepass.Params()
    _, stages = singlepass.blur(*PICTURE[:3], params, stages=Stages((0, 3)))
    for count in (0, 3):
        found = explained("singlepass", f"mean_{count}")
        assert len(found.rows) == count + 1
        assert (found.value == stages[f"mean {count}"][5, 7]).all()
        assert found.agrees


@pytest.mark.parametrize("stage", ["size", "limit", "weight_3", "reach 3"])
def test_maps_of_the_single_pass_have_their_numbers(stage):
    _, stages = singlepass.blur(*PICTURE[:3], stages=Stages((3,)))
    found = explained("singlepass", stage)
    assert found.value == pytest.approx([stages[stage.replace("_", " ")][5, 7]])
    assert found.notes


@pytest.mark.parametrize(("method", "stage"), [("separable", "across"), ("pyramidal", "sub-image 0")])
def test_pictures_on_the_way_are_sums(method, stage):
    found = explained(method, stage)
    assert found.is_sum
    assert found.agrees
    weight, color = found.column("weight"), np.stack([found.column(c) for c in ("red", "green", "blue")])
    np.testing.assert_allclose((weight * color).sum(axis=1), found.value, rtol=0, atol=1e-5)


def test_other_stages_have_a_value():
    found = explained("poisson", "code")
    assert not found.is_sum
    assert found.value.shape == (1,)


@pytest.mark.parametrize(
    ("method", "stage", "says"),
    [
        ("singlepass", "coq", r"^stage: got 'coq'; allowed for singlepass are image, coc, size"),
        ("singlepass", "mean 500", "^stage: the step is beyond the loop"),
        ("singlepass", "taps", r"^stage: got 'taps'"),
        ("poisson", "small", r"^stage: got 'small'"),
    ],
)
def test_unknown_stages_are_refused(method, stage, says):
    with pytest.raises(InputError, match=says):
        explained(method, stage)


@pytest.mark.parametrize("pixel", [(16, 0), (0, 12), (-1, 0)])
def test_pixels_outside_are_refused(pixel):
    with pytest.raises(InputError, match=r"^pixel: got"):
        explained("separable", "image", pixel)

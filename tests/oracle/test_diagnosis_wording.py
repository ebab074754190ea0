"""Sentences of mistakes: no two numbers that are beside each other read the same, and none is a right port's."""

import math
import re
from dataclasses import asdict, replace

import numpy as np
import pytest

from refdof.methods.singlepass import Params
from refdof.oracle.diagnosis.causes import CAUSES, Cause, cause_of
from refdof.oracle.diagnosis.diagnose import _causes
from refdof.oracle.diagnosis.image_switches import image_switches
from refdof.oracle.diagnosis.model import model_of
from refdof.oracle.diagnosis.samples import Shot
from refdof.oracle.diagnosis.search import Found, Step
from refdof.oracle.diagnosis.switches import size_switches
from refdof.oracle.diagnosis.tap_switches import tap_switches
from refdof.oracle.diagnosis.wording import sentence_of, tell_something

pytestmark = pytest.mark.fast

PARAMS = [
    Params(),
    Params(rad_scale=0.8, max_blur_size=6.0, behind_factor=1.0, border="mirror", color_filter="nearest"),
    Params(angle_start=1.0, radius_start=1.5, loop_bound=9.0, order="always", depth_filter="bilinear"),
]
NEAR = (1e-9, -1e-9, 1e-5, -1e-5, 0.004, -0.004)  # of a right port's value, as a fit may end
NUMBER = r"([-+]?\d[\d.]*(?:e[-+]\d+)?)"
BESIDE = (  # said beside each other
    rf"{NUMBER}(?: px| taps| times the pixel's own size)? instead of {NUMBER}",
    rf"{NUMBER} px of {NUMBER}",
    rf"after {NUMBER} taps of {NUMBER}",
    r"is read (.+) instead of (.+)",
    r"holds for (.+) instead of (.+)",
)
ONE, ZERO = r"1(?:\.0*)?(?![\d.]|e-)", r"[-+]?0(?:\.0*)?(?![\d.]|e-)"
USUAL = (  # a right port's, in sentences that do not say them
    rf"(?:are|is) {ONE} times as large", rf"smaller than {ZERO}", rf"moved by {ZERO}", rf"multiplied by {ONE}",
    rf"power of {ONE}", rf"^{ZERO} is added", rf"shifted by {ZERO} px in x and {ZERO} px in y",
    rf"spans {ONE} px in x and {ONE} px in y",
)  # fmt: skip


def shots():
    random = np.random.default_rng(5)
    color, depth = random.random((17, 23, 3)), random.uniform(1.0, 9.0, (17, 23))
    for params in PARAMS:
        right = model_of(asdict(params), "down")
        coc, off = 44.0 * (1.0 / 2.0 - 1.0 / depth), random.random(depth.shape)
        yield Shot("", color, depth, coc, 44.0, 2.0, 1.0, 9.0, color, color, 1e-5, off, right)


SHOTS = list(shots())
SWITCHES = [*size_switches(), *tap_switches(SHOTS[0].right), *image_switches()]


def values_of(switch):
    """What is tried, and what a fit may find beside a right port's value."""
    yield from switch.values
    if not switch.fits or switch.whole:
        return
    for shot in SHOTS:
        words = switch.words(shot, switch.values[0])
        if isinstance(switch.values[0], tuple):
            yield from ((step, 0.0) for step in NEAR)
            yield from ((0.0, step) for step in NEAR)
        else:
            right = {"focus": 1.0}.get(
                switch.key, words.get("expected", dict(cause_of(switch.key).right).get("value", 1.0))
            )
            yield from (right + step for step in (0.0, *NEAR))


def alike(sentence):
    """What is said in it twice, as if it were two things."""
    pairs = [found for pattern in BESIDE for found in re.findall(pattern, sentence)]
    return [pair for pair in pairs if pair[0] == pair[1]]


def usual(sentence):
    """Whether its numbers are a right port's."""
    return any(re.search(pattern, sentence) for pattern in USUAL)


@pytest.mark.parametrize("cause", CAUSES, ids=lambda cause: cause.key)
def test_no_sentence_has_two_numbers_that_read_the_same(cause):
    told = 0
    for switch in (switch for switch in SWITCHES if switch.key == cause.key):
        for value in values_of(switch):
            pictures = [switch.words(shot, value) for shot in SHOTS]
            if not any(tell_something(cause, words) for words in pictures):
                continue
            sentence, told = sentence_of(cause, pictures), told + 1
            assert not alike(sentence), sentence
            assert not usual(sentence), sentence
    assert told or cause.key in ("angle_noise", "in_place", "constant", "not_finite", "other_case")


def test_what_is_looked_for_in_sentences_is_found():
    for bad in (
        "MAX_BLUR_SIZE is 20 px instead of 20", "the loop stops at radius 20 px of 20, after 397 taps of 398",
        "colour is read at the nearest texel instead of at the nearest texel", "the total starts at 1 instead of 1",
        "the loop stops at radius 19 px of 20, after 398 taps of 398",
    ):  # fmt: skip
        assert alike(bad)
    for bad in (
        "circles are 1.000 times as large",
        "+0 is added to colours",
        "taps are shifted by +0.00 px in x and -0.00 px in y",
    ):
        assert usual(bad)
    for good in (
        "colours are multiplied by 1.005",
        "+1e-09 is added to colours",
        "the total starts at 1e-06 instead of 1",
    ):
        assert not alike(good)
        assert not usual(good)


def test_values_of_a_right_port_tell_nothing():
    for name, key in (("size_cap", "size_cap"), ("rad_scale", "rad_scale"), ("color_filter", "color_filter")):
        for shot in SHOTS:
            same = next(switch for switch in SWITCHES if switch.key == key)
            assert not tell_something(cause_of(key), same.words(shot, getattr(shot.right, name)))
    for key, value in (("gain", 1.0), ("offset", 0.0), ("initial_total", 1.0), ("coc_scale", 1.0)):
        assert not tell_something(cause_of(key), {"value": value, "words": ""})
    assert not tell_something(cause_of("behind_factor"), {"value": "any number of", "expected": "any number of"})


@pytest.mark.parametrize(
    ("value", "sentence"),
    [
        (6.0, "MAX_BLUR_SIZE is 6 px instead of 20"),
        (20.001, "MAX_BLUR_SIZE is 20.001 px instead of 20"),
        (20.0 + 1e-12, "MAX_BLUR_SIZE is 20.000000000001 px instead of 20"),
    ],
)
def test_more_digits_where_the_usual_ones_will_not_do(value, sentence):
    assert sentence_of(cause_of("max_blur_size"), [{"value": value, "expected": 20.0}]) == sentence


def test_the_picture_that_differs_is_told():
    """The worst picture has 20 px, too; the other one's 6 px are what a port with a constant does not do."""
    worst, other = replace_off(SHOTS[0], 9.0), replace_off(SHOTS[1], 2.0)
    switch = next(switch for switch in SWITCHES if switch.key == "max_blur_size")
    found = Found((Step(switch, 20.0),), 0.0, 1.0, 1.0, 0.0)
    assert _causes(found, [worst, other])[0].sentence == "MAX_BLUR_SIZE is 20 px instead of 6"
    assert _causes(found, [other, worst])[0].sentence == "MAX_BLUR_SIZE is 20 px instead of 6"


def replace_off(shot, off):
    return shot._replace(off=np.full(shot.off.shape, off))


def test_words_for_infinity():
    switch = next(switch for switch in SWITCHES if switch.key == "behind_factor")
    said = sentence_of(cause_of("behind_factor"), [switch.words(SHOTS[0], math.inf)])
    assert said == "taps from behind count up to any number of times the pixel's own size instead of 2"
    endless = SHOTS[0]._replace(right=replace(SHOTS[0].right, behind_factor=math.inf))
    assert not tell_something(cause_of("behind_factor"), switch.words(endless, math.inf))


def test_a_sentence_without_values():
    assert sentence_of(Cause("", "", "as it is"), [{}]) == "as it is"

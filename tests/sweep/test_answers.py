"""Predictions: of the settings that were asked for, and a line for each method of which there is none."""

from dataclasses import replace

import pytest

from refdof.sweep.answers import answers_of, models_of, predictions_of
from tests.sweep.points import point

pytestmark = pytest.mark.fast
SIZE = (640, 480)


def points():
    """A method whose time grows with its samples, one of two points, and one of which only a word was varied."""
    many = [
        point(f"{n} {w}", 1e-8 * n * w * w * 0.75, 20.0 + n, width=w, height=3 * w // 4)
        for n in (2, 4, 8, 16)
        for w in (160, 320)
    ]
    many = [replace(one, params={"samples": int(one.key.split()[0])}) for one in many]
    many = [replace(one, varied={"samples": one.params["samples"]}) for one in many]
    few = [point(f"few {n}", 0.5, 10.0, method="mipmap", varied={"samples": n}) for n in (8, 16)]
    words = [point(w, 0.6, 10.0, method="poisson", varied={"pattern": w}) for w in ("vogel", "halton")]
    return [*many, *few, *words]


def test_without_a_question_the_slowest_of_each_method():
    told, lacks = predictions_of(points(), [SIZE], None, None)
    assert [(one["method"], one["setting"], one["size"]) for one in told] == [("lensblur", "samples=16", "640x480")]
    assert told[0]["seconds"] == pytest.approx(1e-8 * 16 * 640 * 480, rel=0.01)
    assert lacks == [
        "mipmap: nothing is predicted; with samples varied, at least 4 points are needed, and there are 2",
        "poisson: nothing is predicted; neither the size nor a number of it was varied",
    ]
    assert {model.method for model in models_of(points())} == {"lensblur"}
    assert predictions_of(points(), [], None, None) == ([], [])


def test_with_a_budget_or_a_quality_what_answers_it():
    budget = 1.01e-8 * 8 * 320 * 240  # 8 samples at 320 x 240, and 16 at 160 x 120
    told, lacks = predictions_of(points(), [SIZE, (320, 240)], budget, None)
    assert {(one["setting"], one["size"]) for one in told} == {
        (setting, size) for setting in ("samples=16", "samples=8") for size in ("640x480", "320x240")
    }
    assert lacks == []
    assert {answer["shot"] for answer in answers_of(points(), budget, None)} == {"fence, 160 x 120", "fence, 320 x 240"}
    told, _ = predictions_of(points(), [SIZE], None, 23.0)
    assert [one["setting"] for one in told] == ["samples=4"]
    assert told[0]["seconds"] == pytest.approx(1e-8 * 4 * 640 * 480, rel=0.01)


def test_what_cannot_be_answered_predicts_what_is_named_instead():
    for limits, named in (((None, 59.0), "samples=16"), ((1e-9, None), "samples=2")):
        told, _ = predictions_of(points(), [SIZE], *limits)
        assert [one["setting"] for one in told] == [named]
        assert all(named in answer["words"] for answer in answers_of(points(), *limits))

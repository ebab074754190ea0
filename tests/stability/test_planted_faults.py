"""Faults planted in a method show as broken, with the figure that sees them."""

import numpy as np
import pytest

from refdof.methods import METHODS
from refdof.optics.lens import ThinLens
from refdof.stability.cases.case import Case
from refdof.stability.checks import constant, convex, dark, mirrored, near_pinhole, pinhole, same_bits
from refdof.stability.matrix import cell_of
from refdof.stability.subjects import mosaic, random_picture
from refdof.stability.verdict import BROKEN, NOT_APPLICABLE, PASS

pytestmark = pytest.mark.fast

SIZE = (7, 5)
LENS = ThinLens(0.1, 2.0)
ONE = (0.25, 0.5, 0.75)
DEPTH = np.random.default_rng(1).choice([1.0, 2.0, 5.0], (5, 7))


def even():
    return mosaic(np.broadcast_to(np.array(ONE), (5, 7, 3)), DEPTH, LENS, ONE)


def colourful(radius=LENS.radius, scale=1.0):
    return mosaic(random_picture(1, SIZE), DEPTH, ThinLens(radius, 2.0), scale=scale)


def cell(view, *checks, method="separable", **words):
    case = Case("planted", "depth", "made up", lambda: view, checks, **words)
    return cell_of(case, method, view)


def failing(found):
    return [figure.name for figure in found.figures if not figure.holds]


@pytest.fixture
def change(monkeypatch):
    """Give a filter's answer to a function before anybody sees it, in float32 only or in both types."""

    def plant(alter, wide=False):
        module = METHODS["separable"]
        honest = module._blur

        def broken(color, *others):
            image = honest(color, *others)
            return alter(image.copy()) if wide or color.dtype == np.float32 else image

        monkeypatch.setattr(module, "_blur", broken)

    return plant


def test_an_honest_method_passes():
    found = cell(even(), constant(ONE))
    assert (found.verdict, found.note, found.non_finite, found.first_stage) == (PASS, "", 0, "")
    assert found.error < 8
    assert cell(colourful(), convex(0.1, 0.9)).verdict == PASS


def spoil(image):
    image[2, 3, 1] = np.nan
    return image


def test_a_nan_shows(change):
    change(spoil, wide=True)
    found = cell(even(), constant(ONE))
    assert (found.verdict, found.non_finite) == (BROKEN, 1)
    assert failing(found) == ["non-finite", "constant"]
    assert found.note.startswith("non-finite: 1 px; allowed are 0: finite in, finite out")


def test_a_nan_in_float32_alone_shows(change):
    change(spoil)
    found = cell(even())
    assert failing(found) == ["non-finite", "float32"]
    assert found.first_stage == "image"


def test_lost_light_shows(change):
    change(lambda image: image * np.float32(0.999), wide=True)
    assert failing(cell(even(), constant(ONE))) == ["constant"]


def test_more_light_than_there_is_shows(change):
    change(lambda image: image * 1.2, wide=True)
    assert "convexity" in failing(cell(colourful(), convex(0.1, 0.9)))
    change(lambda image: image + np.float32(1e-6), wide=True)
    assert failing(cell(mosaic(np.zeros((5, 7, 3)), DEPTH, LENS, (0, 0, 0)), dark)) == ["light"]


def test_a_shift_shows_at_a_pinhole(change):
    change(lambda image: np.roll(image, 1, axis=1), wide=True)
    assert failing(cell(colourful(0.0), pinhole)) == ["pinhole"]
    assert failing(cell(colourful(1e-6), near_pinhole(0.8))) == ["sharpness"]


def test_asymmetry_shows(change):
    check = mirrored(lambda: mosaic(random_picture(1, SIZE)[:, ::-1], DEPTH[:, ::-1], LENS))
    assert failing(cell(colourful(), check)) == []
    change(lambda image: image * np.linspace(1.0, 0.999, 7, dtype=np.float32)[:, None], wide=True)
    assert failing(cell(colourful(), check)) == ["symmetry"]


def test_rounding_to_half_shows_in_float32(change):
    change(lambda image: image.astype(np.float16).astype(image.dtype))
    found = cell(colourful())
    assert failing(found) == ["float32"]
    # Half a step of a half float between 0.5 and 1 is 2^-12, over the brightest, up to 0.9: 2^11 steps of float32.
    assert 2**10 < found.error <= 2**11 / 0.8


def test_a_dependence_on_the_unit_shows(monkeypatch):
    found = cell(colourful(), same_bits("same bits", lambda: colourful(scale=4.0)))
    assert found.verdict == PASS
    wrong = cell(colourful(), same_bits("same bits", lambda: colourful(radius=0.11)))
    assert failing(wrong) == ["same bits"]


def test_a_crash_is_a_finding(monkeypatch):
    def crash(*_):
        raise ZeroDivisionError("no weight")

    monkeypatch.setattr(METHODS["separable"], "_blur", crash)
    found = cell(even())
    assert (found.verdict, found.note) == (BROKEN, "raised ZeroDivisionError: no weight")


def test_refusals():
    wrong = {"separable": {"leakage": -1.0}}
    told = "leakage: got -1; allowed is a finite number >= 0"
    found = cell(even(), params=wrong, refused="leakage: got -1")
    assert found.verdict == PASS
    assert found.note.startswith(f"refused: {told}")
    unexpected = cell(even(), params=wrong)
    assert unexpected.verdict == BROKEN
    assert unexpected.note.startswith(f"refused, but should not be: {told}")
    other = cell(even(), params=wrong, refused="color: ")
    assert other.verdict == BROKEN
    missing = cell(even(), refused="leakage: ")
    assert (missing.verdict, missing.note) == (BROKEN, "should be refused with: leakage: ")


def test_a_case_that_says_nothing_about_a_method():
    found = cell(even(), skip={"separable": "it has no such thing"})
    assert (found.verdict, found.note, found.figures) == (NOT_APPLICABLE, "it has no such thing", ())

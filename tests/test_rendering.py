"""Products are made once, booked to everyone who used them, and only made if somebody asks."""

import numpy as np
import pytest
from test_contract import quad, stage

from refdof import METHODS, InputError, View, render
from refdof.rendering import render_view


def view():
    scene = stage(quad(-1, -1, 0.2, 1, 1.0, (0.8, 0.2, 0.1)), background=(0.1, 0.2, 0.3))
    return View(scene, scene.camera, scene.lens)


def test_a_product_is_made_once_and_booked_to_both():
    shared = view()
    with shared.booking() as first:
        color = shared.pinhole().color
    with shared.booking() as second:
        assert shared.pinhole().color is color
    assert first.used == second.used
    assert first.prepare == second.prepare > 0.0
    assert first.spent == pytest.approx(first.prepare)  # the same seconds, summed in another order
    assert second.spent == 0.0
    assert set(first.used) == {"surfaces", "tracer", "layers 1", "pinhole"}


def test_nothing_is_made_that_nobody_asked_for():
    shared = view()
    with shared.booking() as book:
        shared.triangles()
    assert set(book.used) == {"triangles"}


def test_depth_of_a_card_is_exact():
    pinhole = view().pinhole()
    assert pinhole.depth[8, 8] == 3.0  # the card stands at z = 1, the eye at z = 4
    assert np.isinf(pinhole.depth[8, 20])
    np.testing.assert_array_equal(pinhole.color[8, 20], np.float32([0.1, 0.2, 0.3]))


def test_stages_only_when_asked():
    assert render("singlepass", view().scene).stages == {}
    stages = render("singlepass", view().scene, stages=True).stages
    assert set(stages) == {"coc", "size", "taps"}
    assert stages["coc"].shape == (16, 24)


def test_seconds():
    seconds = render_view("singlepass", view()).seconds
    assert set(seconds) == {"prepare", "blur"}
    assert min(seconds.values()) > 0.0


def test_unknown_method_names_the_nearest():
    with pytest.raises(InputError, match="did you mean 'singlepass'"):
        render("single_pass", view().scene)
    assert list(METHODS) == sorted(METHODS)


def test_wrong_objects():
    with pytest.raises(InputError, match="scene: got str"):
        View("fence", view().camera, view().lens)  # type: ignore[arg-type]

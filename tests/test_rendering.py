"""Products are made once, booked to everyone who used them, and only made if somebody asks."""

import time

import numpy as np
import pytest

from refdof import METHODS, InputError, View, render
from refdof.compare import compare
from refdof.rendering import make_params, render_view
from tests.methods.test_contract import flat_scene, quad

pytestmark = pytest.mark.fast


def view():
    scene = flat_scene(quad(-1, -1, 0.2, 1, 1.0, (0.8, 0.2, 0.1)), background=(0.1, 0.2, 0.3))
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


def test_layers_are_forgotten_and_shared_products_kept():
    shared = view()
    pinhole, layers, before = shared.pinhole(), shared.layers(2), render_view("singlepass", shared)
    shared.forget_layers()
    assert shared.pinhole() is pinhole
    assert shared.layers(2) is not layers
    assert all(np.array_equal(a, b) for a, b in zip(shared.layers(2), layers, strict=True))
    after = render_view("singlepass", shared)  # the first layer is forgotten, the time that it took is not
    assert after.seconds["prepare"] == before.seconds["prepare"]


def test_a_product_that_compiled_something_is_timed_once_more(monkeypatch):
    # The first making of "slow" compiles and takes 50 ms; that of "quick" compiles nothing.
    compiled = [0]
    monkeypatch.setattr("refdof.view.compilations", lambda: compiled[0])
    shared, made = view(), []
    shared.times_warm_runs = True

    def slow():
        made.append("slow")
        if len(made) == 1:
            compiled[0] += 1
            time.sleep(0.05)
        return len(made)

    with shared.booking() as book:
        assert shared.product("slow", slow) == 2
        assert shared.product("quick", lambda: made.append("quick")) is None
    assert made == ["slow", "slow", "quick"]
    assert book.used["slow"] < 0.05 < book.spent  # both makings were waited for


def test_a_run_that_compiled_something_is_not_timed(monkeypatch):
    compiled, runs = [0], []
    monkeypatch.setattr("refdof.compare.compilations", lambda: compiled[0])

    def rendered(name, *words, **more):
        runs.append(name)
        compiled[0] += len(runs) <= 3  # the first run
        return render_view(name, *words, **more)

    monkeypatch.setattr("refdof.compare.render_view", rendered)
    monkeypatch.setattr("refdof.compare.warm_up", lambda *_: runs.append("warm up"))
    scene = view().scene
    row = compare(scene, ["separable"], samples=16).rows[0]
    assert runs == ["warm up", "warm up", *["separable"] * 4]
    assert row.runs == 3


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
    assert set(stages) == {"coc", "size", "limit", "taps", "weight_sum"}
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


# --- presets


@pytest.mark.parametrize("name", METHODS)
def test_the_papers_preset_names_fields_that_differ_and_values_that_are_allowed(name):
    best, paper = make_params(name, {}), make_params(name, {}, "paper")
    assert best == METHODS[name].Params()
    for field, value in METHODS[name].METHOD.paper.items():
        assert getattr(paper, field) == value
        assert getattr(best, field) != value


def test_presets_by_hand():
    # Lee et al. 2009: Eq. (8) blends mip levels geometrically; objects are as thick as their layer.
    assert make_params("mipmap", {}, "paper").blend == "geometric"
    assert make_params("multiview", {}, "paper").wall_px == np.inf
    # Lee et al. 2010 read the colour of the sample that is hit. What is given wins.
    assert render("lensblur", view().scene, preset="paper", samples=1).params.filter == "nearest"
    given = render("lensblur", view().scene, preset="paper", samples=1, filter="linear").params
    assert given == make_params("lensblur", {"samples": 1})


@pytest.mark.long
def test_both_presets_are_compared_where_they_differ():
    done = compare(view().scene, ["singlepass", "mipmap"], samples=4, preset=("best", "paper"))
    assert [(row.method, row.preset) for row in done.rows] == [
        ("singlepass", "best"),
        ("mipmap", "best"),
        ("mipmap", "paper"),
    ]
    assert [row.name for row in done.rows] == ["singlepass", "mipmap", "mipmap (paper)"]
    assert [row.params["blend"] for row in done.rows[1:]] == ["linear", "geometric"]
    same = {"mipmap": {"blend": "linear", "depth_format": "f32"}}
    assert len(compare(view().scene, ["mipmap"], same, samples=4, preset=("best", "paper")).rows) == 1
    (alone,) = compare(view().scene, ["singlepass"], samples=4, preset="paper").rows
    assert alone.preset == "paper"


def test_unknown_presets_name_the_nearest():
    with pytest.raises(InputError, match="preset: got 'papr'; did you mean 'paper'"):
        render("singlepass", view().scene, preset="papr")
    with pytest.raises(InputError, match="preset: got 'bets'; did you mean 'best'"):
        compare(view().scene, ["singlepass"], preset=["paper", "bets"])
    with pytest.raises(InputError, match="preset: got none; allowed are best, paper"):
        compare(view().scene, ["singlepass"], preset=())

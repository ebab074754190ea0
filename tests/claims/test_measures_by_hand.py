"""Measures of pictures on pictures whose answers are known, and of times on times that are made up."""

from typing import NamedTuple

import numpy as np
import pytest

from refdof.claims import artefacts, filters, occlusion, pictures, times
from refdof.claims.bench import Bench, params_of, preset_of
from refdof.claims.cards import Card, card_view, depth_of, room_view, slanted_view

pytestmark = pytest.mark.fast


class Told:
    """A bench whose pictures, scores, stages and times are told by name of the method."""

    def __init__(self, images=None, scores=None, steps=None, seconds=None, coc=None):
        self.images, self.scores, self.steps, self.spent, self.coc = images, scores, steps, seconds, coc

    def image(self, shot, render):
        return self.images[render["method"]]

    def truth(self, shot):
        return self.images["truth"]

    def score(self, shot, render, metric="psnr"):
        return self.scores[shot["scene"]][render["method"]]

    def result(self, shot, render, stages):
        return NamedTuple("Result", [("stages", dict)])({"steps": np.array([[self.steps[render["method"]]]])})

    def seconds(self, renders, part="blur"):
        return np.array([[self.spent[render["method"]] * load for _, render in renders] for load in (1.0, 7.0, 2.0)])

    def view(self, shot):
        coc = self.coc
        return type("View", (), {"coc_px": lambda _: coc})()


def of(name, **words):
    return {"method": name, **words}


SHOTS = [{"scene": "one"}, {"scene": "two"}]
SCORES = {"one": {"a": 30.0, "b": 20.0, "c": 28.0}, "two": {"a": 40.0, "b": 36.0, "c": 37.0}}


def test_scores():
    bench = Told(scores=SCORES)
    assert pictures.score(bench, SHOTS, of("a")) == 35.0
    assert pictures.gain(bench, SHOTS, of("a"), of("b")) == 7.0
    assert pictures.order(bench, SHOTS, {"x": of("a"), "y": of("c")}) == {"x": 35.0, "y": 32.5}
    assert pictures.share_of_gain(bench, SHOTS, of("c"), of("b"), of("a")) == 4.5 / 7.0
    assert pictures.gain_of_shot(bench, SHOTS[1], SHOTS[0], of("b")) == 16.0
    assert pictures.order_of_shots(bench, {"near": SHOTS[0], "far": SHOTS[1]}, of("c")) == {"near": 28.0, "far": 37.0}


def test_texels():
    bench = Told(steps={"few": 3.0, "more": 6.0, "none": 11.0, "least": 1.0})
    assert pictures.texels_walked(bench, SHOTS, of("more"), of("few")) == 2.0
    assert pictures.saved_share(bench, SHOTS, of("few"), of("none"), of("least")) == 0.8


def test_times():
    bench = Told(seconds={"a": 0.5, "b": 0.125, "c": 1.0})
    assert times.time_ratio(bench, SHOTS[0], of("a"), of("b")) == 4.0
    assert times.time_order(bench, SHOTS[0], {"x": of("a"), "y": of("b")}) == {"x": 4.0, "y": 1.0}

    class Growing:
        def seconds(self, renders, part="blur"):
            return np.array([[3.0 * render["samples"] ** 0.75 for _, render in renders]])

    assert times.time_power(Growing(), SHOTS[0], of("a"), "samples", (16, 81)) == pytest.approx(0.75, rel=1e-12)


def test_differences_leave_the_border_out():
    first = np.zeros((40, 40, 3))
    second = first.copy()
    second[3, 20], second[20, 20] = 0.5, 0.25
    bench = Told(images={"a": first, "b": second}, coc=np.full((40, 40), -3.5))
    # Circles of 3.5 px: 4 + 5 rows are left out.
    assert pictures.largest_difference(bench, SHOTS, of("a"), of("b")) == 0.25
    assert pictures.largest_difference(bench, SHOTS, of("a"), of("b"), border=True) == 0.5


def test_hidden_detail_is_the_share_of_variance():
    random = np.random.default_rng(0)
    truth, noise = random.random((64, 64, 1)), random.random((64, 64, 1))
    images = {"truth": truth, "same": 0.5 * truth + 0.2, "other": noise, "half": truth + noise, "not": -truth}
    bench = Told(
        images={name: np.repeat(image, 3, axis=2) for name, image in images.items()}, coc=np.full((64, 64), -5.0)
    )

    def shown(*names):
        return occlusion.hidden_detail(bench, SHOTS[0], [of(name) for name in names])

    assert shown("same") == pytest.approx(1.0, abs=1e-12)
    assert shown("other") < 0.01  # 4096 independent numbers
    assert shown("half") == pytest.approx(0.5, abs=0.05)  # equal variances: r^2 = 1 / 2
    assert shown("other", "half") == shown("half")
    assert shown("not") == 0.0


def test_gaps():
    column = np.array([1, 1, 0, 0, 1, 1, 1, 0, 0, 1], dtype=float)
    # 0.7 is crossed at 3.7 and at 6.3, with pixels at whole numbers.
    assert occlusion._gap(column) == pytest.approx(2.6)
    assert occlusion._gap(column[:6]) is None


def test_straying_edges():
    rows, x = np.mgrid[:128, :128]

    def strays(wave):
        """Of an oblique edge of 16 px, on which straight lines between pixels are exact."""
        return artefacts._straying(np.clip((x - 64.0 - 0.25 * (rows - 64.0) - wave) / 16.0 + 0.5, 0.0, 1.0))

    assert strays(0.0) < 1e-9
    # Six whole waves in 48 rows: 0.3 / sqrt 2, less what a line fits of them.
    assert strays(0.3 * np.sin(2.0 * np.pi * rows / 8.0)) == pytest.approx(0.2121, abs=0.003)


def test_leaks(monkeypatch):
    def pictured(render, view):
        image = np.zeros((72, 96))
        image[24:48, 36:60] = 1.0
        image[0, :] = render["leak"]
        return image

    monkeypatch.setattr(artefacts, "_shown", pictured)
    first, second = of("a", leak=0.06), of("b", leak=0.03)
    # 96 pixels of 0.06 over 24 x 24 of 1.
    assert artefacts.leak(None, {"a": first}) == pytest.approx(0.01, rel=1e-12)
    assert artefacts.leak(None, {"a": first, "b": second}) == pytest.approx({"a": 0.01, "b": 0.005}, rel=1e-12)
    assert artefacts.leak_ratio(None, first, second) == pytest.approx(2.0, rel=1e-12)


def test_cards_lie_where_they_say():
    view = card_view([Card(2.0, -3.0, 5.0, 4.0, -6.0, 0.25), Card(0.0, 0.0, 99.0, 99.0, 2.0, 0.75)], (32, 24), 0.2)
    color, depth = view.pinhole()
    grey = np.full((24, 32), 0.75)
    grey[12 + 3 - 4 : 12 + 3 + 4, 16 + 2 - 5 : 16 + 2 + 5] = 0.25  # y is up, rows go down
    np.testing.assert_allclose(color[..., 0], grey, rtol=1e-6)
    np.testing.assert_allclose(view.coc_px(), np.where(grey == 0.25, -6.0, 2.0), rtol=1e-9)
    assert depth_of(-6.0, 0.2) == pytest.approx(1.0 / 1.3)  # 20 (1 - 1 / d) = -6
    assert depth.min() == pytest.approx(1.0 / 1.3)


def test_a_slanted_plane_fills_the_picture_from_reach_to_reach():
    view = slanted_view(6.0, (32, 16), 0.4, 1.0, 0.0)
    assert (view.pinhole().color == 1.0).all()
    columns = np.arange(32) + 0.5 - 16
    # A face spans five pixels and is flat in inverse depth: as exact as float32 depths.
    np.testing.assert_allclose(view.coc_px(), np.broadcast_to(6.0 * columns / 16, (16, 32)), atol=1e-4)


@pytest.mark.parametrize("seed", range(3))
def test_a_room_is_closed(seed):
    view = room_view(seed, (24, 18), 0.02)
    assert view.pinhole().color.max() <= 1.0
    assert (view.layers().triangle >= 0).any(axis=0).all()


def test_renders_in_turn_are_timed_without_the_scene():
    bench = Bench()
    shot = {"scene": "branches", "size": "24x18"}
    renders = [(shot, of("cascaded")), (shot, of("scatter"))]
    alone, total = bench.seconds(renders), bench.seconds(renders, "total")
    assert alone.shape == total.shape == (5, 2)
    assert (alone > 0.0).all()
    assert (total[:, 0] > alone[:, 0].min()).all()  # with four peeled layers
    with bench.view(shot).booking() as book:
        bench.view(shot).pinhole()
    assert book.layers == 0.0


def test_presets_and_fields_of_renders():
    assert preset_of(of("multiview")) == preset_of(of("lensblur", samples=3)) == "paper"
    assert preset_of(of("mipmap")) == "best"
    assert preset_of(of("multiview", preset="best")) == "best"
    assert params_of(of("lensblur", preset="best", samples=3)) == {"samples": 3}


def test_a_bench_makes_a_view_once_with_the_circles_asked_for():
    bench = Bench()
    shot = {"scene": "branches", "size": "24x18", "circle": 5.0}
    view = bench.view(shot)
    assert view is bench.view(dict(reversed(shot.items())))
    assert 2.0 * np.abs(view.coc_px()).mean() == pytest.approx(5.0, rel=1e-9)
    assert view.camera.size == (24, 18)
    assert (bench.image(shot, of("pinhole")) == view.pinhole().color).all()


def test_gaussians_in_steps():
    # A deviation that is one step is the same blur.
    assert filters.blur_in_steps(None, [2.0]) == 0.0
    assert 0.0 < filters.blur_in_steps(None, [1.0, 1.5]) < 0.01


def test_n_buffers():
    assert filters.n_buffer_exact(None, True, 50) == 1.0
    assert 0.3 < filters.n_buffer_exact(None, False, 200) < 0.9
    # Levels of 64 px: 1 + 6, and of 32 blocks: 1 + 5.
    assert filters.n_buffer_memory(None, 64, 40) == pytest.approx(4.0 * 7 / 6)

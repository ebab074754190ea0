"""Measures on small patterns, compiled, where the answer is known."""

import pytest

from refdof.claims import artefacts


@pytest.mark.parametrize("method", ["singlepass", "scatter", "mipmap", "pyramidal"])
def test_white_stays_white(method):
    assert artefacts.white_furnace(None, {"method": method}) < 1e-4  # 398 roundings in float32


def test_discs_inside_the_picture_keep_their_light():
    assert artefacts.shares_of_discs(None) == pytest.approx(1.0, abs=1e-9)  # sums in float64


@pytest.mark.parametrize("method", ["lensblur", "multiview", "accumulation"])
def test_rays_leak_nothing(method):
    assert artefacts.leak(None, {"it": {"method": method}}) == 0.0
    assert artefacts.leak_onto_focus(None, {"method": method}) == 0.0


def test_the_edge_of_a_disc():
    # 64 views of a card whose circle is 10 px in radius: 2 / (10 pi), and the noise of a net at an edge, 64^-0.75.
    assert artefacts.edge_step(None, {"method": "accumulation", "samples": 4096}) == pytest.approx(0.064, abs=0.01)


def test_views_leave_no_ring():
    assert artefacts.ring(None, {"method": "accumulation"}) == 0.0
    assert artefacts.slipped(None, {"method": "accumulation"}, 2) == 0.0


def test_a_filter_that_treats_all_pixels_alike_does_not_flicker():
    shot = {"scene": "branches", "size": "96x72", "circle": 3.0}
    from refdof.claims.bench import Bench

    found = artefacts.flicker(Bench(), shot, {"separable": {"method": "separable"}, "mipmap": {"method": "mipmap"}})
    assert found["separable"] < 1e-6 < found["mipmap"]

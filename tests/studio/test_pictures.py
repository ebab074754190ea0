"""Pictures that a page gets, beside those of the method and of the reference."""

import numpy as np
import pytest

from refdof import ThinLens, View, reference
from refdof.image.display import display, to_8_bit
from refdof.optics.systems.prescription import load_lens
from refdof.rendering import render_view
from refdof.studio.pictures import Pictures
from refdof.studio.state import parse_state
from tests.studio import flat


def test_pictures_are_those_of_the_method(page):
    for number, (method, settings) in enumerate([("scatter", {}), ("lensblur", {"samples": 64})], 1):
        _, levels = page.picture(flat.state(number, method=method, lens_focus=flat.FAR))
        view = View(flat.scene(), flat.scene().camera, ThinLens(0.1, flat.FAR))
        np.testing.assert_array_equal(levels, to_8_bit(render_view(method, view, **settings).image))


def test_the_error_is_the_difference_to_the_reference(page):
    message, levels = page.picture(flat.state(1, overlay="error", method="singlepass"), "reference")
    assert "beside 16 lens samples" in message["legend"]["unit"]
    edge, away = levels[:, 30:34].astype(int).sum(), levels[:, :20].astype(int).sum()
    assert edge > 0
    assert away == 0  # a card of one colour in focus
    # The first block is the reference of seed 0 with 16 samples; the worst difference has the scale's last colour.
    truth = reference(flat.scene(), samples=16, seed=0).image
    image = render_view("singlepass", View(flat.scene(), flat.scene().camera, flat.scene().lens)).image
    error = np.abs(display(image).astype(np.float64) - display(truth))
    root = float(message["legend"]["unit"].split("RMSE ")[1].split()[0])
    assert root == pytest.approx(np.sqrt(np.mean(error**2)), abs=1e-4)  # four digits are shown
    assert (levels.sum(axis=2)[error.max(axis=2) == 0.0] == 0).all()


@pytest.mark.fast
def test_what_a_change_leaves_as_it_was_is_kept():
    """A new focus, aperture or, in a still scene, frame traces rays only; another size keeps Embree's structure."""
    pictures = Pictures(flat.scene(), load_lens)
    first = pictures.view(parse_state(flat.state(1)))
    layers, tracer = first.layers(1), first.tracer()
    assert pictures.view(parse_state(flat.state(2, method="lensblur", overlay="coc"))) is first
    for change in ({"lens_focus": 5.0}, {"lens_radius": 0.2}, {"frame": 3}, {"lens_kind": "plane", "points": points()}):
        view = pictures.view(parse_state(flat.state(3, **change)))
        assert view is not first
        assert view.layers(1) is layers
    smaller = pictures.view(parse_state(flat.state(4)), (16, 12))
    assert smaller.tracer() is tracer
    assert smaller.layers(1).depth.shape[1:] == (12, 16)
    moved = flat.state(5)
    moved["camera"]["eye"] = [0.5, 0.0, 0.0]
    assert pictures.view(parse_state(moved)).tracer() is not tracer


@pytest.mark.fast
def test_a_moving_scene_is_looked_at_anew_at_every_frame():
    rest = flat.scene()
    scene = rest.with_frames(np.stack([rest.vertices, rest.vertices - [0.0, 0.0, 1.0]]))
    pictures = Pictures(scene, load_lens)
    for frame in (0, 1, 0.5, 0):
        view = pictures.view(parse_state(flat.state(1, frame=frame)))
        np.testing.assert_allclose(view.pinhole().depth, flat.depth() + frame, rtol=1e-6)  # of layers: float32


def points():
    return [{"triangle": 0, "barycentrics": [1, 1, 1], "keep": True}]

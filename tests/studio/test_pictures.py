"""Pictures that a page gets, beside those of the method and of the reference."""

import numpy as np
import pytest

from refdof import ThinLens, View, reference
from refdof.image.display import display, to_8_bit
from refdof.rendering import render_view
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

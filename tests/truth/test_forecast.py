"""The forecast of a tolerance, and the cap that keeps it."""

import numpy as np
import pytest

import refdof
from refdof import Forecast, ThinLens
from tests import flat_scene


def striped(size=96):
    """A striped wall in focus on the left, blurred stripes on the right."""
    p = 64.0
    shot, lens = flat_scene.camera(size, size, p), ThinLens(0.25, 1.0)
    left = [flat_scene.rectangle(x / 40, (x + 1) / 40, -2, 2, 1.0) for x in range(-40, 0, 2)]
    right = [flat_scene.rectangle(x / 10, (x + 1) / 10, -9, 9, 4.0) for x in range(0, 40, 2)]
    return flat_scene.scene_of([*left, *right], shot, lens)


@pytest.mark.parametrize("tolerance", [0.05, 0.01])
def test_the_forecast_comes_true(tolerance):
    scene = striped()
    told = refdof.forecast(scene, tolerance=tolerance)
    result = refdof.reference(scene, tolerance=tolerance)
    # 36 tiles of 256 pixels stand for all; each pixel's need is rounded to a power of two.
    assert told.samples == pytest.approx(result.samples.mean(), rel=0.35)
    assert told.unmet == pytest.approx(result.unmet, abs=0.02)


def test_the_cap_holds_and_tells():
    scene = striped()
    result = refdof.reference(scene, tolerance=1e-4, max_samples=256)
    assert result.samples.max() == 256
    above = (result.standard_error > 1e-4).any(axis=-1)
    assert result.unmet == pytest.approx(above.mean(), abs=1e-3)  # float32 at the limit
    assert 0.2 < result.unmet < 0.8  # the right half, and the edge of the left one
    told = refdof.forecast(scene, tolerance=1e-4, max_samples=256)
    assert told.samples <= 256
    assert told.unmet == pytest.approx(result.unmet, abs=0.1)


def test_a_bright_pixel_is_judged_by_its_brightness():
    # An edge between 4 and 0: where the picture is 2, twice the error is allowed.
    shot, lens = flat_scene.camera(32, 8, 32.0), ThinLens(0.5, 1.0)
    card = flat_scene.rectangle(-99, 0, -99, 99, 2.0, (4.0, 4.0, 0.0))
    result = refdof.reference(flat_scene.scene_of([card], shot, lens), tolerance=0.02, max_samples=1 << 16)
    allowed = 0.02 * np.maximum(1.0, result.image.max(axis=-1, keepdims=True))
    assert (result.standard_error <= allowed * (1 + 1e-6)).all()  # float32
    assert result.unmet == 0.0


def test_a_pinhole_costs_nothing():
    scene = striped()
    assert refdof.forecast(scene, lens=ThinLens(0.0, 1.0)) == Forecast(1.0, 0.0, 0.0)


def test_the_words():
    assert str(Forecast(812.3, 80.4, 0.0)) == "about 812 samples per pixel, 1 min 20 s"
    assert str(Forecast(100.0, 9.6, 0.031)) == (
        "about 100 samples per pixel, 10 s; 3.1 % of the pixels will stop above the tolerance"
    )


@pytest.mark.parametrize("tolerance", [1e-300, 5e-324])
def test_a_tolerance_near_the_smallest_number_asks_for_all_samples(tolerance):
    scene = refdof.load_scene("cans")
    found = refdof.forecast(scene, scene.camera.with_size((12, 12)), tolerance=tolerance, max_samples=256)
    assert 16.0 <= found.samples <= 256.0

"""The cost of methods: laws that were put in come out."""

from dataclasses import replace

import numpy as np
import pytest

from refdof.sweep import fitted
from tests.sweep.points import point

pytestmark = pytest.mark.fast

SIZES = ((160, 120), (320, 240), (640, 480))


def swept(law, values=(4, 8, 16, 32, 64), sizes=SIZES, scenes=("fence",), noise=0.0, seed=1):
    random = np.random.default_rng(seed)
    found = []
    for factor, scene in enumerate(scenes, 1):
        for width, height in sizes:
            for value in values:
                seconds = law(width * height, value, height / 100.0, factor) * np.exp(random.normal(0.0, noise))
                found.append(
                    point(
                        f"{scene} {width} {value}",
                        seconds,
                        scene=scene,
                        width=width,
                        height=height,
                        varied={"samples": value, "size": f"{width}x{height}"},
                        mean_coc_px=height / 100.0,
                    )
                )
    return found


def test_a_law_comes_back():
    model = fitted(swept(lambda n, q, _r, k: k * n**1.05 * (2e-7 + 1e-8 * q**0.95), scenes=("fence", "town")))
    assert model.exponents == pytest.approx({"pixels": 1.05, "samples": 0.95}, abs=1e-3)  # the solver's own tolerance
    assert model.per_pixel == pytest.approx({"fence": 2e-7, "town": 4e-7}, rel=1e-2)
    assert model.factors == pytest.approx({"fence": 1e-8, "town": 2e-8}, rel=1e-2)
    assert model.worst < 1e-3


def test_one_scene_exactly_and_at_4k():
    law = lambda n, q, _r, _k: n**1.05 * (2e-7 + 1e-8 * q**0.95)  # noqa: E731
    points = swept(law)
    model = fitted(points)
    assert model.per_pixel == pytest.approx({"fence": 2e-7}, rel=1e-2)
    assert model.worst < 1e-3
    large = 3840 * 2160
    assert model.predict(points[-1], large) == pytest.approx(law(large, 64, 0, 1), rel=1e-2)
    assert "time grows as pixels^1.05 samples^0.95" in str(model)


def test_noise_is_told():
    model = fitted(swept(lambda n, q, _r, _k: 1e-8 * n * q, noise=0.05))
    # A point's own noise, and a little of the fit's: the median of |normal| is 0.67 sigma.
    assert 0.015 < model.error < 0.08
    assert model.exponents["samples"] == pytest.approx(1.0, abs=0.06)  # 5 % over a range of 16: 0.05 / log(16) = 0.02


def test_circles_of_a_varied_lens():
    points = [
        point(str(k), 1e-7 * 76800 * (3.0 + radius**2), mean_coc_px=radius, varied={"lens_radius": radius}, params={})
        for k, radius in enumerate((1.0, 2.0, 4.0, 8.0, 16.0, 32.0))
    ]
    model = fitted(points)
    assert model.exponents == pytest.approx({"circle": 2.0}, abs=1e-3)
    assert model.per_pixel == pytest.approx({"fence": 3e-7}, rel=1e-3)
    assert model.predict(points[0], 76800, circle=64.0) == pytest.approx(1e-7 * 76800 * (3.0 + 64.0**2), rel=1e-2)


def test_words_are_no_numbers():
    points = [point(str(k), 0.1, varied={"pattern": word}) for k, word in enumerate(("vogel", "halton", "poisson"))]
    assert fitted(points) is None


def test_too_few_points():
    assert fitted([point("a", 0.1), replace(point("b", 0.2), varied={"samples": 32})]) is None


def test_two_parameters():
    points = [
        point(
            f"{q} {m}",
            76800 * 1e-8 * q**0.9 * m**0.5,
            varied={"samples": q, "layers": m},
            params={"samples": q, "layers": m},
        )
        for q in (4, 8, 16, 32)
        for m in (1, 2, 4, 8)
    ]
    assert fitted(points).exponents == pytest.approx({"samples": 0.9, "layers": 0.5}, abs=2e-3)

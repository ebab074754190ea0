"""Measures without pictures against numbers worked out by hand, or in another way."""

import math

import numpy as np
import pytest

from refdof.claims import formulas
from refdof.claims.bench import Bench
from refdof.optics.lens_samples import lens_samples

pytestmark = pytest.mark.fast
BENCH = Bench()


def test_texture_reads():
    # Table 1: 2 * 9 * (1/4 + 1/16 + 1/64 + 1/256) + 6 + 9, and 9 + 2 * 9.
    assert formulas.texture_reads(BENCH, ["mipmap"], 1024, 1024) == pytest.approx(20.9765625)
    assert formulas.texture_reads(BENCH, ["separable", "mipmap"], 1024, 1024)["separable"] == 27.0


def test_sums_of_terms():
    assert formulas.sum_of_terms(BENCH, [[24, [1]], [9, [16]]]) == 24.03515625
    assert formulas.sum_of_terms(BENCH, [[8, [1, 2]]]) == 10.0


def test_totals():
    assert formulas.mismatch_of_totals(BENCH, [[1, 2, 3], [4, 5, 10]]) == 1


def test_cones():
    # The nearest of 32 points by brute force.
    points = lens_samples(32, "poisson", 0)[0]
    apart = np.hypot(*(points[:, None] - points).transpose(2, 0, 1)) + 9.0 * np.eye(32)
    assert formulas.cone(BENCH, 32, 1.0, 1.0, seeds=1) == pytest.approx(apart.min(axis=1).mean(), rel=1e-12)
    half = formulas.cone(BENCH, 32, 32.0, 0.5, seeds=1)
    assert half == pytest.approx(16.0 * apart.min(axis=1).mean(), rel=1e-12)
    assert formulas.cone(BENCH, 32, 32.0, 0.5, level=True, seeds=1) == pytest.approx(math.log2(half), rel=1e-12)


def test_the_eye():
    # 0.32 * 3000 / 24 = 40 px per mm of retina; 4 * 17 / (3000 - 17) * 2700 / 300 = 0.20516 mm.
    assert formulas.eye_circle(BENCH, 3000.0) == pytest.approx(40.0 * 0.2051626, rel=1e-6)


def test_the_golden_angle():
    assert formulas.golden_angle(BENCH) == pytest.approx(2.0 * math.pi / ((1.0 + math.sqrt(5.0)) / 2.0) ** 2, rel=1e-15)


def test_the_spiral():
    # r^2 grows by 2 * scale a tap and a little more: nearly 400 / (2 scale) taps up to 20 px.
    taps = formulas.spiral_taps(BENCH, [0.25, 1.0])
    assert taps == {"0.25": pytest.approx(800, abs=4), "1": pytest.approx(200, abs=4)}


def test_umbrae():
    # By hand: s / (E - s) = 0.1 / 0.9 of the depth.
    assert formulas.umbra_offset(BENCH) == pytest.approx(1.0, abs=1e-12)
    # 2 tan 15 / 600 / 0.009 = 0.09924 / m a layer: ten steps to 1 / 131.66 m.
    assert formulas.umbra_layers(BENCH, 131.0) == 10
    assert formulas.umbra_layers(BENCH, 132.0) == 11
    assert formulas.dense_stack_layers(BENCH, 5000) == 11
    assert formulas.pinhole_layers(BENCH, 5) == 1


def test_printed_misprints():
    # Eq. (4) at z_0 = 2 of 2 .. 4: (2 - 2) / (2 - 4) = 0 after a core of 1.
    assert formulas.printed_ramp_jump(BENCH) == pytest.approx(1.0, abs=1e-11)
    # -inf <= z <= -inf holds for no depth.
    assert formulas.foremost_weights(BENCH) == 0.0
    assert formulas._matte_as_printed(1.5, (1.0, 2.0, 3.0)) == 0.5
    assert formulas._matte_as_printed(2.5, (1.0, 2.0, 3.0)) == 1.0
    assert formulas._matte_as_printed(3.5, (1.0, 2.0, 3.0)) == 0.0


def test_glass():
    # n^2 = 1 + B l^2 / (l^2 - C): 0.587 um, by hand of the printed coefficients.
    square = 0.51**2
    printed = (
        1 + 1.039 * square / (square - 0.006) + 0.232 * square / (square - 0.02) + 1.01 * square / (square - 103.6)
    )
    found = formulas.glass_indices(BENCH, {"green": 0.51, "red": 0.65})
    assert found["green"] == pytest.approx(math.sqrt(printed), rel=1e-12)
    assert formulas.glass_error(BENCH, [0.51]) == pytest.approx(1.39e-4, abs=1e-6)  # SCHOTT's 1.52077


def test_lenses():
    assert formulas.lensmaker(BENCH) == pytest.approx(1.0, abs=1e-9)
    # Third order, equi-biconvex, n = 1.5168, f = 50, height 6.25, light from infinity: the longitudinal aberration is
    # about 1.65 h^2 / f (Jenkins and White, shape factor 0), -1.29 mm; the lens has a thickness, and higher orders.
    assert formulas.rim_focus(BENCH) == pytest.approx(-1.65 * 6.25**2 / 50.0, rel=0.1)
    assert formulas.field_focus(BENCH, 10.0) < formulas.field_focus(BENCH, 5.0) < 0.0


def test_focal_surfaces():
    assert formulas.surface_error(BENCH) == 0.0
    found = formulas.far_influence(BENCH, [1.0, 8.0])
    assert found["1"] > found["8"] > 0.0


def test_discs():
    assert formulas.disc_over_deviation(BENCH) == pytest.approx(4.0, abs=1e-3)
    assert formulas.inner_share(BENCH) == pytest.approx(98 / 398 / 0.25, abs=1e-12)  # radii below 10: 98 taps


def test_thin_lenses():
    for measure in (formulas.thin_lens, formulas.listing_circle, formulas.printed_inverse):
        assert measure(BENCH) == 0.0
    assert formulas._beyond_rounding(2e-12) == 2e-12
    assert formulas.circle_bound(BENCH) == pytest.approx(1.0 - 1e-9, abs=1e-14)  # 1 - focus / depth

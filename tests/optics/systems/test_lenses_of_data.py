"""The lenses of data/lenses are as their sources state: focal length, f-number, back focus, and sharp on the axis."""

import math

import numpy as np
import pytest

from refdof.optics.systems.field import longitudinal_aberration
from refdof.optics.systems.glass import LINE_C, LINE_D, LINE_F
from refdof.optics.systems.paraxial import cardinal_points, f_number
from refdof.optics.systems.prescription import LENSES, load_lens

pytestmark = pytest.mark.fast

# Focal length, f-number and back focal distance as stated by the source, times the scale [mm]; and how well they hold:
# old indices have three digits, which move the focal length by some thousandths.
STATED = {
    "biconvex": (50.0, 4.0, None, 1e-5),
    "achromat": (50.0, 2.2, 43.4, 4e-3),  # the catalogue's tolerance is 1 %
    "cooke_triplet": (50.0, 5.0, 42.2078, 6e-3),  # the file's sensor stands where the spot is smallest
    "double_gauss": (50.358, 2.0, None, 1e-5),
    "petzval": (85.0, 2.3, 0.85 * 56.5, 3e-4),
    "telephoto": (400.0, 5.6, 4.0 * 18.960, 5e-3),
    "wide_angle": (35.0, 2.8, 35.0, 3e-3),
}


def test_every_lens_is_stated():
    assert set(STATED) == set(LENSES)


@pytest.mark.parametrize("name", STATED)
def test_a_lens_is_as_its_source_states(name):
    focal_length, stop, back, tolerance = STATED[name]
    system = load_lens(name)
    points = cardinal_points(system)
    assert points.focal_length == pytest.approx(focal_length, rel=tolerance)
    assert f_number(system) == pytest.approx(stop, rel=0.016)  # pbrt's stop makes f/2.03
    if back is not None:
        assert points.back_focal_distance == pytest.approx(back, rel=tolerance)
    assert f"{round(focal_length)} mm f/{stop:g}" in system.name


@pytest.mark.parametrize("name", STATED)
def test_a_lens_is_sharp_on_the_axis_where_its_sensor_stands(name):
    system = load_lens(name)
    points = cardinal_points(system)
    assert system.sensor == pytest.approx(points.back_focus, rel=1e-12)
    where = longitudinal_aberration(system, np.linspace(0.05, 0.95, 40), math.inf, LINE_D)
    # The stop bounds the light of the axis, not a rim; its image is some 3 % smaller for the outermost rays.
    assert np.isfinite(where).all()
    # A single lens has a third-order aberration of 1.7 mm at f/4; the others are corrected.
    assert np.abs(where).max() < (0.03 if name == "biconvex" else 0.006) * points.focal_length


@pytest.mark.parametrize("name", STATED)
def test_all_but_the_single_lens_are_corrected_for_color(name):
    system = load_lens(name)
    blue, red = (cardinal_points(system, line).back_focal_distance for line in (LINE_F, LINE_C))
    shift = (red - blue) / cardinal_points(system).focal_length
    if name == "biconvex":
        assert shift == pytest.approx(1.0 / 64.17, rel=0.04)  # 1 / V_d of N-BK7, for a thin lens; it is 5 mm thick
    else:
        assert abs(shift) < 1.0 / 250.0

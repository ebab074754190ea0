"""Prescriptions: where surfaces lie, and what is refused."""

import math
from dataclasses import replace

import numpy as np
import pytest

from refdof._check import InputError
from refdof.optics.systems.glass import AIR, Glass
from refdof.optics.systems.system import LensSystem, Surface, ThickLens
from tests.optics.systems.lenses import double_gauss, doublet, singlet

pytestmark = pytest.mark.fast

GLASS = Glass("plain", 1.5)
FRONT = Surface(50.0, 5.0, GLASS, 10.0, is_stop=True)
BACK = Surface(-50.0, 40.0, AIR, 10.0)


def test_vertices_add_up():
    system = double_gauss()
    # By hand from the printed thicknesses.
    assert system.vertices == pytest.approx([0, 3.76, 3.88, 7.905, 11.18, 16.885, 21.385, 22.565, 28.63, 28.82, 32.04])
    assert system.sensor == pytest.approx(68.04)
    assert system.stop == 5
    assert system.indices(0.55).tolist() == [1, 1.67, 1, 1.67, 1.699, 1, 1, 1.603, 1.658, 1, 1.717, 1]


def test_sag_is_the_spheres():
    # A 3-4-5 triangle: at height 3 a sphere of radius 5 is 1 from its vertex.
    assert Surface(5.0, 0.0, AIR, 5.0).sag(3.0) == pytest.approx(1.0, rel=1e-15)
    assert Surface(-5.0, 0.0, AIR, 5.0).sag(3.0) == pytest.approx(-1.0, rel=1e-15)
    assert Surface(5.0, 0.0, AIR, 5.0).sag(5.0) == 5.0
    assert Surface(math.inf, 0.0, AIR, 5.0).sag(3.0) == 0.0
    assert Surface(-math.inf, 0.0, AIR, 5.0).radius == math.inf


def test_reversed_twice_is_the_lens():
    for system in (double_gauss(), singlet(), doublet()):
        back = system.reversed()
        assert back.surfaces[0].radius in (-system.surfaces[-1].radius, math.inf)
        assert [s.glass for s in back.surfaces] == [*(s.glass for s in system.surfaces[:-1][::-1]), AIR]
        assert back.vertices == pytest.approx(system.vertices[-1] - system.vertices[::-1])
        last = replace(system.surfaces[-1], thickness=0.0)
        assert back.reversed() == replace(system, surfaces=(*system.surfaces[:-1], last))


def test_stopping_down_changes_the_stop_only():
    system = double_gauss().with_stop(3.0)
    assert system.surfaces[5].semi_diameter == 3.0
    assert [s for s in system.surfaces if not s.is_stop] == [s for s in double_gauss().surfaces if not s.is_stop]


def test_thick_lens_is_two_surfaces():
    front, back = ThickLens(60.0, -80.0, 6.0, 25.0, GLASS).system().surfaces
    assert front == Surface(60.0, 6.0, GLASS, 12.5, is_stop=True)
    assert replace(back, thickness=0.0) == Surface(-80.0, 0.0, AIR, 12.5)
    # By hand: 0.5 (1/60 + 1/80 - 2/4800) = 0.014375, and (1 - 2/60) / 0.014375 = 67.2464 mm behind the back.
    assert back.thickness == pytest.approx(67.2464, abs=5e-5)
    assert ThickLens(-60.0, 80.0, 6.0, 25.0, GLASS).system().surfaces[1].thickness == 0.0  # it has no real image


@pytest.mark.parametrize(
    ("words", "start"),
    [
        ({"radius": 0.0}, "radius: got 0; "),
        ({"radius": math.nan}, "radius: got nan"),
        ({"radius": 9.0}, "semi_diameter: got 10; allowed is at most the surface's radius 9"),
        ({"thickness": -1.0}, "thickness: got -1"),
        ({"thickness": math.inf}, "thickness: got inf"),
        ({"glass": "N-BK7"}, "glass: got str"),
        ({"glass": None}, "glass: got NoneType"),
        ({"semi_diameter": 0.0}, "semi_diameter: got 0"),
        ({"is_stop": "yes"}, "is_stop: got 'yes'"),
    ],
)
def test_bad_surface(words, start):
    with pytest.raises(InputError, match=f"^{start}"):
        replace(FRONT, **words)


@pytest.mark.parametrize(
    ("surfaces", "start"),
    [
        ((), "surfaces: got 0 surfaces"),
        ((FRONT,) * 101, "surfaces: got 101 surfaces"),
        (5, "surfaces: got 5"),
        ((FRONT, "lens"), r"surfaces\[1\]: got str"),
        ((replace(FRONT, is_stop=False), BACK), "surfaces: got 0 stops"),
        ((FRONT, replace(BACK, is_stop=True)), "surfaces: got 2 stops"),
        ((FRONT,), "surfaces: got plain behind the last one; allowed is air"),
        ((replace(FRONT, thickness=2.0), BACK), "surfaces: surface 1 cuts surface 2"),
    ],
)
def test_bad_system(surfaces, start):
    with pytest.raises(InputError, match=f"^{start}"):
        LensSystem("bad", surfaces)


def test_surfaces_may_touch_at_the_rim():
    # Two spheres of radius 5 whose sags at height 3 are 1 and -1 touch there at a thickness of 2.
    rim = [Surface(5.0, 2.0, GLASS, 3.0, is_stop=True), Surface(-5.0, 1.0, AIR, 3.0)]
    assert np.isclose(LensSystem("touching", tuple(rim)).sensor, 3.0)


@pytest.mark.parametrize(
    ("words", "start"),
    [
        ({"radius1": 12.0}, "radius1: got 12"),
        ({"radius2": 0.0}, "radius2: got 0"),
        ({"thickness": 2.0}, "thickness: got 2; allowed is at least"),
        ({"diameter": -1.0}, "diameter: got -1"),
        ({"glass": 1.5}, "glass: got float"),
    ],
)
def test_bad_thick_lens(words, start):
    with pytest.raises(InputError, match=f"^{start}"):
        replace(ThickLens(60.0, -80.0, 6.0, 25.0, GLASS), **words)

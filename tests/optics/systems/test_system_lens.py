"""A lens system on a camera, without rendering: its thin lens, its field of view, its f-number, bad input."""

import math
from dataclasses import replace

import numpy as np
import pytest

from refdof import Camera, InputError, ThinLens
from refdof.optics.systems.glass import Glass, glass_of
from refdof.optics.systems.system import ThickLens
from refdof.optics.systems.system_lens import SystemLens
from tests.optics.systems.lenses import double_gauss

CAMERA = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), size=(60, 40))
pytestmark = pytest.mark.fast


def test_it_is_the_thin_lens_of_its_pupil():
    lens = SystemLens(double_gauss(), 2.0)
    assert isinstance(lens, ThinLens)
    # 50.358 mm and f/2.03 are figures of other programs for this lens.
    assert lens.radius == pytest.approx(0.050358 / 2.03 / 2.0, rel=2e-3)
    assert SystemLens(double_gauss(), 2.0, 5.6).radius == pytest.approx(0.050358 / 5.6 / 2.0, rel=1e-4)
    assert SystemLens(double_gauss(), 2.0, mm_per_unit=500.0).radius == pytest.approx(2.0 * lens.radius, rel=1e-12)


def test_a_rounded_f_number_is_the_whole_lens():
    assert SystemLens(double_gauss(), 2.0, 2.0).radius == SystemLens(double_gauss(), 2.0).radius
    with pytest.raises(InputError, match=r"f_number: got 1\.8; allowed is at least the lens's own, 2\.03"):
        SystemLens(double_gauss(), 2.0, 1.8)


def test_field_of_view_breathes_with_focus():
    """Film of 36 mm width: 39.34 degrees at infinity, 37.50 at 1 m and 35.64 at 0.5 m from the film, about."""
    wide = [SystemLens(double_gauss(), focus).seen_by(CAMERA) for focus in (math.inf, 1.0, 0.5)]
    angles = [math.degrees(2.0 * math.atan(math.tan(math.radians(camera.fov_y) / 2.0) * 1.5)) for camera in wide]
    assert angles[0] == pytest.approx(39.34, abs=0.01)  # 2 atan(18 / 50.358)
    assert angles[0] > angles[1] > angles[2]
    assert angles[1] == pytest.approx(37.50, abs=0.3)  # distances from pupil and film differ by 5 to 10 %
    assert angles[2] == pytest.approx(35.64, abs=0.6)


def test_a_field_can_be_replaced():
    lens = SystemLens(double_gauss(), 2.0, 4.0)
    assert replace(lens, focus_distance=3.0).radius == lens.radius
    assert replace(lens, f_number=None).radius == SystemLens(double_gauss(), 2.0).radius


def test_one_wavelength_is_enough_for_glass_without_dispersion():
    plain = ThickLens(50.0, -50.0, 2.0, 4.0, Glass("plain", 1.5)).system()
    crown = ThickLens(50.0, -50.0, 2.0, 4.0, glass_of("N-BK7")).system()
    for count in (3, 7):
        assert not SystemLens(plain, 2.0, wavelengths=count)._disperses()
        assert SystemLens(crown, 2.0, wavelengths=count)._disperses()


def test_wavelengths_and_vignetting_change_no_thin_lens():
    plain, other = SystemLens(double_gauss(), 2.0), SystemLens(double_gauss(), 2.0, wavelengths=15, vignetting=False)
    assert (plain.wavelengths, plain.vignetting) == (3, True)
    assert (other.radius, other.seen_by(CAMERA)) == (plain.radius, plain.seen_by(CAMERA))
    again = replace(other, wavelengths=3, vignetting=True)
    assert (again.wavelengths, again.vignetting, again.stopped) == (3, True, plain.stopped)


def test_glass_that_is_opaque_to_violet_light_is_refused():
    """Sellmeier's resonance at 0.42 um: beyond it there is no index, and the shortest of 15 wavelengths is 0.41 um."""
    opaque = ThickLens(50.0, -50.0, 2.0, 4.0, Glass("opaque", b=(1.2,), c=(0.42**2,))).system()
    assert SystemLens(opaque, 2.0).wavelengths == 3
    with pytest.raises(InputError, match=r"wavelength_um: got 0\.41; allowed is one at which opaque is transparent"):
        SystemLens(opaque, 2.0, wavelengths=15)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"system": 3}, "system: "),
        ({"focus_distance": 0.01}, r"focus_distance: got 0\.01; allowed is more than .* scene units of 1000 mm"),
        ({"focus_distance": -1.0}, "focus_distance: "),
        ({"focus_distance": np.nan}, "focus_distance: "),
        ({"mm_per_unit": 0.0}, "mm_per_unit: "),
        ({"f_number": -2.0}, "f_number: "),
        ({"wavelengths": 2}, "wavelengths: got 2; allowed "),
        ({"wavelengths": 32}, "wavelengths: got 32; allowed "),
        ({"wavelengths": 7.5}, "wavelengths: "),
        ({"vignetting": 1}, "vignetting: "),
    ],
)
def test_bad_input(change, words):
    with pytest.raises(InputError, match=words):
        SystemLens(**{"system": double_gauss(), "focus_distance": 2.0, **change})

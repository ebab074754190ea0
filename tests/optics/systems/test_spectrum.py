"""The eye's response and the weights of wavelengths, beside the CIE's table and the textbook's matrix."""

import numpy as np
import pytest

from refdof import InputError
from refdof.optics.systems.spectrum import add_wave, channel_weights, color_matching, wavelengths_of

pytestmark = pytest.mark.fast

# CIE 1931, 2 degrees, from 400 to 700 nm in steps of 10 nm, as CIE 15 prints it: x, y, z.
CIE = np.array([
    [0.01431, 0.000396, 0.06785], [0.04351, 0.00121, 0.2074], [0.13438, 0.004, 0.6456], [0.2839, 0.0116, 1.3856],
    [0.34828, 0.023, 1.74706], [0.3362, 0.038, 1.77211], [0.2908, 0.06, 1.6692], [0.19536, 0.09098, 1.28764],
    [0.09564, 0.13902, 0.81295], [0.03201, 0.20802, 0.46518], [0.0049, 0.323, 0.272], [0.0093, 0.503, 0.1582],
    [0.06327, 0.71, 0.07825], [0.1655, 0.862, 0.04216], [0.2904, 0.954, 0.0203], [0.43345, 0.99495, 0.00875],
    [0.5945, 0.995, 0.0039], [0.7621, 0.952, 0.0021], [0.9163, 0.87, 0.00165], [1.0263, 0.757, 0.0011],
    [1.0622, 0.631, 0.0008], [1.0026, 0.503, 0.00034], [0.85445, 0.381, 0.00019], [0.6424, 0.265, 0.00005],
    [0.4479, 0.175, 0.00002], [0.2835, 0.107, 0.0], [0.1649, 0.061, 0.0], [0.0874, 0.032, 0.0], [0.04677, 0.017, 0.0],
    [0.0227, 0.00821, 0.0], [0.011359, 0.004102, 0.0],
])  # fmt: skip
# Linear sRGB, whose primaries are Rec.709's, from XYZ: IEC 61966-2-1.
RGB_OF_XYZ = np.array([[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]])


def weights_of_the_table():
    """Those of 15 wavelengths, which are at 410, 430 .. 690 nm: at every second row of the table."""
    linear = CIE[1::2] @ RGB_OF_XYZ.T
    return linear / linear.sum(axis=0)


def test_color_matching_is_the_tables():
    found = np.array([color_matching(nm / 1000.0) for nm in range(400, 701, 10)])
    assert np.abs(found - CIE).max() < 0.015  # as the fit's docstring says; its largest value is 1.78
    # The table's sums over 360 to 830 nm in steps of 1 nm are all 106.86 to 106.89; half a percent is the fit's.
    whole = np.array([color_matching(nm / 1000.0) for nm in range(360, 831)]).sum(axis=0)
    assert whole == pytest.approx([106.87] * 3, rel=5e-3)
    seen = np.array([color_matching(nm / 1000.0) for nm in range(400, 701)]).sum(axis=0)
    assert (seen / whole > 0.994).all()


def test_wavelengths_are_midpoints():
    assert wavelengths_of(3) == (0.650, 0.510, 0.475)
    assert wavelengths_of(15) == pytest.approx(np.arange(0.410, 0.700, 0.02), abs=1e-15)
    assert wavelengths_of(4) == pytest.approx([0.4375, 0.5125, 0.5875, 0.6625], abs=1e-15)
    for count in (2, 0, 32, 7.5, None):
        with pytest.raises(InputError, match=r"^wavelengths: got"):
            wavelengths_of(count)


def test_weights_are_those_of_the_table_and_the_matrix():
    found, wanted = channel_weights(15), weights_of_the_table()
    # 0.015 of the fit, times the matrix's row of up to 5.3 in all, over a sum of 15 responses of about 6.
    assert np.abs(found - wanted).max() < 0.013
    assert np.abs(found - wanted).mean() < 0.003
    assert found.min() < -0.1  # bluish green light has less red than none


@pytest.mark.parametrize("count", [1, 3, 4, 5, 7, 15, 31])
def test_white_is_white(count):
    weights = channel_weights(count)
    assert weights.shape == (count, 3)
    assert weights.sum(axis=0) == pytest.approx([1.0] * 3, abs=1e-15)
    assert np.abs(weights).sum(axis=0).max() < 2.0  # noise is not blown up


def test_three_wavelengths_are_one_a_channel_and_one_is_all():
    picture = np.array([[0.2, 0.4, 0.8], [np.inf, 0.1, 0.3]])
    for count, wanted in ((3, [0.0, 0.4, 0.0]), (1, [0.2, 0.4, 0.8])):
        total = np.zeros((2, 3))
        add_wave(total, channel_weights(count)[count // 2], picture)
        assert total[0].tolist() == wanted
        assert np.isfinite(total[1, 1:]).all()  # what is too bright in one channel stays there

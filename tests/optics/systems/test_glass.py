"""Refractive indices against what makers and papers print."""

import math

import pytest

from refdof._check import InputError
from refdof.optics.systems.glass import AIR, GLASSES, LINE_C, LINE_D, LINE_F, Glass, glass_of

pytestmark = pytest.mark.fast

# n_d (five digits) and V_d (two digits) as the catalogues print them, which the coefficients were not made from.
PRINTED = {
    "N-BK7": (1.51680, 64.17), "N-K5": (1.52249, 59.48), "N-BAK4": (1.56883, 55.98), "N-BAF10": (1.67003, 47.11),
    "N-SK2": (1.60738, 56.65), "N-SK16": (1.62041, 60.32), "N-SSK8": (1.61773, 49.83), "N-LAK9": (1.69100, 54.71),
    "N-LAK22": (1.65113, 55.89), "N-FK51A": (1.48656, 84.47), "F2": (1.62004, 36.37), "N-F2": (1.62005, 36.43),
    "SF2": (1.64769, 33.85), "N-SF2": (1.64769, 33.82), "N-SF5": (1.67271, 32.25), "N-SF6": (1.80518, 25.36),
    "N-SF10": (1.72828, 28.53), "N-SF11": (1.78472, 25.68), "fused silica": (1.45846, 67.82),
    "calcium fluoride": (1.43385, 95.0),
}  # fmt: skip


@pytest.mark.parametrize("name", PRINTED)
def test_catalogues(name):
    n_d, v_d = PRINTED[name]
    glass = glass_of(name)
    assert glass.index(LINE_D) == pytest.approx(n_d, abs=5.1e-6)  # the last digit is rounded
    assert glass.abbe_number() == pytest.approx(v_d, abs=5.1e-3 if "-" in name else 0.02)  # Malitson's differ in it


def test_every_glass_is_tested():
    assert set(GLASSES) == {*PRINTED, "air", "paper-BK7"}
    assert all(glass.source for glass in GLASSES.values() if glass is not AIR)


def test_bk7_to_six_digits():
    assert glass_of("N-BK7").index(LINE_D) == pytest.approx(1.516800, abs=5e-7)


def test_the_papers_rounded_glass():
    """Sellmeier's equation by hand at the paper's wavelengths for R, G, B; five digits are written out."""
    found = [glass_of("paper-BK7").index(wavelength) for wavelength in (0.650, 0.510, 0.475)]
    assert found == pytest.approx([1.51438, 1.52063, 1.52307], abs=5.1e-6)


def test_abbe_form_keeps_both_numbers():
    glass = Glass("crown", 1.6, 50.0)
    assert glass.index(LINE_D) == 1.6
    assert glass.index(LINE_F) - glass.index(LINE_C) == pytest.approx(0.6 / 50.0, rel=1e-13)  # a few roundings
    assert glass.index(0.45) > glass.index(LINE_F)


def test_plain_index_has_no_dispersion():
    glass = Glass("plain", 1.67)
    assert glass.index(0.4) == glass.index(0.7) == 1.67
    assert math.isinf(glass.abbe_number())
    assert AIR.index(0.5) == 1.0


@pytest.mark.parametrize(
    ("words", "start"),
    [
        ({}, "n_d: got None with 0"),
        ({"n_d": 1.5, "b": (1.0,), "c": (0.01,)}, "n_d: got 1.5 with 1"),
        ({"n_d": 0.9}, "n_d: got 0.9"),
        ({"n_d": math.nan}, "n_d: got nan"),
        ({"n_d": 1.5, "v_d": 0.0}, "v_d: got 0"),
        ({"b": (1.0,), "c": ()}, "c: got 0 numbers"),
        ({"b": (1.0,), "c": ("x",)}, r"c\[0\]: got 'x'"),
        ({"b": (1.0,), "c": (0.01,), "v_d": 30.0}, "v_d: got 30"),
    ],
)
def test_bad_glass(words, start):
    with pytest.raises(InputError, match=f"^{start}"):
        Glass("bad", **words)


def test_up_to_six_coefficients():
    # Six equal terms: n^2 = 1 + 6 b / (1 - c) at 1 um.
    assert Glass("six", b=(0.2,) * 6, c=(0.01,) * 6).index(1.0) == pytest.approx(math.sqrt(1.0 + 1.2 / 0.99), rel=1e-14)
    with pytest.raises(InputError, match=r"^b: got tuple; allowed is a list of up to 6 numbers"):
        Glass("seven", b=(0.2,) * 7, c=(0.01,) * 7)


def test_bad_names_and_wavelengths():
    with pytest.raises(InputError, match=r"^glass: got 'BK7'; did you mean 'N-BK7'"):
        glass_of("BK7")
    for wavelength in (0.0, 550.0, math.nan, "blue"):
        with pytest.raises(InputError, match=r"^wavelength_um: got"):
            AIR.index(wavelength)
    with pytest.raises(InputError, match="transparent"):
        Glass("opaque", b=(1.0,), c=(0.36,)).index(0.5)
    with pytest.raises(InputError, match="transparent"):
        Glass("at its resonance", b=(1.0,), c=(0.25,)).index(0.5)

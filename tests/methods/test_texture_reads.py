"""Texture reads: the sums of table 1 in Lee, Kim and Choi (2009), and what `refdof methods` makes of them."""

import math
from dataclasses import replace

import pytest

from refdof import METHODS, InputError
from refdof.methods import mipmap, poisson, pyramidal, separable, singlepass
from refdof.methods._contract import facts_of, level_shares

pytestmark = pytest.mark.fast

SIDE = 1024  # table 1's picture; its circles are at most 16 px wide, 8 px in the mean


def units(module):
    return module.METHOD.reads_per_pixel(SIDE, SIDE)


def test_mipmap_makes_the_printed_20_98():
    # 2 x 9 (1/2^2 + 1/4^2 + 1/8^2 + 1/16^2) + 6 + 9, exact in binary.
    assert units(mipmap) == 18 * (1 / 4 + 1 / 16 + 1 / 64 + 1 / 256) + 15
    assert f"{units(mipmap):.2f}" == "20.98"


def test_poisson_makes_the_24_56_of_its_real_size():
    assert units(poisson) == 9 / 16 + 12 + 12
    assert f"{units(poisson):.2f}" == "24.56"


def test_poisson_makes_the_printed_24_04_of_the_printed_size():
    # Table 1 has 24.04, its text 24.03, for 9 / 16^2 + 24 = 24.035: rounded and cut.
    assert math.ceil(100 * poisson.method._units(1 / 16**2)) / 100 == 24.04


def test_separable_makes_the_printed_27():
    assert units(separable) == 27.0


def test_pyramidal_makes_172_75_of_the_printed_terms():
    shares = [4.0**-k for k in range(5)]
    eight = 8 * pyramidal.method._units(shares, shares)
    # 8 + 8 (4 + 16)(1/4 + 1/16 + 1/64 + 1/256) + 8 (5 + 4)(1 + 1/4 + 1/16 + 1/64) + 8 + 8, exact in binary.
    assert eight == 172.75
    # The printed 173.02 has a fifth term in the second sum, 1 / 16^2, and both sums rounded to three digits.
    assert round(24 + 160 * 0.332 + 72 * 1.332, 2) == 173.02
    assert sum(shares[1:]) == pytest.approx(0.332, abs=5e-4)
    assert sum(shares) == pytest.approx(1.332, abs=5e-4)


def test_pyramidal_counts_its_own_sub_images():
    # 8 px need three sub-images on each side, up to 1.5 * 1.7 * 2^2 = 10.2 px; 1024 px need ten levels to fill.
    fill = 4 * sum(4.0**-k for k in range(1, 11)) + 5 * sum(4.0**-k for k in range(10))
    blur = [16 * sum(4.0**-k for k in range(1, n + 1)) + 4 * sum(4.0**-k for k in range(n)) for n in (0, 1, 2, 3)]
    assert units(pyramidal) == pytest.approx(7 * (3 + fill) + 2 * sum(blur) - blur[0], rel=1e-14)


def test_single_pass_reads_colour_and_depth_at_398_taps():
    assert units(singlepass) == 796.0


def test_levels_of_odd_sizes_are_rounded_down():
    assert level_shares(7, 5, 2) == [3 * 2 / 35, 1 / 35]


@pytest.mark.parametrize("name", METHODS)
def test_facts_of_every_method(name):
    facts = facts_of(METHODS[name].METHOD, 640, 480)
    assert facts["source"]
    assert facts["texture_reads_per_pixel"] is None or facts["texture_reads_per_pixel"] >= 0
    assert facts["params"] == vars(METHODS[name].Params())
    assert METHODS[name].METHOD.reads_in_words(640, 480)


def test_facts_in_words():
    assert METHODS["accumulation"].METHOD.reads_in_words(64, 48) == "no textures"
    assert METHODS["separable"].METHOD.reads_in_words(64, 48) == "27.00 texture reads per pixel"
    assert METHODS["separable"].METHOD.origin == "after Zhou, Chen, Pullen 2007 (reconstruction)"
    assert METHODS["mipmap"].METHOD.origin == "Lee, Kim, Choi 2009"


def test_a_method_without_a_count_depends_on_the_scene():
    record = replace(METHODS["separable"].METHOD, texture_reads=None)
    assert facts_of(record, 64, 48)["texture_reads_per_pixel"] is None
    assert record.reads_in_words(64, 48) == "reads depend on the scene"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ({"kind": "single imag"}, "kind: got 'single imag'; did you mean 'single image'"),
        ({"promises": ("constant", "pinhol")}, "promises: got 'pinhol'; did you mean 'pinhole'"),
        ({"paper": {"leakag": 1.0}}, "paper: got 'leakag'; did you mean 'leakage'"),
    ],
)
def test_a_record_names_what_does_not_exist(words, message):
    with pytest.raises(InputError, match=message):
        replace(METHODS["separable"].METHOD, **words)

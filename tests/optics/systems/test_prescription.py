"""Prescriptions: what the readers of three formats make of good files, and the round trip of lens.toml."""

import math

import pytest

from refdof import InputError
from refdof.optics.systems.glass import AIR, LINE_D, Glass, glass_of
from refdof.optics.systems.lens_toml import lens_text, parse_toml
from refdof.optics.systems.prescription import LENSES, load_lens, save_lens
from refdof.optics.systems.system import LensSystem, Surface
from tests.optics.systems.lenses import DOUBLE_GAUSS_ROWS

pytestmark = pytest.mark.fast

PBRT = "# A double Gauss\n# radius thickness index diameter\n" + "".join(
    f"{radius}\t{thickness}\t{0 if radius == 0 else index} {diameter}\n"
    for radius, thickness, index, diameter in DOUBLE_GAUSS_ROWS
)

# Written for these tests, in the keywords and the order of Zemax: a cemented doublet behind its stop, in centimetres.
ZEMAX = """\
VERS 140730 195 26155
MODE SEQ
NAME A doublet
NOTE 0 Made for a test.
UNIT CM X W X CM MR CPMM
GCAT SCHOTT
WAVM 1 5.875618E-1 1
SURF 0
  TYPE STANDARD
  CURV 0.0 0 0 0 0 ""
  DISZ INFINITY
  DIAM 0 0 0 0 1 ""
SURF 1
  COMM a plane that does nothing
  TYPE STANDARD
  CURV 0.0 0 0 0 0 ""
  DISZ 1.0
  DIAM 0.2 0 0 0 1 ""
SURF 2
  STOP
  TYPE STANDARD
  CURV 0.0 0 0 0 0 ""
  DISZ 0.1
  DIAM 0.5 0 0 0 1 ""
SURF 3
  TYPE STANDARD
  CURV 0.0 0 0 0 0 ""
  DISZ 0.1
  DIAM 0.0 0 0 0 1 ""
SURF 4
  TYPE STANDARD
  CURV 1.25E-1 0 0 0 0 ""
  DISZ 0.6
  GLAS n-bk7 0 0 1.5 40.0 0 0 0 0 0 0
  DIAM 1.25 1 0 0 1 ""
SURF 5
  TYPE STANDARD
  CURV -2.5E-1 0 0 0 0 ""
  DISZ 0.2
  GLAS X-99 0 0 1.62 36.5 0 0 0 0 0 0
  DIAM 1.25 1 0 0 1 ""
SURF 6
  TYPE STANDARD
  CURV 0.0 0 0 0 0 ""
  DISZ 5.0
  DIAM 1.25 1 0 0 1 ""
  CLAP 0 1.2 0
SURF 7
  TYPE STANDARD
  CURV 0.0 0 0 0 0 ""
  DISZ 3.0
  DIAM 1.25 1 0 0 1 ""
SURF 8
  TYPE STANDARD
  CURV 0.0 0 0 0 0 ""
  DISZ 0
  DIAM 2.0 0 0 0 1 ""
MNUM 1 1
"""


def test_a_pbrt_file_has_the_numbers_of_its_columns(tmp_path):
    path = tmp_path / "gauss.dat"
    path.write_text(PBRT)
    system = load_lens(path)
    assert system.name == "gauss"
    assert system.source == "A double Gauss; radius thickness index diameter"
    assert system.stop == 5
    for surface, (radius, thickness, index, diameter) in zip(system.surfaces, DOUBLE_GAUSS_ROWS, strict=True):
        assert surface.radius == (math.inf if radius == 0.0 else radius)
        assert surface.thickness == thickness
        assert surface.glass.index(0.45) == index  # no dispersion
        assert surface.semi_diameter == diameter / 2.0


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_a_zemax_file_is_read_in_every_encoding_that_is_written(tmp_path, encoding):
    path = tmp_path / "doublet.ZMX"
    path.write_bytes(ZEMAX.replace("A doublet", "A doublet Ø25 mm").replace("\n", "\r\n").encode(encoding))
    system = load_lens(path)
    assert system.name == "A doublet Ø25 mm"
    assert system.source == "Made for a test."
    # In millimetres; planes in air that are not the stop are gone, and their thickness is the neighbour's.
    expected = [
        (math.inf, 2.0, AIR, 5.0),
        (80.0, 6.0, glass_of("N-BK7"), 12.5),
        (-40.0, 2.0, Glass("[1.62, 36.5]", 1.62, 36.5), 12.5),
        (math.inf, 80.0, AIR, 12.0),  # the clear radius of CLAP
    ]
    assert system.stop == 0
    for surface, (radius, thickness, glass, semi_diameter) in zip(system.surfaces, expected, strict=True):
        assert surface.radius == radius
        assert surface.thickness == pytest.approx(thickness, rel=1e-15)
        assert surface.glass == glass
        assert surface.semi_diameter == pytest.approx(semi_diameter, rel=1e-15)


def test_a_toml_file_says_what_it_says():
    text = """
        name = "Two lenses"
        source = "made for a test"
        unit = "mm"
        surface = [
            {radius = 40, thickness = 3, glass = "N-BK7", diameter = 20},
            {radius = 0, thickness = 5.5, glass = "air", diameter = 18},
            {radius = inf, thickness = 1, glass = 1, diameter = 10, stop = true},
            {radius = 30.0, thickness = 2, glass = [1.62, 36.0], diameter = 15},
            {radius = -inf, thickness = 25, glass = 1.0, diameter = 15, stop = false},
        ]
    """
    system = parse_toml("two.toml", text)
    glasses = [glass_of("N-BK7"), AIR, AIR, Glass("[1.62, 36]", 1.62, 36.0), AIR]
    assert system.name == "Two lenses"
    assert [surface.radius for surface in system.surfaces] == [40.0, math.inf, math.inf, 30.0, math.inf]
    assert [surface.thickness for surface in system.surfaces] == [3.0, 5.5, 1.0, 2.0, 25.0]
    assert [surface.semi_diameter for surface in system.surfaces] == [10.0, 9.0, 5.0, 7.5, 7.5]
    assert [surface.glass for surface in system.surfaces] == glasses
    assert system.stop == 2


def test_a_last_thickness_of_0_is_the_back_focal_distance():
    text = PBRT.replace("36.0", "0")
    from refdof.optics.systems.pbrt_file import parse_pbrt

    assert parse_pbrt("x.dat", text, "x").surfaces[-1].thickness == pytest.approx(36.10590, abs=1e-5)  # by hand


@pytest.mark.parametrize("name", LENSES)
def test_what_is_written_is_read_again(tmp_path, name):
    system = load_lens(name)
    path = tmp_path / "new" / "lens.toml"
    save_lens(path, system)
    assert load_lens(path) == system
    assert load_lens(str(path)) == system


def test_odd_words_and_numbers_survive_the_round_trip(tmp_path):
    surfaces = (
        Surface(1e3 / 7.0, 1e-7, Glass("1.5", 1.5), 1e-5, True),
        Surface(-math.pi * 1e9, 1.0 / 3.0, AIR, 2e-5),
    )
    system = LensSystem('a "name" \\ with\ttabs, \n lines, \x7f and \N{GREEK SMALL LETTER LAMDA}', surfaces, "'")
    save_lens(tmp_path / "lens.toml", system)
    assert load_lens(tmp_path / "lens.toml") == system


def test_a_glass_without_a_form_is_not_written():
    own = Glass("own", b=(1.0,), c=(0.01,))
    system = LensSystem("own", (Surface(50.0, 2.0, own, 5.0, True), Surface(-50.0, 40.0, AIR, 5.0)), "test")
    with pytest.raises(InputError, match=r"^glass: got 'own'"):
        lens_text(system)


def test_saving_to_another_suffix_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"allowed is a name that ends in \.toml"):
        save_lens(tmp_path / "lens.dat", load_lens("biconvex"))


def test_every_lens_names_its_source_and_has_air_at_its_ends():
    assert set(LENSES) >= {
        "biconvex",
        "achromat",
        "cooke_triplet",
        "double_gauss",
        "petzval",
        "telephoto",
        "wide_angle",
    }
    for name in LENSES:
        system = load_lens(name)
        assert system.source.strip()
        assert system.surfaces[-1].glass.index(LINE_D) == 1.0

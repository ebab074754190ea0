"""Bad lens files: one line that names the file and what is wrong, whatever the file holds."""

import re
import time

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from refdof import InputError
from refdof.optics.systems.lens_toml import lens_text
from refdof.optics.systems.prescription import MOST_BYTES, load_lens
from refdof.optics.systems.system import LensSystem
from tests.optics.systems.test_prescription import PBRT, ZEMAX

pytestmark = pytest.mark.fast

TOML = lens_text(load_lens("double_gauss"))
GOOD = {".toml": TOML, ".dat": PBRT, ".zmx": ZEMAX}

# Suffix, what is replaced (a regular expression behind re:), by what, and what the message says.
FAULTS = [
    # Numbers.
    (".toml", "radius = 29.475", "radius = 'wide'", "surface 1: radius: got 'wide'; allowed is a number"),
    (".toml", "radius = 29.475", "radius = nan", "surface 1: radius: got nan"),
    (".toml", "thickness = 3.76", "thickness = inf", "surface 1: thickness: got inf"),
    (".toml", "thickness = 3.76", "thickness = -3.76", "surface 1: thickness: got -3.76"),
    (".toml", "thickness = 3.76", f"thickness = {'9' * 5000}", "lens.toml"),
    (".toml", "diameter = 25.2", "diameter = -25.2", "surface 1: diameter: got -25.2; allowed is a finite number > 0"),
    (".toml", "diameter = 25.2", "diameter = true", "surface 1: diameter: got True"),
    (".toml", "diameter = 17.1", "diameter = 0", "surface 6: diameter of the stop: got 0; allowed is a finite number"),
    (".toml", "stop = true", "stop = 1", "surface 6: stop: got 1; allowed are True and False"),
    (".dat", "29.475", "29,475", "line 3: radius: got '29,475'"),
    (".dat", "29.475", "29_475", "line 3: radius"),
    (".dat", "25.2", "-25.2", "line 3: diameter: got -25.2"),
    (".dat", "17.1", "0", "line 8: diameter of the stop: got 0"),
    (".zmx", "CURV 1.25E-1", "CURV one", "SURF 4: CURV: got 'one'"),
    (".zmx", "DISZ 0.6", "DISZ INFINITY", "SURF 4: DISZ: got inf"),
    (".zmx", "DISZ 0.6", "DISZ -0.6", "SURF 4: thickness: got -6"),
    (".zmx", "DIAM 0.5", "DIAM 0", "SURF 2: diameter of the stop: got 0"),
    (".zmx", "DIAM 1.25", "DIAM -1.25", "SURF 4: diameter: got -25"),
    # Glass.
    (".toml", "glass = [1.67, 47.1]", 'glass = "N-BK8"', "surface 1: glass: got 'N-BK8'; did you mean 'N-BK7'"),
    (".toml", "glass = [1.67, 47.1]", "glass = 0.9", "surface 1: glass: n_d: got 0.9"),
    (".toml", "glass = [1.67, 47.1]", "glass = [1.67, 0]", "surface 1: glass: V_d: got 0"),
    (".toml", "glass = [1.67, 47.1]", "glass = [1.67, 1e-9]", "surface 1: glass: V_d: got 1e-09; allowed is a finite"),
    (".toml", "glass = [1.67, 47.1]", "glass = [1.67]", "surface 1: glass: got a list; allowed is a name, an index or"),
    (".toml", "glass = [1.67, 47.1]\n", "", "surface 1: glass: missing; needed are radius, thickness, glass, diameter"),
    (".toml", r"re:glass = \[.*\]", "glass = 'air'", "lens.toml: got no glass; allowed is a lens with one"),
    (".dat", r"re:\b1\.[67]\d*", "1.0", "lens.dat: got no glass"),
    (".zmx", "n-bk7 0 0 1.5", "N-BK8 0 0 1.5", "SURF 4: glass: got 'N-BK8'; did you mean 'N-BK7'"),
    (".zmx", "n-bk7 0 0 1.5 40.0 0 0 0 0 0 0", "", "SURF 4: GLAS: got no name"),
    # Surfaces.
    (".toml", "thickness = 5.705", "thickness = 0.5", "surface 5 cuts surface 6"),
    (".toml", "diameter = 18.0", "diameter = 26.0", "surface 5: diameter: got 26; allowed is at most that of the sph"),
    (".toml", "stop = true\n", "", "surfaces: got 0 stops; allowed is exactly one"),
    (".toml", "diameter = 25.2\n", "diameter = 25.2\nstop = true\n", "surfaces: got 3 stops"),
    (".dat", "40.77", "0", "line 6: index: got 1.699 at radius 0, which is the stop"),
    (".dat", "-39.73\t36.0\t1.0", "-39.73\t36.0\t1.5", "got 1.5 behind the last one; allowed is air"),
    # Keys and columns.
    (".toml", "radius = 29.475", "raduis = 29.475", "surface 1: 'raduis': unknown; did you mean 'radius'"),
    (".toml", "unit =", "units =", "lens.toml: 'units': unknown; did you mean 'unit'"),
    (".toml", 'unit = "mm"', 'unit = "inch"', "lens.toml: unit: got 'inch'; allowed is 'mm'"),
    (".toml", 'unit = "mm"', "unit = 1", "lens.toml: unit: got 1; allowed is 'mm'"),
    (".toml", 're:name = ".*"', "name = ' '", "lens.toml: name: got ' '; allowed is a sentence"),
    (".toml", "[[surface]]", "[surface]", "lens.toml: got "),
    (".dat", "29.475\t3.76", "29.475", "line 3: got 3 columns; allowed are 4: radius, thickness, index, diameter"),
    (".dat", "25.2", "25.2 1", "line 3: got 5 columns"),
    (".dat", "1.67 25.2", "25.2 1.67", "line 3: index: got 25.2; allowed is 1 to 4, and 0 at the stop"),
    (".dat", "29.475\t3.76\t1.67", "29.475\t0\t1.67", "line 3: thickness: got 0 in front of the first glass"),
    # What Zemax has and a lens of spheres has not.
    (".zmx", "TYPE STANDARD\n  CURV 1.25", "TYPE EVENASPH\n  CURV 1.25", "SURF 4: TYPE EVENASPH: an even asphere"),
    (".zmx", "TYPE STANDARD\n  CURV 1.25", "TYPE COORDBRK\n  CURV 1.25", "SURF 4: TYPE COORDBRK: a coordinate break"),
    (".zmx", "TYPE STANDARD\n  CURV 1.25", "TYPE GRID\n  CURV 1.25", "SURF 4: TYPE GRID: another kind of surface"),
    (".zmx", "GLAS n-bk7", "GLAS MIRROR", "SURF 4: GLAS MIRROR: a mirror is not supported"),
    (".zmx", "DISZ 0.6", "DISZ 0.6\n  CONI -1.0", "SURF 4: CONI: got -1.0, a conic asphere"),
    (".zmx", "DISZ 0.6", "DISZ 0.6\n  OBSC 0 0.1", "SURF 4: OBSC: an aperture that is not a disc"),
    (".zmx", "CLAP 0", "CLAP 0.3", "SURF 6: CLAP: a ring as an aperture"),
    (".zmx", "MODE SEQ", "MODE NSC", "lens.zmx: MODE NSC is not supported; allowed is SEQ"),
    (".zmx", "MNUM 1", "MNUM 3", "lens.zmx: MNUM: several configurations"),
    (".zmx", "UNIT CM", "UNIT FT", "lens.zmx: UNIT: got 'FT'; allowed are MM, CM, IN, METER"),
    (".zmx", "SURF 4", "SURF 5", "lens.zmx: SURF: got numbers out of order"),
    (".zmx", "SURF 4", "SURF 1000000000", "lens.zmx: SURF: got '1000000000'"),
    (".zmx", 're:(?s)SURF 8.*DIAM 2.0', "SURF 8\n  CURV 0.1\n  DIAM 2.0", "SURF 8: a curved sensor"),
    (".zmx", "re:(?s)SURF 2.*", "", "lens.zmx: got 2 SURF; allowed are 3 at least"),
]  # fmt: skip


def refusal(tmp_path, suffix, data):
    path = tmp_path / f"lens{suffix}"
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    with pytest.raises(InputError) as caught:
        load_lens(path)
    message = str(caught.value)
    assert len(message.splitlines()) == 1
    assert len(message) < 500
    assert "lens" in message
    return message


@pytest.mark.parametrize(("suffix", "old", "new", "says"), FAULTS, ids=[f"{f[0][1:]}-{f[3][:40]}" for f in FAULTS])
def test_a_fault_is_named(tmp_path, suffix, old, new, says):
    pattern = old.removeprefix("re:") if old.startswith("re:") else re.escape(old)
    text, count = re.subn(pattern, lambda _: new, GOOD[suffix])
    assert count > 0
    assert says in refusal(tmp_path, suffix, text)


def test_a_lens_that_is_sharp_nowhere_near_is_named(tmp_path):
    text = lens_text(load_lens("biconvex"))
    text = re.sub(r"thickness = [0-9.]+\nglass = \"air\"", 'thickness = 0.0\nglass = "air"', text)
    weak = text.replace('glass = "N-BK7"', "glass = 1.0000001")
    assert "thickness of the last surface: got 0 for a lens that is sharp 2.5" in refusal(tmp_path, ".toml", weak)


@pytest.mark.parametrize("suffix", GOOD)
@pytest.mark.parametrize(
    "data",
    [b"", b"\0" * 1000, bytes(range(256)) * 4, b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", b"\xff\xfe\x00", b"[" * 100_000],
    ids=["empty", "zeros", "bytes", "png", "half a word", "brackets"],
)
def test_a_file_of_something_else_is_refused(tmp_path, suffix, data):
    assert refusal(tmp_path, suffix, data)


def test_too_many_surfaces_are_refused_before_they_are_made(tmp_path):
    line = "50 1 1 10\n"
    begin = time.perf_counter()
    message = refusal(tmp_path, ".dat", line * 90_000)
    assert "got 90000 surfaces; allowed are 1 to 100" in message
    tables = "[[surface]]\n" * 20_000
    assert "got 20000 surfaces" in refusal(tmp_path, ".toml", f"name='a'\nsource='b'\nunit='mm'\n{tables}")
    surfaces = "".join(f"SURF {k}\n" for k in range(60_000))
    assert "got 101 surfaces" in refusal(tmp_path, ".zmx", surfaces)
    with (tmp_path / "lens.dat").open("wb") as file:
        file.truncate(10**10)  # as of 1e9 surfaces; takes no room on the disc
    with pytest.raises(InputError, match=f"has 10000000000 bytes; allowed are at most {MOST_BYTES}"):
        load_lens(tmp_path / "lens.dat")
    assert time.perf_counter() - begin < 10.0  # a second as a rule; made, these would take minutes


@pytest.mark.parametrize("name", ["double_gaus", "lens.txt", "", None, 3, "a\0b", b"x", "missing.dat", "folder.zmx"])
def test_a_name_that_is_no_lens_is_refused(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder.zmx").mkdir()
    with pytest.raises(InputError, match=r"^lens: ") as caught:
        load_lens(name)
    assert len(str(caught.value).splitlines()) == 1
    if name == "double_gaus":
        assert "did you mean 'double_gauss'?" in str(caught.value)


@pytest.mark.parametrize("suffix", GOOD)
@settings(max_examples=80, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_a_damaged_file_is_a_lens_or_an_input_error(tmp_path, suffix, data):
    good = GOOD[suffix].encode()
    words = [b"", b"0", b"-", b"e9", b"nan", b"inf", b"1e999", b"\n", b"#", b'"', b"[[surface]]", b"SURF 3\n", b"\xff"]
    piece = st.sampled_from(words) | st.binary(max_size=4)
    damaged = good
    for _ in range(data.draw(st.integers(1, 3))):
        start = data.draw(st.integers(0, len(damaged)))
        stop = start + data.draw(st.integers(0, 12))
        damaged = damaged[:start] + data.draw(piece) + damaged[stop:]
    path = tmp_path / f"lens{suffix}"
    path.write_bytes(damaged)
    try:
        found: LensSystem | InputError = load_lens(path)
    except InputError as error:
        found = error
    assert isinstance(found, LensSystem) or len(str(found).splitlines()) == 1

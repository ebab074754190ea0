"""The command `refdof lens`: its tables, its drawings, and one line for bad input."""

import hashlib
import json
import math
import re
import sys

import pytest
from PIL import Image
from typer.testing import CliRunner

from refdof.cli import app, main
from refdof.lens_cli import DRAWINGS
from refdof.optics.systems.lens_toml import lens_text
from refdof.optics.systems.prescription import LENSES, load_lens, save_lens


def lens(*words):
    done = CliRunner().invoke(app, ["lens", *map(str, words)])
    assert done.exit_code == 0, done.exception
    return done.stdout


def test_the_table_has_the_numbers_of_the_double_gauss():
    lines = dict(line.split("  ", 1) for line in lens("double_gauss").splitlines()[:11])
    values = {key: value.strip() for key, value in lines.items()}
    assert values["lens"] == "Double Gauss 50 mm f/2"
    assert values["focal length"] == "50.358 mm"  # pbrt's table, by two other programs
    assert values["T-stop"].endswith(" (uncoated glass, absorption not counted)")
    assert values["in focus at"] == "infinity"
    assert values["field of view, 36 x 24 mm"] == "39.34 x 26.81 degrees, diagonal 46.50"  # 2 atan(18 / f) and so on


def test_json_holds_the_same(tmp_path):
    path = tmp_path / "copy.toml"
    save_lens(path, load_lens("double_gauss"))
    sheet, near = json.loads(lens(path, "--json")), json.loads(lens(path, "--json", "--focus", "1"))
    assert sheet["focal_length"] == pytest.approx(50.35816, abs=1e-5)
    assert sheet["focus_distance"] is None  # infinity
    assert near["focus_distance"] == 1.0
    assert near["sensor"] - sheet["sensor"] == pytest.approx(50.35816**2 / (1000.0 + 3.29 - 50.36), rel=1e-3)  # Newton
    assert [row["height"] for row in sheet["field"]] == [0.0, 10.0, 18.0, 21.6]
    assert sheet["field"][0] == pytest.approx({"height": 0.0, "light": 1.0, "cat_eye": 1.0, "distortion": 0.0})
    assert [row["light"] for row in sheet["field"]] == pytest.approx([1.0, 0.65, 0.29, 0.15], abs=0.02)


def test_the_t_stop_counts_what_both_faces_reflect():
    """4 % at each: f/4.00 over the root of (4 n / (1 + n)^2)^2, by hand f/4.00 times 2.5168^2 / (4 * 1.5168)."""
    sheet = json.loads(lens("biconvex", "--json"))
    assert sheet["t_stop"] / sheet["f_number"] == pytest.approx(2.5168**2 / (4.0 * 1.5168), rel=1e-5)
    assert sheet["t_stop"] == pytest.approx(4.176, abs=0.002)
    assert f"{sheet['t_stop']:.3f} (uncoated glass" in lens("biconvex")


def test_the_drawings_are_the_same_bytes_every_time(tmp_path):
    digests = []
    for _ in range(2):
        printed = lens("cooke_triplet", "--focus", "2", "--out", tmp_path / "out")  # replaces its own
        digests.append([hashlib.sha256((tmp_path / "out" / name).read_bytes()).hexdigest() for name in DRAWINGS])
    assert digests[0] == digests[1]
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == sorted(DRAWINGS)
    assert "in focus at" in printed
    for name in DRAWINGS:
        with Image.open(tmp_path / "out" / name) as picture:
            picture = picture.convert("RGB")
            assert min(picture.size) >= 300
            # Ink of the three colours of film heights, of wavelengths or of the two focal surfaces.
            colors = {color for _, color in picture.getcolors(picture.width * picture.height)}
            assert {(0xC6, 0x28, 0x28), (0x15, 0x65, 0xC0)} <= colors or name == "spots.png"


@pytest.mark.fast
@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["double_gaus"], "lens: got 'double_gaus'; did you mean 'double_gauss'? allowed are"),
        (["missing.dat"], "lens: got 'missing.dat': there is no such file; allowed is a file"),
        (["double_gauss", "--focus", "0.03"], "focus"),
        (["double_gauss", "--focus", "nan"], "focus: got nan; allowed is a number > 0"),
        (["double_gauss", "--focus", "-1"], "focus: got -1; allowed is a number > 0"),
        (["double_gauss", "--out", "full"], "out: got 'full', which holds other files"),
        (["double_gauss", "--out", "file"], "out: got 'file'"),
        (["bad.toml"], "bad.toml: 'radius': unknown; allowed are name, source, unit, surface"),
        (["diverging.dat"], "allowed is a lens with a real image"),
        (["window.dat"], "which has no focal length"),
    ],
)
def test_bad_input_is_one_line_and_status_2(tmp_path, monkeypatch, capsys, words, says):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "full").mkdir()
    for name in ("full/notes.txt", "file"):
        (tmp_path / name).write_text("mine")
    (tmp_path / "bad.toml").write_text("radius = 3")
    (tmp_path / "diverging.dat").write_text("0 1 0 5\n-50 2 1.5 10\n50 0 1 10\n")
    (tmp_path / "window.dat").write_text("0 1 0 5\n1e300 2 1.5 10\n-1e300 3 1 10\n")
    monkeypatch.setattr(sys, "argv", ["refdof", "lens", *words])
    with pytest.raises(SystemExit) as stopped:
        main()
    out, err = capsys.readouterr()
    assert stopped.value.code == 2
    assert out == ""
    assert err.startswith("refdof: ")
    assert err.count("\n") == 1
    assert says in err
    assert (tmp_path / "full/notes.txt").read_text() == "mine"


def test_every_lens_of_data_has_light_on_its_axis_and_less_in_the_corner():
    for name in LENSES:
        field = json.loads(lens(name, "--json"))["field"]
        assert 0.1 < field[-1]["light"] < 1.0, name
        assert all(abs(row["distortion"]) < 0.05 for row in field), name
        assert not any(math.isnan(row["cat_eye"]) for row in field), name


def test_control_characters_of_a_name_reach_neither_terminal_nor_drawing(tmp_path):
    text = lens_text(load_lens("biconvex"))
    file = tmp_path / "odd.toml"
    file.write_text(re.sub('name = ".*"', r'name = "a\\nb\\u001b[31m"', text))
    done = CliRunner().invoke(app, ["lens", str(file), "--out", str(tmp_path / "out")], catch_exceptions=False)
    assert done.stdout.splitlines()[0].split(maxsplit=1)[1] == "a b [31m"  # and no warning of a missing glyph

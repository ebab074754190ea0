"""Options of the shot: each replaces its part of what a scene suggests, and no other."""

import json
import math
import shlex
from dataclasses import replace

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

from refdof import Camera, InputError, ThinLens, load_lens
from refdof.cli import app
from refdof.optics.lens import photographic_share
from refdof.report import rows_as_json
from refdof.scene.load import load_scene
from refdof.shot import CameraChoice, LensChoice, SceneChoice, scene_camera_lens
from tests.fake_comparison import comparison

pytestmark = pytest.mark.fast

# From 10 units away a picture of this angle is 8 units high.
HALF = math.degrees(2.0 * math.atan(0.4))
CARD = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1 2 3 4\n"  # 2 x 1 units, to the upper right of the middle


@pytest.mark.parametrize(
    ("choice", "part"),
    [
        ({"size": "8x6"}, {"size": (8, 6)}),
        ({"eye": "1,2.5,-3"}, {"eye": (1.0, 2.5, -3.0)}),
        ({"target": "-1e1, 0,0"}, {"target": (-10.0, 0.0, 0.0)}),
        ({"up": "1,0,0"}, {"up": (1.0, 0.0, 0.0)}),
        ({"fov": 12.5}, {"fov_y": 12.5}),
    ],
)
def test_an_option_replaces_its_own_part(choice, part):
    scene = load_scene("branches")
    _, camera, lens = scene_camera_lens("branches", CameraChoice(**choice))
    assert camera == replace(scene.camera, **part)
    assert camera != scene.camera
    assert (lens.radius, lens.focus_distance) == (scene.lens.radius, scene.lens.focus_distance)


def test_a_place_that_was_the_other_one_may_be_taken():
    """The parts are checked together: the eye can go to where the target was."""
    camera = load_scene("branches").camera
    eye, target = (",".join(map(repr, place)) for place in (camera.target, camera.eye))
    _, turned, _ = scene_camera_lens("branches", CameraChoice(eye=eye, target=target))
    assert (turned.eye, turned.target) == (camera.target, camera.eye)


def test_a_real_lens_keeps_its_field_of_view_wherever_it_stands():
    chosen = LensChoice(file="double_gauss")
    _, first, lens = scene_camera_lens("branches", CameraChoice(), chosen)
    _, other, _ = scene_camera_lens("branches", CameraChoice(eye="0,1,9", up="1,0,0"), chosen)
    assert other.fov_y == first.fov_y == lens.seen_by(first).fov_y
    assert (other.eye, other.up, other.target) == ((0.0, 1.0, 9.0), (1.0, 0.0, 0.0), first.target)


@pytest.mark.parametrize(
    ("up", "rows", "columns", "nearest"),
    [("0,1,0", (6, 8), (8, 12), "8,7"), ("0,-3,0", (8, 10), (4, 8), "7,8")],
)
def test_pictures_are_of_the_camera_that_is_said(tmp_path, monkeypatch, up, rows, columns, nearest):
    """A row is half a unit: the card covers 4 x 2 whole pixels; held upside down, on the other side of the middle."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "card.obj").write_text(CARD)
    seen = ["--size", "16x16", "--eye", "0,0,10", "--target", "0,0,0", "--up", up, "--fov", repr(HALF)]
    run(["export", "card.obj", "--methods", "singlepass", "--out", "a", *seen])
    depth = np.load(tmp_path / "a" / "depth.npy")
    expected = np.full((16, 16), np.inf)
    expected[slice(*rows), slice(*columns)] = 10.0
    np.testing.assert_allclose(depth, expected, rtol=1e-6)  # float32
    about = json.loads((tmp_path / "a" / "arrays.json").read_text())
    assert about["camera"]["eye"] == [0.0, 0.0, 10.0]
    assert about["camera"]["pixels_per_tangent"] == pytest.approx(20.0, rel=1e-12)  # 16 rows over 2 x 0.4; float64
    # Beside the middle of the picture is the place (0.25, 0.25): of its triangle's corners (0, 0), (2, 1) and (0, 1).
    words = ["pick", "card.obj", "--pixel", nearest, "--json", *seen]
    assert sorted(json.loads(run(words))["barycentrics"]) == pytest.approx([0.125, 0.125, 0.75], rel=1e-12)


@pytest.mark.parametrize(
    ("units", "unit_mm"),
    [(None, 1000.0), ("m", 1000.0), ("cm", 10.0), ("mm", 1.0), ("inch", 25.4), ("ft", 304.8), ("0.5", 500.0)],
)
def test_photographers_numbers_say_lens_and_field_of_view(units, unit_mm):
    """50 mm, f/2, a sensor 24 mm high: a radius of 12.5 mm, and 2 atan(12 / 50) = 26.99 degrees."""
    far = 1e4 / unit_mm  # 10 m
    choice = LensChoice(focus=far, f_number=2.0, focal_length=50.0, sensor=24.0, units=units)
    scene, camera, lens = scene_camera_lens("branches", CameraChoice(), choice)
    assert lens.radius == pytest.approx(12.5 / unit_mm, rel=1e-12)
    assert lens.focus_distance == far
    assert lens.aperture is scene.lens.aperture
    assert camera.fov_y == pytest.approx(26.9915, abs=5e-5)
    assert replace(camera, fov_y=scene.camera.fov_y) == scene.camera


def test_each_part_can_be_said_alone():
    own = load_scene("branches")
    # No sensor: the field of view stays. No f-number: the lens stays.
    _, camera, lens = scene_camera_lens("branches", CameraChoice(), LensChoice(f_number=4.0, focal_length=100.0))
    assert (camera, lens.radius) == (own.camera, pytest.approx(0.0125, rel=1e-12))
    _, camera, lens = scene_camera_lens("branches", CameraChoice(), LensChoice(focal_length=12.0, sensor=24.0))
    assert (camera.fov_y, lens.radius) == (pytest.approx(90.0, rel=1e-12), own.lens.radius)
    # No focal length: of 90 degrees and 24 mm it is 12 mm, and of f/3 the radius is 2 mm.
    _, camera, lens = scene_camera_lens("branches", CameraChoice(fov=90.0), LensChoice(f_number=3.0, sensor=24.0))
    assert (camera.fov_y, lens.radius) == (90.0, pytest.approx(0.002, rel=1e-12))


def test_units_give_a_real_lens_its_own_size():
    """In centimetres a unit has 10 of the prescription's millimetres; without units the pupil is the lens radius."""
    choice = LensChoice(focus=300.0, file="double_gauss", units="cm")
    _, _, lens = scene_camera_lens("branches", CameraChoice(), choice)
    assert lens.mm_per_unit == pytest.approx(10.0, rel=1e-12)
    # 50.36 mm at f/2.03, of the table in docs/lenses.md, whose last digits are rounded.
    assert lens.radius == pytest.approx(50.36 / 2.03 / 2.0 / 10.0, rel=3e-3)
    assert lens.system == load_lens("double_gauss")


@pytest.mark.parametrize(
    ("choice", "said"),
    [
        ({"f_number": 2.0, "focal_length": 50.0, "radius": 0.1}, "lens-radius: got 0.1 with --f-number, which sets it"),
        ({"file": "biconvex", "units": "cm", "radius": 0.1}, "lens-radius: got 0.1 with --lens and --units, which set"),
        ({"f_number": 0.0, "focal_length": 50.0}, "f-number: got 0; allowed is a finite number > 0"),
        ({"f_number": math.nan, "sensor": 24.0}, "f-number: got nan"),
        ({"f_number": 2.0, "focal_length": -50.0}, "focal-length: got -50; allowed is a finite number > 0"),
        ({"f_number": 2.0, "sensor": math.inf}, "sensor: got inf; allowed is a finite number > 0"),
        ({"f_number": 2.0, "sensor": 24.0, "units": "parsec"}, "units: got 'parsec'; allowed are m, cm, mm, inch, ft"),
        ({"f_number": 2.0, "sensor": 24.0, "units": "0"}, "units: got '0'; allowed are m, cm,"),
        ({"f_number": 2.0, "sensor": 24.0, "units": "nan"}, "units: got 'nan'; allowed are m, cm,"),
        (
            {"f_number": 2.0, "focal_length": 50.0, "focus": 0.04},
            "focus: got 0.04; allowed is a distance above",
        ),
        ({"focal_length": 0.01, "sensor": 24.0}, "focal-length: got 0.01 with --sensor 24, a field of view of 179.9"),
    ],
)
def test_numbers_that_contradict_or_are_not_allowed_are_one_line(choice, said):
    with pytest.raises(InputError) as error:
        scene_camera_lens("branches", CameraChoice(), LensChoice(**choice))
    message = str(error.value)
    assert message.startswith(said)
    assert "; allowed" in message
    assert "\n" not in message


@pytest.mark.parametrize(
    ("choice", "said"),
    [
        ({"background": "1,2"}, "background: got '1,2'; allowed is R,G,B, three numbers"),
        ({"background": "1,2,-3"}, "background: smallest value is -3; allowed are values >= 0"),
        ({"shading": "toon"}, "shading: got 'toon'; "),
    ],
)
def test_looks_that_are_not_allowed_are_one_line(choice, said):
    with pytest.raises(InputError) as error:
        scene_camera_lens("branches", CameraChoice(), choice=SceneChoice(**choice))
    assert str(error.value).startswith(said)


@pytest.mark.parametrize("kind", ["scene", "file"])
def test_a_look_is_that_of_all_surfaces_and_of_what_is_behind(kind, tmp_path):
    (tmp_path / "card.obj").write_text(CARD)
    name = {"scene": "branches", "file": str(tmp_path / "card.obj")}[kind]
    scene, *_ = scene_camera_lens(name, CameraChoice(), choice=SceneChoice("unlit", "0.25, 0.5,2"))
    assert scene.background == (0.25, 0.5, 2.0)
    assert {material.shading for material in scene.materials} == {"unlit"}


def test_circles_are_a_stated_share_of_photographic_ones():
    """50 mm, f/2, focused at 3 m, sensor 24 mm high, of 480 rows; a point at 6 m. By hand:

    A photographer's circle is f^2 / N |d - s| / (d (s - f)) = 2500 / 2 * 3000 / (6000 * 2950) = 0.21186 mm across,
    or 4.2373 px, a radius of 2.1186 px. Ours is (3000 - 50) / 3000 = 0.98333 of it: 2.0833 px.
    """
    choice = LensChoice(focus=3.0, f_number=2.0, focal_length=50.0, sensor=24.0)
    _, camera, lens = scene_camera_lens("branches", CameraChoice(size="640x480"), choice)
    ours = float(lens.coc_px(np.array(6.0), camera))
    photographic = 0.05**2 / 2.0 * 3.0 / (6.0 * 2.95) / 0.024 * 480.0 / 2.0
    assert ours == pytest.approx(2.083333, abs=1e-6)
    assert photographic == pytest.approx(2.118644, abs=1e-6)
    assert ours / photographic == pytest.approx(photographic_share(0.05, 3.0), rel=1e-12)
    assert photographic_share(0.05, 3.0) == pytest.approx(0.983333, abs=1e-6)
    assert photographic_share(0.05, math.inf) == 1.0
    with pytest.raises(InputError, match=r"focal_length, focus_distance: got 0\.05 and 0\.05; allowed"):
        photographic_share(0.05, 0.05)
    assert lens == replace(ThinLens.from_f_number(0.05, 2.0, 3.0), aperture=lens.aperture)


def test_the_relation_is_recorded_where_numbers_are(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    photo = ["--focus", "300", "--f-number", "2", "--focal-length", "50", "--sensor", "24", "--units", "cm"]
    words = ["branches", "--size", "8x6", *photo, "--json"]
    facts = json.loads(run(["export", *words, "--methods", "singlepass", "--out", "a"]))
    assert facts["coc_over_photographic"] == 0.983333
    assert (facts["focal_length_mm"], facts["lens_radius"]) == (50.0, 1.25)
    about = json.loads((tmp_path / "a" / "arrays.json").read_text())
    assert "(s - f) / s" in about["conventions"]["coc_photographic"]
    assert "(s - f) / s" in rows_as_json(comparison())["lens"]["coc_photographic"]
    assert about["lens"]["radius"] == 1.25
    rendered = json.loads(run(["render", *words, "--method", "singlepass", "-o", "a.npy"]))
    assert rendered["coc_over_photographic"] == 0.983333


def test_a_pick_has_the_same_field_of_view(tmp_path, monkeypatch):
    """A sensor that is 0.8 focal lengths high has the angle whose picture is 8 units high from 10 units away."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "card.obj").write_text(CARD)
    seen = ["--size", "16x16", "--eye", "0,0,10", "--target", "0,0,0", "--focal-length", "50", "--sensor", "40"]
    words = ["pick", "card.obj", "--pixel", "8,7", "--json", *seen]
    assert sorted(json.loads(run(words))["barycentrics"]) == pytest.approx([0.125, 0.125, 0.75], rel=1e-12)


def test_the_nearest_command_of_a_report_has_its_camera():
    """Every digit: the command line that a report from Python shows has the same camera."""
    camera = Camera((0.1, -2.0 / 3.0, 7.0), (1e-3, 0.0, -0.0), (0.0, 1.0, 1.0 / 7.0), 100.0 / 3.0, (40, 30))
    program, command, *words = shlex.split(rows_as_json(replace(comparison(), camera=camera))["command"])
    assert (program, command) == ("refdof", "compare")
    _, command, _ = typer.main.get_command(app).resolve_command(None, ["compare"])
    told = command.make_context("compare", words).params
    choice = CameraChoice(**{name: told[name] for name in ("size", "eye", "target", "up", "fov")})
    assert scene_camera_lens(told["scenes"][0], choice)[1] == camera


def run(words):
    done = CliRunner().invoke(app, words, catch_exceptions=False)
    assert done.exit_code == 0
    return done.stdout

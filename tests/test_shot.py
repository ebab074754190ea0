"""Options of the shot: each replaces its part of what a scene suggests, and no other."""

import json
import math
import shlex
from dataclasses import replace

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

from refdof import Camera
from refdof.cli import app
from refdof.report import rows_as_json
from refdof.scene.load import load_scene
from refdof.shot import CameraChoice, LensChoice, scene_camera_lens
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

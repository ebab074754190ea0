"""`refdof pick` and `refdof focus`: what they print and write, and bad input in one line."""

import json
from itertools import pairwise

import numpy as np
import pytest
from typer.testing import CliRunner

from refdof import InputError, View, load_scene, render
from refdof.cli import app
from refdof.focus.focus_file import load_focus, parse_focus
from refdof.focus.focus_lens import focus_lens
from refdof.image.file import load_image

SMALL = ["--size", "48x36"]


def run(*words):
    return CliRunner().invoke(app, [*words], catch_exceptions=False)


def test_what_pick_prints_is_a_focus_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = run("pick", "cans", "--pixel", "24,20", "--name", "can", *SMALL)
    assert done.exit_code == 0
    focus = parse_focus("focus.toml", done.stdout)
    assert focus.points[0].name == "can"
    facts = json.loads(run("pick", "cans", "--pixel", "24,20", "--json", *SMALL).stdout)
    assert facts["triangle"] == focus.points[0].triangle
    with pytest.raises(InputError, match="pixel: got 48,0; allowed is 0,0 to 47,35"):
        run("pick", "cans", "--pixel", "48,0", *SMALL)


def test_a_sequence_has_a_picture_a_frame_and_changes_smoothly(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    point = run("pick", "cans", "--pixel", "24,20", *SMALL).stdout
    (tmp_path / "focus.toml").write_text('kind = "distance"\n' + point + "offset = [[0, 0.0], [23, 2.0]]\n")
    words = [
        "focus",
        "cans",
        "--points",
        "focus.toml",
        "--method",
        "scatter",
        "--out",
        "frames",
        "--format",
        "npy",
        *SMALL,
    ]
    done = run(*words, "--frames", "0:24")
    assert done.exit_code == 0
    assert done.stdout.strip() == "out=frames, frames=24"
    frames = [load_image(path) for path in sorted((tmp_path / "frames").iterdir())]
    assert len(frames) == 24
    whole = np.sqrt(np.mean((frames[-1] - frames[0]) ** 2))
    steps = [np.sqrt(np.mean((after - before) ** 2)) for before, after in pairwise(frames)]
    # An even walk has steps of 1/23 of the way at least; a monotone cubic is 1.5 times as steep in its middle, and the
    # circle of confusion grows with 1 / distance.
    assert max(steps) < 4.0 * whole / 23.0
    (tmp_path / "frames" / "mine.txt").write_text("")
    with pytest.raises(InputError, match="out: got 'frames', which holds other files"):
        run(*words)
    scene = load_scene("cans")
    camera = scene.camera.with_size((48, 36))
    lens = focus_lens(load_focus("focus.toml"), View(scene, camera, scene.lens), 5)
    np.testing.assert_array_equal(frames[5], render("scatter", scene, camera, lens).image)


def test_compare_follows_focus_points(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = "".join(run("pick", "cans", "--pixel", pixel, *SMALL).stdout for pixel in ("24,20", "40,30"))
    (tmp_path / "focus.toml").write_text(text)
    words = [
        "--methods",
        "lensblur,scatter",
        "--samples",
        "64",
        "--out",
        "here",
        "--focus-points",
        "focus.toml",
        *SMALL,
    ]
    assert run("compare", "cans", *words).exit_code == 0
    table = json.loads((tmp_path / "here" / "table.json").read_text())
    assert table["lens"]["expressive"]["focal_surface"]["shape"] == [36, 48]
    scene = load_scene("cans")
    camera = scene.camera.with_size((48, 36))
    lens = focus_lens(load_focus("focus.toml"), View(scene, camera, scene.lens))
    np.testing.assert_array_equal(
        load_image(tmp_path / "here" / "scatter.npy"), render("scatter", scene, camera, lens).image
    )
    out = ["-o", "a.npy", "--focus-points", "focus.toml", *SMALL]
    assert run("render", "cans", "--method", "scatter", *out).exit_code == 0
    np.testing.assert_array_equal(load_image("a.npy"), load_image(tmp_path / "here" / "scatter.npy"))


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--frames", "3:3"], "frames: got '3:3'; allowed is A:B, whole numbers with A below B"),
        (["--frames", "a"], "frames: got 'a'"),
        (["--format", "gif"], "format: got 'gif'; allowed are png, exr, npy"),
        (["--points", "none.toml"], "points: got 'none.toml'"),
        (["--method", "lensblurr"], "method: got 'lensblurr'"),
    ],
)
def test_bad_words_are_named(tmp_path, monkeypatch, words, message):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "focus.toml").write_text("[[point]]\ntriangle = 0\nbarycentrics = [1, 1, 1]\n")
    with pytest.raises(InputError) as told:
        run("focus", "cans", "--points", "focus.toml", "--method", "scatter", "--out", "frames", *SMALL, *words)
    assert str(told.value).startswith(message)
    assert not (tmp_path / "frames").exists()

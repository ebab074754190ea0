"""The commands of docs/frames.md, on files as the page says that they are."""

import json
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import refdof
from refdof import View
from refdof.cli import app
from refdof.rendering import render_view
from tests.frame import exr_files
from tests.frame.depth_twin import stored_depth

pytestmark = pytest.mark.fast
ROOT = next(folder for folder in Path(__file__).parents if (folder / "pyproject.toml").exists())
PAGE = (ROOT / "docs" / "frames.md").read_text(encoding="utf-8")


def example(name):
    """The words of a command of the page, without the program's name."""
    text = re.search(rf"<!-- example: {name} -->\n```bash\n(.*?)```", PAGE, re.DOTALL)[1]
    program, *words = shlex.split(text.replace("\\\n", " "))
    assert program == "refdof"
    return words


def run(words):
    done = CliRunner().invoke(app, words, standalone_mode=False)
    if done.exception is not None:
        raise done.exception
    return done.output


@pytest.fixture
def view(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("refdof.compare.warm_up", lambda *_: None)
    monkeypatch.setattr("refdof.compare._RUNS", 1)
    scene = refdof.load_scene("cans")
    return View(scene, scene.camera.with_size((16, 12)), scene.lens)


def test_a_blender_file(view, tmp_path):
    pinhole = view.pinhole()
    exr_files.write_blender(tmp_path / "frame.exr", pinhole.color, pinhole.depth)
    said = run(example("blender"))
    assert "No reference" in said
    table = json.loads((tmp_path / "blurred" / "table.json").read_text())
    filters = [name for name, module in refdof.METHODS.items() if module.METHOD.kind == "single image"]
    assert [row["method"] for row in table["rows"]] == filters
    # 24 mm of sensor under 40 degrees have a focal length of 12 mm / tan 20 = 32.97 mm; over 2 * 1.8, in metres.
    assert table["lens"]["radius"] == pytest.approx(0.0091584, rel=1e-4)
    assert np.array_equal(np.load(tmp_path / "blurred" / "pinhole.npy"), pinhole.color)


def test_a_depth_buffer(view, tmp_path):
    pinhole = view.pinhole()
    np.save(tmp_path / "color.npy", pinhole.color)
    np.save(tmp_path / "depth.npy", stored_depth("reversed", pinhole.depth, view.camera, 0.1, 100.0))
    words = example("device depth")
    lens = refdof.ThinLens(float(words[words.index("--lens-radius") + 1]), float(words[words.index("--focus") + 1]))
    camera = refdof.frame.frame.frame_camera(float(words[words.index("--fov") + 1]), view.camera.size)
    wanted = refdof.Frame(pinhole.color, pinhole.depth, camera, lens).view()
    np.save(tmp_path / "truth.npy", render_view("scatter", wanted).image)
    said = run(words)
    assert re.search(r"\| scatter +\| +inf \|", said)
    table = json.loads((tmp_path / "blurred" / "table.json").read_text())
    assert [(row["method"], row["psnr"] == "inf") for row in table["rows"]] == [
        ("scatter", True),
        ("singlepass", False),
    ]

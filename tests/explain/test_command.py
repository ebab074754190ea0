"""The command `refdof explain`: text, JSON, files, and errors in one line."""

import csv
import json

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

from refdof import METHODS, InputError, SystemLens, View, load_lens, load_scene
from refdof.cli import app
from refdof.explain import explain_view
from refdof.methods import singlepass
from refdof.oracle.cases import Case
from tests.packs import pack_of

CASES = [
    Case("cards", "singlepass", "cards", (24, 18), {"max_blur_size": 8.0}),
    Case("cards_up", "singlepass", "cards", (24, 18), {"max_blur_size": 8.0, "row_order": "up"}, "up"),
]


@pytest.fixture(scope="module")
def pack(tmp_path_factory):
    return pack_of(CASES, tmp_path_factory.mktemp("explain") / "pack")


def run(*words):
    result = CliRunner().invoke(app, ["explain", *map(str, words)], standalone_mode=False)
    if isinstance(result.exception, InputError):
        raise result.exception
    return result.return_value or 0, result.stdout


def test_a_case_is_explained(pack, tmp_path):
    out = tmp_path / "out"
    status, text = run(pack / "cases" / "cards", "--pixel", "11,8", "--out", out)
    assert status == 0
    golden = np.load(pack / "cases" / "cards" / "expected" / "image.npy")[8, 11]
    assert "the method's picture" in text.splitlines()[-2]
    assert "rows of less weight" in text
    found = json.loads((out / "explanation.json").read_text())
    assert found["value"] == pytest.approx(golden.tolist(), rel=1e-6)  # goldens are made in float64
    assert found["agrees"]
    rows = list(csv.DictReader((out / "table.csv").read_text().splitlines()))
    assert len(rows) == len(singlepass.spiral(singlepass.Params(max_blur_size=8.0))) + 1
    assert float(rows[-1]["running_red"]) == pytest.approx(golden[0], abs=1e-6)
    with Image.open(out / "picture.png") as picture:
        assert picture.size == (640, 640)
    assert run(pack / "cases" / "cards", "--pixel", "1,1", "--out", out)[0] == 0  # replaces an earlier one


def test_pixels_are_counted_as_in_the_files(pack):
    _, text = run(pack / "cases" / "cards_up", "--pixel", "11,8", "--json")
    golden = np.load(pack / "cases" / "cards_up" / "expected" / "image.npy")[8, 11]
    assert json.loads(text)["value"] == pytest.approx(golden.tolist(), rel=1e-6)


def test_a_scene_is_explained():
    status, text = run("fence", "--method", "separable", "--pixel", "3,2", "--size", "16x12", "--stage", "coc")
    assert status == 0
    assert "coc = P E (1 / focus - 1 / depth)" in text


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["CASE", "--pixel", "24,0"], "^pixel: got 24,0; allowed are 0,0 .. 23,17"),
        (["CASE", "--pixel", "4"], "^pixel: got '4'; allowed is X,Y"),
        (["CASE", "--pixel", "0,0", "--stage", "x"], r"^stage: got 'x'"),
        (["CASE", "--pixel", "0,0", "--method", "poisson"], "^method: got 'poisson' with a case"),
        (["fence", "--pixel", "0,0"], "^method: got none with a scene"),
        (["fence", "--pixel", "0,0", "--method", "poison"], "^method: got 'poison'"),
        (["no-such-scene", "--pixel", "0,0", "--method", "poisson"], "^scene: got 'no-such-scene'"),
    ],
)
def test_bad_words_are_refused(pack, words, says):
    words = [str(pack / "cases" / "cards") if word == "CASE" else word for word in words]
    with pytest.raises(InputError, match=says):
        run(*words)


def test_a_spoilt_case_is_refused(pack, tmp_path):
    import shutil

    copy = shutil.copytree(pack, tmp_path / "pack")
    (copy / "cases" / "cards" / "inputs" / "depth.npy").write_bytes(b"x")
    with pytest.raises(InputError, match=r"^case: cards: inputs/depth.npy: is not as it was written"):
        run(copy / "cases" / "cards", "--pixel", "0,0")


def test_other_files_are_not_replaced(pack, tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(InputError, match=r"^out: got"):
        run(pack / "cases" / "cards", "--pixel", "0,0", "--out", tmp_path)
    assert (tmp_path / "mine.txt").read_text() == "mine"


def test_a_lens_system_is_refused_where_its_rays_are_not_explained():
    scene = load_scene("fence")
    lens = SystemLens(load_lens("biconvex"), 8.0)
    view = View(scene, scene.camera.with_size((9, 9)), lens)
    with pytest.raises(
        InputError, match="lens: got one whose rays are its own; allowed for an explanation of accumulation"
    ):
        explain_view("accumulation", view, METHODS["accumulation"].Params(), (4, 4))

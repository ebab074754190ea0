"""`refdof score`: the scores of metrics, and what the reference is worth."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

import refdof
from refdof import InputError, metrics
from refdof.cli import app
from refdof.image.file import load_image, save_image
from refdof.metrics import METRICS

pytestmark = pytest.mark.fast
SIZE = (24, 32, 3)


def run(*words):
    done = CliRunner().invoke(app, ["score", *map(str, words)], standalone_mode=False)
    if done.exception is not None:
        raise done.exception
    return done.output


@pytest.fixture
def folder(tmp_path):
    random = np.random.default_rng(5)
    truth = random.uniform(0.1, 0.9, SIZE)
    np.save(tmp_path / "truth.npy", truth)
    save_image(tmp_path / "near.exr", truth + random.normal(0, 1e-3, SIZE))
    save_image(tmp_path / "far.png", truth * 0.5)
    np.save(tmp_path / "variance.npy", np.full(SIZE, 1e-4))
    np.save(tmp_path / "second.npy", truth + random.normal(0, 0.01, SIZE))
    return tmp_path


def test_scores_are_those_of_metrics(folder):
    words = [folder / name for name in ("truth.npy", "near.exr", "far.png")]
    found = json.loads(run(*words, "--json"))
    for row, path in zip(found["rows"], words[1:], strict=True):
        assert row["image"] == str(path)
        wanted = metrics.scores(np.load(words[0]), load_image(path))
        assert {name: row[name] for name in METRICS} == pytest.approx(wanted)
        assert row["at_noise_floor"] is False
    assert found["reference"] == {"image": str(words[0]), "size": [32, 24], "noise_floor_psnr": None}


def test_the_table_has_80_characters_and_all_columns_if_wide(folder):
    words = [folder / name for name in ("truth.npy", "near.exr", "far.png", "truth.npy")]
    said = run(*words)
    assert [line.split("|")[1].strip() for line in said.splitlines()[2:5]] == ["near.exr", "far.png", "truth.npy"]
    assert "inf" in said.splitlines()[4]
    assert max(map(len, said.splitlines()[:6])) <= 80
    assert said.rstrip().endswith("32 x 24, noise unknown.")
    wide = run(*words, "--wide")
    assert all(metric.title in wide for metric in METRICS.values())
    again = run(words[0], words[1], folder / ".." / folder.name / "near.exr")  # one name: paths, cut from the left
    assert again.splitlines()[2].split("|")[1].strip().startswith("...")


def test_noise_floors_by_hand(folder):
    # Noise of variance 1e-4 on every linear value passes the display curve by its slope.
    words = [folder / "truth.npy", folder / "near.exr"]
    truth = np.load(words[0])
    floor = json.loads(run(*words, "--variance", folder / "variance.npy", "--json"))["reference"]["noise_floor_psnr"]
    assert floor == metrics.noise_floor_psnr(truth, np.full(SIZE, 1e-2))
    second = json.loads(run(*words, "--second", folder / "second.npy", "--json"))
    # The second reference has noise of 0.01, the first none: half of its variance is charged to each. 2304 squares
    # scatter by sqrt(2 / 2304) = 0.13 dB; three times that, and as much for what the curve bends.
    assert second["reference"]["noise_floor_psnr"] == pytest.approx(floor + 10 * np.log10(2), abs=0.5)
    assert second["rows"][0]["at_noise_floor"]
    assert "| noise floor |" in run(*words, "--second", folder / "second.npy")


def test_the_floor_of_a_pair_by_hand():
    # Display values 0 and 12.92 * 0.001 = 0.01292 differ: half of 0.01292^2 is 8.346e-5, which is 40.785 dB.
    dark, light = np.zeros((2, 2, 3)), np.full((2, 2, 3), 0.001)
    assert metrics.noise_floor_of_pair(dark, light) == pytest.approx(40.785, abs=1e-3)
    assert metrics.noise_floor_of_pair(dark, dark) == np.inf
    assert metrics.noise_floor_of_pair(np.full((2, 2, 3), 5.0), np.full((2, 2, 3), 9.0)) == np.inf  # both are white


@pytest.mark.long
def test_the_floor_of_a_pair_is_that_of_the_estimates():
    """Of two references of the same scene, against what their own error bars say."""
    scene = refdof.load_scene("fence")
    camera = scene.camera.with_size((16, 12))
    first, second = (refdof.reference(scene, camera, samples=64, seed=seed) for seed in (1, 2))
    # 192 pixels, a part of them blurred, so that a decibel or two is chance.
    pair = metrics.noise_floor_of_pair(first.image, second.image)
    assert pair == pytest.approx(first.noise_floor_psnr, abs=2.5)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["truth.npy", "none.npy"], "image: got 'none.npy': there is no such file"),
        (["none.npy", "truth.npy"], "reference: got 'none.npy': there is no such file"),
        (["truth.npy", "small.npy"], r"image: got shape \(11, 11, 3\); allowed is \(24, 32, 3\) \(small.npy\)"),
        (["tiny.npy", "tiny.npy"], "reference: got 2x2 pixels; allowed for scores is at least 11x11"),
        (["truth.npy", "nan.npy"], r"image: has 1 NaN values; none are allowed \(nan.npy\)"),
        (["truth.npy", "flat.npy"], r"image: got shape \(24, 32\)"),
        (["truth.npy", "truth.npy", "--variance", "minus.npy"], "variance: smallest value is -1"),
        (["truth.npy", "truth.npy", "--second", "small.npy"], "second: got shape"),
        (
            ["truth.npy", "truth.npy", "--second", "truth.npy", "--variance", "truth.npy"],
            "second: got 'truth.npy'",
        ),
        (["truth.npy", "a.jpg"], "image: got 'a.jpg'; allowed are names that end in"),
    ],
)
def test_bad_words_are_one_line(folder, monkeypatch, words, said):
    monkeypatch.chdir(folder)
    np.save("small.npy", np.ones((11, 11, 3)))
    np.save("tiny.npy", np.ones((2, 2, 3)))
    np.save("flat.npy", np.ones((24, 32)))
    bad = np.ones(SIZE)
    bad[0, 0, 0] = -1.0
    np.save("minus.npy", bad)
    bad[0, 0, 0] = np.nan
    np.save("nan.npy", bad)
    with pytest.raises(InputError, match=f"^{said}") as caught:
        run(*words)
    assert len(str(caught.value).splitlines()) == 1

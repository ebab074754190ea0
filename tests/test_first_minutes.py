"""What meets a newcomer: counts that are rounded are said, and pipes and devices are refused by name, at once."""

import os
import signal

import pytest
from typer.testing import CliRunner

from refdof._check import InputError
from refdof.cli import app

SMALL = ["--size", "32x24"]


def run(*words):
    done = CliRunner().invoke(app, list(words), standalone_mode=False)
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        raise done.exception
    return done


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ("16", ""),
        ("17", "refdof: reference: 17 samples per pixel are rounded up to 32\n"),
        ("1", "refdof: reference: 1 samples per pixel are rounded up to 16\n"),
        ("256", ""),
    ],
)
def test_rounded_counts_of_the_reference_are_said(tmp_path, asked, said):
    words = ["compare", "branches", "--methods", "singlepass", "--samples", asked, "--out", str(tmp_path / "out")]
    lines = run(*words, *SMALL).stderr.splitlines(keepends=True)
    assert "".join(line for line in lines if "compiling" not in line) == said
    assert f"Reference: {said.split()[-1] if said else asked} samples" in (tmp_path / "out" / "table.md").read_text()


def test_rounded_counts_of_a_method_are_said(tmp_path):
    words = ["render", "branches", "--method", "accumulation", "-o", str(tmp_path / "a.npy"), *SMALL]
    assert run(*words, "--samples", "5").stderr == "refdof: accumulation: 5 samples per pixel are rounded up to 8\n"
    assert run(*words, "--samples", "8").stderr == ""


def test_samples_and_a_tolerance_are_refused(tmp_path):
    with pytest.raises(InputError, match="samples: got 16 with --tolerance, which replaces it; allowed without it"):
        run("compare", "branches", "--samples", "16", "--tolerance", "0.1", "--out", str(tmp_path / "out"), *SMALL)


# Each asks for a file, which is put in the place of FILE.
READERS = {
    "scene": "render FILE --method singlepass -o a.png",
    "lens": "render cans --method singlepass -o a.png --lens FILE",
    "lens itself": "lens FILE",
    "focus points": "render cans --method singlepass -o a.png --focus-points FILE",
    "points": "focus cans --method singlepass --points FILE --out frames",
    "shader": "check --pack PACK --shader FILE",
    "bindings": "check --pack PACK --shader ports/glsl/singlepass.frag --bindings FILE",
    "waivers": "check --pack PACK --results . --waivers FILE",
}
ROOT = os.path.dirname(os.path.dirname(__file__))


@pytest.mark.fast
@pytest.mark.parametrize("words", READERS.values(), ids=READERS)
@pytest.mark.parametrize("file", ["-", "/dev/stdin", "pipe", "folder"])
def test_what_is_no_plain_file_is_refused_by_name(tmp_path, monkeypatch, words, file):
    monkeypatch.chdir(tmp_path)
    suffix = ".frag" if "--shader FILE" in words else ".toml" if "FILE" in words.split("--")[-1] else ".obj"
    if file == "pipe":
        file = str(tmp_path / f"pipe{suffix}")
        os.mkfifo(file)
    elif file == "folder":
        file = str(tmp_path / f"folder{suffix}")
        os.mkdir(file)
    pack = os.path.join(ROOT, "data", "packs", "core")
    words = [{"FILE": file, "PACK": pack}.get(word, word) for word in words.split()]
    words = [os.path.join(ROOT, word) if word.startswith("ports/") else word for word in words]
    signal.alarm(60)  # nobody writes into the pipe: who reads it waits for ever
    try:
        with pytest.raises(InputError) as error:
            run(*words)
    finally:
        signal.alarm(0)
    assert "\n" not in str(error.value)
    assert os.path.basename(file) in str(error.value)

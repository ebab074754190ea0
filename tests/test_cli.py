"""The command line as a user sees it: output, exit status, one line for bad input."""

import json
import os
import re
import shlex
import subprocess
import sys

import numpy as np
import pytest
from typer.testing import CliRunner

from refdof import METHODS, SCENES
from refdof._jit import JIT_DISABLED, thread_count
from refdof.cli import app
from refdof.image.file import load_image
from refdof.methods._contract import BASES
from tests.one_line import refused

SMALL = ["--size", "48x36", "--samples", "64"]


def refdof(*words, cwd=None):
    command = [sys.executable, "-m", "refdof.cli", *words]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, cwd=cwd)


def test_scenes_and_methods_list_the_registry():
    listed = refdof("scenes", "--json")
    assert [row["scene"] for row in json.loads(listed.stdout)] == list(SCENES)
    listed = refdof("methods", "--json")
    assert [row["method"] for row in json.loads(listed.stdout)] == list(METHODS)
    # Each with its source, what kind that is, and its known defects, a line each.
    blocks = re.split(r"^(?=\S)", refdof("methods").stdout, flags=re.MULTILINE)[1:]
    assert [block.split("\n", 1)[0] for block in blocks] == list(METHODS)
    for block, module in zip(blocks, METHODS.values(), strict=True):
        method = module.METHOD
        assert f" {method.source} ({method.basis}). " in " ".join(block.split()), method.source
        lines = [line[6:] for line in block.splitlines() if line.startswith("    - ")]
        assert lines == list(method.known_defects)
        assert re.search(r"radius (\S+) of the disc's, energy (\S+)\.$", block, re.MULTILINE).groups() == tuple(
            f"{number:.2f}" for number in method.kernel
        )
    assert {module.METHOD.basis for module in METHODS.values()} == set(BASES)


def test_only_their_own_commands_import_the_oracle_and_explanations():
    looks = (
        "import sys, refdof.cli; print([m for m in sys.modules if m.startswith(('refdof.oracle', 'refdof.explain'))])"
    )
    done = subprocess.run([sys.executable, "-c", looks], capture_output=True, text=True, timeout=300)
    assert done.stdout.strip() == "[]", done.stderr
    listed = CliRunner().invoke(app, ["--help"]).output
    assert all(command in listed for command in ("render", "golden", "check", "diagnose", "explain"))


def test_compare_writes_everything(tmp_path):
    done = refdof("compare", "branches", *SMALL, "--out", "here", "--set", "accumulation.samples=16", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("### branches, 48 x 36")
    assert max(map(len, done.stdout.splitlines())) <= 80
    assert done.stdout.endswith("\nReport: here/report.html; all columns: here/table.md, or --wide\n")
    names = {path.name for path in (tmp_path / "here").iterdir()}
    assert names >= {"table.md", "table.csv", "table.json", "overview.png", "report.html"}
    assert names >= {f"{name}.{kind}" for name in [*METHODS, "reference"] for kind in ("png", "npy")}
    table = json.loads((tmp_path / "here" / "table.json").read_text())
    assert table["scene"] == "branches"
    assert {row["method"]: row["params"] for row in table["rows"]}["accumulation"]["samples"] == 16


# Runs a comparison, and writes down of every run of a method, and of every making of a product that methods share, how
# many functions Numba compiled or read from a file meanwhile.
WATCHED = """
import json, sys
import refdof.compare
from contextlib import contextmanager
from numba.core import event
from refdof._jit import compile as jit
from refdof.cli import main
from refdof.view import View

runs, products, reads = [], {}, []
load, render_view, product = jit._KeyedFiles.load, refdof.compare.render_view, View.product

@contextmanager
def counted(told):
    first = len(reads)
    with event.install_recorder("numba:compile") as compiled:
        yield
    told(len(compiled.buffer) + len(reads) - first)

def read(files, key):
    reads.append(key)
    return load(files, key)

def watched(method, view, *args, **kwargs):
    before = len(runs)
    with counted(lambda count: runs.insert(before, [method, result.seconds["blur"], count])):
        result = render_view(method, view, *args, **kwargs)
    return result

def made(view, name, build):
    def watched_build():
        with counted(lambda count: products.update({name: count})):
            return build()
    return product(view, name, watched_build)

jit._KeyedFiles.load, refdof.compare.render_view, View.product = read, watched, made
try:
    main()
finally:
    json.dump([runs, products], open("seen.json", "w"))
"""


@pytest.mark.slow
@pytest.mark.skipif(JIT_DISABLED, reason="about compiled code; the compiled pass runs it")
def test_no_time_of_a_first_table_has_compiling_in_it(tmp_path):
    # Without a cache. This method was 170 times too slow in a first table, since a small picture before it does not
    # compile all. What counts is what Numba itself says, not a clock: other programs slow times down.
    words = ["compare", "cans", "--methods", "mipmap", "--samples", "16", "--size", "320x240", "--out", "here"]
    environment = {**os.environ, "REFDOF_CACHE_DIR": str(tmp_path / "cache")}
    done = subprocess.run(
        [sys.executable, "-c", WATCHED, *words], env=environment, cwd=tmp_path, capture_output=True, timeout=600
    )
    assert done.returncode == 0, done.stderr
    runs, products = json.loads((tmp_path / "seen.json").read_text())
    assert any(count for *_, count in runs)  # it has something to leave out
    assert "pinhole" in products
    assert not any(products.values())
    for row in json.loads((tmp_path / "here" / "table.json").read_text())["rows"]:
        warm = [seconds for method, seconds, count in runs if method == row["method"] and not count]
        assert row["runs"] == 3
        assert row["blur_s"] == pytest.approx(np.median(warm[-3:]), abs=1e-6)
        assert len(warm) == 3
    marks = {path.name for path in (tmp_path / "cache").glob("*/*.warm")}
    alone = thread_count() < 2  # then nothing is compiled ahead
    assert marks == (set() if alone else {"reference.warm", "mipmap-best.warm"})


def test_the_command_in_a_report_works_again(tmp_path):
    words = ["branches", "--methods", "singlepass", *SMALL, "--eye", "-0.5,1.5,6", "--up", "0.1,1,0", "--fov", "33.3"]
    words += ["--motion", "3"]
    done = refdof("compare", *words, "--out", "first", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    first = json.loads((tmp_path / "first" / "table.json").read_text())
    assert first["camera"]["eye"] == [-0.5, 1.5, 6.0]
    assert first["command"] == "refdof " + shlex.join(["compare", *words, "--out", "first"])
    assert first["command"] in (tmp_path / "first" / "report.html").read_text()
    again = refdof(*shlex.split(first["command"])[1:-1], "second", cwd=tmp_path)
    assert again.returncode == 0, again.stderr
    for name in ("reference.npy", "singlepass.npy"):
        np.testing.assert_array_equal(np.load(tmp_path / "first" / name), np.load(tmp_path / "second" / name))
    # Flicker too: the number, and all frames.
    second = json.loads((tmp_path / "second" / "table.json").read_text())
    assert first["motion"] == second["motion"]
    assert (first["motion"]["frames"], first["motion"]["size"], first["motion"]["samples"]) == (3, [48, 36], 64)
    assert first["rows"][0]["flicker"] == second["rows"][0]["flicker"] != 0.0
    for name in ("motion.png", "motion_strip.png"):
        assert (tmp_path / "first" / name).read_bytes() == (tmp_path / "second" / name).read_bytes()


def test_both_presets_at_once(tmp_path):
    words = ("--methods", "mipmap,singlepass", "--preset", "best,paper")
    done = refdof("compare", "branches", *words, *SMALL, "--out", "here", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    rows = json.loads((tmp_path / "here" / "table.json").read_text())["rows"]
    told = [(row["method"], row["preset"], row["params"].get("blend")) for row in rows]
    assert told == [("mipmap", "best", "linear"), ("mipmap", "paper", "geometric"), ("singlepass", "best", None)]
    assert (tmp_path / "here" / "mipmap-paper.png").exists()
    assert "| mipmap (paper) |" in done.stdout
    listed = {row["method"]: row["paper"] for row in json.loads(refdof("methods", "--json").stdout)}
    assert listed["mipmap"] == {"blend": "geometric", "depth_format": "f16"}
    assert listed["multiview"]["wall_px"] == "inf"  # JSON has no infinite numbers
    assert listed["scatter"] == {}


def test_compare_takes_files_and_several_scenes(tmp_path):
    (tmp_path / "card.obj").write_text("v -1 -1 0\nv 1 -1 0\nv 1 1 0.5\nv -1 1 0.5\nf 1 2 3 4\n")
    done = refdof("compare", "card.obj", "branches", "--methods", "singlepass", *SMALL, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out" / "branches" / "singlepass.png").exists()
    assert len(json.loads((tmp_path / "out" / "table.json").read_text())) == 2


def test_the_same_command_gives_the_same_picture(tmp_path):
    for threads, name in ((1, "a.npy"), (2, "b.npy")):
        words = (
            "--method",
            "accumulation",
            "--samples",
            "16",
            "--size",
            "40x30",
            "--threads",
            str(threads),
            "-o",
            name,
        )
        done = refdof("render", "branches", *words, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
    np.testing.assert_array_equal(np.load(tmp_path / "a.npy"), np.load(tmp_path / "b.npy"))


@pytest.mark.parametrize("suffix", [".png", ".exr", ".npy"])
def test_render_writes_the_kind_that_the_name_says(tmp_path, suffix):
    done = refdof("render", "branches", "--method", "singlepass", "--size", "20x15", "-o", f"a{suffix}", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert load_image(tmp_path / f"a{suffix}").shape == (15, 20, 3)


def test_render_writes_stages_that_other_languages_read(tmp_path):
    words = ("--method", "singlepass", "--size", "20x15", "--set", "max_taps=9", "-o", "a.npy", "--stages", "here")
    done = refdof("render", "branches", *words, "--steps", "3,9", "--pixel", "4,5", "--pixel", "0,14", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    index = json.loads((tmp_path / "here" / "arrays.json").read_text())
    assert set(index["arrays"]) == {
        "image", "coc", "size", "limit", "taps", "weight_sum", "reach_3", "reach_9", "weight_3", "weight_9", "mean_3",
        "mean_9", "probes",
    }  # fmt: skip
    picture = np.load(tmp_path / "a.npy")
    assert np.array_equal(np.load(tmp_path / "here" / "image.npy"), picture)
    assert (tmp_path / "here" / "mean_9.f32").read_bytes() == picture.astype("<f4").tobytes()
    assert index["arrays"]["probes"]["shape"] == [2, 10, 13]
    assert index["arrays"]["taps"]["columns"] == ["x", "y", "radius"]
    assert index["methods"]["singlepass"]["params"]["max_taps"] == 9


def test_export_writes_inputs_and_stages(tmp_path):
    words = ("--size", "16x12", "--layers", "2", "--set", "singlepass.loop_bound=4", "--json")
    done = refdof("export", "branches", *words, "--out", "here", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    assert said["out"] == "here"
    assert {"poisson", "singlepass"} <= set(said["methods"].split(","))
    index = json.loads((tmp_path / "here" / "arrays.json").read_text())
    assert {"color", "depth", "coc", "layer_color", "layer_depth", "singlepass/image", "singlepass/probes"} <= set(
        index["arrays"]
    )
    assert index["arrays"]["layer_depth"]["shape"] == [2, 12, 16]


def test_help_keeps_its_units():
    """Rich reads [px] as markup and drops it."""
    for command in ("render", "compare"):
        text = CliRunner().invoke(app, [command, "--help"], env={"COLUMNS": "200"}).output
        assert "Image size in pixels" in text
        assert "Lens radius in scene units" in text
        assert "Focus distance in scene units" in text


def test_bad_input_from_a_shell():
    done = refdof("compare", "fenc")
    assert done.returncode == 2
    assert done.stderr.startswith("refdof: scene: got 'fenc'; did you mean 'fence'?")
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["compare", "fenc"], "scene: got 'fenc'; did you mean 'fence'"),
        (["compare", "nothing.obj"], "scene: got"),
        (["compare", "fence", "--methods", "multivew"], "methods: got 'multivew'; did you mean 'multiview'"),
        (["compare", "fence", "--methods", "mipmap, multivew"], "methods: got 'multivew'"),
        (["compare", "fence", "--methods", "singlepas"], "did you mean 'singlepass'"),
        (["compare", "fence", "--size", "640"], "size: got '640'; allowed is WIDTHxHEIGHT"),
        (["compare", "fence", "--size", "0x10"], "size: got '0x10'; allowed is WIDTHxHEIGHT"),
        (["compare", "fence", "--size", "10x10"], "size: got 10x10; allowed for scores is at least 11x11"),
        (["compare", "fence", "--size", "99999x10"], "size: got"),
        (["compare", "fence", "--eye", "1,2"], "refdof: eye: got '1,2'; allowed is X,Y,Z, three numbers"),
        (["compare", "fence", "--eye", "1,2,x"], "refdof: eye: got '1,2,x'; allowed is X,Y,Z, three numbers"),
        (["compare", "fence", "--target", "1,2,3,4"], "refdof: target: got '1,2,3,4'; allowed is X,Y,Z"),
        (["compare", "fence", "--target", "inf,0,0"], "refdof: target: "),
        (["compare", "fence", "--up", ""], "refdof: up: got ''; allowed is X,Y,Z, three numbers"),
        (["compare", "fence", "--up", "0,nan,0"], "refdof: up: "),
        (
            ["compare", "fence", "--eye", "1,2,3", "--target", "1,2,3"],
            "refdof: target: got (1.0, 2.0, 3.0), the same point as eye",
        ),
        (
            ["export", "fence", "--out", "a", "--eye", "0,0,5", "--target", "0,0,0", "--up", "0,0,2"],
            "refdof: up: got (0.0, 0.0, 2.0), parallel to the view",
        ),
        (["compare", "fence", "--fov", "180"], "refdof: fov: got 180; allowed is a finite number >= 1e-06 and <= 179"),
        (["pick", "fence", "--pixel", "1,1", "--fov", "0"], "refdof: fov: got 0; allowed is"),
        (["compare", "fence", "--lens-radius", "-1"], "refdof: lens-radius: got -1; allowed is a finite number >= 0"),
        (["compare", "fence", "--lens-radius", "nan"], "lens-radius: got nan"),
        (["compare", "fence", "--focus", "0"], "refdof: focus: got 0; allowed is a number > 0"),
        (["compare", "fence", "--samples", "0"], "samples: got 0; allowed is a whole number in 1"),
        (["compare", "fence", "--motion", "2"], "motion: got 2; allowed is a whole number in 3 .. 64"),
        (["compare", "fence", "--motion", "65"], "motion: got 65; allowed is a whole number in 3 .. 64"),
        (["compare", "fence", "--motion", "1.5"], "refdof: motion: got '1.5'; allowed is a whole number\n"),
        (["compare", "fence", "--motion", "3", "--focus", "inf"], "motion: got 3 with focus at infinity"),
        (["compare", "fence", "--tolerance", "0"], "tolerance: got 0; allowed is a finite number > 0"),
        (["compare", "fence", "--seed", "-1"], "seed: got -1"),
        (
            ["compare", "fence", "--out", "/dev/null/x"],
            "out: got '/dev/null/x', but /dev/null",
        ),
        (["compare", "fence", "--threads", "0"], "threads: got 0"),
        (["compare", "fence", "--set", "samples=3"], "set: got 'samples=3'; allowed is METHOD.KEY=VALUE"),
        (["compare", "fence", "--set", "accumulation.sample=3"], "did you mean 'samples'"),
        (["compare", "fence", "--set", "accumulation.samples=many"], "samples: got 'many'"),
        (
            ["compare", "fence", "--set", "singlepass.depth_filter=cubic"],
            "depth_filter: got 'cubic'; allowed are nearest",
        ),
        (["render", "fence", "--method", "nothing", "-o", "a.png"], "method: got 'nothing'; allowed are"),
        (
            ["render", "fence", "--method", "singlepass", "-o", "a.jpg"],
            "output: got 'a.jpg'; allowed are names that end",
        ),
        (["render", "fence", "--method", "singlepass", "--size", "20x15", "-o", "/proc/no/a.png"], "out"),
        (["render", "fence", "--method", "singlepass"], "Missing option"),
        (["render", "fence", "--method", "singlepass", "--samples", "4", "-o", "a.png"], "singlepass: got 'samples'"),
        (["compare", "fence", "--preset", "papre"], "preset: got 'papre'; did you mean 'paper'"),
        (["compare", "fence", "--preset", "best,"], "preset: got ''"),
        (
            ["render", "fence", "--method", "singlepass", "--preset", "Best", "-o", "a.png"],
            "preset: got 'Best'; did you mean 'best'",
        ),
        (
            ["render", "fence", "--method", "singlepass", "--size", "9x9", "-o", "a.npy", "--stages", "/proc/no"],
            "stages: ",
        ),
        (["export", "fence", "--out", "a", "--steps", "1,x"], "steps: got '1,x'; allowed"),
        (
            [
                "render",
                "fence",
                "--method",
                "singlepass",
                "--size",
                "9x9",
                "-o",
                "a.npy",
                "--stages",
                "b",
                "--pixel",
                "9,0",
            ],
            "pixel: got '9,0'; allowed are 0,0 .. 8,8",
        ),
        (["export", "fence", "--out", "/dev/null"], "out: got '/dev/null', but /dev/null is not a writable folder"),
        (["export", "fence", "--out", "a", "--methods", "singlepas"], "methods: got 'singlepas'; did you mean"),
        (["export", "fence", "--out", "a", "--pixel", "3"], "pixel: got '3'; allowed is X,Y"),
        (["export", "fence", "--out", "a", "--pixel", "3,-1"], "pixel: got '3,-1'; allowed are whole numbers"),
        (["export", "fence", "--out", "a", "--layers", "0"], "layers: got 0; allowed is a whole number in 1 .. 64"),
        (["export", "fence", "--out", "a", "--set", "singlepass.rad_scale=0"], "rad_scale: got 0"),
        (["rendr"], "No such command 'rendr'"),
        (["compare", "fence", "--frobnicate"], "No such option"),
    ],
)
def test_bad_input_is_one_line_and_status_2(tmp_path, monkeypatch, capsys, words, message):
    monkeypatch.chdir(tmp_path)
    assert message in refused(monkeypatch, capsys, *words)
    assert not list(tmp_path.rglob("*.png"))

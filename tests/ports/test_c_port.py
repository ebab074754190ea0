"""The single pass in C: within the bounds of every case, and refuses bad folders. Faults: `tests.oracle.mutations`.

REFDOF_REQUIRE_CC=1 makes a missing compiler a failure.
"""

import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from refdof.oracle import check_command
from tests.ports.cases import CASES, lay_down, outside

SOURCE = (Path(__file__).parents[2] / "ports" / "c" / "singlepass.c").read_text()


@pytest.fixture(scope="session")
def compiler():
    found = shutil.which("cc")
    if found is None:
        reason = "no C compiler: there is no `cc`"
        if os.environ.get("REFDOF_REQUIRE_CC") == "1":
            pytest.fail(f"REFDOF_REQUIRE_CC is set, but {reason}", pytrace=False)
        pytest.skip(reason)
    return found


@pytest.fixture(scope="session")
def folders(tmp_path_factory):
    root = tmp_path_factory.mktemp("cases")
    return {case.name: lay_down(case, root) for case in CASES}


@pytest.fixture(scope="session")
def program(compiler, tmp_path_factory):
    return build(compiler, SOURCE, tmp_path_factory.mktemp("port"), "-Wall", "-Wextra", "-Werror", "-pedantic")


def build(compiler, source, folder, *options):
    (folder / "port.c").write_text(source)
    command = [compiler, "-std=c99", "-O2", *options, "-o", folder / "port", folder / "port.c", "-lm"]
    subprocess.run(command, check=True, capture_output=True, text=True, timeout=60)
    return folder / "port"


def picture_of(program, place, case, out):
    subprocess.run([program, "--case", place, "--out", out], check=True, capture_output=True, timeout=60)
    return np.fromfile(out / "image.f32", dtype="<f4").reshape(case.height, case.width, 3)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_every_case_is_within_its_bounds(case, program, folders, tmp_path):
    image = picture_of(program, folders[case.name], case, tmp_path)
    print(f"{outside(image, case):.2f} tolerances; {outside(case.expected, case):.2f} are refdof's own")
    assert outside(image, case) <= 1.0
    assert outside(case.expected, case) <= 1.0


def test_ties_need_bounds():
    """Some pixels of a right port are far from the one expected picture, and none is where nothing is tied."""
    low, high = CASES[0].bounds
    assert (high - low).max() > 1e-2
    assert 0.01 < (low < high).any(axis=-1).mean() < 0.5


@pytest.mark.parametrize("line", ["depth_filter bilinear", "order size", "shift_x 0.5", "max_taps 9"])
def test_what_it_does_not_do_is_status_77(line, program, tmp_path):
    place = lay_down(CASES[0], tmp_path)
    with (place / "params.txt").open("a") as file:
        file.write(f"{line}\n")
    done = subprocess.run([program, "--case", place, "--out", tmp_path], capture_output=True, text=True, timeout=60)
    assert done.returncode == 77
    assert done.stderr == f"singlepass: {line.split()[0]}: a value that this port does not have\n"


@pytest.mark.parametrize(
    ("file", "content", "message"),
    [
        ("params.txt", None, "params.txt: cannot be opened"),
        ("params.txt", b"", "params.txt: width, height or focus is missing"),
        ("params.txt", b"width 64\nheight -48\n", "height: no number, or out of range"),
        ("params.txt", b"width 64\nheight 48\nrad_scale nan\n", "rad_scale: no number, or out of range"),
        ("params.txt", b"width 64\nheight 48\ncoc_scale 40\n", "params.txt: width, height or focus is missing"),
        ("inputs/coc.f32", None, "inputs/coc.f32: cannot be opened"),
        ("inputs/depth.f32", b"\0" * 7, "inputs/depth.f32: too short"),
        ("inputs/color.f32", b"\0" * (64 * 48 * 12 + 1), "inputs/color.f32: too long"),
    ],
)
def test_a_bad_folder_is_refused_in_one_line(file, content, message, program, tmp_path):
    place = lay_down(CASES[0], tmp_path)
    (place / file).unlink() if content is None else (place / file).write_bytes(content)
    done = subprocess.run([program, "--case", place, "--out", tmp_path], capture_output=True, text=True, timeout=60)
    assert done.returncode == (77 if "filter" in message else 2)  # 77: not supported
    assert message in done.stderr
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "image.f32").exists()


def test_the_core_pack_passes(program):
    pack = Path(__file__).parents[2] / "data" / "packs" / "core"
    report = check_command(f"{program} --case {{case}} --out {{out}}", pack)
    assert report.passed, [outcome.message for outcome in report.outcomes if outcome.status not in ("pass", "waived")]
    assert {outcome.status for outcome in report.outcomes if "singlepass" in outcome.case} == {"pass"}

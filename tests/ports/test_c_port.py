"""The single pass in C: within the bounds of every case, refuses bad folders, and no planted fault passes.

REFDOF_REQUIRE_CC=1 makes a missing compiler a failure.
"""

import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from refdof.oracle import check_command
from tests.ports.cases import CASES, caught, lay_down, mutated, outside

SOURCE = (Path(__file__).parents[2] / "ports" / "c" / "singlepass.c").read_text()

FAULTS = {
    "the loop ends at half its bound": ("radius < p->loop_bound;", "radius < 0.5f * p->loop_bound;"),
    "the loop ends a tap early": ("radius < p->loop_bound;", "radius + p->rad_scale / radius < p->loop_bound;"),
    "the first tap is skipped": ("(float radius = p->radius_start;", "(float radius = 2.0f * p->radius_start;"),
    "the radius grows by a constant": ("radius += p->rad_scale / radius)", "radius += p->rad_scale)"),
    "the radius scale is the listing's": ("(float radius = p->radius_start;", "(float radius = 0.5f;"),
    "the largest circle is the listing's": ("radius < p->loop_bound;", "radius < 20.0f;"),
    "the spiral is mirrored": ("v + sinf(angle)", "v - sinf(angle)"),
    "sine for cosine": ("u + cosf(angle)", "u + sinf(angle)"),
    "a wrong digit of the golden angle": ("2.39996323f", "2.39966323f"),
    "the angle is advanced first": ("angle = p->angle_start;", "angle = p->angle_step;"),
    "the ellipse of a scalar pixel size": ("sinf(angle) * pixel_v", "sinf(angle) * pixel_u"),
    "the pixel is left of its centre": ("((float)x + 0.5f)", "((float)x)"),
    "colour half a pixel off": ("float x = u * (float)p->width - 0.5f,", "float x = u * (float)p->width,"),
    "depth half a pixel off": ("clamped(floorf(v * (float)p->height),", "clamped(floorf(v * (float)p->height - 0.5f),"),
    "colour at the nearest texel": ("float across = x - floorf(x), down", "float across = x - floorf(x) > 0.5f, down"),
    "no blend between rows": ("down = y - floorf(y);", "down = 0.0f;"),
    "the picture wraps": (
        "return (int)fminf(fmaxf(index, 0.0f), (float)(count - 1));",
        "return ((int)index % count + count) % count;",
    ),
    "circles are not cut": ("fminf(fabsf(p->coc[texel]), p->max_blur_size)", "fabsf(p->coc[texel])"),
    "near circles are lost": ("fabsf(p->coc[texel])", "fmaxf(p->coc[texel], 0.0f)"),
    "diameters": ("fabsf(p->coc[texel])", "2.0f * fabsf(p->coc[texel])"),
    "the limit is the listing's": ("p->behind_factor * center_size", "2.0f * center_size"),
    "the order is by size": ("p->depth[texel] > p->depth[center]", "size > center_size"),
    "no limit from behind": ("p->behind_factor * center_size", "p->max_blur_size"),
    "the limit of the text": ("p->behind_factor * center_size", "1.0f * center_size"),
    "the other side is limited": ("p->depth[texel] > p->depth", "p->depth[texel] < p->depth"),
    "both sides are limited": ("p->depth[texel] > p->depth", "p->depth[texel] != p->depth"),
    "a hard rim": ("float t = fminf(fmaxf((value - low) / (high - low), 0.0f), 1.0f);", "float t = value >= low;"),
    "a linear rim": ("return t * t * (3.0f - 2.0f * t);", "return t;"),
    "the rim half a pixel out": ("smoothstep(radius - 0.5f, radius + 0.5f", "smoothstep(radius, radius + 1.0f"),
    "no mean where a tap misses": ("color[c] / total * (1.0f - m) + ", ""),
    "the total starts at nothing": ("float total = 1.0f, angle", "float total = 1e-6f, angle"),
    "the sum is divided by one too few": ("color[c] /= total;", "color[c] /= 398.0f;"),
    "the centre's red and blue are swapped": (
        "color[c] = color_at(p, u, v, c);",
        "color[c] = color_at(p, u, v, 2 - c);",
    ),
}


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


@pytest.mark.parametrize("fault", FAULTS)
def test_no_planted_fault_passes(fault, compiler, folders, tmp_path):
    program = build(compiler, mutated(SOURCE, *FAULTS[fault]), tmp_path)
    found = caught(lambda case: picture_of(program, folders[case.name], case, tmp_path))
    print(f"{fault}: {found}")
    assert found is not None


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

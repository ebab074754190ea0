"""The C port against a pack, as a porter runs the check; it needs no Python but for that."""

import subprocess

import numpy as np
import pytest

from refdof.oracle import Plan, check_command
from refdof.oracle.cases import Case
from tests.packs import pack_of
from tests.ports.cases import mutated
from tests.ports.test_c_port import SOURCE, build, compiler  # noqa: F401 (a fixture)

pytestmark = pytest.mark.fast

PARAMS = {
    "rad_scale": 0.8,
    "max_blur_size": 9.0,
    "behind_factor": 1.5,
    "radius_start": 1.3,
    "loop_bound": 7.0,
    "angle_start": 0.7,
    "angle_step": 2.3,
}
CASES = [
    Case("listing", "singlepass", "cards", (24, 18), {"loop_bound": 9.0}),
    Case("others", "singlepass", "cards", (24, 18), PARAMS),
    Case("mirrored", "singlepass", "cards", (24, 18), PARAMS | {"row_order": "up"}),
    Case("up", "singlepass", "cards", (24, 18), PARAMS | {"row_order": "up"}, "up"),
    Case("sizes", "singlepass", "cards", (24, 18), PARAMS | {"order": "size"}),
]
IGNORED = {
    "radius_start": ("float radius = p->radius_start", "float radius = p->rad_scale"),
    "loop_bound": ("radius < p->loop_bound", "radius < p->max_blur_size"),
    "angle_start": ("angle = p->angle_start", "angle = 0.0f"),
    "angle_step": ("angle += p->angle_step", "angle += 2.39996323f"),
    "row_step": (" * p->row_step", ""),
}


@pytest.fixture(scope="module")
def pack(tmp_path_factory):
    return pack_of(CASES, tmp_path_factory.mktemp("oracle") / "pack")


def check(source, compiler, folder, pack, plan=Plan()):  # noqa: F811 (the fixture's value)
    program = build(compiler, source, folder)
    return check_command(f"'{program}' --case {{case}} --out {{out}}", pack, timeout=60, plan=plan)


def test_every_key_of_a_pack_is_understood(compiler, pack, tmp_path):  # noqa: F811
    report = check(SOURCE, compiler, tmp_path, pack)
    assert [outcome.status for outcome in report.outcomes] == [*["pass"] * 4, "not supported"], report.outcomes
    assert report.outcomes[-1].message == "singlepass: order: a value that this port does not have"


@pytest.mark.parametrize("key", IGNORED)
def test_a_key_that_is_ignored_shows(compiler, pack, tmp_path, key):  # noqa: F811
    report = check(mutated(SOURCE, *IGNORED[key]), compiler, tmp_path, pack, Plan(only="mirrored"))
    assert [outcome.status for outcome in report.outcomes] == ["fail"]


def test_circles_are_its_own_unless_they_are_given(compiler, pack, tmp_path):  # noqa: F811
    wrong = mutated(SOURCE, "picture.coc_scale * (1.0f", "0.25f * picture.coc_scale * (1.0f")
    assert check(wrong, compiler, tmp_path, pack, Plan(only="others")).outcomes[0].status == "fail"
    case = tmp_path / "others"
    (case / "inputs").mkdir(parents=True)
    for name in ("color", "depth", "coc"):
        values = np.load(pack / "cases" / "others" / "inputs" / f"{name}.npy")
        values.tofile(case / "inputs" / f"{name}.f32")
    params = (pack / "cases" / "others" / "params.txt").read_text()
    images = {}
    for given in ("", "given coc\n"):
        (case / "params.txt").write_text(params + given)
        subprocess.run([tmp_path / "port", "--case", case, "--out", tmp_path], check=True, timeout=60)
        images[given] = np.fromfile(tmp_path / "image.f32", "<f4")
    golden = np.load(pack / "cases" / "others" / "expected" / "image.npy").ravel()
    assert np.abs(images["given coc\n"] - golden).max() < 1e-3 < np.abs(images[""] - golden).max()

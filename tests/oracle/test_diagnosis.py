"""Diagnosis: independent wrong ports get their cause named first; right ones none, and nonsense no explanation."""

import json
import re
import shlex
import sys

import numpy as np
import pytest
from typer.testing import CliRunner

from refdof import InputError
from refdof.cli import app
from refdof.methods.singlepass.params import GOLDEN_ANGLE
from refdof.oracle import diagnose
from refdof.oracle.cases import Case
from refdof.oracle.diagnosis.beyond import in_place as beyond_in_place
from refdof.oracle.diagnosis.beyond import turned as beyond_turned
from refdof.oracle.diagnosis.causes import CAUSES, STAGES, cause_of
from refdof.oracle.diagnosis.image_switches import image_switches
from refdof.oracle.diagnosis.probes import probe
from refdof.oracle.diagnosis.search import search
from refdof.oracle.diagnosis.shots import probed, shots_of, telling
from refdof.oracle.diagnosis.switches import size_switches
from refdof.oracle.diagnosis.tap_switches import tap_switches
from refdof.oracle.files import open_pack
from refdof.oracle.sources import of_function
from tests.oracle.wrong_ports import WRONG, in_place, mixed, port, short_and_shifted, turned
from tests.packs import pack_of

CASES = [
    Case("cards", "singlepass", "cards", (40, 30)),
    Case("noise", "singlepass", "noise", (32, 24)),
    Case("impulses", "singlepass", "impulses", (32, 32)),
]


@pytest.fixture(scope="module")
def pack(tmp_path_factory):
    """A pack of three small cases."""
    return pack_of(CASES, tmp_path_factory.mktemp("diagnosis") / "pack")


def test_every_cause_has_a_stage_and_one_key():
    assert len({cause.key for cause in CAUSES}) == len(CAUSES) >= 45
    assert {cause.stage for cause in CAUSES} == set(STAGES)
    with pytest.raises(InputError, match="key: got 'no'"):
        cause_of("no")


def test_a_right_port_has_no_cause(pack):
    found = diagnose(port, pack)
    assert (found.key, found.stage) == ("none", "")
    assert found.lines()[0].startswith("no difference")


@pytest.mark.parametrize("cause", [("shift", "taps"), ("gamma", "image")], ids=str)
def test_a_wrong_port_has_its_cause_named_first(pack, cause):
    found = diagnose(WRONG[cause], pack)
    print("\n".join(found.lines()))
    assert (found.key, found.stage) == cause
    assert found.exact > 0.9
    assert len(found.causes) == 1
    if cause[0] == "shift":
        assert found.causes[0].sentence == "all reads are shifted by +0.50 px in x and +0.50 px in y"
    if cause[0] == "gamma":
        assert "not linear" in "\n".join(found.probes)


@pytest.mark.parametrize("cause", WRONG, ids=lambda cause: cause[0])
def test_of_the_values_of_a_cause_one_gives_what_a_wrong_port_gives(pack, cause):
    """The search with the switches of few keys: quick enough for every cause."""
    shots, _ = shots_of(open_pack(pack), of_function(WRONG[cause]), None)
    chosen = telling(shots)
    switches = [*size_switches(), *tap_switches(chosen[0].right), *image_switches()]
    few = [switch for switch in switches if switch.key in ("behind_factor", "channels", cause[0])]
    best = search(chosen, few)[0]
    assert [step.switch.key for step in best.steps] == [cause[0]]
    assert best.is_exact
    assert cause_of(cause[0]).stage == cause[1]


def test_two_mistakes_at_once(pack):
    found = diagnose(mixed, pack)
    assert {cause.key for cause in found.causes} == {"behind_factor", "row_order"}
    assert found.exact > 0.9


def test_ports_that_no_model_gives(pack):
    opened = open_pack(pack)
    for port_of, beyond, other in (
        (in_place, beyond_in_place, beyond_turned),
        (turned, beyond_turned, beyond_in_place),
    ):
        shots, _ = shots_of(opened, of_function(port_of), "cards")
        assert beyond(shots) > 0.75
        assert other(shots) is None


def test_nonsense_is_unexplained(pack):
    found = diagnose(lambda color, *_: np.random.default_rng(3).random(color.shape), pack)
    assert found.key == "unexplained"
    assert "explains" in found.evidence


def test_results_that_no_model_is_needed_for(pack):
    assert diagnose(lambda color, *_: np.full_like(color, np.nan), pack).key == "not_finite"
    assert diagnose(lambda color, *_: np.full_like(color, 0.5), pack).key == "constant"


def test_probes_show_a_shift_and_a_short_loop(pack):
    opened = open_pack(pack)
    shots, _ = shots_of(opened, of_function(short_and_shifted), "impulses")
    lines = probe(of_function(short_and_shifted), *probed(opened, shots))
    assert "linear in colour" in lines[1]
    rows = [[float(word) for word in re.findall(r"[-+]?\d+\.\d+", line)] for line in lines if "middle" in line]
    (_, *expected), (total, *got) = rows
    # Every tap and the pixel itself have the same share where all discs are beyond the loop.
    radii = [0.5]
    while radii[-1] < 8.8:
        radii.append(radii[-1] + 0.5 / radii[-1])
    turns = GOLDEN_ANGLE * np.arange(len(radii) - 1)
    places = np.array([[0.0, *np.multiply(radii[:-1], wave(turns))] for wave in (np.cos, np.sin)])
    assert total == 1.0
    assert got[:2] == pytest.approx(places.mean(axis=1) + 0.5, abs=0.01)
    assert got[2:] == pytest.approx(places.std(axis=1), abs=0.1)  # a blend of texels spreads, too
    assert min(expected[2:]) > 2.0 * max(got[2:])


def test_probes_in_which_nothing_differs_are_left_out(pack):
    opened = open_pack(pack)
    shots, _ = shots_of(opened, of_function(port), "impulses")
    assert probe(of_function(port), *probed(opened, shots)) == []

    bright = shots[0].expected[..., 1].copy()
    np.fill_diagonal(bright, 0.0)  # so that rows and columns cannot be exchanged
    y, x = np.unravel_index(np.argmax(bright), bright.shape)

    def darker(color, depth, coc, params):
        image = port(color, depth, coc, params)
        image[y, x] *= 0.5
        return image

    shots, _ = shots_of(opened, of_function(darker), "impulses")
    lines = probe(of_function(darker), *probed(opened, shots))
    assert lines[2] == f"  taps of pixel ({x}, {y}):"
    assert f"  weight of texel ({x}, {y}) in the pixels around it, in thousandths:" in lines
    assert ["weights sum to 1.0000" in lines[3], "weights sum to 0.5000" in lines[4]] == [True, True]


def test_the_command(pack, tmp_path):
    script = tmp_path / "port.py"
    script.write_text(
        "import sys, pathlib, numpy as np\ncase, out = map(pathlib.Path, sys.argv[1:])\n"
        "np.save(out / 'image.npy', np.load(case / 'inputs' / 'color.npy')[..., ::-1].copy())\n"
    )
    command = f"{shlex.quote(sys.executable)} {shlex.quote(str(script))} {{case}} {{out}}"
    told = tmp_path / "told.json"
    words = ["--pack", str(pack), "--impl", command]
    done = CliRunner().invoke(app, ["diagnose", *words, "--case", "cards", "--json", str(told)])
    assert done.exit_code == 1, done.output
    content = json.loads(told.read_text())
    assert {cause["key"] for cause in content["causes"]} == {"no_blur", "channels"}
    assert content["causes"][0]["sentence"] in done.output


@pytest.mark.parametrize(
    ("words", "said"),
    [({"function": 1}, "function: got int"), ({"case": "no"}, "case: got 'no'"), ({"pack": "/no"}, "pack: got '/no'")],
)
def test_bad_calls(pack, words, said):
    with pytest.raises(InputError, match=said):
        diagnose(**{"function": port, "pack": pack, **words})

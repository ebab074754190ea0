"""Diagnosis: independent wrong ports get their cause named first; right ones none, and nonsense no explanation."""

import json
import re
import shlex
import sys

import numpy as np
import pytest

from refdof import InputError
from refdof.cli import main
from refdof.oracle import diagnose, write_pack
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
from tests.oracle.wrong_ports import WRONG, in_place, mixed, port, turned

CASES = [
    Case("cards", "singlepass", "cards", (40, 30)),
    Case("noise", "singlepass", "noise", (32, 24)),
    Case("impulses", "singlepass", "impulses", (32, 32)),
]


@pytest.fixture(scope="module")
def pack(tmp_path_factory):
    """A pack of three small cases."""
    folder = tmp_path_factory.mktemp("diagnosis") / "pack"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("refdof.oracle.pack.cases_of", lambda level, methods: CASES)
        write_pack(folder)
    return folder


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


def probes_of(pack, fault):
    """The lines of probes, and of those with sums: middle in x and y, spread in x and y, expected and got."""
    source = of_function(WRONG[fault])
    opened = open_pack(pack)
    shots, _ = shots_of(opened, source, "impulses")
    lines = probe(source, *probed(opened, shots))
    numbers = [[float(word) for word in re.findall(r"[-+]?\d+\.\d+", line)] for line in lines if "middle" in line]
    return lines, numbers


def test_probes_show_a_shift_and_a_short_loop(pack):
    lines, ((total, *expected), (got_total, *got)) = probes_of(pack, ("shift", "taps"))
    assert "linear in colour" in lines[1]
    assert (total, got_total) == (1.0, 1.0)
    assert np.subtract(got[:2], expected[:2]) == pytest.approx([0.5, 0.5], abs=0.02)
    _, (expected, got) = probes_of(pack, ("loop_cut", "taps"))
    # The taps of a disc of radius R spread by R / 2, those of a picture's border less.
    assert got[3:] == pytest.approx([8.8 / 2, 8.8 / 2], abs=0.1)
    assert min(expected[3:]) > 9.0


def test_the_command(pack, tmp_path, capsys):
    script = tmp_path / "port.py"
    script.write_text(
        "import sys, pathlib, numpy as np\ncase, out = map(pathlib.Path, sys.argv[1:])\n"
        "np.save(out / 'image.npy', np.load(case / 'inputs' / 'color.npy')[..., ::-1].copy())\n"
    )
    command = f"{shlex.quote(sys.executable)} {shlex.quote(str(script))} {{case}} {{out}}"
    told = tmp_path / "told.json"
    with pytest.raises(SystemExit) as end:
        main(["diagnose", "--pack", str(pack), "--impl", command, "--case", "cards", "--json", str(told)])
    assert end.value.code == 1
    content = json.loads(told.read_text())
    assert {cause["key"] for cause in content["causes"]} == {"no_blur", "channels"}
    assert content["causes"][0]["sentence"] in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "said"),
    [({"function": 1}, "function: got int"), ({"case": "no"}, "case: got 'no'"), ({"pack": "/no"}, "pack: got '/no'")],
)
def test_bad_calls(pack, words, said):
    with pytest.raises(InputError, match=said):
        diagnose(**{"function": port, "pack": pack, **words})

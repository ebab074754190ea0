"""Diagnosis: independent wrong ports get their cause named first; right ones none, and nonsense no explanation."""

import json
import shlex
import sys

import numpy as np
import pytest

from refdof import InputError
from refdof.cli import main
from refdof.oracle import diagnose, write_pack
from refdof.oracle.cases import Case
from refdof.oracle.diagnosis.causes import CAUSES, STAGES, cause_of
from tests.oracle.wrong_ports import WRONG, mixed, port

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


@pytest.mark.parametrize("cause", WRONG, ids=lambda cause: cause[0])
def test_a_wrong_port_has_its_cause_named_first(pack, cause):
    found = diagnose(WRONG[cause], pack)
    print("\n".join(found.lines()))
    assert (found.key, found.stage) == cause
    assert found.exact > 0.9
    assert len(found.causes) == 1


def test_sentences_have_the_fitted_values(pack):
    assert (
        diagnose(WRONG["shift", "taps"], pack).causes[0].sentence.endswith("shifted by +0.50 px in x and +0.50 px in y")
    )
    assert "radius 8.8" in diagnose(WRONG["loop_cut", "taps"], pack).causes[0].sentence


def test_two_mistakes_at_once(pack):
    found = diagnose(mixed, pack)
    assert {cause.key for cause in found.causes} == {"behind_factor", "row_order"}
    assert found.exact > 0.9


def test_nonsense_is_unexplained(pack):
    found = diagnose(lambda color, *_: np.random.default_rng(3).random(color.shape), pack)
    assert found.key == "unexplained"
    assert "explains" in found.evidence


def test_results_that_no_model_is_needed_for(pack):
    assert diagnose(lambda color, *_: np.full_like(color, np.nan), pack).key == "not_finite"
    assert diagnose(lambda color, *_: np.full_like(color, 0.5), pack).key == "constant"


def test_probes_show_a_shift_and_a_short_loop(pack):
    lines = diagnose(WRONG["shift", "taps"], pack).probes
    middles = [line.split("middle is ")[1].split(",")[0] for line in lines if "middle" in line]
    (expected_x, expected_y), (got_x, got_y) = (
        [float(word) for word in middle.replace(" px in x and", "").replace(" in y", "").split()] for middle in middles
    )
    assert got_x - expected_x == pytest.approx(0.5, abs=0.02)
    assert got_y - expected_y == pytest.approx(0.5, abs=0.02)
    short = diagnose(WRONG["loop_cut", "taps"], pack).probes
    spreads = [float(line.split("spread ")[1].split()[0]) for line in short if "spread" in line]
    assert spreads[1] < 0.6 * spreads[0]


def test_probes_tell_what_is_not_linear(pack):
    lines = "\n".join(diagnose(WRONG["gamma", "image"], pack).probes)
    assert "not linear" in lines


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

"""Own and inherited errors: a port that shows its stages, wrong in one or two of them, is blamed where it is wrong."""

import numpy as np
import pytest

from refdof.methods.poisson import Params, code_of, gather, shrink
from refdof.oracle import Plan, check
from refdof.oracle.cases import Case
from refdof.stages import Stages
from tests.oracle.small_pack import of_case, staged_port, stages_of, statuses
from tests.packs import pack_of

pytestmark = pytest.mark.fast

PARTS = ("coc", "size", "limit", "mean_1", "mean_4", "image")

# Fault: {part: what is wrong with it}, own errors, and parts that surely inherit from them.
FAULTS = {
    "diameters": ({"coc": lambda s: 2 * s}, "coc", "size limit image"),
    "the sign of circles": ({"coc": lambda s: -s}, "coc", ""),
    "sizes too small": ({"size": lambda s: s / 2}, "size", "limit image"),
    "sizes that are not cut": ({"size": lambda s: s * 1.5}, "size", "limit image"),
    "another factor from behind": ({"limit": lambda s: s / 2}, "limit", "image"),
    "the first tap": ({"tap 1": (0.4, 0.0)}, "mean_1", "mean_4 image"),
    "the third tap": ({"tap 3": (0.9, 0.3)}, "mean_4", "image"),
    "a late tap": ({"tap 9": (1.0, 1.0)}, "image", ""),
    "a tone map": ({"image": lambda c: c / (1 + c)}, "image", ""),
    "two stages": ({"coc": lambda s: 1.1 * s, "tap 3": (0.9, 0.3)}, "coc mean_4", "size limit image"),
    "first and last": ({"size": lambda s: s / 2, "image": lambda c: 0.9 * c}, "size image", "limit"),
}


def faulty(faults):
    return of_case(lambda *words: staged_port(*words, faults), stages_of)


def test_a_right_port_passes_in_all_parts(pack):
    report = check(faulty({}), pack)
    assert statuses(report) == ["pass"] * 3, [outcome.message for outcome in report.outcomes]
    assert tuple(report.outcomes[0].findings) == PARTS
    assert all(outcome.causes == {} and outcome.first_wrong is None for outcome in report.outcomes)


@pytest.mark.long
@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("number", [0, 2], ids=["down", "up"])
def test_own_errors_and_inherited_ones(pack, fault, number):
    faults, own, inherited = FAULTS[fault]
    outcome = check(faulty(faults), pack, plan=Plan(only=("cards", "", "noise_up")[number])).outcomes[0]
    print(outcome.message)
    causes = {part: cause for part, cause in outcome.causes.items() if part in (*own.split(), *inherited.split())}
    assert causes == {part: "own" for part in own.split()} | {part: "inherited" for part in inherited.split()}
    assert "own" not in [cause for part, cause in outcome.causes.items() if part not in own.split()]
    assert outcome.first_wrong == own.split()[0]
    assert outcome.message.startswith(f"{outcome.first_wrong}: ")


def test_where_a_stage_is_nan_what_follows_is_unknown(pack):
    outcome = check(faulty({"coc": lambda s: np.full_like(s, np.nan)}), pack, plan=Plan(only="cards")).outcomes[0]
    assert outcome.causes["coc"] == "own"
    assert set(outcome.causes.values()) == {"own", "unknown"}
    assert outcome.own("image") is None


def test_a_right_picture_after_a_stage_that_is_only_shown_wrong(pack):
    def shown_wrong(*words):
        shown = staged_port(*words)
        return shown | {"size": 2 * shown["size"]}

    outcome = check(of_case(shown_wrong, stages_of), pack, plan=Plan(only="cards")).outcomes[0]
    assert outcome.causes == {"size": "own"}
    assert outcome.findings["image"].status == "pass"
    assert outcome.own("image").status == "fail"  # it does not follow from the size that is shown


def test_an_implementation_that_takes_stages_is_run_once_more(pack):
    runs = []

    def counted(color, depth, coc, params):
        runs.append(tuple(params.get("given", ())))
        return staged_port(color, depth, coc, params, {"coc": lambda s: 2 * s} if "given" not in params else ())

    plan = Plan(only="cards", given=("coc", "size"))
    outcome = check(of_case(counted, stages_of), pack, plan=plan).outcomes[0]
    assert runs == [(), ("coc", "size")]
    assert outcome.causes["coc"] == "own"
    assert set(outcome.causes) >= {"size", "limit", "image"}
    assert {cause for part, cause in outcome.causes.items() if part != "coc"} == {"inherited"}
    runs.clear()
    assert check(of_case(lambda *w: counted(*w[:3], w[3] | {"given": {}}), stages_of), pack, plan=plan).passed
    assert len(runs) == 1  # what is right needs no second run


PLANES = {"near_plane": 1.0, "focus_plane": 2.0, "far_plane": 6.0}


@pytest.fixture(scope="module")
def poisson_pack(tmp_path_factory):
    cases = [
        Case("linear", "poisson", "hdr", (16, 12), PLANES, stages=Stages((4,))),
        Case("thin_lens", "poisson", "hdr", (16, 12), {"code": "thin_lens"}, stages=Stages((4,))),
    ]
    return pack_of(cases, tmp_path_factory.mktemp("poisson") / "pack")


def poisson_port(color, depth, coc, params, faults):
    """The filter from the functions of its steps, each with a fault: who is blamed is tested here, not they."""
    record = Params(**{key: tuple(map(tuple, v)) if isinstance(v, list) else v for key, v in params.items()})
    shown = {}

    def stage(name, values):
        shown[name] = faults.get(name, lambda same: same)(values.astype(np.float32))
        return shown[name]

    code = stage("code", code_of(depth, stage("coc", coc), record))
    coded = np.concatenate([color, code[..., None]], axis=-1)
    small = stage("small", shrink(coded, record.small_size))
    largest, reach = np.float32(record.max_radius), record.small_radius * record.small_size
    taps = record.table.astype(np.float32)
    stage("mean_4", gather(coded, small, taps[:4], largest, reach))
    stage("image", gather(coded, small, taps, largest, reach))
    return shown


@pytest.mark.parametrize(
    ("case", "fault", "own", "inherited"),
    [
        ("linear", {}, (), ()),
        ("thin_lens", {}, (), ()),
        ("linear", {"coc": lambda s: 2 * s}, ("coc",), ()),  # the code is made of depth
        ("thin_lens", {"coc": lambda s: s / 8}, ("coc",), ("code", "small", "mean_4", "image")),
        ("linear", {"code": lambda b: 1 - b}, ("code",), ("small", "mean_4", "image")),
        ("linear", {"small": lambda p: p * np.float32(0.9)}, ("small",), ("mean_4", "image")),
        ("linear", {"mean_4": lambda c: c * np.float32(0.9)}, ("mean_4",), ()),
        ("linear", {"image": lambda c: c * np.float32(0.9)}, ("image",), ()),
    ],
)
def test_poisson(poisson_pack, case, fault, own, inherited):
    port = lambda *words: poisson_port(*words, fault)  # noqa: E731
    outcome = check(port, poisson_pack, plan=Plan(only=case)).outcomes[0]
    expected = dict.fromkeys(own, "own") | dict.fromkeys(inherited, "inherited")
    assert outcome.causes == expected, outcome.message

"""Waivers forgive what they name until their day, and say so when they are of no use."""

from datetime import date

import numpy as np
import pytest

from refdof import InputError
from refdof.oracle import Plan, check, check_command
from refdof.oracle.waivers import Waiver, read_waivers
from tests.oracle.small_pack import command, of_case, port, staged_port, stages_of, statuses

pytestmark = pytest.mark.fast

URL = "https://example.org/bugs/7"
TODAY, LATER, BEFORE = date(2026, 6, 30), date(2026, 7, 1), date(2026, 6, 29)


def waiver(case, part="*", expires=LATER):
    return Waiver(case, "the driver", URL, expires, part)


def plan(*waivers, **words):
    return Plan(waivers=waivers, today=TODAY, **words)


def wrong_in_noise(color, depth, coc, params):
    return port(color, depth, coc, params) * np.float32(1.0 if depth.shape == (18, 24) else 0.5)


def test_a_waived_failure_is_told_and_no_failure(pack):
    report = check(wrong_in_noise, pack, plan=plan(waiver("noise*")))
    assert statuses(report) == ["pass", "waived", "waived"]
    assert report.passed
    assert report.warnings == ()
    assert report.outcomes[1].message.startswith(f"the driver ({URL}): image: ")


def test_all_waived_is_no_success(pack):
    report = check(wrong_in_noise, pack, plan=plan(waiver("*"), only="noise*"))
    assert statuses(report) == ["waived", "waived"]
    assert not report.passed


def test_a_waiver_of_a_part_covers_no_other(pack):
    def two_wrong(*words):
        return staged_port(*words, {"size": lambda s: s / 2, "image": lambda c: c * np.float32(0.5)})

    function = of_case(two_wrong, stages_of)
    report = check(function, pack, plan=plan(waiver("cards", "size"), only="cards"))
    assert statuses(report) == ["fail"]
    assert report.outcomes[0].waived == ("size",)
    every = [waiver("cards", part) for part in ("size", "limit", "mean_*", "image")]
    assert statuses(check(function, pack, plan=plan(*every, only="cards"))) == ["waived"]


@pytest.mark.parametrize(("expires", "status"), [(LATER, "waived"), (TODAY, "waived"), (BEFORE, "fail")])
def test_the_last_day(pack, expires, status):
    report = check(wrong_in_noise, pack, plan=plan(waiver("noise", expires=expires), only="noise"))
    assert statuses(report) == [status]
    if status == "fail":
        assert "expired after 2026-06-29" in report.outcomes[0].message
        assert report.warnings == (f"waiver of noise: expired after 2026-06-29, and is not applied: {URL}",)


def test_waivers_of_no_use(pack):
    waivers = (waiver("cards"), waiver("card"), waiver("noise", "image"), waiver("noise_up"))
    report = check(wrong_in_noise, pack, plan=plan(*waivers, only="*s*"))
    assert report.warnings == (
        "waiver of cards: is not needed, nothing that it covers fails",
        "waiver of card: matches no case of the pack",
    )
    # What is not run is not told to be of no use.
    assert check(wrong_in_noise, pack, plan=plan(*waivers[2:], only="cards")).warnings == ()


def test_errors_of_the_implementation_can_be_waived_and_those_of_the_pack_not(copied, tmp_path):
    crash = command(tmp_path, "sys.exit('no such thing')")
    (copied / "cases" / "noise" / "params.txt").write_bytes(b"")
    report = check_command(crash, copied, plan=plan(waiver("noise"), waiver("cards"), only="*[se]"))
    assert statuses(report) == ["waived", "error"]
    assert "is empty" in report.outcomes[1].message


GOOD = {"case": '"noise*"', "reason": '"why"', "url": f'"{URL}"', "expires": "2026-07-01"}


def written(tmp_path, **lines):
    path = tmp_path / "waivers.toml"
    path.write_text("[[waiver]]\n" + "".join(f"{key} = {value}\n" for key, value in lines.items()))
    return path


def test_a_file_of_waivers(tmp_path):
    assert read_waivers(written(tmp_path, **GOOD)) == (Waiver("noise*", "why", URL, LATER),)
    assert read_waivers(written(tmp_path, **GOOD, part='"size"'))[0].part == "size"


@pytest.mark.parametrize("key", GOOD)
def test_an_incomplete_waiver_is_refused(tmp_path, key):
    with pytest.raises(InputError, match=rf"^waivers, number 1: lacks {key}; needed are case, reason, url, expires$"):
        read_waivers(written(tmp_path, **{name: value for name, value in GOOD.items() if name != key}))


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("reason", '""', "reason: got ''"),
        ("reason", '"""a\nb"""', "one line"),
        ("case", "7", "case: got '7'"),
        ("url", '"bug 7"', "url: got 'bug 7'"),
        ("expires", '"2026-07-01"', "expires: got '2026-07-01'; allowed is a day"),
        ("expires", "2026-07-01T00:00:00", "expires"),
        ("expire", "2026-07-01", "has 'expire'"),
    ],
)
def test_a_garbled_waiver_is_refused(tmp_path, key, value, said):
    with pytest.raises(InputError, match=r"^waivers, number 1") as error:
        read_waivers(written(tmp_path, **(GOOD | {key: value})))
    assert said in str(error.value)
    assert len(str(error.value).splitlines()) == 1


@pytest.mark.parametrize(
    "content", ["", "x", "waiver = 1", "waiver = [1]", "[waiver]\na = 1", "[[waivers]]", "a = " + "[" * 9999]
)
def test_no_file_of_waivers(tmp_path, content):
    path = tmp_path / "waivers.toml"
    path.write_text(content)
    with pytest.raises(InputError, match=r"^waivers: "):
        read_waivers(path)
    with pytest.raises(InputError, match=r"^waivers: "):
        read_waivers(tmp_path / "none.toml")

"""The check: right ports pass, wrong ones fail, and files that are not what they have to be are told in one line."""

import json
import os
from xml.etree import ElementTree

import numpy as np
import pytest

from refdof import InputError
from refdof.oracle import check, check_command, check_results
from refdof.oracle.junit import junit
from tests.methods.singlepass.shader32 import listing
from tests.oracle.small_pack import CASES, command, flip_bit, port, rewrite, write_results
from tests.packs import pack_of

pytestmark = pytest.mark.fast


def test_a_right_port_passes(pack):
    report = check(port, pack)
    assert report.passed
    assert {status: count for status, count in report.counts().items() if count} == {"pass": 3}


FAULTS = {
    "a tap is skipped": lambda c, d, s, p: listing(c, d, s, faults=[(3, "skip")]),
    "a tap is taken twice": lambda c, d, s, p: listing(c, d, s, faults=[(0, "twice")]),
    "a tap is shifted": lambda c, d, s, p: listing(c, d, s, faults=[(5, (0.5, 0.0))]),
    "near and far": lambda c, d, s, p: listing(c, -d, s),
    "diameters": lambda c, d, s, p: listing(c, d, 2 * s),
    "half the circles": lambda c, d, s, p: listing(c, d, 0.5 * s),
    "no depth": lambda c, d, s, p: listing(c, np.ones_like(d), s),
    "rows the wrong way round": lambda c, d, s, p: listing(c[::-1], d[::-1], s[::-1])[::-1],
    "no blur": lambda c, d, s, p: c,
    "one row up": lambda c, d, s, p: np.roll(listing(c, d, s), 1, axis=0),
    "red and blue": lambda c, d, s, p: listing(c, d, s)[..., ::-1],
    "display values": lambda c, d, s, p: np.clip(listing(c, d, s), 0, 1) ** (1 / 2.2),
    "NaN": lambda c, d, s, p: np.full_like(c, np.nan),
    "infinity": lambda c, d, s, p: np.full_like(c, np.inf),
    "nothing": lambda c, d, s, p: np.zeros_like(c),
}


@pytest.mark.long
@pytest.mark.parametrize("fault", FAULTS)
def test_a_wrong_port_fails(pack, fault):
    report = check(lambda *words: np.asarray(FAULTS[fault](*words), dtype=np.float32), pack)
    assert not report.passed
    assert report.counts()["fail"] >= 1, report.counts()
    json.dumps(report.as_json(), allow_nan=False)


def test_stages_are_compared_too(pack):
    def with_stages(color, depth, coc, params):
        image = port(color, depth, coc, params)
        shown = {"image": image}
        if depth.shape == (18, 24):
            shown["size"] = np.zeros_like(depth)
        return shown

    report = check(with_stages, pack)
    assert [outcome.status for outcome in report.outcomes] == ["fail", "pass", "pass"]
    assert report.outcomes[0].message.startswith("size: ")
    assert report.outcomes[0].findings["image"].status == "pass"


def test_nothing_compared_is_no_success(pack):
    def not_mine(color, depth, coc, params):
        raise NotImplementedError("other filters only")

    report = check(not_mine, pack)
    assert not report.passed
    assert report.counts()["not supported"] == 3
    suite = ElementTree.fromstring(junit(report))
    assert suite.get("skipped") == "3"


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (np.zeros((2, 2, 3), np.float32), "shape"),
        (np.zeros((18, 24, 3), np.uint8), "uint8"),
        ({"picture": np.zeros((18, 24, 3))}, "picture"),
        (None, "object"),
    ],
)
def test_results_of_another_kind(pack, given, said):
    report = check(lambda *words: given, pack)
    assert report.counts()["error"] == 3
    assert said in report.outcomes[0].message


def spoiled(copied, spoil):
    """Outcomes after `spoil(case folder)` of the case "cards"."""
    spoil(copied / "cases" / "cards")
    return check(port, copied).outcomes


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (lambda case: flip_bit(case / "inputs" / "color.npy"), "inputs/color.npy: is not as it was written"),
        (lambda case: flip_bit(case / "expected" / "image.f32"), "expected/image.f32: is not as it was written"),
        (lambda case: (case / "case.json").unlink(), "case.json: is missing"),
        (lambda case: (case / "more.npy").write_bytes(b"x"), "more.npy: is not in the manifest"),
        (lambda case: (case / "params.txt").write_bytes(b""), "params.txt: is empty"),
        (lambda case: (case / "link").symlink_to("/"), "link: is a link"),
    ],
)
def test_a_spoiled_case_is_an_error_and_no_other(copied, spoil, said):
    outcomes = spoiled(copied, spoil)
    assert [outcome.status for outcome in outcomes] == ["error", "pass", "pass"]
    assert outcomes[0].message.startswith(said)
    assert len(outcomes[0].message.splitlines()) == 1


@pytest.mark.parametrize(
    "place", ["../../../secret.npy", "/etc/passwd", "inputs/../../noise/inputs/color.npy", 7, None]
)
def test_a_path_out_of_its_case_is_refused(copied, place):
    (copied.parent / "secret.npy").write_bytes(b"secret")
    rewrite(copied, "cases/cards/case.json", lambda about: about["inputs"]["color"].update(npy=place))
    outcome = check(port, copied).outcomes[0]
    assert (outcome.status, outcome.message[:16]) == ("error", "case.json: names")


@pytest.mark.parametrize("name", ["../x", "/x", "a/../../x", ""])
def test_a_manifest_that_leaves_its_pack_is_refused(copied, name):
    rewrite(copied, "manifest.json", lambda manifest: manifest["files"].update({name: "0" * 64}))
    with pytest.raises(InputError, match="pack"):
        check(port, copied)


@pytest.mark.parametrize("content", ["", "[]", "{}", "{", '{"schema": "refdof-pack-1"}', "[" * 100000])
def test_a_manifest_of_another_kind_is_refused(copied, content):
    (copied / "manifest.json").write_text(content)
    with pytest.raises(InputError, match=r"^pack"):
        check(port, copied)


def test_results_that_say_not_supported(pack, tmp_path):
    """not_supported.txt alone, its first line; beside a picture it is no result."""
    write_results(tmp_path, pack)
    for name in ("cards", "noise"):
        (tmp_path / name / "not_supported.txt").write_text("other filters only\nmore\n")
    (tmp_path / "cards" / "image.f32").unlink()
    report = check_results(tmp_path, pack)
    assert [outcome.status for outcome in report.outcomes] == ["not supported", "error", "pass"]
    assert report.outcomes[0].message == "other filters only"
    assert report.outcomes[1].message.startswith("not_supported.txt: is no result of this case")


def test_not_supported_is_not_read_through_a_link(pack, tmp_path):
    (tmp_path / "secret.txt").write_text("secret\n")
    (tmp_path / "cards").mkdir()
    (tmp_path / "cards" / "not_supported.txt").symlink_to(tmp_path / "secret.txt")
    outcome = check_results(tmp_path, pack).outcomes[0]
    assert (outcome.status, outcome.message) == ("error", "not_supported.txt: is no regular file")


def header(text):
    """An NPY file of version 1 with this header and no numbers."""
    text = text.encode() + b"\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text


NPY = {
    "objects": (header("{'descr': '|O', 'fortran_order': False, 'shape': (18, 24, 3), }"), "object"),
    "huge": (header("{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999, 99999999999, 3), }"), "shape"),
    "short": (header("{'descr': '<f4', 'fortran_order': False, 'shape': (18, 24, 3), }"), "bytes"),
    "code": (header("__import__('os').system('true')"), "header"),
    "text": (b"hello", "header"),
    "nothing": (b"", "empty"),
}


@pytest.mark.parametrize("kind", NPY)
def test_hostile_arrays(pack, tmp_path, kind):
    content, said = NPY[kind]
    write_results(tmp_path, pack)
    (tmp_path / "cards" / "image.f32").unlink()
    (tmp_path / "cards" / "image.npy").write_bytes(content)
    outcomes = check_results(tmp_path, pack).outcomes
    assert [outcome.status for outcome in outcomes] == ["error", "pass", "pass"]
    assert said in outcomes[0].message


def test_results_of_another_case(pack, tmp_path):
    write_results(tmp_path, pack)
    assert check_results(tmp_path, pack).passed
    (tmp_path / "cards" / "image.f32").write_bytes((tmp_path / "noise" / "image.f32").read_bytes())
    (tmp_path / "noise" / "image.f32").unlink()
    outcomes = check_results(tmp_path, pack).outcomes
    assert [outcome.status for outcome in outcomes] == ["error", "error", "pass"]
    assert "bytes" in outcomes[0].message
    assert "missing" in outcomes[1].message


@pytest.mark.skipif(os.name != "posix", reason="process groups are POSIX's")
@pytest.mark.parametrize(
    ("code", "status", "said"),
    [
        ("(out / 'image.f32').write_bytes((case / 'expected' / 'image.f32').read_bytes())", "pass", "image"),
        ("(out / 'image.f32').write_bytes((case / 'inputs' / 'color.f32').read_bytes())", "fail", "image"),
        ("sys.exit(77)", "not supported", "the command ended with status 77: it does not do this case"),
        ("sys.stderr.write('other filters only'); sys.exit(77)", "not supported", "other filters only"),
        ("sys.exit('no such thing')", "error", "status 1: no such thing"),
        ("time.sleep(60)", "error", "ran for more than 1 s"),
        ("pass", "error", "image.f32: is missing"),
    ],
)
def test_commands(pack, tmp_path, code, status, said):
    outcomes = check_command(command(tmp_path, code), pack, timeout=1.0).outcomes
    assert outcomes[0].status == status, outcomes[0].message
    assert outcomes[0].message == said if status == "not supported" else said in outcomes[0].message


@pytest.mark.parametrize("words", ["", "port", "port {case}", "port {out}", "'"])
def test_commands_without_folders_are_refused(pack, words):
    with pytest.raises(InputError, match=r"^impl"):
        check_command(words, pack)


@pytest.mark.long
def test_a_pack_is_the_same_bytes_again(pack, tmp_path):
    pack_of(CASES, tmp_path / "again")
    for path in pack.rglob("*"):
        if path.is_file():
            assert (tmp_path / "again" / path.relative_to(pack)).read_bytes() == path.read_bytes()

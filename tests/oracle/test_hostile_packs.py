"""Hostile packs: refused or told in one line, and never a wrong verdict."""

import json
import os

import numpy as np
import pytest

from refdof import InputError
from refdof.oracle import Plan, check
from refdof.oracle.cases import Case
from refdof.oracle.expectation import expectation_of
from refdof.oracle.files import open_pack
from tests.oracle.small_pack import flip_bit, port, posix, resign, rewrite
from tests.packs import pack_of

pytestmark = pytest.mark.fast

CASE = "cases/cards/case.json"


def only_cards(pack):
    return check(port, pack, plan=Plan(only="cards")).outcomes[0]


def error_of(pack):
    outcome = only_cards(pack)
    assert outcome.status == "error", outcome.message
    assert len(outcome.message.splitlines()) == 1
    return outcome.message


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('{"schema": "refdof-case-1", "name": "noise", "name": "cards"}', "the key 'name' is there twice"),
        ("[" * 100000, "cannot be read"),
        ('{"schema": NaN}', "NaN is no JSON"),
        ('{"schema": -Infinity}', "-Infinity is no JSON"),
        ('{"schema": ' + "9" * 5000 + "}", "cannot be read"),
        ("[]", "is not the description of cards"),
        ('{"schema": "refdof-case-2", "name": "cards"}', "its schema has to be refdof-case-1"),
        ('{"schema": "refdof-case-1", "name": "noise"}', "is not the description of cards"),
        ('{"schema": "refdof-case-1", "name": "cards"}', "lacks or garbles 'size'"),
        ("\ud800".encode("utf-8", "surrogatepass").decode("latin-1"), "cannot be read"),
    ],
)
def test_descriptions_that_are_none(copied, text, said):
    resign(copied, CASE, text)
    assert said in error_of(copied)


def put(about, path, value):
    *keys, last = path.split(".")
    for key in keys:
        about = about[key]
    about[last] = value


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("size", [24]),
        ("size", ["24", "18"]),
        ("size", [True, 18]),
        ("size", [24, -18]),
        ("size", [10**12, 10**12]),
        ("size", None),
        ("rows", ["up"]),
        ("method", {}),
        ("tags", 7),
        ("tags", [7]),
        ("params", 7),
        ("inputs", []),
        ("expected.stages", []),
        ("expected.stages", {"../x": {}}),
        ("expected.stages", {"size": None}),
        ("expected.image", None),
        ("expected.image.shape", [18, 24]),
        ("expected.image.shape", [18, 24, 10**9]),
        ("expected.image.shape", [10**9, 10**9, 3]),
        ("expected.image.shape", [18, 24, 3, 1]),
        ("expected.image.shape", "abc"),
        ("expected.image.npy", "expected/image.f32x"),
        ("expected.image.low", "expected/high.npy"),  # above what high then is
        ("expected.image.tolerance", None),
        ("expected.image.tolerance", {}),
        ("expected.image.tolerance.max_abs", "1"),
        ("expected.image.tolerance.max_abs", 1e999),
        ("expected.image.tolerance.max_abs", -1.0),
        ("expected.image.tolerance.max_rms", [0.1]),
        ("expected.image.tolerance.nan", "ignore"),
        ("expected.image.tolerance.more", 1),
    ],
)
def test_garbled_descriptions(copied, path, value):
    def change(about):
        put(about, path, value)
        if path.endswith("low"):
            about["expected"]["image"]["high"] = "expected/low.npy"

    text = (copied / CASE).read_text()
    about = json.loads(text)
    change(about)
    resign(copied, CASE, json.dumps(about).replace("Infinity", "1e999"))
    assert error_of(copied).startswith("case.json: ")


def test_parameters_that_the_method_does_not_have(copied):
    """They only keep errors from being told apart."""
    rewrite(copied, CASE, lambda about: about.update(params={"no such": [1]}))
    shown = {"size": np.zeros((18, 24), np.float32), "image": np.zeros((18, 24, 3), np.float32)}
    outcome = check(lambda *words: shown, copied, plan=Plan(only="cards")).outcomes[0]
    assert outcome.causes == {"size": "own", "image": "unknown"}


@pytest.mark.parametrize(
    "text", ['{"schema": "refdof-pack-1", "cases": [], "cases": []}', '{"schema": NaN}', "[" * 99999]
)
def test_manifests_that_are_none(copied, text):
    (copied / "manifest.json").write_text(text)
    with pytest.raises(InputError, match=r"^pack: ") as error:
        check(port, copied)
    assert len(str(error.value).splitlines()) == 1


@pytest.mark.parametrize(
    "name",
    ["..", ".", "", "a/b", "/x", "Cards", "a" * 81, "cards\n", "a b", "$(x)", "-x", "ä", "٣", "a\0", 7, None, ["a"]],
)
def test_case_names_with_tricks(copied, name):
    rewrite(copied, "manifest.json", lambda manifest: manifest["cases"].append(name))
    with pytest.raises(InputError, match=r"^pack: manifest\.json names the case "):
        check(port, copied)


def test_a_case_that_is_there_twice(copied):
    rewrite(copied, "manifest.json", lambda manifest: manifest["cases"].append("cards"))
    with pytest.raises(InputError, match="twice"):
        check(port, copied)


@pytest.mark.parametrize("place", ["README.md", "conventions.json", "schemas/case.schema.json"])
def test_a_flipped_bit_outside_of_cases(copied, place):
    flip_bit(copied / place)
    with pytest.raises(InputError, match="is not as it was written"):
        check(port, copied)


def test_more_files_outside_of_cases(copied):
    (copied / "cases" / "other").mkdir()
    (copied / "cases" / "other" / "case.json").write_text("{}")
    with pytest.raises(InputError, match="is not in the manifest"):
        check(port, copied)


@posix
@pytest.mark.parametrize("place", ["cases/cards", "cases", "schemas"])
def test_folders_that_are_links(copied, tmp_path, place):
    (copied / place).rename(tmp_path / "moved")
    (copied / place).symlink_to(tmp_path / "moved")
    with pytest.raises(InputError, match="is a link"):
        check(port, copied)


@posix
def test_links_and_pipes_in_a_case(copied):
    image = copied / "cases" / "cards" / "expected" / "image.npy"
    image.rename(image.parents[3] / "elsewhere.npy")
    image.symlink_to(image.parents[3] / "elsewhere.npy")
    with pytest.raises(InputError, match=r"elsewhere\.npy' is not in the manifest"):
        check(port, copied)
    (image.parents[3] / "elsewhere.npy").unlink()
    assert "image.npy: is a link" in error_of(copied)
    image.unlink()
    os.mkfifo(image)
    assert "image.npy: is no regular file" in error_of(copied)


@pytest.mark.parametrize("size", [(1, 5), (5, 1)])
def test_pictures_of_one_row_or_column_are_allowed(tmp_path, size):
    folder = pack_of([Case("line", "singlepass", "noise", size)], tmp_path / "pack")
    expected = expectation_of(open_pack(folder), "line").parts["image"]
    assert expected.values.shape == (*size[::-1], 3)

"""Hostile packs, results and programs: refused or told in one line, and never a wrong verdict."""

import json
import os
import time

import numpy as np
import pytest

from refdof import InputError
from refdof.oracle import Plan, check, check_command, check_results
from tests.oracle.small_pack import command, flip_bit, port, resign, rewrite, statuses, write_results

pytestmark = pytest.mark.fast

posix = pytest.mark.skipif(os.name != "posix", reason="process groups, links and pipes are POSIX's")
CASE = "cases/cards/case.json"


def only_cards(pack):
    return check(port, pack, plan=Plan(only="cards")).outcomes[0]


def error_of(pack):
    outcome = only_cards(pack)
    assert outcome.status == "error", outcome.message
    assert len(outcome.message.splitlines()) == 1
    return outcome.message


# Packs


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


# Results


def npy(values, **words):
    from io import BytesIO

    file = BytesIO()
    np.lib.format.write_array(file, values, allow_pickle=True, **words)
    return file.getvalue()


def header(text, version=b"\x01\x00", size=None):
    """An NPY file with this header and no numbers."""
    text = text.encode() + b"\n"
    return b"\x93NUMPY" + version + (len(text) if size is None else size).to_bytes(2 * version[0], "little") + text


GOOD = np.zeros((18, 24, 3), np.float32)
HEADER = "{'descr': '<f4', 'fortran_order': False, 'shape': (18, 24, 3), }"
NPY = {
    "objects": (npy(np.full((18, 24, 3), None)), "object"),
    "objects, headed as numbers": (header("{'descr': '|O', 'fortran_order': False, 'shape': (18, 24, 3), }"), "object"),
    "records": (npy(np.zeros((18, 24, 3), [("a", "<f4")])), "allowed is little-endian"),
    "the other byte order": (npy(GOOD.astype(">f4")), "allowed is little-endian"),
    "Fortran's order": (npy(np.asfortranarray(GOOD)), "Fortran"),
    "half floats": (npy(GOOD.astype("f2")), "float16"),
    "whole numbers": (npy(GOOD.astype("i4")), "int32"),
    "complex numbers": (npy(GOOD.astype("c8")), "complex64"),
    "dates": (npy(np.zeros((18, 24, 3), "M8[s]")), "datetime64"),
    "text": (npy(np.zeros((18, 24, 3), "U1")), "<U1"),
    "another shape": (npy(GOOD[:, :, :2]), "shape"),
    "one axis": (npy(GOOD.ravel()), "shape"),
    "no axis": (npy(np.float32(1)), "shape"),
    "huge": (header("{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999, 99999999999, 3), }"), "shape"),
    "negative": (header("{'descr': '<f4', 'fortran_order': False, 'shape': (-18, -24, 3), }"), "shape"),
    "many axes": (header("{'descr': '<f4', 'fortran_order': False, 'shape': " + "(" + "1," * 999 + "), }"), "shape"),
    "truncated": (npy(GOOD)[:-1], "bytes"),
    "too long": (npy(GOOD) + b"x", "bytes"),
    "no numbers": (header(HEADER), "bytes"),
    "a header cut short": (header(HEADER, size=60000), "header"),
    "a header of 4 GB": (header(HEADER, b"\x02\x00", 2**32 - 1), "header"),
    "nested": (header("(" * 5000), "header"),
    "code": (header("__import__('os').system('true')"), "header"),
    "Python 2": (header(HEADER.replace("18,", "18L,")), "bytes"),
    "another version": (npy(GOOD).replace(b"\x01\x00", b"\x03\x00", 1), "header"),
    "an unknown version": (header(HEADER).replace(b"\x01\x00", b"\x09\x09", 1), "header"),
    "a pickle": (b"\x80\x04N.", "header"),
    "nothing": (b"", "empty"),
}


@pytest.mark.parametrize("kind", NPY)
def test_hostile_arrays(pack, tmp_path, kind):
    content, said = NPY[kind]
    (tmp_path / "cards").mkdir()
    (tmp_path / "cards" / "image.npy").write_bytes(content)
    outcome = check_results(tmp_path, pack, plan=Plan(only="cards")).outcomes[0]
    assert outcome.status == "error"
    assert outcome.message.startswith("image.npy: ")
    assert said in outcome.message


def edited(values, number):
    values.reshape(-1)[7] = number
    return values


@pytest.mark.parametrize(
    "change",
    [
        lambda image: np.full_like(image, np.nan),
        lambda image: np.full_like(image, np.inf),
        lambda image: np.full_like(image, -np.inf),
        lambda image: edited(image, np.nan),
        lambda image: edited(image, np.inf),
        lambda image: edited(image, 1e30),
        lambda image: image[::-1],
        lambda image: image[:, ::-1],
        lambda image: image[..., ::-1],
        lambda image: np.roll(image, 1, axis=1),
        lambda image: image.astype(np.float16),
        lambda image: 0 * image,
    ],
)
def test_wrong_numbers(pack, tmp_path, change):
    write_results(tmp_path, pack)
    path = tmp_path / "cards" / "image.f32"
    image = np.fromfile(path, "<f4").reshape(18, 24, 3)
    path.write_bytes(change(image).astype("<f4").tobytes())
    report = check_results(tmp_path, pack)
    assert statuses(report) == ["fail", "pass", "pass"]
    json.dumps(report.as_json(), allow_nan=False)


def test_results_of_another_case_of_the_same_size(pack, tmp_path):
    write_results(tmp_path, pack)
    places = [tmp_path / name / "image.f32" for name in ("noise", "noise_up")]
    first, second = (place.read_bytes() for place in places)
    for place, content in zip(places, (second, first), strict=True):
        place.write_bytes(content)
    assert statuses(check_results(tmp_path, pack)) == ["pass", "fail", "fail"]


@posix
@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (lambda case: (case / "image.npy").write_bytes(npy(GOOD)), "as .f32 and as .npy"),
        (lambda case: (case / "more.f32").write_bytes(b"0000"), "more.f32: is no result of this case"),
        (lambda case: (case / "size.f32").mkdir(), "size.f32: is no regular file"),
        (lambda case: (case / "image.f32").write_bytes(b""), "is empty"),
        (lambda case: (case / "image.f32").write_bytes(b"0" * 7), "has 7 bytes"),
        (lambda case: ((case / "image.f32").unlink(), (case / "image.f32").symlink_to("/dev/zero")), "no regular"),
        (lambda case: ((case / "image.f32").unlink(), os.mkfifo(case / "image.f32")), "no regular file"),
        (lambda case: ((case / "image.f32").unlink(), case.rmdir(), case.symlink_to("/")), "no folder cards"),
        (lambda case: ((case / "image.f32").unlink(), case.rmdir()), "no folder cards"),
        (lambda case: (case / "image.f32").unlink(), "image.f32: is missing"),
    ],
)
def test_spoiled_results(pack, tmp_path, spoil, said):
    write_results(tmp_path, pack)
    spoil(tmp_path / "cards")
    outcomes = check_results(tmp_path, pack).outcomes
    assert [outcome.status for outcome in outcomes] == ["error", "pass", "pass"]
    assert said in outcomes[0].message


# Functions and programs


def left(color, depth, coc, params):
    raise SystemExit(0)


class Ragged:
    def __array__(self, *words, **more):
        raise RuntimeError("no\narray")


@pytest.mark.parametrize(
    ("function", "said"),
    [
        (left, "raised SystemExit"),
        (lambda *words: 1 / 0, "raised ZeroDivisionError"),
        (lambda *words: {}, "image: is missing"),
        (lambda *words: {7: GOOD, "image": GOOD}, "7: is no result"),
        (lambda *words: {("a",): GOOD, "image": GOOD}, "is no result"),
        (lambda *words: [[1.0], [1.0, 2.0]], "is no array"),
        (lambda *words: Ragged(), "is no array"),
        (lambda *words: {"image": GOOD, "size": GOOD}, "size: is float32 of shape"),
    ],
)
def test_functions(pack, function, said):
    outcome = check(function, pack, plan=Plan(only="cards")).outcomes[0]
    assert outcome.status == "error"
    assert said in outcome.message


def test_a_function_cannot_spoil_what_it_is_given(pack):
    def spoiling(color, depth, coc, params):
        image = port(color, depth, coc, params)
        for array in (color, depth, coc):
            array[...] = np.nan
        params.clear()
        return image

    assert check(spoiling, pack).passed


RIGHT = "(out / 'image.f32').write_bytes((case / 'expected' / 'image.f32').read_bytes())\n"
WRONG = "(out / 'image.f32').write_bytes((case / 'inputs' / 'color.f32').read_bytes())\n"
LATER = """
if os.fork() == 0:
    {leave}
    while True:
        time.sleep(0.01)
        print('x', file=sys.stderr, flush=True)
"""


@posix
@pytest.mark.parametrize(
    ("code", "status", "said"),
    [
        (RIGHT + "sys.stdout.write('x' * 20_000_000)", "pass", "image"),
        (RIGHT + "sys.stderr.write('x' * 20_000_000)", "pass", "image"),
        ("sys.stderr.write('x' * 5_000_000 + chr(10) + 'the end'); sys.exit(3)", "error", "status 3: the end"),
        ("sys.stderr.write('a' + chr(27) + '[2J' + chr(7) + 'b'); sys.exit(3)", "error", "a [2J b"),
        ("sys.stderr.buffer.write(bytes([255, 10])); sys.exit(3)", "error", "status 3"),
        ("print('nothing said'); os.kill(os.getpid(), 9)", "error", "status -9"),
        ("while True: pass", "error", "ran for more than 1.5 s"),
        (RIGHT + "sys.stdin.read()", "pass", "image"),
        (RIGHT + LATER.format(leave="pass") + "sys.exit(0)", "pass", "image"),
        (RIGHT + LATER.format(leave="os.setsid()") + "sys.exit(0)", "pass", "image"),
        (LATER.format(leave="pass") + "time.sleep(60)", "error", "ran for more than 1.5 s"),
        (RIGHT + "(out / 'more').write_text('x')", "error", "more: is no result"),
        (RIGHT + "(case / 'more').write_text('x')", "error", "has changed the pack: more: is not in the manifest"),
        (
            WRONG + "(case / 'expected/image.npy').write_bytes((case / 'inputs/color.npy').read_bytes())",
            "error",
            "has changed the pack: expected/image.npy: is not as it was written",
        ),
        (WRONG + "(case / 'case.json').unlink()", "error", "has changed the pack: case.json: is missing"),
        ("out.rmdir()", "error", "no folder"),
        ("out.rmdir(); out.symlink_to(case / 'expected')", "error", "no folder"),
        ("(out / 'image.f32').symlink_to(case / 'expected' / 'image.f32')", "error", "no regular file"),
    ],
)
def test_programs(copied, tmp_path, code, status, said):
    if "setsid" in code:  # it is out of the group: nobody but this test ends it
        code = code.replace("while True:", f"while not pathlib.Path({str(tmp_path / 'end')!r}).exists():")
    began = time.monotonic()
    report = check_command(command(tmp_path, code), copied, timeout=1.5, plan=Plan(only="cards"))
    (tmp_path / "end").touch()
    assert time.monotonic() - began < 10.0
    outcome = report.outcomes[0]
    assert outcome.status == status, outcome.message
    assert said in outcome.message
    assert outcome.message.isprintable()


@posix
def test_a_command_line_is_no_shell_and_marks_are_filled_in_once(pack, tmp_path):
    words = command(tmp_path, RIGHT + "assert sys.argv[1].endswith('cards')")
    assert check_command(words, pack, plan=Plan(only="cards")).passed
    evil = f"{words} '; touch {tmp_path / 'evil'}' '$(touch {tmp_path / 'evil'})'"
    assert statuses(check_command(evil, pack, plan=Plan(only="cards"))) == ["error"]
    assert not (tmp_path / "evil").exists()


@posix
def test_given_stages_are_in_a_copy_of_the_case(pack, tmp_path):
    code = (
        "given = [line.split()[1] for line in (case / 'params.txt').read_text().splitlines() if 'given' in line]\n"
        "factor = 1.0 if given == ['size'] and (case / 'inputs/size.npy').stat().st_size == 128 + 1728 else 0.5\n"
        "import numpy as np\n"
        f"golden = pathlib.Path({str(pack / 'cards')!r}.replace('cards', 'cases/cards')) / 'expected'\n"
        "assert (case / 'expected').exists() == (not given)\n"
        "for name, place in (('size', 'stages/size'), ('image', 'image')):\n"
        "    values = np.load(golden / f'{place}.npy') * np.float32(factor)\n"
        "    (out / f'{name}.f32').write_bytes(values.tobytes())\n"
    )
    outcome = check_command(command(tmp_path, code), pack, plan=Plan(only="cards", given=("size",))).outcomes[0]
    assert outcome.causes == {"size": "own", "image": "inherited"}, outcome.message

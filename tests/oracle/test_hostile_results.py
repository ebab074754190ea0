"""Hostile results: files with tricks, wrong numbers and results of other cases."""

import json
import os
from io import BytesIO

import numpy as np
import pytest

from refdof.oracle import Plan, check_results
from tests.oracle.small_pack import posix, statuses, write_results

pytestmark = pytest.mark.fast


def npy(values, **words):
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

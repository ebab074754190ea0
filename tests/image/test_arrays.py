"""Folders of arrays: what is written is read back without NumPy, whole or not at all."""

import json
import struct

import numpy as np
import pytest

from refdof import InputError
from refdof.image.arrays import Described, check_arrays_folder, save_arrays
from refdof.image.atomic import atomic_folder

pytestmark = pytest.mark.fast

NUMBERS = np.array([[0.5, -1.25, np.inf], [3.0, 1e-3, -0.0]])


def test_raw_numbers_are_little_endian_rows_first(tmp_path):
    arrays = {
        "a": Described(np.asfortranarray(NUMBERS), "H W", "px", "some numbers", ("x", "y", "z"), "formula"),
        "b/whole": Described(np.array([1, -2, 70000]), "N"),
        "b/mask": Described(np.array([True, False]), "N"),
    }
    save_arrays(tmp_path / "out", arrays, {"scene": "none"})
    raw = (tmp_path / "out" / "a.f32").read_bytes()
    assert struct.unpack("<6f", raw) == tuple(np.float32(v) for v in (0.5, -1.25, np.inf, 3.0, 1e-3, -0.0))
    assert struct.unpack("<3i", (tmp_path / "out" / "b" / "whole.i32").read_bytes()) == (1, -2, 70000)
    assert struct.unpack("<2i", (tmp_path / "out" / "b" / "mask.i32").read_bytes()) == (1, 0)
    assert np.array_equal(np.load(tmp_path / "out" / "a.npy"), NUMBERS)
    index = json.loads((tmp_path / "out" / "arrays.json").read_text())
    assert index["schema"] == "refdof-arrays-1"
    assert index["scene"] == "none"
    assert index["arrays"]["a"] == {
        "npy": "a.npy", "raw": "a.f32", "raw_type": "float32", "dtype": "float64", "shape": [2, 3], "axes": "H W",
        "unit": "px", "meaning": "some numbers", "columns": ["x", "y", "z"], "comparison": "formula",
    }  # fmt: skip
    assert index["arrays"]["b/whole"]["raw_type"] == "int32"


def test_an_earlier_export_is_replaced_whole(tmp_path):
    save_arrays(tmp_path, {"old": Described(NUMBERS, "H W")}, {})
    save_arrays(tmp_path, {"new": Described(NUMBERS, "H W")}, {})
    assert {path.name for path in tmp_path.iterdir()} == {"new.npy", "new.f32", "arrays.json"}


def test_other_files_are_not_touched(tmp_path):
    (tmp_path / "thesis.txt").write_text("mine")
    with pytest.raises(InputError, match=r"^out: got '.*', which holds other files; allowed is a new or empty folder"):
        save_arrays(tmp_path, {}, {})
    (tmp_path / "arrays.json").write_text('{"schema": "another"}')
    with pytest.raises(InputError, match=r"^stages: got"):
        check_arrays_folder(tmp_path, "stages")
    assert {path.name for path in tmp_path.iterdir()} == {"thesis.txt", "arrays.json"}


def test_a_failure_leaves_the_old_folder_and_nothing_else(tmp_path):
    target = tmp_path / "out"
    save_arrays(target, {"old": Described(NUMBERS, "H W")}, {})
    with pytest.raises(ValueError, match="Object arrays cannot be saved"):  # NumPy's own words
        save_arrays(target, {"new": Described(NUMBERS, "H W"), "bad": Described(np.array([object()]), "N")}, {})
    assert {path.name for path in tmp_path.iterdir()} == {"out"}
    assert {path.name for path in target.iterdir()} == {"old.npy", "old.f32", "arrays.json"}


def test_an_interrupted_run_leaves_nothing(tmp_path):
    def run():
        with atomic_folder(tmp_path / "out") as folder:
            (folder / "a").write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run()
    assert not list(tmp_path.iterdir())


def test_a_file_in_the_way_is_named(tmp_path):
    (tmp_path / "out").write_text("a file")
    with pytest.raises(InputError, match=r"^out: got .* is not a writable folder"):
        save_arrays(tmp_path / "out", {}, {})

"""The store: what is kept is what would be made, and nothing else is ever given back."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

import refdof._store
from refdof._store import fingerprint, stored
from refdof.optics.camera import Camera
from refdof.scene.builtin import _made, built_in, shot_of

pytestmark = pytest.mark.fast


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(refdof._store, "results_folder", lambda: tmp_path)
    return tmp_path / "numbers"


def counting():
    made = []

    def make():
        made.append(len(made))
        return np.arange(5.0) + len(made)

    return make, made


def test_a_result_is_made_once_and_comes_back_with_the_same_bits(folder):
    make, made = counting()
    first = stored("numbers", ("a", 1), make)
    assert np.array_equal(stored("numbers", ("a", 1), make), first)
    assert len(made) == 1
    stored("numbers", ("a", 2), make)
    assert len(made) == 2
    assert len(list(folder.iterdir())) == 2


@pytest.mark.parametrize("content", [b"", b"garbage", b"\x80\x05."])
def test_a_spoilt_file_is_made_again(folder, content):
    make, made = counting()
    stored("numbers", "a", make)
    (file,) = folder.iterdir()
    file.write_bytes(content)
    assert np.array_equal(stored("numbers", "a", make), np.arange(5.0) + 2)
    assert len(made) == 2
    stored("numbers", "a", make)
    assert len(made) == 2


def test_what_was_used_longest_ago_goes(folder):
    make, made = counting()
    for name in "abc":
        stored("numbers", name, make, most_bytes=1 << 20)
    size = next(folder.iterdir()).stat().st_size
    stored("numbers", "d", make, most_bytes=2 * size)
    assert len(list(folder.iterdir())) == 2
    stored("numbers", "d", make)
    assert len(made) == 4


def test_a_folder_that_cannot_be_written_costs_nothing_but_time(folder):
    folder.write_text("a file where a folder should be")
    make, made = counting()
    for _ in range(2):
        stored("numbers", "a", make)
    assert len(made) == 2


@dataclass(frozen=True)
class Pair:
    one: object
    two: object


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (1, 1.0),
        (1, True),
        ("1", 1),
        (None, "None"),
        ((1, 2), ((1,), 2)),
        (("a", "bc"), ("ab", "c")),
        (Pair(1, 2), Pair(2, 1)),
        (Pair(1, 2), (1, 2)),
        ({"a": 1}, {"a": 2}),
        (np.zeros(4), np.zeros((2, 2))),
        (np.zeros(2), np.zeros(4, dtype=np.float32)),
        (np.array([0.0]), np.array([-0.0])),
        (np.array([1.0, 2.0]), np.array([2.0, 1.0])),
    ],
)
def test_different_values_have_different_fingerprints(one, other):
    assert fingerprint(one) != fingerprint(other)
    assert fingerprint(one) == fingerprint(one)


def test_order_in_memory_does_not_matter():
    values = np.arange(12.0).reshape(3, 4)
    assert fingerprint(values) == fingerprint(np.asfortranarray(values))
    assert fingerprint(np.zeros((0, 3))) != fingerprint(np.zeros((3, 0)))


def test_a_value_that_may_differ_unseen_has_no_fingerprint(folder):
    with pytest.raises(TypeError, match="object has no fingerprint"):
        fingerprint(object())
    make, made = counting()
    for _ in range(2):
        stored("numbers", object(), make)
    assert len(made) == 2


def test_a_kept_scene_is_the_made_one_to_the_bit(folder):
    first, kept = built_in("branches"), built_in("branches")
    made = _made("branches", shot_of("branches"))
    assert fingerprint(kept) == fingerprint(made) == fingerprint(first)
    assert kept is not first
    assert (folder.parent / "scenes").is_dir()
    moved = replace(kept, camera=Camera(eye=(0.0, 0.0, 3.0), target=(0.0, 0.0, 0.0)))
    assert fingerprint(moved) != fingerprint(made)

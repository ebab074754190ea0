"""Each target takes its seeds, and refuses spoilt ones in one clear line; without atheris."""

import random

import pytest

from tests.fuzz.rooms import ROOMS
from tests.fuzz.run import figures
from tests.fuzz.targets import TARGETS, refused

pytestmark = pytest.mark.fast


def spoilt(seed, dice):
    """A seed with a few bytes changed, cut or repeated."""
    data = bytearray(seed)
    for _ in range(dice.randint(1, 4)):
        at = dice.randrange(len(data))
        kind = dice.randrange(4)
        if kind == 0:
            data[at] = dice.randrange(256)
        elif kind == 1:
            data[at] ^= 1 << dice.randrange(8)
        elif kind == 2:
            del data[at : at + dice.randint(1, 8)]
        else:
            data[at:at] = data[at : at + dice.randint(1, 8)]
        if not data:
            return b""
    return bytes(data)


@pytest.mark.parametrize("name", TARGETS)
def test_seeds_are_read_and_spoilt_ones_refused_or_read(name):
    target, dice = TARGETS[name], random.Random(name)
    seeds = target.seeds()
    assert seeds
    assert not any(refused(target, seed) for seed in seeds)
    answers = [refused(target, spoilt(seed, dice)) for seed in seeds * max(1, 12 // len(seeds))]
    assert any(answers) or name == "texture"  # one that is broken is left out


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("settings", b"multiv\x01.sam\x0b\x0b=inf"),  # an error with the line breaks of what was given
        ("settings", b"a\x0bb=1\na\x0bb=2"),
        ("npy", b"\x93NUMPY\x01\x00\x10\x00{'shape': (3, 4 "),  # NumPy's parser of old headers
        ("scene_toml", b"a = " + b"[" * 5000),
        ("scene_toml", b"a = " + b"9" * 5000),
    ],
)
def test_what_fuzzing_found(name, data):
    assert refused(TARGETS[name], data)


def test_every_target_says_what_is_watched():
    assert list(ROOMS) == list(TARGETS)


def test_figures_of_a_run():
    words = "#2 INITED cov: 7 ft: 9\n#64 DONE   cov: 41 ft: 90 corp: 3/8b\nstat::number_of_executed_units: 64\n"
    assert figures(words) == (64, 41)

"""FLIP in processes of its own: the same numbers, whatever becomes of the processes, and none is left."""

import sys

import numpy as np
import pytest

from refdof import metrics
from refdof._check import InputError
from refdof.metrics import perceptual
from refdof.metrics.perceptual import flip, flip_here, flip_processes

pytestmark = pytest.mark.fast


@pytest.fixture
def images():
    return np.random.default_rng(3).uniform(0.0, 1.2, (4, 17, 23, 3)).astype(np.float32)


@pytest.fixture
def started(monkeypatch):
    """Processes that were started."""
    found, start = [], perceptual._start

    def noted():
        found.append(start())
        return found[-1]

    monkeypatch.setattr(perceptual, "_start", noted)
    return found


def test_processes_answer_with_the_same_bits(images, started, monkeypatch):
    expected = [flip(images[0], image) for image in images]
    maps = [flip_here(images[0], image)()[1] for image in images]
    monkeypatch.setattr(perceptual, "evaluate", lambda *_: pytest.fail("worked out in this process"))
    with flip_processes(2) as ask:
        first, second = ask(images[0], images[0]), ask(images[0], images[1])
        found = {1: second(), 0: first()} | {k: ask(images[0], images[k])() for k in range(2, len(images))}
    for k, (mean, errors) in found.items():
        assert mean == expected[k]
        np.testing.assert_array_equal(errors, maps[k])
    assert len(started) == 2
    assert all(process.returncode is not None for process in started)


def test_who_finds_no_idle_process_gets_the_number_too(images, started):
    with flip_processes(1) as ask:
        answers = [ask(images[0], image) for image in images]
        assert [answer()[0] for answer in answers] == [flip(images[0], image) for image in images]


def test_a_process_that_ends_is_replaced_by_this_one(images, started):
    with flip_processes(2) as ask:
        waiting = ask(images[0], images[1])
        for process in started:
            process.kill()
            process.wait()
        assert [waiting()[0], ask(images[0], images[2])()[0]] == [flip(images[0], image) for image in images[1:3]]


@pytest.mark.parametrize("executable", ["", "/no/such/python"])
def test_without_a_python_to_start_this_process_does_it(images, monkeypatch, executable):
    monkeypatch.setattr(sys, "executable", executable)
    with flip_processes(2) as ask:
        assert ask(images[0], images[1])()[0] == flip(images[0], images[1])


def test_the_map_has_the_mean_and_lies_on_the_pixels(images):
    """FLIP filters over few pixels: far from the only difference it is zero, and on it largest."""
    changed = images[0].copy()
    changed[3, 15] += 0.5
    mean, errors = flip_here(images[0], changed)()
    assert errors.shape == images[0].shape[:2]
    assert errors.mean(dtype=np.float64) == pytest.approx(mean, rel=1e-5)  # the library adds in float32
    assert np.unravel_index(errors.argmax(), errors.shape) == (3, 15)


@pytest.mark.parametrize("few", [0, 10**9])
def test_scores_of_many_are_the_scores_of_each(images, monkeypatch, few):
    monkeypatch.setattr(metrics, "_FEW_VALUES", few)
    monkeypatch.setattr(metrics, "thread_count", lambda: 2)
    told = []
    found = metrics.scores_of_many(images[0], list(images), lambda *count: told.append(count))
    assert found == [metrics.scores(images[0], image) for image in images]
    assert told == [(k, 4) for k in range(1, 5)]


def test_an_error_reaches_the_caller_and_no_process_is_left(images, started, monkeypatch):
    monkeypatch.setattr(metrics, "_FEW_VALUES", 0)
    monkeypatch.setattr(metrics, "thread_count", lambda: 2)
    with pytest.raises(InputError, match=r"image: got shape \(17, 22, 3\)"):
        metrics.scores_of_many(images[0], [*images, images[0, :, 1:]] * 3)
    assert started
    assert all(process.returncode is not None for process in started)

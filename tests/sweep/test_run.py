"""Sweeps that end, that go on, and that are killed."""

import json
import os
import subprocess
import sys
import time
from dataclasses import asdict

import numpy as np
import pytest

from refdof import METHODS, InputError
from refdof.sweep import Results, axis_of, jobs_of, shots_of, sweep
from refdof.sweep.measure import Task, measure
from refdof.sweep.peak_memory import peak_memory
from refdof.sweep.run import ReferenceChoice
from refdof.sweep.time_left import TimeLeft
from tests.sweep.points import sleeping_method, small_view

CHOICE = ReferenceChoice(samples=64)
TIMES = ("prepare_s", "layers_s", "blur_s", "spread_s", "peak_bytes", "measured_at", "runs")  # differ from run to run


@pytest.fixture
def sleep(monkeypatch):
    monkeypatch.setitem(METHODS, "sleep", sleeping_method())


@pytest.fixture(autouse=True)
def own_cache(monkeypatch, tmp_path):
    monkeypatch.setattr("refdof._store.results_folder", lambda: tmp_path / "cache")


def shot_of(view, settings):
    (shot,) = shots_of(view, [])
    (job,) = jobs_of(["sleep"], [], {"sleep": {"samples": 1, **settings}})
    shot.image = np.asarray(view.pinhole().color)
    return shot, Task(job, "key", "command")


def test_a_known_time_is_measured(sleep):
    found = measure(*shot_of(small_view(), {"seconds": 0.05}))
    # Sleeping takes at least as long as asked; a busy machine wakes late.
    assert 0.05 <= found.blur_s < 0.15
    assert found.runs == 3
    assert found.layers_s == 0.0
    assert found.time_s == found.blur_s
    assert found.prepare_s > 0.0
    long = measure(*shot_of(small_view(), {"seconds": 1.1}))
    assert 1.1 <= long.blur_s < 1.6
    assert long.runs == 1
    assert np.isnan(long.spread_s)


def test_a_known_memory_is_measured(sleep):
    found = measure(*shot_of(small_view(), {"megabytes": 64}))
    if np.isnan(found.peak_bytes):
        pytest.fail("this system does not tell the highest resident size")
    # Pages of the allocator may be given back, or taken, meanwhile.
    assert 63.0 <= found.peak_bytes / 2**20 < 72.0
    with peak_memory() as nothing:
        pass
    assert nothing.bytes < 2**20


def test_what_is_measured_of_a_picture(sleep):
    shot, task = shot_of(small_view((32, 24)), {})
    found = measure(shot, task)
    assert (found.width, found.height, found.scene, found.command) == (32, 24, "triangle", "command")
    assert found.reads_per_pixel == 2.0
    image = np.asarray(shot.image, dtype=np.float64)
    assert found.scores["rmse"] == pytest.approx(0.1 * np.sqrt((image**2).mean()), rel=1e-5)  # float32
    coc = shot.view.lens.coc_px(shot.view.pinhole().depth, shot.view.camera)
    assert found.max_coc_px == pytest.approx(abs(coc).max())
    assert found.mean_coc_px == pytest.approx(abs(coc).mean())


def test_nothing_is_measured_twice(sleep, tmp_path):
    axes = [axis_of("samples=1,2"), axis_of("size=16x12,20x15")]
    told = []

    def run(methods_axes):
        with Results(tmp_path / "sweep.duckdb") as results:
            before = results.keys()
            keys = sweep(
                shots_of(small_view(), methods_axes),
                jobs_of(["sleep"], methods_axes),
                results,
                CHOICE,
                count=2,
                progress=lambda *words: told.append(words),
            )
            return keys, {key: one.measured_at for key, one in zip(keys, results.points(keys), strict=True)}, before

    keys, _, before = run(axes)
    assert len(set(keys)) == 4
    assert not before
    assert told[-1][1] <= told[-1][2]
    assert any("left" in what for what, _, _ in told)
    told.clear()
    again, _, before = run(axes)
    assert again == keys
    assert before == set(keys)
    assert not told
    more, _, _ = run([axis_of("samples=1,2,3"), axes[1]])
    assert set(keys) < set(more)
    assert len({what.split(",")[0] for what, _, _ in told if "sleep" in what}) == 2  # one new point at each shot


def test_another_reference_or_another_code_is_another_point(sleep, tmp_path, monkeypatch):
    with Results(tmp_path / "sweep.duckdb") as results:

        def run(choice):
            jobs = jobs_of(["sleep"], [axis_of("samples=1")])
            return sweep(shots_of(small_view(), []), jobs, results, choice)

        keys = {run(CHOICE)[0], run(CHOICE._replace(seed=1))[0], run(CHOICE._replace(samples=128))[0]}
        monkeypatch.setattr("refdof.sweep.run.source_digest", lambda: "other")
        keys.add(run(CHOICE)[0])
        monkeypatch.setattr("refdof.sweep.run.processor", lambda: "other")
        keys.add(run(CHOICE)[0])
    assert len(keys) == 5


def test_too_small(sleep, tmp_path):
    with Results(tmp_path / "sweep.duckdb") as results, pytest.raises(InputError, match="size: got 8x8"):
        sweep(shots_of(small_view((8, 8)), []), jobs_of(["sleep"], []), results)


@pytest.mark.slow
def test_killed_at_random_moments(sleep, tmp_path):
    """Points of 20 runs that were killed are those of one that was not, and none is measured twice."""
    environment = {**os.environ, "REFDOF_CACHE_DIR": str(tmp_path / "cache2"), "NUMBA_DISABLE_JIT": "1"}
    command = [sys.executable, "-m", "tests.sweep.interrupted", str(tmp_path)]
    run = subprocess.run(command, check=True, env=environment, stdout=subprocess.PIPE)
    counts = json.loads(run.stdout)
    assert counts == sorted(counts)
    assert len(set(counts)) > 3  # it was killed in the middle
    tables = {}
    for name in ("whole", "killed"):
        with Results(tmp_path / name / "sweep.duckdb") as results:
            rows = [asdict(one) for one in results.points()]
        tables[name] = [{key: repr(value) for key, value in row.items() if key not in TIMES} for row in rows]
    assert tables["killed"] == tables["whole"]
    assert len(tables["whole"]) == 48


def test_time_left(monkeypatch):
    now = [0.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    left = TimeLeft(["a", "b", "b", "a", "c"])
    assert str(left) == ""
    for kind, seconds in (("a", 10.0), ("b", 2.0)):
        now[0] += seconds
        left.ended(kind)
    assert left.seconds() == 2.0 + 10.0 + 6.0  # c: the mean of what is known
    left.ended("b", measured=False)
    assert left.seconds() == 16.0
    assert str(left) == ", about 16 s left"
    now[0] += 600.0
    left.ended("a")
    assert left.seconds() == pytest.approx((305.0 + 2.0) / 2.0)
    assert str(left) == ", about 3 min left"
    assert (left.done, left.count) == (4, 5)

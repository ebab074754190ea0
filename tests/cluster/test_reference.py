"""References on two workers have the bits of those made here; a worker that is killed costs only its own tiles."""

import os
import signal
import subprocess
import sys

import numpy as np
import pytest

from refdof import Camera, ExpressiveLens, InputError, Part, Scene, SystemLens, ThinLens, load_lens, reference
from refdof.cluster import connected
from refdof.truth import tile_tasks
from tests.cluster import work
from tests.cluster.machines import ROOT, scheduler, worker

CAMERA = Camera((0.0, 0.0, 4.0), (0.0, 0.0, 0.0), fov_y=40.0, size=(24, 20))  # four tiles, three of them cut
LENS = ThinLens(0.3, 3.0)


def scene():
    """Sixty small triangles at random, with colours."""
    random = np.random.default_rng(7)
    middle = random.uniform(-1.5, 1.5, (60, 1, 3))
    vertices = (middle + random.uniform(-0.4, 0.4, (60, 3, 3))).reshape(-1, 3)
    part = Part(vertices, np.arange(180).reshape(60, 3), color=random.uniform(0.1, 0.9, (180, 3)))
    return Scene.from_parts("triangles", [part], CAMERA, LENS, background=(0.1, 0.2, 0.3))


def assert_same(ours, theirs):
    """All but the time, to the bit."""
    for name in ("image", "standard_error", "low", "high", "samples"):
        first, second = getattr(ours, name), getattr(theirs, name)
        assert first.dtype == second.dtype
        np.testing.assert_array_equal(first, second, err_msg=name)
    assert (ours.noise_floor_psnr, ours.unmet) == (theirs.noise_floor_psnr, theirs.unmet)


def lenses():
    return {
        "thin": LENS,
        "expressive": ExpressiveLens(0.3, 3.0, 0.5, power=(1.0, 1.1), image_offset=(0.0, 0.1)),
        "real": SystemLens(load_lens("biconvex"), 3.0, mm_per_unit=20.0),
    }


@pytest.mark.parametrize(
    ("lens", "words"),
    [
        ("thin", {"samples": 16, "seed": 3}),
        ("thin", {"samples": 16, "pixel_filter": "box"}),
        ("thin", {"tolerance": 0.003, "max_samples": 512}),
        ("thin", {"samples": 16, "replicates": 4, "shared_pattern": True}),
        ("expressive", {"samples": 16}),
        ("real", {"samples": 16}),
    ],
)
def test_identical_bits(two, monkeypatch, lens, words):
    shot = scene(), CAMERA, lenses()[lens]
    here = reference(*shot, **words)
    monkeypatch.setattr(tile_tasks.TileWork, "sampler", None)  # nothing is sampled in this process
    done = []
    there = reference(*shot, **words, cluster=two, progress=lambda *tiles: done.append(tiles))
    assert_same(here, there)
    assert done[-1] == (4, 4)
    assert done == sorted(done)
    if "tolerance" in words:
        assert len(np.unique(here.samples)) > 1  # some pixels needed more
        assert 0.0 < here.unmet < 1.0


def test_an_error_is_that_of_a_local_run(two):
    with pytest.raises(InputError, match=r"^samples: got 0; "):
        reference(scene(), samples=0, cluster=two)
    with pytest.raises(InputError, match=r"^cluster: got str; allowed is a Cluster"):
        reference(scene(), cluster="here")


def test_a_worker_killed_half_way_costs_only_its_tiles(log, monkeypatch):
    shot = scene(), CAMERA.with_size((96, 64))  # 24 tiles
    here = reference(*shot, samples=4, replicates=4)
    monkeypatch.setattr(tile_tasks, "_sample", work.sample)
    monkeypatch.setattr(tile_tasks, "_TASK_S", 0.0)  # a tile a task
    kept = set()

    with connected(workers=2) as cluster:

        def kill(done, _):
            if done == 8:
                victim = min(cluster.client.run(os.getpid).values())
                work.wait_until(lambda: work.is_at_work(victim))
                kept.update(said.removeprefix("end ") for _, said in work.told() if said.startswith("end"))
                os.kill(victim, signal.SIGKILL)
                killed.append(True)

        killed = []
        there = reference(*shot, samples=4, replicates=4, cluster=cluster, progress=kill)
    assert killed
    assert_same(here, there)
    begun = [said.removeprefix("begin ") for _, said in work.told() if said.startswith("begin")]
    again = {batch for batch in begun if begun.count(batch) > 1}
    assert len(set(begun)) == 24
    assert len(again) <= 2  # the tile that the dead worker did, and one that had ended and was not fetched yet
    assert len(begun) <= 24 + 2


SCRIPT = """
import numpy as np
from refdof import reference
from refdof.cluster import connected
from tests.cluster.test_reference import CAMERA, LENS, scene
if __name__ == "__main__":
    here = reference(scene(), CAMERA, LENS, samples=16)
    with connected(workers=1) as cluster:
        there = reference(scene(), CAMERA, LENS, samples=16, cluster=cluster)
    print(np.array_equal(here.image, there.image))
"""


def test_a_script_that_imports_refdof_before_its_worker_does(tmp_path):
    """A worker process runs the script's head first: Numba is there before the worker's settings are."""
    (tmp_path / "script.py").write_text(SCRIPT)
    done = subprocess.run(
        [sys.executable, "-W", "error", "script.py"],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert (done.stdout, done.stderr) == ("True\n", "")


def test_tasks_last_about_a_second():
    batches = tile_tasks._Batches([(k, 0) for k in range(10_000)], workers=2)
    tasks, done = iter(batches), []
    for _ in range(4):
        done.append(len(next(tasks)))
    assert done == [1, 1, 1, 1]  # before anything was measured
    batches.learn(1, float("nan"))  # compiling
    assert len(next(tasks)) == 1
    batches.learn(4, 0.02)
    assert len(next(tasks)) == 200  # of 5 ms each
    batches.learn(200, 3.06)
    assert len(next(tasks)) == 66  # 204 tiles took 3.08 s
    rest = [len(batch) for batch in tasks]
    assert max(rest) == 66
    assert rest[-1] == 1  # towards the end they are shorter
    assert sum(rest) + 66 + 200 + 5 == 10_000


@pytest.mark.slow
def test_a_machine_with_a_cold_cache_beside_a_warm_one(log, monkeypatch, tmp_path):
    """A scheduler and two workers of their own, one with an empty cache: it compiles, and both agree to the bit."""
    shot, cache = (scene(), CAMERA), tmp_path / "cache"
    monkeypatch.setattr(tile_tasks, "_sample", work.sample_beside_another)
    with (
        scheduler(tmp_path) as (address, _),
        worker(address, tmp_path / "cold", REFDOF_CACHE_DIR=str(cache)),
        worker(address, tmp_path / "warm"),
        connected(address) as cluster,
    ):
        cluster.client.wait_for_workers(2, timeout=60)
        there = reference(*shot, samples=16, cluster=cluster)
    assert_same(reference(*shot, samples=16), there)
    assert any(cache.rglob("*.nbc"))

"""Small sweeps that are killed, as a program of its own: python -m tests.sweep.interrupted FOLDER.

Each is a child that has all imported already, so that most of its life is the sweep. Prints, as JSON, how many points
each of them found when it began.
"""

import json
import os
import random
import signal
import sys
from pathlib import Path

from refdof import METHODS
from refdof.sweep import Results, axis_of, jobs_of, shots_of, sweep
from refdof.sweep.run import ReferenceChoice
from tests.sweep.points import sleeping_method, small_view

KILLS = 20
LATEST_S = 0.2  # after the first point was there


def measure_all(folder, begins):
    """Measure 48 points, and write to `begins` how many were there before, as soon as the first new one is there."""
    METHODS["sleep"] = sleeping_method()
    axes = [axis_of("samples=" + ",".join(str(k) for k in range(1, 25))), axis_of("focus=1,3"), axis_of("seconds=0.01")]
    with Results(folder / "sweep.duckdb") as results:
        before, first = len(results.keys()), []

        def tell(what, _done, _count):
            if ": sleep" in what and first and begins:
                os.write(begins.pop(), b"%d\n" % before)
            elif ": sleep" in what:
                first.append(what)

        shots, jobs = shots_of(small_view(), axes), jobs_of(["sleep"], axes)
        sweep(shots, jobs, results, ReferenceChoice(samples=64), count=2, progress=tell)


def started(folder):
    """A child that measures, and what it writes when it begins."""
    ear, mouth = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(ear)
        measure_all(folder, [mouth])
        os._exit(0)
    os.close(mouth)
    return child, os.fdopen(ear, "rb")


def wait_for(folder):
    child, ear = started(folder)
    with ear:
        ear.read()
    _, status = os.waitpid(child, 0)
    assert status == 0


def main(folder):
    wait_for(folder / "whole")  # it also fills the cache
    moments, counts = random.Random(5), []
    for _ in range(KILLS):
        child, ear = started(folder / "killed")
        with ear:
            said = ear.readline()
            if said:
                counts.append(int(said))
                signal.sigtimedwait([signal.SIGCHLD], moments.uniform(0.0, LATEST_S))
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
    wait_for(folder / "killed")
    print(json.dumps(counts))


if __name__ == "__main__":
    signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGCHLD])
    main(Path(sys.argv[1]))

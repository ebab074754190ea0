"""Schedulers and workers started as an administrator starts them: programs of their own, as on other machines."""

import json
import os
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).parents[2]


@contextmanager
def program(words, folder, **environment):
    """A Dask program; its log is a file, and it is ended with the block."""
    own = {
        **os.environ,
        "PYTHONPATH": str(ROOT),
        "DASK_DISTRIBUTED__SCHEDULER__DASHBOARD__ENABLED": "False",
        **environment,
    }
    with (folder / "log").open("ab") as log:
        process = subprocess.Popen([sys.executable, "-m", *words], env=own, cwd=folder, stdout=log, stderr=log)
    try:
        yield process
    finally:
        process.kill()
        process.wait(timeout=30)


@contextmanager
def scheduler(folder):
    """A scheduler; yields its address and its process."""
    file = folder / "scheduler.json"
    words = [
        "distributed.cli.dask_scheduler",
        "--host",
        "127.0.0.1",
        "--port",
        "0",
        "--dashboard-address",
        "127.0.0.1:0",
    ]
    with program([*words, "--no-dashboard", "--scheduler-file", str(file)], folder) as process:
        yield _when_there(lambda: json.loads(file.read_text())["address"]), process


def worker(address, folder, *words, **environment):
    """A worker of one process, without a nanny that would start it again."""
    folder.mkdir(exist_ok=True)
    command = ["distributed.cli.dask_worker", address, "--no-nanny", "--nthreads", "1", "--no-dashboard"]
    return program([*command, "--local-directory", str(folder), *words], folder, **environment)


def _when_there(find):
    deadline = time.monotonic() + 60.0
    while True:
        try:
            return find()
        except (OSError, ValueError, KeyError):
            if time.monotonic() > deadline:
                raise
            time.sleep(0.05)

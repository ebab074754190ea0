"""Connections: what is refused, in one line and soon, and what is left behind: nothing."""

import os
import re
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path
from threading import Thread

import pytest

from refdof import InputError
from refdof.cluster import completed, connected
from refdof.cluster.build import own_build, refuse_other
from tests.cluster import work
from tests.cluster.machines import ROOT, scheduler, worker
from tests.test_interrupt import children_of, said_of_interrupt, started

pytestmark = pytest.mark.fast


def refusal(**words):
    """What is said, and after how many seconds."""
    began = time.monotonic()
    with pytest.raises(InputError) as refused, connected(**words):
        pass
    assert len(str(refused.value).splitlines()) == 1
    return str(refused.value), time.monotonic() - began


def test_without_words_there_is_no_cluster():
    with connected() as cluster:
        assert cluster is None


@pytest.mark.parametrize(
    ("address", "workers", "said"),
    [
        ("tcp://a:1", 2, "scheduler: got 'tcp://a:1' with workers; allowed is one of them"),
        (None, 0, "workers: got 0; allowed is a whole number in 1 .. 1024"),
        *(
            (address, None, f"scheduler: got {address!r}; allowed is tcp://HOST:PORT or tls://HOST:PORT")
            for address in (
                "",
                "here",
                "http://a:1",
                "tcp://a",
                "tcp://:1",
                "tcp://a:b",
                "tcp://a:99999",
                "tcp://a:1/b",
            )
        ),
    ],
)
def test_words_that_are_refused(address, workers, said):
    assert refusal(scheduler=address, workers=workers)[0] == said


def test_a_port_where_nobody_listens():
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
    said, seconds = refusal(scheduler=f"tcp://127.0.0.1:{port}")
    assert said == (
        f"scheduler: got tcp://127.0.0.1:{port}, which cannot be reached (Connection refused); allowed is one that runs"
    )
    assert seconds < 2.0


def test_a_port_where_something_silent_listens():
    with socket.create_server(("127.0.0.1", 0)) as server:
        address = f"tcp://127.0.0.1:{server.getsockname()[1]}"
        said, seconds = refusal(scheduler=address)
    assert said == f"scheduler: got {address}, which cannot be reached (timed out); allowed is one that runs"
    assert seconds < 10.0


@pytest.mark.parametrize("words", [b"SSH-2.0-OpenSSH_9.2\r\n", b""])
def test_a_port_where_something_else_answers(words):
    def answer():
        connection, _ = server.accept()
        connection.sendall(words)
        connection.close()

    with socket.create_server(("127.0.0.1", 0)) as server:
        thread = Thread(target=answer)
        thread.start()
        address = f"tcp://127.0.0.1:{server.getsockname()[1]}"
        said, seconds = refusal(scheduler=address)
        thread.join()
    assert "(it does not speak as a Dask scheduler)" in said
    assert seconds < 2.0


def test_a_scheduler_without_workers(tmp_path):
    with scheduler(tmp_path) as (address, _):
        said, seconds = refusal(scheduler=address, wait_s=0.5)
    assert said == f"scheduler: got {address}, which had no worker for 0.5 s; allowed after: dask worker {address}"
    assert seconds < 5.0


OTHER = """
import refdof, refdof.cluster.build as build
{change}
"""


@pytest.mark.parametrize(
    ("change", "got", "allowed"),
    [
        ("refdof.__version__ = '0.0.9'", "refdof 0.0.9", f"refdof {own_build().refdof}"),
        ("build.source_digest = lambda: 'abc'", "sources abc", f"sources {own_build().sources}"),
    ],
)
def test_a_worker_with_another_build(tmp_path, change, got, allowed):
    preload = tmp_path / "other.py"
    preload.write_text(OTHER.format(change=change))
    with scheduler(tmp_path) as (address, _), worker(address, tmp_path / "worker", "--preload", str(preload)):
        said, _ = refusal(scheduler=address)
    assert re.fullmatch(rf"worker tcp://127\.0\.0\.1:\d+: got {got}; allowed is {allowed}, as here", said)


def test_a_worker_that_comes_later_with_another_build(tmp_path, log):
    preload = tmp_path / "other.py"
    preload.write_text(OTHER.format(change="build.source_digest = lambda: 'abc'"))

    def tasks():
        yield from range(3)
        with worker(address, tmp_path / "b", "--preload", str(preload)):
            yield from range(3, 500)

    with (
        scheduler(tmp_path) as (address, _),
        worker(address, tmp_path / "a"),
        connected(address) as cluster,
        pytest.raises(InputError, match=r"^worker tcp://127\.0\.0\.1:\d+: got sources abc; "),
    ):
        list(completed(work.slow, work.Scene(0), tasks(), cluster))


@pytest.mark.parametrize("part", own_build()._fields)
def test_every_part_of_a_build_counts(part):
    ours = own_build()
    refuse_other("tcp://a:1", ours, ours)
    with pytest.raises(InputError) as refused:
        refuse_other("tcp://a:1", ours._replace(**{part: "other"}), ours)
    assert str(refused.value).startswith(f"worker tcp://a:1: got {part} other; allowed is {part} {getattr(ours, part)}")


def test_without_dask(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    monkeypatch.delitem(sys.modules, "refdof.cluster.by_dask", raising=False)
    said, _ = refusal(workers=2)
    assert said.startswith("workers: got 2 without Dask (")
    assert said.endswith("allowed after: pip install 'refdof[distributed]'")


QUIET = """
import operator
from refdof.cluster import completed, connected
if __name__ == "__main__":
    with connected(workers=2) as cluster:
        print(sorted(completed(operator.add, 40, range(3), cluster)))
"""


def test_nothing_is_said_and_nothing_is_left(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(QUIET)
    (tmp_path / "scratch").mkdir()
    own = {**os.environ, "PYTHONPATH": str(ROOT), "TMPDIR": str(tmp_path / "scratch")}
    done = subprocess.run(
        [sys.executable, "-W", "error", str(script)], env=own, cwd=tmp_path, capture_output=True, text=True, timeout=60
    )
    assert (done.stdout, done.stderr) == ("[(0, 40), (1, 41), (2, 42)]\n", "")
    assert not list((tmp_path / "scratch").iterdir())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["scratch", "script.py"]


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere Ctrl-C waits for the running step")
@pytest.mark.parametrize("seconds", [3.0, 6.0])
def test_interrupt_leaves_no_process_and_no_folder(tmp_path, monkeypatch, seconds):
    (tmp_path / "scratch").mkdir()
    monkeypatch.setenv("TMPDIR", str(tmp_path / "scratch"))
    words = "compare fence --size 640x480 --samples 65536 --methods mipmap --workers 2 --out out"
    process = started(words.split(), tmp_path)
    time.sleep(seconds)
    below = children_of(process.pid)
    assert len(below) >= 1
    began = time.monotonic()
    os.killpg(process.pid, signal.SIGINT)
    _, error = process.communicate(timeout=60)
    assert time.monotonic() - began < 3.0
    assert said_of_interrupt(error)
    assert process.returncode == 130
    deadline = time.monotonic() + 5.0
    while any(Path(f"/proc/{child}").exists() for child in below) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not [child for child in below if Path(f"/proc/{child}").exists()]
    assert not list((tmp_path / "scratch").glob("refdof-workers-*"))


def test_a_scheduler_that_dies(tmp_path, log):
    with (
        scheduler(tmp_path) as (address, process),
        worker(address, tmp_path / "a"),
        connected(address) as cluster,
    ):
        results = completed(work.slow, work.Scene(0), range(50), cluster)
        next(results)
        process.kill()
        began = time.monotonic()
        with pytest.raises(InputError, match=r"^cluster: ") as refused:
            list(results)
        assert len(str(refused.value).splitlines()) == 1
        assert time.monotonic() - began < 30.0

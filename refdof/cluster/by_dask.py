"""By Dask: connections, and tasks on workers. The only file that imports dask.distributed.

1. Connect, and refuse workers of another build                          `attached`, `started`
2. Send what all tasks share to every worker                             `run`
3. Keep each worker supplied, and hand on what is done                   `run`
4. On a worker: check its build, wait for the task before, do the task   `_perform`

Dask sends a task again whose worker died. What tasks share is lost when all workers that had it die; it is sent anew.
"""

import logging
import math
import os
import signal
import socket
import tempfile
import time
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from multiprocessing import resource_tracker
from pathlib import Path
from threading import Lock
from typing import Any, NamedTuple
from urllib.parse import urlsplit

import dask
from distributed import CancelledError, Client, KilledWorker, LocalCluster, as_completed, get_worker

from refdof._check import InputError, as_integer
from refdof._jit import thread_count, use_threads
from refdof._process import unfinished
from refdof.cluster.build import Build, own_build, python_version, refuse_other
from refdof.cluster.completed import Cluster

__all__ = ["attached", "run", "started"]

_ANSWER_S = 8.0  # for a connection; with what comes around it, an error is there within 10 s
_MOST_PARTS = 1 << 16
_AHEAD = 2  # tasks per worker thread that are sent before others are done, so that no worker waits for the next one
_ASK_AGAIN_S = 1.0  # how many workers there are: some may come later
_NO_WORKER_S = 60.0  # after the last one died
_MOST_SENT = 4  # times that a task is sent; Dask itself gives up after as many deaths
_LOGGERS = ("distributed", "distributed.client", "tornado", "tornado.application", "asyncio")
_THREADS = "REFDOF_WORKER_THREADS"  # Numba's own word must be there before Numba is, which a script may import first
_DROPS_COPIES = "distributed.scheduler.active-memory-manager.start"
_one_at_a_time = Lock()


@contextmanager
def attached(address: str, wait_s: float) -> Iterator[Cluster]:
    """A cluster of the workers that a scheduler has."""
    _knock(address)
    with _quiet(), _client(address, _ANSWER_S) as client:
        with suppress(TimeoutError):
            client.wait_for_workers(1, timeout=wait_s)
        if not client.scheduler_info()["workers"]:
            raise InputError(
                f"scheduler: got {address}, which had no worker for {wait_s:g} s; allowed after: dask worker {address}"
            )
        _refuse_others(client)
        yield Cluster(client, address)


def _knock(address: str) -> None:
    """Raise unless a Dask scheduler is behind an address: Dask's client would wait for ever for a silent one.

    A scheduler speaks first, and its message begins with the small number of its parts. Encrypted, it does not.
    """
    parts = urlsplit(address)
    try:
        with socket.create_connection((parts.hostname or "", parts.port or 0), timeout=_ANSWER_S) as door:
            first = b"" if parts.scheme == "tls" else door.recv(8)
    except OSError as error:
        raise _unreachable(address, error.strerror or str(error)) from None
    if parts.scheme != "tls" and not 0 < int.from_bytes(first, "little") < _MOST_PARTS:
        raise _unreachable(address, "it does not speak as a Dask scheduler")


@contextmanager
def started(workers: int, wait_s: float) -> Iterator[Cluster]:
    """A cluster of new processes on this machine, which share its processors."""
    environment = {_THREADS: str(max(1, thread_count() // workers)), "DASK_LOGGING__DISTRIBUTED": "critical"}
    with ExitStack() as stack:
        stack.enter_context(_quiet())
        scratch = stack.enter_context(tempfile.TemporaryDirectory(prefix="refdof-workers-", ignore_cleanup_errors=True))
        stack.enter_context(unfinished(Path(scratch)))
        # Dask would drop copies of what tasks share whenever some workers are idle, and send it to them again.
        stack.enter_context(dask.config.set({"temporary-directory": scratch, _DROPS_COPIES: False}))
        _hush_tracker()
        cluster = LocalCluster(
            n_workers=0,
            threads_per_worker=1,
            processes=True,
            scheduler_kwargs={"dashboard": False, "dashboard_address": "127.0.0.1:0"},
            memory_limit=0,
            silence_logs=logging.CRITICAL,
            env=environment,
        )
        with _closing(cluster), _client(cluster, wait_s) as client:
            cluster.scale(workers)
            with suppress(TimeoutError):
                client.wait_for_workers(workers, timeout=wait_s)
            there = len(client.nthreads())
            if there < workers:
                why = f"of which {there} had started after {wait_s:g} s"
                raise InputError(f"workers: got {workers}, {why}; allowed are as many as this machine can start")
            _refuse_others(client)
            yield Cluster(client, cluster.scheduler_address)


def _hush_tracker() -> None:
    """Start Python's own cleaner of semaphores now, so that it does its work in silence if this process is killed."""
    before = os.environ.get("PYTHONWARNINGS")
    os.environ["PYTHONWARNINGS"] = "ignore::UserWarning:multiprocessing.resource_tracker"
    try:
        resource_tracker.ensure_running()
    finally:
        os.environ.pop("PYTHONWARNINGS")
        if before is not None:
            os.environ["PYTHONWARNINGS"] = before


@contextmanager
def _closing(cluster: LocalCluster) -> Iterator[None]:
    """Close a cluster; if something was raised, kill its workers first, which may be in the middle of a task."""
    try:
        yield
    except BaseException:
        cluster.shutdown_on_close = False  # Dask would do it once more when Python ends
        for nanny in cluster.workers.values():
            nanny.close_gracefully()  # starts no new process
            if nanny.pid is not None:
                with suppress(ProcessLookupError):
                    os.kill(nanny.pid, signal.SIGKILL)
        with suppress(Exception):  # of workers that were just being started
            cluster.close()
        raise
    cluster.close()


@contextmanager
def _client(where: Any, timeout: float) -> Iterator[Client]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of versions of what carries the messages: they are newer or older, and work
        try:
            client = Client(where, timeout=timeout, set_as_default=False)
        except (OSError, ValueError) as error:
            raise _unreachable(str(where), " ".join(str(error).split())) from None
    with client:
        yield client


def _unreachable(address: str, why: str) -> InputError:
    return InputError(f"scheduler: got {address}, which cannot be reached ({why}); allowed is one that runs")


@contextmanager
def _quiet() -> Iterator[None]:
    """Dask tells of workers that come and go; so does the program itself, where it matters."""
    loggers = [logging.getLogger(name) for name in _LOGGERS]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL + 1)
    with dask.config.set({"distributed.admin.large-graph-warning-threshold": "1GB"}):
        try:
            yield
        except KeyboardInterrupt:  # Python ends soon, and with it what Dask would tell of: it stays quiet
            levels = [logging.CRITICAL + 1] * len(levels)
            raise
        finally:
            for logger, level in zip(loggers, levels, strict=True):
                logger.setLevel(level)


def _refuse_others(client: Client) -> None:
    """Raise if a worker has another Python, which could not even read what it is sent, or another build."""
    versions: Any = client.get_versions()
    for worker, facts in versions["workers"].items():
        python = ".".join(facts["host"]["python"].split(".")[:3])
        if python != python_version():
            raise InputError(f"worker {worker}: got python {python}; allowed is python {python_version()}, as here")
    for worker, build in client.run(own_build, on_error="return").items():
        if not isinstance(build, Build):
            why = " ".join(str(build).split())
            allowed = f"allowed is refdof {own_build().refdof} with the same sources as here"
            raise InputError(f"worker {worker}: got no refdof that could answer ({why}); {allowed}")
        refuse_other(worker, build, own_build())


class _Parcel:
    """Something that Dask shall not look into."""

    __slots__ = ("content",)

    def __init__(self, content: Any) -> None:
        self.content = content


def run(function: Callable[[Any, Any], Any], shared: Any, tasks: Iterable[Any], client: Client) -> Iterator[Any]:
    """`refdof.cluster.completed` on the workers of a client."""
    flow = _Flow(client, function, shared, tasks)
    try:
        flow.supply()
        while flow.calls:
            yield flow.next()
            flow.supply()
    finally:
        with suppress(Exception):  # of a scheduler that is gone
            client.cancel(list(flow.calls), force=True)


@contextmanager
def _lost() -> Iterator[None]:
    """Say in one line that the scheduler or its last worker is gone."""
    try:
        yield
    except (OSError, TimeoutError, CancelledError) as error:
        why = " ".join(str(error).split()) or type(error).__name__
        raise InputError(f"cluster: lost its scheduler or all workers ({why}); allowed are some that go on") from None


class _Call(NamedTuple):
    """A task, its place in the list of all, and how often it was sent."""

    number: int
    task: _Parcel
    sent: int = 0


class _Flow:
    """Tasks on their way: `calls`, by the future of their results."""

    def __init__(self, client: Client, function: Any, shared: Any, tasks: Iterable[Any]) -> None:
        self._client, self._function, self._shared, self._left = client, function, shared, enumerate(tasks)
        self.calls: dict[Any, _Call] = {}
        self._ended = as_completed(loop=client.loop)
        self._place = self._scattered()
        self._wanted, self._asked = 0, -math.inf

    def _scattered(self) -> Any:
        with _lost():
            return self._client.scatter([_Parcel(self._shared)], broadcast=True, hash=False, timeout=_NO_WORKER_S)[0]

    def _send(self, call: _Call) -> None:
        if call.sent == _MOST_SENT:
            raise _mortal(call.number)
        future = self._client.submit(_perform, self._place, call.task, pure=False)
        self.calls[future] = call._replace(sent=call.sent + 1)
        self._ended.add(future)

    def supply(self) -> None:
        """Send tasks until every worker has the next one."""
        if time.monotonic() > self._asked + _ASK_AGAIN_S:
            with _lost():
                self._wanted = _AHEAD * max(sum(self._client.nthreads().values()), 1)
            self._asked = time.monotonic()
        while len(self.calls) < self._wanted:
            for number, task in self._left:
                self._send(_Call(number, _Parcel((self._function, task, own_build()))))
                break
            else:
                return

    def next(self) -> tuple[int, Any]:
        """Wait for a result."""
        while True:
            future = next(self._ended)
            call = self.calls.pop(future)
            if future.status == "error":
                error = future.exception()
                if isinstance(error, KilledWorker):
                    raise _mortal(call.number)
                raise error.with_traceback(future.traceback())
            with suppress(CancelledError):
                return call.number, future.result()
            if self._place.status != "finished":  # all workers died that had what tasks share
                self._place = self._scattered()
            self._send(call)


def _mortal(number: int) -> InputError:
    return InputError(
        f"cluster: got workers that died while they had task {number}, again and again"
        " (their logs tell why; often it is memory); allowed are workers that survive it"
    )


def _perform(place: _Parcel, call: _Parcel) -> Any:
    """Do a task on a worker."""
    function, task, build = call.content
    worker = get_worker()
    refuse_other(worker.address, own_build(), build)
    with _one_at_a_time:
        use_threads(as_integer(_THREADS, os.environ.get(_THREADS, worker.state.nthreads), minimum=1))
        return function(place.content, task)

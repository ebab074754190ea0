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
import socket
import tempfile
import time
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from threading import Lock
from typing import Any
from urllib.parse import urlsplit

import dask
from distributed import Client, LocalCluster, as_completed, get_worker

from refdof._check import InputError
from refdof._jit import thread_count, use_threads
from refdof._process import unfinished
from refdof.cluster.build import Build, own_build, python_version, refuse_other
from refdof.cluster.completed import Cluster

__all__ = ["attached", "run", "started"]

_ANSWER_S = 8.0  # for a connection; with what comes around it, an error is there within 10 s
_AHEAD = 2  # tasks per worker thread that are sent before others are done, so that no worker waits for the next one
_ASK_AGAIN_S = 1.0  # how many workers there are: some may come later
_LOGGERS = ("distributed", "distributed.client", "tornado", "tornado.application", "asyncio")
_one_at_a_time = Lock()


@contextmanager
def attached(address: str, wait_s: float) -> Iterator[Cluster]:
    """A cluster of the workers that a scheduler has."""
    parts = urlsplit(address)
    try:
        socket.create_connection((parts.hostname or "", parts.port or 0), timeout=_ANSWER_S).close()
    except OSError as error:
        raise _unreachable(address, error.strerror or str(error)) from None
    with _quiet(), _client(address, _ANSWER_S) as client:
        with suppress(TimeoutError):
            client.wait_for_workers(1, timeout=wait_s)
        if not client.scheduler_info()["workers"]:
            raise InputError(
                f"scheduler: got {address}, which had no worker for {wait_s:g} s; allowed after: dask worker {address}"
            )
        _refuse_others(client)
        yield Cluster(client, address)


@contextmanager
def started(workers: int, wait_s: float) -> Iterator[Cluster]:
    """A cluster of new processes on this machine, which share its processors."""
    threads = max(1, thread_count() // workers)
    environment = {"NUMBA_NUM_THREADS": str(threads), "DASK_LOGGING__DISTRIBUTED": "critical"}
    with ExitStack() as stack:
        stack.enter_context(_quiet())
        scratch = stack.enter_context(tempfile.TemporaryDirectory(prefix="refdof-workers-", ignore_cleanup_errors=True))
        stack.enter_context(unfinished(Path(scratch)))
        cluster = stack.enter_context(
            LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                processes=True,
                dashboard_address=None,
                local_directory=scratch,
                memory_limit=0,
                silence_logs=logging.CRITICAL,
                env=environment,
            )
        )
        client = stack.enter_context(_client(cluster, wait_s))
        client.wait_for_workers(workers, timeout=wait_s)
        _refuse_others(client)
        yield Cluster(client, cluster.scheduler_address)


@contextmanager
def _client(where: Any, timeout: float) -> Iterator[Client]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of versions of what carries the messages: they are newer or older, and work
        try:
            client = Client(where, timeout=timeout, set_as_default=False)
        except (OSError, ValueError) as error:
            raise _unreachable(str(where), f"no answer of a Dask scheduler: {error}") from None
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
    try:
        with dask.config.set({"distributed.admin.large-graph-warning-threshold": "1GB"}):
            yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)


def _refuse_others(client: Client) -> None:
    """Raise if a worker has another Python, which could not even read what it is sent, or another build."""
    for worker, facts in client.get_versions()["workers"].items():
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
    waiting = enumerate(tasks)
    calls: dict[Any, tuple[int, _Parcel]] = {}  # by future

    def send(number: int, call: _Parcel) -> None:
        future = client.submit(_perform, place, call, pure=False)
        calls[future] = number, call
        ended.add(future)

    def supply() -> None:
        nonlocal wanted, asked
        if time.monotonic() > asked + _ASK_AGAIN_S:
            wanted, asked = _AHEAD * max(sum(client.nthreads().values()), 1), time.monotonic()
        while len(calls) < wanted:
            number, task = next(waiting, (-1, None))
            if number < 0:
                break
            send(number, _Parcel((function, task, own_build())))

    place = _scattered(client, shared)
    ended = as_completed(loop=client.loop)
    wanted, asked = 0, -math.inf
    try:
        supply()
        while calls:
            future = next(ended)
            number, call = calls.pop(future)
            if future.status == "cancelled":  # all workers died that had what tasks share
                if place.status != "finished":
                    place = _scattered(client, shared)
                send(number, call)
                continue
            if future.status == "error":
                raise _error_of(future, number) from None
            result = future.result()
            future.release()
            supply()
            yield number, result
    finally:
        client.cancel(list(calls), force=True)


def _scattered(client: Client, shared: Any) -> Any:
    return client.scatter([_Parcel(shared)], broadcast=True, hash=False)[0]


def _error_of(future: Any, number: int) -> BaseException:
    """What a task raised; or, if its workers died, that they did."""
    error: BaseException = future.exception()
    if type(error).__name__ == "KilledWorker":
        return InputError(
            f"cluster: got a task, number {number}, that ended every worker it was sent to"
            " (their logs tell why; often it is memory); allowed is one that they survive"
        )
    return error


def _perform(place: _Parcel, call: _Parcel) -> Any:
    """Do a task on a worker."""
    function, task, build = call.content
    worker = get_worker()
    refuse_other(worker.address, own_build(), build)
    with _one_at_a_time:
        if "NUMBA_NUM_THREADS" not in os.environ:
            use_threads(worker.state.nthreads)
        return function(place.content, task)

"""Connection: to a Dask scheduler that runs somewhere, or to worker processes on this machine."""

from collections.abc import Iterator
from contextlib import contextmanager
from urllib.parse import urlsplit

from refdof._check import InputError, as_integer, as_number
from refdof.cluster.completed import Cluster

__all__ = ["connected"]

_MOST_WORKERS = 1024  # on one machine
_FOR_WORKERS_S = 60.0


@contextmanager
def connected(
    scheduler: str | None = None, workers: int | None = None, wait_s: float = _FOR_WORKERS_S
) -> Iterator[Cluster | None]:
    """A cluster for `refdof.cluster.completed` and `refdof.reference` as long as the block lasts.

    Parameters
    ----------
    scheduler : str, optional
        Where a Dask scheduler listens: "tcp://host:port", or "tls://host:port" with Dask's own settings.
    workers : int, optional
        Instead: start so many processes on this machine, which share its processors, and end them with the block.
        As with all that starts processes, a script must do so below `if __name__ == "__main__":`.
    wait_s : float
        How long to wait for a scheduler's first worker, and for each to say which refdof it has [s].

    Yields
    ------
    Cluster or None
        None without a scheduler and without workers: everything is done in this process.

    Raises
    ------
    InputError
        If both are given, nobody answers, there is no worker, or a worker has another refdof, Python, NumPy, Numba,
        Embree or kind of processor, other sources, or does not compile as this process does.
    """
    if scheduler is not None and workers is not None:
        raise InputError(f"scheduler: got {scheduler!r} with workers; allowed is one of them")
    wait_s = as_number("wait_s", wait_s, above=0.0)
    if workers is not None:
        workers = as_integer("workers", workers, minimum=1, maximum=_MOST_WORKERS)
    elif scheduler is not None:
        scheduler = _as_address(scheduler)
    else:
        yield None
        return
    try:
        from refdof.cluster.by_dask import attached, started
    except ImportError as error:
        raise InputError(
            f"{'workers' if scheduler is None else 'scheduler'}: got {workers or scheduler} without Dask"
            f" ({error}); allowed after: pip install 'refdof[distributed]'"
        ) from None
    with attached(scheduler, wait_s) if scheduler is not None else started(workers or 1, wait_s) as cluster:
        yield cluster


def _as_address(scheduler: object) -> str:
    try:
        if not isinstance(scheduler, str):
            raise ValueError
        parts = urlsplit(scheduler)
        bare = not (parts.path.strip("/") or parts.query or parts.fragment or parts.username)
        if parts.scheme in ("tcp", "tls") and parts.hostname and parts.port and bare and scheduler.isprintable():
            return scheduler.rstrip("/")
    except ValueError:  # a port that is no number
        pass
    said = repr(scheduler) if isinstance(scheduler, str) else f"a {type(scheduler).__name__}"
    raise InputError(f"scheduler: got {said}; allowed is tcp://HOST:PORT or tls://HOST:PORT")

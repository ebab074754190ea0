"""Completed: the results of tasks as they end, from this process or from the workers of a cluster.

A task is a function of something that all tasks share and of a little of its own. What they share travels to each
worker once and stays there as one object, so whatever a task keeps in it is found by the next one. A task that is sent
again, since its worker died, gives the same result: it depends on nothing else.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from refdof._check import as_instance

__all__ = ["Cluster", "completed"]


@dataclass(frozen=True, eq=False)
class Cluster:
    """A connection to workers, made by `refdof.cluster.connected`.

    Attributes
    ----------
    client : distributed.Client
    where : str
        What errors call it: the scheduler's address.
    """

    client: Any
    where: str

    def workers(self) -> int:
        """How many workers there are now; each does one task at a time."""
        return len(self.client.scheduler_info(n_workers=-1)["workers"])


def completed(
    function: Callable[[Any, Any], Any], shared: Any, tasks: Iterable[Any], cluster: Cluster | None = None
) -> Iterator[tuple[int, Any]]:
    """Call function(shared, task) for every task.

    Parameters
    ----------
    function : callable
        Of a module that workers can import. It may use kernels: a worker does one task at a time, with all its threads.
    shared : anything that pickle takes
        Sent to each worker once.
    tasks : iterable
        Small values that pickle takes, read while others are done, a few ahead of the workers.
    cluster : Cluster, optional
        Without one, tasks are done here, in order.

    Yields
    ------
    (int, result)
        The task's place in `tasks`, and what it returned, as tasks end.

    Raises
    ------
    InputError
        If a worker has other sources than this process, or a task ended every worker that did it.
    Exception
        Whatever a task raises.
    """
    if cluster is None:
        for number, task in enumerate(tasks):
            yield number, function(shared, task)
        return
    as_instance("cluster", cluster, Cluster)
    from refdof.cluster.by_dask import run

    yield from run(function, shared, tasks, cluster.client)

"""Run: a sweep, shot by shot and job by job, each point kept as soon as it is measured."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial
from importlib.metadata import version
from typing import NamedTuple

import refdof
from refdof._jit import JIT_DISABLED, source_digest, thread_count
from refdof._store import fingerprint
from refdof.cluster import Cluster, completed
from refdof.compare import check_window, kept_reference
from refdof.machine import processor
from refdof.sweep.measure import Task, measure
from refdof.sweep.plan import Job, Shot
from refdof.sweep.results import Results
from refdof.sweep.time_left import TimeLeft
from refdof.truth.reference import MAX_SAMPLES

__all__ = ["ReferenceChoice", "sweep"]


_PARTS = 100  # of a step, in the progress that is told


class ReferenceChoice(NamedTuple):
    """What the references of a sweep take."""

    samples: int = 256
    tolerance: float | None = None
    seed: int = 0
    max_samples: int = MAX_SAMPLES


def sweep(
    shots: Iterable[Shot],
    jobs: Sequence[Job],
    results: Results,
    choice: ReferenceChoice = ReferenceChoice(),
    count: int = 1,
    cluster: Cluster | None = None,
    command: Callable[[Shot, Job], str] = lambda _shot, _job: "",
    progress: Callable[[str, int, int], None] | None = None,
) -> list[str]:
    """Measure every job at every shot that the results do not hold yet.

    Parameters
    ----------
    shots : of one scene after the other
    jobs : as of `jobs_of`
    results : Results
    choice : ReferenceChoice
    count : int
        How many shots there are, for the time left.
    cluster : Cluster, optional
        Where references and points are made; times are then those of its workers. Without one: here.
    command : (shot, job) -> str
        What renders a picture, kept beside its point.
    progress : callable, optional
        Called with (what, done, all).

    Returns
    -------
    list of str
        The keys of all points, shot by shot, whether they were measured now or before.

    Raises
    ------
    InputError
        If a picture is too small for scores, or results cannot be written. Points measured before are kept.
    """
    known, keys, prints = results.keys(), [], ("", "")
    build = _build(cluster)
    left = TimeLeft(["reference", *(job.method for job in jobs)] * count)

    def tell(what: str, done: float = 0.0) -> None:
        if progress is not None:
            progress(what + str(left), round(_PARTS * (left.done + done)), _PARTS * left.count)

    def tell_share(what: str, done: int, of: int) -> None:
        tell(what, done / of)

    for shot in shots:
        check_window(shot.view)
        scene = shot.view.scene
        if prints[0] != str(id(scene)):
            prints = str(id(scene)), fingerprint(scene)
        about = prints[1], shot.view.camera, shot.view.lens, tuple(choice)
        shared = fingerprint((build, about))
        tasks = [Task(job, fingerprint((shared, job.method, job.params)), command(shot, job)) for job in jobs]
        keys += [task.key for task in tasks]
        todo = [task for task in tasks if task.key not in known]
        if todo:
            told = partial(tell_share, f"{shot.name}: reference")
            truth, _ = kept_reference(shot.view, *choice, told, cluster)
            shot = replace(
                shot,
                image=truth.image,
                standard_error=truth.standard_error,
                noise_floor_psnr=truth.noise_floor_psnr,
            )
        left.ended("reference", bool(todo))
        for task in tasks:
            if task.key in known:
                left.ended(task.job.method, measured=False)
        if todo:
            tell(f"{shot.name}: {todo[0].job.method}")
        for number, (place, point) in enumerate(completed(measure, shot, todo, cluster), 1):
            results.add(point)
            known.add(point.key)
            left.ended(todo[place].job.method)
            if number < len(todo):
                tell(f"{shot.name}: {todo[number].job.method}")
    return keys


def _build(cluster: Cluster | None) -> str:
    """A digest of the code and of the machine that times are of."""
    code = source_digest(), version("embreex"), JIT_DISABLED, refdof.__version__
    where = (processor(), thread_count()) if cluster is None else ("a worker of a cluster", 0)
    return fingerprint((code, where))

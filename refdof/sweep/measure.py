"""Measure: one point of a sweep: its time, memory, reads and scores."""

import math
from datetime import UTC, datetime
from statistics import median
from typing import NamedTuple

import numpy as np

import refdof
from refdof._jit import source_digest, thread_count
from refdof.compare import timed, warm_up
from refdof.machine import processor
from refdof.methods import METHODS
from refdof.metrics import scores
from refdof.metrics.artefacts import ArtefactMaps, artefacts
from refdof.report.rows import plain
from refdof.sweep.measured import Measured
from refdof.sweep.peak_memory import peak_memory
from refdof.sweep.plan import Job, Shot

__all__ = ["Task", "measure"]


class Task(NamedTuple):
    """A job, the key of its point, and the command that renders its picture."""

    job: Job
    key: str
    command: str


def measure(shot: Shot, task: Task) -> Measured:
    """Render a job's picture warm, and score it against the shot's reference."""
    assert shot.image is not None
    view, job = shot.view, task.job
    record = METHODS[job.method].METHOD
    width, height = view.camera.size
    view.times_warm_runs = True
    pinhole = view.pinhole()
    maps = ArtefactMaps(pinhole.depth, view.coc_px(), pinhole.color, shot.standard_error)
    view.forget_layers()  # so that they are in the memory of every job that needs them
    circles = np.abs(view.coc_px())
    view.tracer()
    warm_up(job.method, job.settings)
    with peak_memory() as peak:
        result, times = timed(job.method, view, "best", job.settings)
    reads = math.nan if record.texture_reads is None else float(record.texture_reads(job.params, width, height))
    return Measured(
        key=task.key,
        scene=view.scene.name,
        method=job.method,
        params=plain(vars(job.params)),
        varied=plain({**shot.varied, **{name: getattr(job.params, name) for name in job.varied}}),
        width=width,
        height=height,
        lens_radius=float(view.lens.radius),
        focus=float(view.lens.focus_distance),
        mean_coc_px=float(circles.mean()),
        max_coc_px=float(circles.max()),
        prepare_s=result.seconds["prepare"],
        layers_s=result.layers_s,
        blur_s=median(times),
        spread_s=max(times) - min(times) if len(times) > 1 else math.nan,
        runs=len(times),
        peak_bytes=peak.bytes,
        reads_per_pixel=reads or math.nan,
        rays_per_pixel=float(getattr(job.params, "samples", math.nan)),
        scores=scores(shot.image, result.image),
        noise_floor_psnr=shot.noise_floor_psnr,
        command=task.command,
        machine=processor(),
        threads=thread_count(),
        version=refdof.__version__,
        sources=source_digest(),
        measured_at=datetime.now(UTC).isoformat(timespec="seconds"),
        artefacts=artefacts(maps, shot.image, result.image),
    )

"""Checks of lenses and of lens samples."""

from collections.abc import Sequence

import numpy as np

from refdof.optics.systems.paraxial import focal_length
from refdof.optics.systems.system_lens import SystemLens
from refdof.stability.checks import FLIPS, Check
from refdof.stability.run import ROOM, ULP, Run, bright
from refdof.stability.twins import through_points
from refdof.stability.verdict import Figure

__all__ = ["edge_of_half_plane", "lensmaker", "no_more_light", "one_ray"]


def edge_of_half_plane(edge: float, circle: float) -> Check:
    """A white half-plane left of `edge` [px], nearer than a black wall in focus, shows by the share of a disc."""

    def check(run: Run) -> Figure:
        t = np.clip((edge - np.arange(run.image.shape[1]) - 0.5) / circle, -1.0, 1.0)
        share = 0.5 + (t * np.sqrt(1.0 - t * t) + np.arcsin(t)) / np.pi
        error = float(np.abs(run.image - share[None, :, None]).max())
        return Figure(
            "edge",
            error,
            FLIPS * run.rays**-0.75,
            "of the contrast",
            "well spread points miss a half-disc by a few N^-3/4",
        )

    return check


def lensmaker(power: float) -> Check:
    """The lens has the power that the lensmaker's equation gives [1/mm]."""

    def check(run: Run) -> Figure:
        lens = run.view.lens
        assert isinstance(lens, SystemLens)
        error = abs(focal_length(lens.stopped) * power - 1.0)
        return Figure("focal length", error, 1e-12, "relative", "three surfaces' worth of products in float64")

    return check


def no_more_light(color: Sequence[float]) -> Check:
    """A lens lets through no more light of one colour than comes in."""

    def check(run: Run) -> Figure:
        excess = float((run.image / np.asarray(color)).max()) - 1.0
        room = run.rays**-0.75 if run.traces else ROOM * ULP
        return Figure("light", excess, room, "of the light", "N well spread points know a pupil's area to N^-3/4")

    return check


def one_ray(run: Run) -> Figure:
    """64 lens samples in one point are one sample."""
    point = np.array([[[0.3, -0.4]]])
    many, single = (through_points(run.method, run.view, np.repeat(point, n, axis=1)) for n in (64, 1))
    error = float(np.abs(many - single).max()) / (bright(single) * ULP)
    return Figure("one ray", error, 1.0, "ulp of the brightest", "64 equal numbers have that mean, in float64")

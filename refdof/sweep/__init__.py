"""Sweep: methods with many settings, how long each takes and how near it comes to the reference."""

from refdof.sweep.cost import CostModel, fitted
from refdof.sweep.front import fastest, front, nearest
from refdof.sweep.measured import Measured
from refdof.sweep.plan import Axis, Job, Shot, axis_of, jobs_of, shots_of
from refdof.sweep.results import Results
from refdof.sweep.run import sweep

__all__ = [
    "Axis",
    "CostModel",
    "Job",
    "Measured",
    "Results",
    "Shot",
    "axis_of",
    "fastest",
    "fitted",
    "front",
    "jobs_of",
    "nearest",
    "shots_of",
    "sweep",
]

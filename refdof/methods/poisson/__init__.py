"""Poisson disc: some taps inside the blur, each between the picture and a small blurred copy of it.

Steps and departures: `method`.
"""

from refdof.methods.poisson import method
from refdof.methods.poisson.coding import code_of, shrink
from refdof.methods.poisson.gather import gather
from refdof.methods.poisson.method import METHOD, blur, render, texture_reads
from refdof.methods.poisson.params import TAP_TABLES, TAPS, Params
from refdof.methods.poisson.ties import bounds

__all__ = [
    "METHOD",
    "TAPS",
    "TAP_TABLES",
    "Params",
    "blur",
    "bounds",
    "code_of",
    "gather",
    "render",
    "shrink",
    "texture_reads",
]

__doc__ = method.__doc__

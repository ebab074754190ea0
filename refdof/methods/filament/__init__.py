"""Filament: rings of taps in tiles of half the size, with background by rings that hide each other, and foreground.

Steps and departures: `method`.
"""

from refdof.methods.filament import method
from refdof.methods.filament.method import METHOD, Params, blur, render, texture_reads

__all__ = ["METHOD", "Params", "blur", "render", "texture_reads"]

__doc__ = method.__doc__

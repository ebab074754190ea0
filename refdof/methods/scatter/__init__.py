"""Scatter: every pixel spreads its colour evenly over its circle of confusion. Steps and departures: `method`."""

from refdof.methods.scatter import method
from refdof.methods.scatter.method import METHOD, Params, blur, render, texture_reads

__all__ = ["METHOD", "Params", "blur", "render", "texture_reads"]

__doc__ = method.__doc__

"""Halfres: near and far blur at half the size, one mean and one maximum over a disc of points; as in three.js.

Steps and departures: `method`.
"""

from refdof.methods.halfres import method
from refdof.methods.halfres.method import METHOD, Params, blur, render, texture_reads

__all__ = ["METHOD", "Params", "blur", "render", "texture_reads"]

__doc__ = method.__doc__

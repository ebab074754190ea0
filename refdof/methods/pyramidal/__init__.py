"""Pyramidal: the picture is cut by depth into sub-images, each filled, blurred by a pyramid and laid over the next.

Steps and departures: `method`.
"""

from refdof.methods.pyramidal import method
from refdof.methods.pyramidal.method import METHOD, Params, blur, render, texture_reads

__all__ = ["METHOD", "Params", "blur", "render", "texture_reads"]

__doc__ = method.__doc__

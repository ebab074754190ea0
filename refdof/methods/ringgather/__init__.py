"""Ring gather: rings of taps at half the size, sorted by depth into near and far; as in Wicked Engine.

Steps and departures: `method`.
"""

from refdof.methods.ringgather import method
from refdof.methods.ringgather.method import METHOD, Params, blur, render, texture_reads

__all__ = ["METHOD", "Params", "blur", "render", "texture_reads"]

__doc__ = method.__doc__

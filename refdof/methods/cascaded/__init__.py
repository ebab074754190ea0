"""Cascaded: peeled surfaces matted into depth layers, which are blurred and composed step by step towards focus.

Steps and departures: `method`.
"""

from refdof.methods.cascaded import method
from refdof.methods.cascaded.method import METHOD, Params, blur_buffers, buffers_of, layering_of, render

__all__ = ["METHOD", "Params", "blur_buffers", "buffers_of", "layering_of", "render"]

__doc__ = method.__doc__

"""Mipmap interpolation: every pixel reads a mip level as coarse as its blur, made without leaks from sharp pixels.

Steps and departures: `method`.
"""

from refdof.methods.mipmap import method
from refdof.methods.mipmap.method import METHOD, Params, blur, render, texture_reads

__all__ = ["METHOD", "Params", "blur", "render", "texture_reads"]

__doc__ = method.__doc__

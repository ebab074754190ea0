"""Circular: complex kernels whose products of two passes sum up to a disc.

Steps and departures: `method`.
"""

from refdof.methods.circular import method
from refdof.methods.circular.coefficients import COMPONENTS, kernels
from refdof.methods.circular.method import METHOD, Params, blur, render, texture_reads

__all__ = ["COMPONENTS", "METHOD", "Params", "blur", "kernels", "render", "texture_reads"]

__doc__ = method.__doc__

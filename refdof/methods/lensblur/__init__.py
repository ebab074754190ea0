"""Lens blur: a few layers that hide each other as the lens sees them, and lens rays traced through them.

Steps and departures: `method`.
"""

from refdof.methods.lensblur import method
from refdof.methods.lensblur.method import METHOD, Params, render

__all__ = ["METHOD", "Params", "render"]

__doc__ = method.__doc__

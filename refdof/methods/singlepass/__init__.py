"""Single pass: every pixel gathers taps on a golden-angle spiral; a tap that does not reach it repeats the mean.

Steps and departures: `method`.
"""

from refdof.methods.singlepass import method
from refdof.methods.singlepass.method import METHOD, blur, render, texture_reads
from refdof.methods.singlepass.params import MAX_BLUR_SIZE, Params
from refdof.methods.singlepass.ties import bounds
from refdof.methods.singlepass.walk import spiral

__all__ = ["MAX_BLUR_SIZE", "METHOD", "Params", "blur", "bounds", "render", "spiral", "texture_reads"]

__doc__ = method.__doc__

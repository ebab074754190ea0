"""Slots: what a compiled shader wants to be given, and what it then is, whatever its language."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

__all__ = ["COUNTS", "Given", "ShaderFault", "Slot"]

COUNTS = {
    f"{prefix}{suffix}": count
    for prefix, suffix, count in (
        *((kind, "", 1) for kind in ("float", "int", "uint", "bool")),
        *((kind, str(count), count) for kind in ("vec", "ivec", "uvec", "bvec") for count in (2, 3, 4)),
    )
}
"""How many numbers each type of a uniform holds."""


class ShaderFault(Exception):
    """What is wrong with a shader or with the means to draw it: one line."""


class Slot(NamedTuple):
    """One name that a shader reads.

    kind: "uniform", "texture" or "sampler"; type: one of `COUNTS`, or any other word; has_default: it has a value of
    its own; reads: the textures that a sampler is used with.
    """

    name: str
    kind: str
    type: str = ""
    has_default: bool = False
    reads: tuple[str, ...] = ()


class Given(NamedTuple):
    """What a shader is given to draw with, by the names of its slots.

    uniforms: numbers, but for those that have a value of their own; textures: images (H, W, C) float32; filters:
    "nearest" or "linear" of each texture and sampler.
    """

    uniforms: Mapping[str, list[float]]
    textures: Mapping[str, np.ndarray]
    filters: Mapping[str, str]

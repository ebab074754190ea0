"""Scheuermann's twelve taps as a fragment shader: the last pass of the port, with its textures made by the host."""

from typing import Any

import numpy as np

from tests.gl import shader
from tests.gl.port import source_of

__all__ = ["upload"]


def upload(context: Any, coded: np.ndarray, small: np.ndarray, max_radius: float) -> tuple[Any, ...]:
    """What `shader.draw` needs: the pass, its textures and its uniforms. coded and small are (h, w, 4)."""
    height, width = coded.shape[:2]
    textures = {name: shader.texture_of(context, a, linear=True) for name, a in (("uSharp", coded), ("uSmall", small))}
    work = shader.new_pass(context, source_of("poisson"), (height, width))
    return work, textures, {"uSize": (width, height), "uMaxRadius": max_radius}

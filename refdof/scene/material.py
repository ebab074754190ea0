"""Material and light: how surfaces are shaded.

Shading of a surface point with normal n, seen from direction o, and albedo a = base_color * texture * vertex color:

========  =====================================================================================
unlit     a + emission
lambert   a * E(n) + emission
phong     a * E(n) + emission + specular * (sun * max(0, r.l)^shininess + environment(r))
========  =====================================================================================

E(n) = sun * max(0, n.l) + ground + (sky - ground) * (1 + n.y) / 2, r the mirror direction of o about n. Every surface
has two sides: n is turned towards the viewer. No shadows: what a scene wants dark is dark in its colours.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from refdof._check import (
    LARGEST_COLOR,
    Float,
    InputError,
    as_choice,
    as_color,
    as_image,
    as_number,
    as_vector,
)

__all__ = ["SHADINGS", "Light", "Material", "as_colors"]

SHADINGS = ("unlit", "lambert", "phong")


@dataclass(frozen=True, eq=False)
class Material:
    """How a surface answers light. Colours are linear Rec.709 RGB, at most 1e8.

    Parameters
    ----------
    shading : "unlit", "lambert" or "phong"
    base_color, emission, specular : (3,) floats >= 0
        Emission may exceed 1 (HDR emitters). `specular` is used by phong only.
    texture : (h, w, 3) float32, or None
        Linear RGB, bilinear, repeated; (u, v) = (0, 0) is its lower left corner, row 0 its top row.
    shininess : float
        Phong exponent >= 1.
    """

    shading: str = "lambert"
    base_color: tuple[float, float, float] = (1.0, 1.0, 1.0)
    texture: Float | None = None
    emission: tuple[float, float, float] = (0.0, 0.0, 0.0)
    specular: tuple[float, float, float] = (0.0, 0.0, 0.0)
    shininess: float = 50.0

    def __post_init__(self) -> None:
        as_choice("shading", self.shading, SHADINGS)
        for name in ("base_color", "emission", "specular"):
            object.__setattr__(self, name, as_color(name, getattr(self, name)))
        object.__setattr__(self, "shininess", as_number("shininess", self.shininess, minimum=1.0, maximum=1e6))
        if self.texture is not None:
            object.__setattr__(self, "texture", as_colors("texture", self.texture, (None, None, 3)))


@dataclass(frozen=True, eq=False)
class Light:
    """A distant sun, a two-colour dome and what mirrors see.

    Parameters
    ----------
    sun_direction : (3,) floats
        From the surface towards the sun, world space, any length.
    sun, sky, ground : (3,) floats >= 0
        Irradiance / pi of the sun at normal incidence, and of the dome from above and below.
    environment : (n, n, 3) float32, or None
        What a mirror sees, as an octahedral map of world directions (y up); None: the dome's own colours.
    """

    sun_direction: tuple[float, float, float] = (0.4, 0.8, 0.45)
    sun: tuple[float, float, float] = (0.75, 0.72, 0.66)
    sky: tuple[float, float, float] = (0.42, 0.46, 0.54)
    ground: tuple[float, float, float] = (0.20, 0.18, 0.16)
    environment: Float | None = None

    def __post_init__(self) -> None:
        direction = np.asarray(as_vector("sun_direction", self.sun_direction))
        if not direction.any():
            raise InputError("sun_direction: got (0, 0, 0); allowed is any other direction")
        # Scale by a power of two before the norm, so that squares neither leave the type nor vanish.
        direction = np.ldexp(direction, -np.frexp(np.abs(direction).max())[1])
        x, y, z = (direction / np.linalg.norm(direction)).tolist()
        object.__setattr__(self, "sun_direction", (x, y, z))
        for name in ("sun", "sky", "ground"):
            object.__setattr__(self, name, as_color(name, getattr(self, name)))
        if self.environment is not None:
            environment = as_colors("environment", self.environment, (None, None, 3))
            if environment.shape[0] != environment.shape[1]:
                raise InputError(f"environment: got shape {environment.shape}; allowed is (n, n, 3), an octahedral map")
            object.__setattr__(self, "environment", environment)


def as_colors(name: str, value: Any, shape: tuple[int | None, ...]) -> Float:
    """Return `value` as linear RGB, float32, whose products stay in that type."""
    return as_image(name, value, shape, dtype=np.float32, minimum=0.0, maximum=LARGEST_COLOR)

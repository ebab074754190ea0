"""Material and light: how surfaces are shaded.

Shading of a surface point with normal n, seen from direction o, and albedo a = base_color * texture * vertex color:

========  =====================================================================================
unlit     a + emission
lambert   a * E(n) + emission
phong     a * E(n) + emission + specular * (sun * max(0, r.l)^shininess + environment(r))
========  =====================================================================================

E(n) = sun * max(0, n.l) + ground + (sky - ground) * (1 + n.y) / 2, r the mirror direction of o about n. Every surface
has two sides: n is turned towards the viewer. No shadows: what a scene wants dark is dark in its colours.

The opacity of a surface point is opacity * opacity texture * vertex opacity. With a cutoff, points of lower opacity
are holes and all others are solid (alpha test). Without one, a ray is stopped with that probability (alpha blending);
points of opacity 0 are holes.
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
    as_float,
    as_image,
    as_number,
    as_vector,
)

__all__ = ["SHADINGS", "WRAPS", "Light", "Material", "as_colors", "as_opacity"]

SHADINGS = ("unlit", "lambert", "phong")
WRAPS = ("repeat", "clamp", "mirror")


@dataclass(frozen=True, eq=False)
class Material:
    """How a surface answers light. Colours are linear Rec.709 RGB, at most 1e8.

    Parameters
    ----------
    shading : "unlit", "lambert" or "phong"
    base_color, emission, specular : (3,) floats >= 0
        Emission may exceed 1 (HDR emitters). `specular` is used by phong only.
    texture : (h, w, 3) float32, or None
        Linear RGB, bilinear; (u, v) = (0, 0) is its lower left corner, row 0 its top row.
    shininess : float
        Phong exponent >= 1.
    emission_texture : (h, w, 3) float32, or None
        Linear RGB, read as `texture`; multiplies `emission`.
    opacity : float
        0 .. 1.
    opacity_texture : (h, w) float32, or None
        0 .. 1, read as `texture`; multiplies `opacity`.
    cutoff : float, or None
        0 .. 1: what is less opaque is a hole, all else is solid. None: surfaces are as transparent as their opacity.
    wrap : "repeat", "clamp" or "mirror", or two of them
        How textures go on outside 0 .. 1, along u and along v.
    """

    shading: str = "lambert"
    base_color: tuple[float, float, float] = (1.0, 1.0, 1.0)
    texture: Float | None = None
    emission: tuple[float, float, float] = (0.0, 0.0, 0.0)
    specular: tuple[float, float, float] = (0.0, 0.0, 0.0)
    shininess: float = 50.0
    emission_texture: Float | None = None
    opacity: float = 1.0
    opacity_texture: Float | None = None
    cutoff: float | None = None
    wrap: str | tuple[str, str] = ("repeat", "repeat")

    def __post_init__(self) -> None:
        as_choice("shading", self.shading, SHADINGS)
        for name in ("base_color", "emission", "specular"):
            object.__setattr__(self, name, as_color(name, getattr(self, name)))
        object.__setattr__(self, "shininess", as_number("shininess", self.shininess, minimum=1.0, maximum=1e6))
        for name in ("texture", "emission_texture"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, as_colors(name, getattr(self, name), (None, None, 3)))
        object.__setattr__(self, "opacity", as_number("opacity", self.opacity, minimum=0.0, maximum=1.0))
        if self.opacity_texture is not None:
            texture = as_opacity("opacity_texture", self.opacity_texture, (None, None))
            if not texture.size:
                raise InputError(f"opacity_texture: got shape {texture.shape}; allowed is at least one pixel")
            object.__setattr__(self, "opacity_texture", texture)
        if self.cutoff is not None:
            object.__setattr__(self, "cutoff", as_number("cutoff", self.cutoff, minimum=0.0, maximum=1.0))
        pair: Any = self.wrap if isinstance(self.wrap, tuple | list) and len(self.wrap) == 2 else (self.wrap,) * 2
        object.__setattr__(self, "wrap", tuple(as_choice("wrap", word, WRAPS) for word in pair))


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


def as_opacity(name: str, value: Any, shape: tuple[int | None, ...]) -> Float:
    """Return `value` as opacities, float32 in 0 .. 1."""
    return as_float(name, value, shape, dtype=np.float32, minimum=0.0, maximum=1.0)

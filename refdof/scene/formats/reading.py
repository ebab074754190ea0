"""What readers of mesh files share: the files beside, pictures, limits, and a list of what is left out."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof.scene.beside import FilesBeside
from refdof.scene.formats.pictures import Pictures, decode_srgb
from refdof.scene.limits import Limits, Meter
from refdof.scene.material import Material

__all__ = ["GREY", "SPECULAR", "WHITE", "Reading", "Surface", "decoded"]

GREY = (0.5, 0.5, 0.5)  # albedo of what has no colour
WHITE = (1.0, 1.0, 1.0)  # leaves the colours of a texture or of vertices as they are
SPECULAR = (0.04, 0.04, 0.04)  # normal reflectance of glass and plastic, glTF 2.0 appendix B


class Surface(NamedTuple):
    """Triangles of one material, as a file has them: V vertices, F faces; None is what it does not say."""

    vertices: Float  # (V, 3)
    faces: Index  # (F, 3)
    material: Material
    uv: Float | None = None  # (V, 2), v upwards
    color: Float | None = None  # (V, 3) linear RGB
    opacity: Float | None = None  # (V,)
    normal: Float | None = None  # (V, 3), of any length


class Reading:
    """One file being read; `shading` replaces the file's own if it is given."""

    def __init__(self, path: Path, shading: str | None, limits: Limits) -> None:
        self.meter = Meter(limits)
        self.beside = FilesBeside(path, self.meter)
        self.pictures = Pictures(self.meter)
        self._given = shading
        self._left_out: dict[str, str] = {}
        self._plain: dict[tuple[float, ...], Material] = {}

    def leave_out(self, what: str, reason: str = "") -> None:
        """Tell that something is not read."""
        self._left_out.setdefault(what, reason)

    def left_out(self) -> list[str]:
        """What is left out, each with its reason where there is one."""
        found = {**self.beside.missing, **self.pictures.broken, **self._left_out}
        return [f"{name} ({reason})" if reason else name for name, reason in found.items()]

    def shading(self, own: str = "lambert") -> str:
        """The shading of a material."""
        return own if self._given is None else self._given

    def plain(self, base_color: tuple[float, float, float]) -> Material:
        """A material without a texture, the same for the same colour."""
        if base_color not in self._plain:
            self._plain[base_color] = Material(self.shading(), base_color, specular=SPECULAR)
        return self._plain[base_color]


def decoded(colors: Float, kind: str = "f", bits: int = 8) -> tuple[Float, Float | None]:
    """Linear RGB (N, 3) and opacity (N,), None where all are 1, of sRGB colours (N, 3 or 4).

    Whole numbers (`kind` "u") are parts of what their bits hold. Floats are parts of 1, or of 255 where one is larger.
    """
    most = float((1 << bits) - 1) if kind == "u" else (255.0 if colors.size and colors.max() > 1.0 else 1.0)
    shares = np.clip(colors / most, 0.0, 1.0)
    opacity = shares[:, 3] if shares.shape[1] > 3 and (shares[:, 3] < 1.0).any() else None
    return decode_srgb(shares[:, :3]), opacity

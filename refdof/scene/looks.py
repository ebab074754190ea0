"""Looks: colours, textures and materials of mesh files, made linear; what is broken is left out and told."""

from typing import Any

import numpy as np

from refdof._check import Float
from refdof.scene.gltf.look import look_of
from refdof.scene.gltf.plain import material_of
from refdof.scene.material import Material

__all__ = ["Looks"]

_MOST_PIXELS = 1 << 26  # of a texture: 8192 x 8192, 805 MB as linear colours
_GREY = (0.5, 0.5, 0.5)  # albedo of what has no colour
_WHITE = (1.0, 1.0, 1.0)  # leaves the colours of a texture or of vertices as they are
_SPECULAR = (0.04, 0.04, 0.04)  # normal reflectance of glass and plastic, glTF 2.0 appendix B
_MAX_SHININESS = 2000.0  # a highlight narrower than a pixel would only flicker


class Looks:
    """Materials as this package wants them; every material and every texture is made once and shared.

    `shading` replaces the file's own if it is given; `header` is a glTF file's. `broken` has textures that are left
    out, with the reason.
    """

    def __init__(self, shading: str | None, header: dict[str, Any] | None) -> None:
        self._shading, self._given = "lambert" if shading is None else shading, shading is not None
        self._header, self.of_gltf = header, header is not None
        self._materials: dict[Any, Material] = {}
        self._textures: dict[int, Float | None] = {}
        self.broken: dict[str, str] = {}

    def of(self, mesh: Any) -> tuple[Float | None, Float | None, Material]:
        """Texture coordinates (V, 2), linear colours (V, 3), or (F, 3) if per face, and the material."""
        visual = mesh.visual
        if visual.kind in ("vertex", "face"):
            colors = visual.vertex_colors if visual.kind == "vertex" else visual.face_colors
            return None, self._linear(colors), self._plain(_WHITE)
        if visual.kind != "texture":
            return None, None, self._plain(_GREY)
        colors = visual.vertex_attributes.get("color", mesh.vertex_attributes.get("color"))
        fits = visual.uv is not None and np.shape(visual.uv) == (len(mesh.vertices), 2)
        uv = np.array(visual.uv) if fits else None
        color = None if colors is None else self._linear(colors)
        return uv, color, self._material(visual.material, uv is not None)

    def _linear(self, colors: Any) -> Float:
        """(N, 3) linear RGB of (N, 3 or 4) colours; glTF stores them linear, all others as sRGB."""
        colors = np.asarray(colors)
        rgb = colors[:, :3] / (np.iinfo(colors.dtype).max if colors.dtype.kind in "ui" else 1.0)
        return rgb if self.of_gltf else _decode_srgb(rgb)

    def _plain(self, base_color: tuple[float, float, float]) -> Material:
        if base_color not in self._materials:
            self._materials[base_color] = Material(self._shading, base_color, specular=_SPECULAR)
        return self._materials[base_color]

    def _material(self, source: Any, has_uv: bool) -> Material:
        """Material of one of trimesh's; the colours of materials are linear already."""
        key = (id(source), has_uv)
        if key not in self._materials:
            shading = self._shading
            if hasattr(source, "baseColorFactor"):
                image, shininess = source.baseColorTexture, _shininess(source.roughnessFactor)
                factor = source.baseColorFactor
                base = _WHITE if factor is None else tuple((factor[:3] / 255.0).tolist())
                glows = source.emissiveFactor is not None and source.emissiveTexture is None
                emission = tuple(source.emissiveFactor.tolist()) if glows else (0.0, 0.0, 0.0)
                index = None if self._header is None else material_of(source.name)
                if self._header is not None and index is not None:
                    look = look_of(self._header, index)
                    base, emission = base if look.base is None else look.base, look.emission
                    shading = "unlit" if look.unlit and not self._given else shading
            else:
                words = getattr(source, "kwargs", {})  # of the .mtl file, as written
                image, emission = getattr(source, "image", None), (0.0, 0.0, 0.0)
                if getattr(image, "format", None) is None:  # from no file: trimesh's stand-in for no material
                    image = None
                base = words.get("kd", _GREY if image is None else _WHITE)
                base = tuple(np.broadcast_to(np.maximum(base, 0.0), 3).tolist())
                shininess = float(np.clip(words.get("ns", 50.0), 1.0, _MAX_SHININESS))
            texture = self._texture(image) if image is not None and has_uv else None
            self._materials[key] = Material(shading, base, texture, emission, _SPECULAR, shininess)
        return self._materials[key]

    def _texture(self, image: Any) -> Float | None:
        """(h, w, 3) float32 linear RGB; None if the image is broken."""
        if id(image) not in self._textures:
            name = f"texture {len(self._textures) + 1}"
            try:
                if image.width * image.height > _MOST_PIXELS:
                    raise ValueError(f"{image.width} x {image.height} pixels; allowed are at most {_MOST_PIXELS}")
                encoded = np.asarray(image.convert("RGB"))
            except (OSError, ValueError, SyntaxError) as error:  # Pillow reads pixels only now
                self._textures[id(image)] = None
                self.broken[name] = " ".join(str(error).split())
            else:
                self._textures[id(image)] = _decode_srgb(np.arange(256) / 255.0).astype(np.float32)[encoded]
        return self._textures[id(image)]


def _shininess(roughness: float | None) -> float:
    """Phong exponent for a glTF roughness: a quarter of the half vector's 2 / roughness^4 - 2."""
    alpha = (1.0 if roughness is None else float(roughness)) ** 2
    return float(np.clip((2.0 / max(alpha * alpha, 1e-6) - 2.0) / 4.0, 1.0, _MAX_SHININESS))


def _decode_srgb(encoded: Float) -> Float:
    """Linear values of sRGB-encoded ones, IEC 61966-2-1."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)

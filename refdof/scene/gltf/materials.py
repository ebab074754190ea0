"""Materials of a glTF file: colours stay floats, pictures are shared, and what is not read is told by name.

1. factors and textures, of the core or of specular-glossiness     `_base`
2. alpha modes: opaque, a cut-out, or transparent                  `_with_alpha`
3. emission, its texture and its strength                          `_with_emission`

A material has one set of texture coordinates, one transform and one way to wrap: those of its base colour, or of its
emission where the base has no texture. An emissive texture in another place is left out; it wraps as the base does.

References
----------
.. [1] Khronos Group (2021), glTF 2.0 Specification: 3.8 (textures, samplers), 3.9 (materials).
.. [2] Khronos Group: KHR_materials_emissive_strength, KHR_materials_unlit, KHR_materials_pbrSpecularGlossiness,
   KHR_texture_transform, EXT_texture_webp, EXT_texture_avif.
"""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from refdof._check import InputError, as_choice, as_float, as_integer, as_number
from refdof.scene.formats.mtl import MAX_SHININESS
from refdof.scene.formats.pictures import Picture
from refdof.scene.formats.reading import SPECULAR, Reading
from refdof.scene.gltf.file import Numbers, bytes_of_uri, member, table_of
from refdof.scene.material import Material

__all__ = ["Dress", "Materials"]

_TRANSFORM = "KHR_texture_transform"
_DIFFUSE = "KHR_materials_pbrSpecularGlossiness"
_STRENGTH = "KHR_materials_emissive_strength"
_MODES = ("OPAQUE", "MASK", "BLEND")
_WRAPS = {33071: "clamp", 33648: "mirror", 10497: "repeat"}
_NEAREST = (9728, 9984, 9986)
_PICTURES_OF = ("EXT_texture_webp", "EXT_texture_avif")
_MOST_SETS = 64  # of texture coordinates


class Dress(NamedTuple):
    """What a primitive gets of a material; its texture coordinates are the set `texcoord`, moved by `transform`."""

    material: Material
    texcoord: int | None  # None: it has no texture
    transform: dict[str, Any]
    is_opaque: bool  # alpha of vertices does not count


class _Texture(NamedTuple):
    picture: Picture | None
    texcoord: int
    transform: dict[str, Any]
    wrap: tuple[str, str]

    def place(self) -> tuple:
        return self.texcoord, self.transform


class Materials:
    """The materials of a file, made when they are first asked for."""

    def __init__(self, header: dict[str, Any], numbers: Numbers, reading: Reading) -> None:
        self._header, self._numbers, self._reading = header, numbers, reading
        self._made: dict[Any, Dress] = {}

    def of(self, index: Any, sets: frozenset[int]) -> Dress:
        """The dress of a primitive with a material, or None, and with these sets of texture coordinates.

        Raises
        ------
        InputError
            If the material, or what it points at, is not as the specification demands.
        """
        if (index, sets) not in self._made:
            self._made[index, sets] = self._dress(
                {} if index is None else member(self._header, "materials", index), sets
            )
        return self._made[index, sets]

    def _dress(self, says: dict[str, Any], sets: frozenset[int]) -> Dress:
        extensions = table_of(says, "extensions")
        rgba, texture, roughness = self._base(says, extensions)
        base = None if texture is None else self._texture(texture, sets)
        glow = self._texture(says["emissiveTexture"], sets) if "emissiveTexture" in says else None
        first = base or glow
        picture = None if base is None else base.picture
        material = Material(
            self._reading.shading("unlit" if "KHR_materials_unlit" in extensions else "lambert"),
            rgba[:3],
            None if picture is None else picture.color,
            specular=SPECULAR,
            shininess=_shininess(roughness),
            wrap=("repeat", "repeat") if first is None else first.wrap,
        )
        material = self._with_emission(material, says, extensions, glow, first)
        mode = as_choice("alphaMode", says.get("alphaMode", "OPAQUE"), _MODES)
        self._tell(says)
        if mode != "OPAQUE":
            material = _with_alpha(material, says, mode, rgba[3], picture)
        texcoord = None if first is None else first.texcoord
        return Dress(material, texcoord, {} if first is None else first.transform, mode == "OPAQUE")

    def _base(self, says: dict[str, Any], extensions: dict[str, Any]) -> tuple[Any, dict[str, Any] | None, float]:
        """Factor (RGBA), texture and roughness of the base colour."""
        if _DIFFUSE in extensions:
            rough = table_of(extensions, _DIFFUSE)
            names = ("diffuseFactor", "diffuseTexture")
            roughness = 1.0 - as_number(
                "glossinessFactor", rough.get("glossinessFactor", 1.0), minimum=0.0, maximum=1.0
            )
            if "specularGlossinessTexture" in rough:
                self._reading.leave_out("specular-glossiness textures")
        else:
            rough = table_of(says, "pbrMetallicRoughness")
            names = ("baseColorFactor", "baseColorTexture")
            roughness = as_number("roughnessFactor", rough.get("roughnessFactor", 1.0), minimum=0.0, maximum=1.0)
            if as_number("metallicFactor", rough.get("metallicFactor", 0.0)) > 0.0:
                self._reading.leave_out("metallicFactor", "no surface is metallic")
            if "metallicRoughnessTexture" in rough:
                self._reading.leave_out("metallic-roughness textures")
        given = rough.get(names[0], [1.0, 1.0, 1.0, 1.0])
        factor = as_float(names[0], given, (None,), dtype=np.float64, minimum=0.0)
        if len(factor) != 4:
            raise InputError(f"{names[0]}: got {len(factor)} numbers; allowed are 4")
        return tuple(factor.tolist()), table_of(rough, names[1]) if names[1] in rough else None, roughness

    def _tell(self, says: dict[str, Any]) -> None:
        for key, what in (("normalTexture", "normal textures"), ("occlusionTexture", "occlusion textures")):
            if key in says:
                self._reading.leave_out(what)

    def _with_emission(
        self,
        material: Material,
        says: dict[str, Any],
        extensions: dict[str, Any],
        glow: _Texture | None,
        first: _Texture | None,
    ) -> Material:
        factor = says.get("emissiveFactor", [0.0, 0.0, 0.0])
        light = as_float("emissiveFactor", factor, (3,), dtype=np.float64, minimum=0.0)
        strength = table_of(extensions, _STRENGTH).get("emissiveStrength", 1.0)
        red, green, blue = (light * as_number("emissiveStrength", strength, minimum=0.0)).tolist()
        if "emissiveTexture" not in says or not light.any():
            return replace(material, emission=(red, green, blue))
        if glow is not None and first is not None and glow.place() != first.place():
            self._reading.leave_out("an emissive texture", "it is placed otherwise than the base colour's")
            glow = None
        if glow is not None and first is not None and glow.wrap != first.wrap:
            self._reading.leave_out("the wrapping of an emissive texture", "the base colour's holds for both")
        if glow is None or glow.picture is None:  # a factor alone would glow all over
            return material
        return replace(material, emission=(red, green, blue), emission_texture=glow.picture.color)

    def _texture(self, info: Any, sets: frozenset[int]) -> _Texture | None:
        """A texture that a material names; None if it cannot be placed."""
        if not isinstance(info, dict):
            raise InputError(f"texture: got {type(info).__name__}; allowed is an object")
        transform = table_of(table_of(info, "extensions"), _TRANSFORM)
        chosen = as_integer(
            "texCoord", transform.get("texCoord", info.get("texCoord", 0)), minimum=0, maximum=_MOST_SETS
        )
        texture = member(self._header, "textures", info.get("index"))
        if chosen not in sets:
            self._reading.leave_out(f"texture {info['index']}", f"a mesh has no TEXCOORD_{chosen}")
            return None
        wrap = self._wrap(texture)
        return _Texture(self._picture(info["index"], texture), chosen, transform, wrap)

    def _wrap(self, texture: dict[str, Any]) -> tuple[str, str]:
        if "sampler" not in texture:
            return "repeat", "repeat"
        sampler = member(self._header, "samplers", texture["sampler"])
        if sampler.get("magFilter") in _NEAREST or sampler.get("minFilter") in _NEAREST:
            self._reading.leave_out("nearest filtering", "textures are bilinear")
        codes = [sampler.get(key, 10497) for key in ("wrapS", "wrapT")]
        for code in codes:
            if not isinstance(code, int) or code not in _WRAPS:
                raise InputError(f"samplers: wraps by {str(code)[:40]}; allowed are {', '.join(map(str, _WRAPS))}")
        return _WRAPS[codes[0]], _WRAPS[codes[1]]

    def _picture(self, index: int, texture: dict[str, Any]) -> Picture | None:
        extensions = table_of(texture, "extensions")
        source = next((table_of(extensions, name)["source"] for name in _PICTURES_OF if name in extensions), None)
        source = texture.get("source") if source is None else source
        if source is None:
            self._reading.leave_out(
                f"texture {index}", f"it has no image but of {', '.join(extensions) or 'none'}"[:80]
            )
            return None
        image = member(self._header, "images", source)
        name = f"texture {index + 1}"
        try:
            if "bufferView" in image:
                data = self._numbers.view(f"images {source}", image["bufferView"])
            else:
                uri = str(image.get("uri"))
                data = bytes_of_uri(uri, self._reading.beside.get)
                name = name if uri.startswith("data:") else uri
        except FileNotFoundError:
            return None  # it is told as missing
        return self._reading.pictures.get(("image", source), name, data)


def _with_alpha(material: Material, says: dict[str, Any], mode: str, alpha: float, picture: Picture | None) -> Material:
    opacity = min(alpha, 1.0)
    texture = None if picture is None else picture.opacity
    if mode == "BLEND":
        return replace(material, opacity=opacity, opacity_texture=texture)
    cutoff = as_number("alphaCutoff", says.get("alphaCutoff", 0.5), minimum=0.0)
    if cutoff > 1.0:  # nothing is as opaque
        opacity, cutoff = 0.0, 1.0
    return replace(material, opacity=opacity, opacity_texture=texture, cutoff=cutoff)


def _shininess(roughness: float) -> float:
    """Phong exponent for a roughness: a quarter of the half vector's 2 / roughness^4 - 2."""
    alpha = roughness**2
    return float(np.clip((2.0 / max(alpha * alpha, 1e-6) - 2.0) / 4.0, 1.0, MAX_SHININESS))
